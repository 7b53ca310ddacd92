// tumble check a1 [FILE] [PATTERN...]: the student's loop.
#include <memory>

#include "framework/cli/check_program.h"

namespace tumble::cli {

void add_check(CLI::App& app, Command& command) {
  auto id = std::make_shared<std::string>();
  auto rest = std::make_shared<std::vector<std::string>>();
  auto own_tests = std::make_shared<std::string>();
  Verb verb(app, "check", "Build your file and run the public tests: a verdict and a story each");
  add_check_words(verb, *rest, *id);
  verb.option("--my-tests", *own_tests,
              "Your own tests in place of the public ones: a GoogleTest file as in tests/, run on "
              "your module in the sandbox, as the grader runs it")
      .type_name("FILE");
  verb.footer(
      "Exit: 0 all right, 1 something is wrong or does not compile, 2 something to repair, 4 the "
      "rest is right but not all is attempted.");
  verb.runs([&command, id, rest, own_tests] {
    CheckWords words = read_check_words(*id, *rest);
    words.own_tests = *own_tests;
    command.exit = check_once(command, words);
  });
}

}  // namespace tumble::cli
