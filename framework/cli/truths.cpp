// tumble truths FOLDER: results of this project against reference values computed elsewhere at high
// precision.
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>

#include "framework/cli/json_output.h"
#include "framework/cli/module_choice.h"
#include "framework/cli/read_truth.h"
#include "framework/cli/truths_table.h"
#include "framework/cli/verb.h"
#include "framework/core/version.h"
#include "framework/truths/families.h"
#include "framework/truths/module_truths.h"

namespace tumble::cli {
namespace {

using truths::Case;
using truths::Comparison;
using truths::Verdict;

struct TruthsOptions {
  std::filesystem::path folder;
  // as after --modules; empty: the reference where this tree has one, else the student
  std::string modules;
  bool each = false;
  bool json = false;
};

/// The chosen modules, as function tables and as laws.
struct Chosen {
  std::map<std::string, modules::AnyModule> tables;  // by id
  Laws laws = library_laws();
};

bool mentions(const std::filesystem::path& source, const std::string& word) {
  std::ifstream stream(source);
  return std::string(std::istreambuf_iterator<char>(stream), {}).find(word) != std::string::npos;
}

/// The file of a module in a choice that names no module: student, reference, a file of this
/// module, or a submission's folder (ID.so, else the student's file by its name). Empty: the choice
/// has nothing of this module.
std::string word_for(const modules::ModuleKind& kind, const std::string& choice) {
  namespace fs = std::filesystem;
  const fs::path path = choice;
  if (fs::is_directory(path)) {
    for (const std::string& name : {kind.id + ".so", kind.folder + ".cpp"})
      if (fs::exists(path / name)) return path / name;
    return "";
  }
  // A source file includes its own module's header, which is in the assignment's folder.
  if (path.extension() == ".cpp" && fs::exists(path))
    return mentions(path, "assignments/" + kind.folder + "/") ? choice : "";
  return choice;
}

/// @param choice  as after --modules: one word for all modules, or a1=WORD,a2=WORD
Chosen load_modules(const Context& context, const std::string& choice) {
  namespace fs = std::filesystem;
  const ModuleWords words = parse_module_words(choice, context.registry);
  Chosen chosen;
  bool any_loaded = false;
  for (const modules::ModuleKind* kind : context.registry.all()) {
    const bool built = fs::exists(context.build / "modules" / (kind->id + "_reference.so"));
    const std::string otherwise = built ? "reference" : "student";
    modules::AnyModule table;
    if (const auto own = words.find(kind->id); own != words.end()) {
      table = load_word(context, *kind, own->second);
    } else if (const auto all = words.find(""); all != words.end()) {
      const std::string word = word_for(*kind, all->second);
      try {
        if (!word.empty()) table = load_word(context, *kind, word);
      } catch (const UserError&) {
        // a shared object of another module: tried with the next
        if (fs::path(word).extension() != ".so" || !fs::exists(word)) throw;
      }
    }
    any_loaded = any_loaded || table != nullptr;
    if (table == nullptr) table = load_word(context, *kind, otherwise);
    kind->bind(table, chosen.laws);
    chosen.tables[kind->id] = table;
  }
  if (!any_loaded && !choice.empty())
    throw UserError("--modules " + choice, "holds no module of any assignment",
                    "Give student, reference, a file that implements a module's header (.cpp or "
                    ".so), or a folder with such files.");
  return chosen;
}

/// All comparisons of a case; nothing for an unknown family.
std::optional<CaseResult> compute(const Context& context, const Chosen& chosen, const Case& truth) {
  Comparison comparison;
  bool known = false;
  if (const auto family = truths::framework_families().find(truth.family);
      family != truths::framework_families().end()) {
    comparison.attempt(truth.family, [&] { family->second(truth, chosen.laws, comparison); });
    known = true;
  }
  for (const modules::ModuleKind* kind : context.registry.all()) {
    const auto families = kind->note<truths::ModuleTruths>().families;
    const auto family = families.find(truth.family);
    if (family == families.end()) continue;
    comparison.attempt(truth.family,
                       [&] { family->second(chosen.tables.at(kind->id), truth, comparison); });
    known = true;
  }
  if (!known) return std::nullopt;
  return CaseResult{truth.id, truth.family, comparison.lines()};
}

/// A file that cannot be read: its error and remedy.
struct OddFile {
  std::string file, problem;
};

/// A line on stderr every ten seconds: the number of files done, and the estimated remaining time.
class Progress {
 public:
  explicit Progress(std::size_t count) : count_(count) {}
  /// Called before each file.
  void tell() {
    constexpr double kEvery = 10.0;  // s
    const double now =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begun_).count();
    if (now - told_ >= kEvery) {
      std::fprintf(stderr, "tumble: %zu of %zu files, about %.0f s left\n", done_, count_,
                   now / static_cast<double>(done_) * static_cast<double>(count_ - done_));
      told_ = now;
    }
    ++done_;
  }

