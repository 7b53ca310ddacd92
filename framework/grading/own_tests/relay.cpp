#include "framework/grading/own_tests/relay.h"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <set>

#include "framework/grading/sandbox/protection.h"
#include "framework/grading/test_program/test_words.h"
#include "framework/grading/verdicts/call_log.h"
#include "framework/grading/verdicts/plain_text.h"
#include "framework/grading/verdicts/verdict_table.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;
using Ending = SandboxOutcome::Ending;

constexpr const char* kProgramInside = "/tests";
constexpr std::size_t kMostTests = 100;  // a file of a hundred tests is long
constexpr std::size_t kMostDeaths = 5;   // of the program: then the rest is not run
constexpr std::size_t kLongestName = 120;
constexpr std::uint64_t kOwnCpu = 5;  // s of the tests' own CPU time: they ask, and compare numbers
constexpr double kStall = 15.0;       // s in which the tests neither compute nor wait for a core
// s in all: many short naps would make one run long. They wait for the module's answers, too, which
// take some seconds where the machine has nothing else to do.
constexpr double kIdle = 100.0;
constexpr double kWall = 300.0;  // s: a loaded machine is not the tests' fault

struct Words {
  WorkerOptions worker;
  fs::path tests, json;
};

Words read_words(const char* id, int argc, char** argv) {
  Words words;
  words.worker.id = id;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto value = [&] { return value_after(argc, argv, i); };
    if (word == "--submission")
      words.worker.module = value();
    else if (word == "--tests")
      words.tests = value();
    else if (word == "--json")
      words.json = value();
    else if (word == "--quick")
      words.worker.call_own_s = 2.0;
    else
      throw UserError(word, "is not known here",
                      "Known: --tests PROGRAM, --submission FILE.so, --json FILE, --quick.");
  }
  if (words.worker.module.empty() || words.tests.empty())
    throw UserError(words.tests.empty() ? "--tests" : "--submission", "is missing");
  return words;
}

// A name of GoogleTest's, and nothing else: it is shown in pages and terminals.
bool is_name(const std::string& name) {
  return name.size() <= kLongestName && name.find('.') != std::string::npos &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) {
           return std::isalnum(c) != 0 || c == '.' || c == '_' || c == '/';
         });
}

/// The tests of one program against one module.
class Run {
 public:
  Run(const Words& words, const Relay& relay)
      : relay_(relay), connection_(words.worker), user_(SandboxUser::lease()), stage_(&user_) {
    const WorkerPrograms programs = worker_programs(words.worker.id, words.worker.programs);
    job_.kind = chosen_sandbox();
    if (traits_of(job_.kind).links_worker)
      throw UserError("own tests", "cannot run in the sandbox 'bare', in which no file is opened",
                      "tumble doctor says how to get a stronger one.");
    if (traits_of(job_.kind).needs_init) job_.init = stage_.add_file(programs.init, "init", true);
    job_.binds = {{stage_.add_file(words.tests, "tests", true), kProgramInside}};
    job_.uid = user_.uid();
    job_.limits.wall_s = kWall;
    job_.limits.cpu_s = kOwnCpu;
    job_.limits.stall_s = kStall;
    job_.limits.idle_s = kIdle;
    job_.limits.tmp_bytes = 0;
    job_.is_alone = true;
  }

  std::vector<TestResult> all() {
    for (std::size_t deaths = 0; deaths < kMostDeaths; ++deaths) {
      const std::size_t before = results_.size();
      const SandboxOutcome outcome = once();
      if (outcome.ending == Ending::kNotStarted)
        throw std::runtime_error("the sandbox did not start: " + outcome.printed);
      said_ = outcome.printed;
      if (!running_.empty()) {
        finish(died(outcome), "the program with the tests " + how_it_ended(outcome));
      } else if (outcome.ending == Ending::kExited && outcome.code <= 1) {
        break;
      } else if (results_.size() == before) {
        break;  // it dies before its first test: a restart would do the same
      }
    }
    return results_;
  }

  /// What the tests printed.
  const std::string& said() const { return said_; }

