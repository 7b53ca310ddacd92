#include "framework/grading/attacks/run_attacks.h"

#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <random>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/grading/attacks/make_attack.h"
#include "framework/grading/attacks/watchers.h"
#include "framework/core/run_program.h"
#include "framework/grading/grades/grade_files.h"
#include "framework/grading/grades/ledger.h"
#include "framework/grading/verdicts/plain_text.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kHonest = "honest";
constexpr std::size_t kNamed = 5;  // attacks that a fault of all of them names
constexpr int kMostAgain = 2;  // times that the same command is given where the machine was busy
constexpr double kLongest = 3600.0;                  // s of one grading of many
constexpr std::uintmax_t kLargestOutput = 8u << 20;  // bytes of a submission's results

std::string random_word() {
  std::random_device source;  // a secret: not to be the same in two runs
  return fmt::format("{:08x}{:08x}", source(), source());
}

void write_readable(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  write_whole(file, text);
  fs::permissions(file, fs::perms{0644});
}

// A secret in the environment of the grader, for its lifetime.
class Environment {
 public:
  Environment(const AttackPlaces& places, const std::string& secret) {
    ::setenv("TUMBLE_ROOT", places.at("root").c_str(), 1);
    ::setenv("TUMBLE_GRADER_KEY", places.at("key").c_str(), 1);
    ::setenv("TUMBLE_CANARY", secret.c_str(), 1);
  }
  ~Environment() {
    ::unsetenv("TUMBLE_GRADER_KEY");
    ::unsetenv("TUMBLE_CANARY");
  }
};

/// Attacks of one assignment, graded together.
class Batch {
 public:
  Batch(std::vector<const Attack*> attacks, const AttackOptions& options)
      : attacks_(std::move(attacks)), options_(options), watchers_("tumble-mark-" + random_word()) {
    // everybody may enter and read: that a submission reads nothing there is the sandbox's doing
    fs::permissions(folder_.path(), fs::perms{0755});
    for (const auto& entry : fs::directory_iterator(options.root / "assignments"))
      if (entry.path().filename().string().starts_with(id() + "_")) assignment_ = entry.path();
    if (assignment_.empty()) throw UserError(id(), "is no assignment of this tree");
    name_places();
  }

  void run(AttackReport& report) {
    const std::string honest = text_of(reference()) + "// " + secret_ + "\n";
    grade_harmless(honest, report);
    write_readable(path("in") / kHonest / source_name(), honest);
    places_["honest"] = (path("in") / kHonest / source_name()).string();
    for (const Attack* attack : attacks_) {
      places_["me"] = attack->folder;
      make_attack(*attack, text_of(attack->base == "stub" ? stub() : reference()), source_name(),
                  places_, path("in") / attack->folder);
    }
    const auto before = listing(path("in"));
    const ProgramOutcome outcome = grade("in", "out", attacks_.front()->media);
    check_grader(outcome, report);
    if (listing(path("in")) != before) fault(report, "a submission was changed");
    if (text_of(path("secret.txt")) != secret_ + "\n") fault(report, "the secret was changed");
    for (const std::string& found : watchers_.found({path("in"), path("out"), options_.build}))
      fault(report, found);
    check_outputs(outcome.printed, report);
    for (const Attack* attack : attacks_) report.attacks.push_back(result_of(*attack));
  }

 private:
  std::string id() const { return attacks_.front()->module; }
  std::string source_name() const { return assignment_.filename().string() + ".cpp"; }
  fs::path stub() const { return assignment_ / source_name(); }
  fs::path solution() const { return options_.root / "solutions_private" / assignment_.filename(); }
  fs::path reference() const { return solution() / source_name(); }
  fs::path path(const std::string& name) const { return folder_.path() / name; }

  void fault(AttackReport& report, const std::string& what) const {
    std::string names;
    for (const Attack* attack : attacks_) names += " " + attack->name;
    if (attacks_.size() > kNamed) names = fmt::format(" one of {} attacks", attacks_.size());
    report.faults.push_back(options_.sandbox + ", " + id() + ": " + what + " (by" + names + ")");
  }