 private:
  std::size_t count_, done_ = 0;
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
  double told_ = 0.0;  // [s]
};

ExitCode exit_code(const std::vector<CaseResult>& results, const std::vector<OddFile>& odd) {
  if (count_cases(results, Verdict::kWrong) > 0) return ExitCode::kCheckFailed;
  if (!odd.empty()) return ExitCode::kUserError;
  return count_cases(results, Verdict::kNotAttempted) > 0 ? ExitCode::kNotAttempted
                                                          : ExitCode::kFine;
}

ExitCode run_truths(const Context& context, const TruthsOptions& options) {
  const std::vector<std::filesystem::path> files = find_truths(options.folder);
  const Chosen chosen = load_modules(context, options.modules);
  std::vector<CaseResult> results;
  std::map<std::string, int> skipped;
  std::set<std::string> said;  // hints
  if (!options.json) print_truths_head();
  std::vector<OddFile> odd;
  Progress progress(files.size());
  // Compares file by file.
  for (const auto& file : files) {
    progress.tell();
    try {
      const Case truth = read_truth(file);
      const std::optional<CaseResult> result = compute(context, chosen, truth);
      if (!result) {
        ++skipped[truth.family];
        continue;
      }
      results.push_back(*result);
      if (!options.json) print_truths_case(*result, options.each, said), std::fflush(stdout);
      // one wrong file does not prevent the comparison of the others
    } catch (const UserError& error) {
      if (files.size() == 1) throw;
      odd.push_back({file.string(), error.what()});
      std::fprintf(stderr, "tumble: %s\n", error.what());
    }
  }
  // The result as JSON or as a table.
  if (options.json) {
    nlohmann::ordered_json all{{"command", context.command_line},
                               {"version", kProgramVersion},
                               {"modules", options.modules}};
    all.update(truths_to_json(results, skipped));
    all["odd_files"] = nlohmann::ordered_json::array();
    for (const OddFile& one : odd)
      all["odd_files"].push_back({{"file", one.file}, {"problem", one.problem}});
    std::printf("%s\n", json_text(all, 1).c_str());
  } else {
    print_truths_count(results, skipped);
    if (!odd.empty())
      std::printf("%zu file%s could not be compared, the first: %s\n", odd.size(),
                  odd.size() == 1 ? "" : "s", odd.front().problem.c_str());
  }
  return exit_code(results, odd);
}

}  // namespace

void add_truths(CLI::App& app, Context& context) {
  auto options = std::make_shared<TruthsOptions>();
  Verb verb(app, "truths", "Compare results with reference values of high precision");
  verb.option("folder", options->folder,
              "Folder of files of reference values, or one file (tests/truths)")
      .required();
  verb.option("--modules", options->modules,
              "student, reference, PATH.cpp, PATH.so, a folder of them; or a1=WORD,a2=WORD")
      .default_text("reference where this tree has one, else student");
  verb.flag("--each", options->each,
            "Show every output, not only the one closest to its tolerance");
  verb.flag("--json", options->json, "The same for machines");
  verb.runs([&context, options] { context.exit = run_truths(context, *options); });
}

}  // namespace tumble::cli
