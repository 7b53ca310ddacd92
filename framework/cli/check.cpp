// tumble check a1 [FILE] [TEST...]: the student's loop.
#include <memory>

#include <nlohmann/json.hpp>

#include "framework/cli/check_program.h"
#include "framework/cli/json_output.h"

namespace tumble::cli {
namespace {

// The verdicts for other programs, such as an editor.
ExitCode check_for_machines(const Command& command, const CheckWords& words) {
  const CheckedTests checked = check_quietly(command, words);
  nlohmann::ordered_json tests = nlohmann::ordered_json::array();
  for (const grading::TestResult& result : checked.results)
    tests.push_back({{"test", result.test},
                     {"verdict", grading::words(result.verdict)},
                     {"story", result.story},
                     {"calls", result.calls},
                     {"last_call", result.last_call},
                     {"printed", result.printed}});
  print_json(command, {{"assignment", words.id},
                       {"file", checked_file(command, words).string()},
                       {"why_no_test_ran", checked.said},
                       {"tests", std::move(tests)}});
  return checked.said.empty() ? grading::exit_code(checked.results) : ExitCode::kCheckFailed;
}

}  // namespace

void add_check(CLI::App& app, Command& command) {
  auto given = std::make_shared<GivenWords>();
  auto own_tests = std::make_shared<std::string>();
  Verb verb(app, "check", "Build your file and run the public tests: a verdict and a story each");
  add_check_words(verb, *given);
  auto json = std::make_shared<bool>(false);
  verb.flag("--json", *json, "For machines");
  verb.option("--my-tests", *own_tests,
              "Your own tests in place of the public ones: a GoogleTest file as in tests/, run on "
              "your module in the sandbox, as the grader runs it")
      .type_name("FILE");
  auto first = std::make_shared<bool>(false);
  verb.flag("--first", *first,
            "Without the tests of whole scenes (a4), for which ./tumble builds an engine once");
  verb.footer(
      "Exit: 0 all tests right; 1 your code: a test is not right, or it does not compile; 2 this "
      "command: no such assignment, file, test or flag, and nothing was checked; 4 not all is "
      "attempted, and the rest is right.\n"
      "Example: tumble check a1\n         tumble check a1 'two walls'\n"
      "         tumble check a1 collision_impulse --all");
  verb.runs([&command, given, own_tests, json, first] {
    CheckWords words = read_check_words(*given);
    words.own_tests = *own_tests;
    words.first = *first;
    if (*json && !own_tests->empty())
      throw UserError("--json", "is of the public tests", "Leave it out, or leave --my-tests out.");
    command.exit = *json ? check_for_machines(command, words) : check_once(command, words);
  });
}

}  // namespace tumble::cli