 private:
  SandboxOutcome once() {
    int pair[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0)
      throw std::runtime_error("no descriptor left for a program with tests");
    job_.channel = pair[1];
    job_.command = {kProgramInside, std::to_string(results_.size())};
    Sandbox sandbox = Sandbox::start(job_);
    ::close(pair[1]);
    {
      modules::Channel channel(modules::Channel::End::kAnswers, pair[0], pair[0]);
      relay_(connection_, channel, [this](modules::Reader& reader) { take(reader); });
    }
    ::close(pair[0]);
    connection_.reset();
    return sandbox.wait();
  }

  void take(modules::Reader& reader) {
    std::string test, said;
    TestReport what{};
    reader.value(test);
    reader.value(what);
    reader.value(said);
    if (!is_name(test)) throw modules::WireError("a name that no test has");
    if (what == TestReport::kBegins) {
      if (!running_.empty() || results_.size() >= kMostTests || !seen_.insert(test).second)
        throw modules::ChannelClosed("reports tests that it cannot have");
      running_ = test;
      call_log() = CallLog{};
    } else if (test == running_) {
      finish(what == TestReport::kPassed ? Verdict::kRight : Verdict::kWrong, said);
    }
  }

  // A failed test whose module did not answer has the verdict of that.
  void finish(Verdict verdict, const std::string& said) {
    const CallLog& log = call_log();
    TestResult result;
    result.test = running_;
    result.last_call = log.last_call;
    result.calls = log.calls;
    result.verdict = verdict == Verdict::kRight || !log.noted ? verdict : log.verdict;
    if (verdict != Verdict::kRight) result.story = plain_text(log.noted ? log.story : said);
    results_.push_back(std::move(result));
    running_.clear();
    if (log.noted && verdict != Verdict::kRight) connection_.reset();
    call_log() = CallLog{};
  }

  static Verdict died(const SandboxOutcome& outcome) {
    switch (outcome.ending) {
      case Ending::kWallLimit: return Verdict::kMachineBusy;
      case Ending::kStalled:
      case Ending::kOutputLimit:
      case Ending::kDiskLimit: return Verdict::kOutOfResources;
      case Ending::kSignal:
        return outcome.cpu_s >= static_cast<double>(kOwnCpu) - 1.0 ? Verdict::kOutOfResources
                                                                   : Verdict::kCrashed;
      default: return Verdict::kCrashed;
    }
  }

  static std::string how_it_ended(const SandboxOutcome& outcome) {
    switch (outcome.ending) {
      case Ending::kSignal: return "ended with " + signal_words_of(outcome.code);
      case Ending::kStalled: return "waited too long";
      case Ending::kOutputLimit: return "printed more than its limit";
      case Ending::kExited:
        return "ended with code " + std::to_string(outcome.code) + " inside the test";
      default: return "did not end the test";
    }
  }

  const Relay& relay_;
  WorkerConnection connection_;
  SandboxUser user_;
  Stage stage_;
  SandboxJob job_;
  std::vector<TestResult> results_;
  std::set<std::string> seen_;
  std::string running_, said_;
};

int run(const char* id, const Relay& relay, int argc, char** argv) {
  const Words words = read_words(id, argc, argv);
  Run run(words, relay);
  const std::vector<TestResult> results = run.all();
  if (!words.json.empty()) {
    write_results(words.json.string(), results);
    return static_cast<int>(exit_code(results));
  }
  if (!run.said().empty()) std::cout << "your tests printed:\n" << plain_text(run.said()) << '\n';
  if (results.empty()) {
    std::cout << "no test ran: the file has none, or its program ends before the first\n";
    return static_cast<int>(ExitCode::kCheckFailed);
  }
  TableWords table = table_words_for(STDOUT_FILENO);
  table.all = true;
  print_verdicts(std::cout, results, {}, table);
  return static_cast<int>(exit_code(results));
}

}  // namespace

int run_relay_program(const char* id, const Relay& relay, int argc, char** argv) {
  try {
    return run(id, relay, argc, argv);
  } catch (const UserError& error) {
    std::cerr << error.what() << '\n';
    return static_cast<int>(ExitCode::kUserError);
  } catch (const std::exception& error) {
    std::cerr << "own tests could not be run: " << error.what() << '\n';
    return static_cast<int>(ExitCode::kOurBug);
  }
}

}  // namespace tumble::grading