  void name_places() {
    write_readable(path("secret.txt"), secret_ + "\n");
    fs::create_directories(path("key"));
    fs::permissions(path("key"), fs::perms{0700});
    places_ = {{"secret", path("secret.txt").string()},
               {"mark", watchers_.socket_name()},
               {"port", std::to_string(watchers_.port())},
               {"socket", watchers_.socket_name()},
               {"root", options_.root.string()},
               {"build", options_.build.string()},
               {"submissions", path("in").string()},
               {"results", path("out").string()},
               {"honest", ""},
               {"me", ""},
               {"reference", reference().string()},
               {"hidden", (solution() / "rubric_hidden.json").string()},
               {"judge", (options_.build / "bin" / ("judge_" + id())).string()},
               {"key", (path("key") / "grader.key").string()},
               {"pid", std::to_string(::getpid())}};
  }

  ProgramOutcome grade(const std::string& in, const std::string& out, bool media) const {
    const Environment environment(places_, secret_);
    std::vector<std::string> words = {(options_.build / "bin/tumble").string(),
                                      "grade",
                                      id(),
                                      path(in).string(),
                                      "--out",
                                      path(out).string(),
                                      "--jobs",
                                      std::to_string(options_.jobs),
                                      "--sandbox",
                                      options_.sandbox,
                                      "--accept-sandbox",
                                      options_.sandbox};
    if (!media) words.push_back("--no-media");
    if (options_.progress)
      options_.progress(fmt::format("{}, {}: grading {}", options_.sandbox, id(),
                                    in == "in" ? fmt::format("{} hostile submissions and an honest "
                                                             "one",
                                                             attacks_.size())
                                               : "harmless submissions"));
    ProgramOutcome outcome = run_program(words, Output::kCaptured, kLongest);
    for (int again = 0; again < kMostAgain && was_busy(outcome); ++again)
      outcome = run_program(words, Output::kCaptured, kLongest);
    return outcome;
  }

  // Whether the machine alone stood in the way: the same command then goes on with what is left. A
  // fault of the grader is not run again, because an attack may be behind it.
  static bool was_busy(const ProgramOutcome& outcome) {
    const auto says = [&](Verdict verdict) {
      return outcome.printed.find(words(verdict)) != std::string::npos;
    };
    return outcome.in_time && says(Verdict::kMachineBusy) && !says(Verdict::kGraderFault);
  }

  // The honest submission alone, and what the attacks are compared with.
  void grade_harmless(const std::string& honest, AttackReport& report) {
    write_readable(path("harmless") / kHonest / source_name(), honest);
    for (const Attack* attack : attacks_) {
      std::string text = text_of(stub());
      if (attack->base != "stub") {
        text = text_of(reference());
        for (const std::string& function : attack->functions())
          text = with_body(text, function,
                           "  throw ::tumble::NotImplemented(\"" + function + "\", \"hints\");\n",
                           attack->file.string());
      }
      if (attack->harmless() != "reference")
        write_readable(path("harmless") / attack->harmless() / source_name(), text);
    }
    const ProgramOutcome outcome = grade("harmless", "harmless_out", false);
    if (outcome.code != 0)
      throw UserError((options_.build / "bin/tumble").string(),
                      "cannot grade harmless submissions: " + outcome.printed);
    honest_ = text_of(path("harmless_out") / kHonest / "results.json");
    if (Json::parse(honest_).at("score") != 100.0)
      fault(report, "the honest submission has less than all points");
  }

  void check_grader(const ProgramOutcome& outcome, AttackReport& report) const {
    const bool is_blank = std::any_of(attacks_.begin(), attacks_.end(), [](const Attack* attack) {
      return attack->states.contains("nothing to compile");
    });
    if (!outcome.in_time) fault(report, "the grading did not end");
    if (outcome.code != (is_blank ? 1 : 0))
      fault(report, fmt::format("the grader ended with exit code {}: {}", outcome.code,
                                outcome.printed.substr(0, 2000)));
    if (text_of(path("out") / kHonest / "results.json") != honest_)
      fault(report, "the honest submission's results.json is not the same as without attacks");
  }

  // Every file of the results: no secret, nothing but ordinary files, no cell of the gradebook that
  // a spreadsheet would compute.
  void check_outputs(const std::string& printed, AttackReport& report) const {
    const auto hold_secret = [&](const std::string& text) {
      const std::string key = text_of(places_.at("key"));
      return text.find(secret_) != std::string::npos ||
             (!key.empty() && text.find(key) != std::string::npos);
    };
    if (hold_secret(printed)) fault(report, "a secret was printed by the grader");
    for (const auto& entry : fs::recursive_directory_iterator(path("out"))) {
      const std::string name = entry.path().lexically_relative(path("out")).string();
      if (!entry.is_directory() && !fs::is_regular_file(entry.symlink_status()))
        fault(report, "among the results is no ordinary file: " + name);
      else if (entry.is_regular_file() && hold_secret(text_of(entry.path())))
        fault(report, "a secret stands in " + name);
    }
    std::istringstream book(text_of(path("out") / "gradebook.csv"));
    for (std::string line; std::getline(book, line);)
      for (std::size_t at = 0; at != std::string::npos; at = line.find(',', at + 1)) {
        const std::size_t cell = line.find_first_not_of(",\" ", at);
        if (cell != std::string::npos && std::string("=+-@").find(line[cell]) != std::string::npos)
          fault(report, "a spreadsheet would compute a cell of the gradebook: " + line);
      }
  }

  // The folder of a submission's results; empty where the ledger names none.
  fs::path results_of(const Attack& attack) const {
    for (const auto& [folder, entry] : latest_entries(read_ledger(path("out") / kLedgerFile)))
      if (entry.name == plain_name(attack.folder) || folder == attack.folder)
        return path("out") / folder;
    return {};
  }

  AttackResult result_of(const Attack& attack) const {
    AttackResult result{attack.name, options_.sandbox, "", 0.0, 0.0, {}};
    const fs::path folder = results_of(attack);
    if (folder.empty()) {
      result.faults.push_back("the ledger does not name it");
      return result;
    }
    const std::string harmless =
        attack.harmless() == "reference"
            ? honest_
            : text_of(path("harmless_out") / attack.harmless() / "results.json");
    compare_results(attack, text_of(folder / "results.json"), text_of(folder / "record.json"),
                    harmless, result);
    std::uintmax_t bytes = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (!entry.is_regular_file() || entry.path().parent_path().filename() == "media") continue;
      bytes += entry.file_size();
      if (entry.path().extension() != ".html") continue;
      const std::string text = text_of(entry.path());
      for (const std::string& never : attack.never)
        if (text.find(never) != std::string::npos)
          result.faults.push_back(entry.path().filename().string() + " holds '" + never + "'");
    }
    if (bytes > kLargestOutput)
      result.faults.push_back(fmt::format("its results have {} bytes", bytes));
    const Json times = Json::parse(text_of(path("out") / "times.json"), nullptr, false);
    if (!times.is_discarded())
      result.seconds = times.at("seconds").value(folder.filename().string(), 0.0);
    return result;
  }

  // Names, kinds and contents.
  static std::map<std::string, std::string> listing(const fs::path& folder) {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      const auto status = entry.symlink_status();
      std::string about = std::to_string(static_cast<int>(status.type())) + " " +
                          std::to_string(static_cast<unsigned>(status.permissions()));
      if (fs::is_regular_file(status) && entry.file_size() < kLargestOutput)
        about += text_of(entry.path());
      all[entry.path().string()] = about;
    }
    return all;
  }

  std::vector<const Attack*> attacks_;
  const AttackOptions& options_;
  PrivateFolder folder_;
  Watchers watchers_;
  fs::path assignment_;
  const std::string secret_ = "tumble-secret-" + random_word();
  AttackPlaces places_;
  std::string honest_;  // results.json
};

}  // namespace

bool AttackReport::is_good() const {
  return faults.empty() && std::all_of(attacks.begin(), attacks.end(),
                                       [](const AttackResult& r) { return r.faults.empty(); });
}

AttackReport run_attacks(const std::vector<Attack>& attacks, const AttackOptions& options) {
  std::map<std::pair<std::string, bool>, std::vector<const Attack*>> batches;
  for (const Attack& attack : attacks)
    if (!attack.not_in.contains(options.sandbox) && (!attack.needs_root || ::geteuid() == 0))
      batches[{attack.module, attack.media}].push_back(&attack);
  AttackReport report;
  for (const auto& batch : batches) Batch(batch.second, options).run(report);
  return report;
}

}  // namespace tumble::grading
