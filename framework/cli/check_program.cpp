#include "framework/cli/check_program.h"

#include <cstdio>
#include <fstream>
#include <iterator>
#include <sstream>

#include <fmt/format.h>
#include <unistd.h>

#include "framework/core/files.h"
#include "framework/core/terminal.h"
#include "framework/grading/compiler/build_module.h"
#include "framework/grading/compiler/compiler_words.h"
#include "framework/core/run_program.h"
#include "framework/modules/names.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;

// s: a test program starts in 20 ms; the rest is for a loaded machine
constexpr double kLoadLimit = 10.0;

// @throws UserError for an id that no assignment has
const std::string& folder_of(const std::string& id) {
  return modules::find_name(assignment_names(), id).folder;
}

// The public tests against a shared object.
fs::path loaded_check(const Command& command, const std::string& id) {
  return command.build / "bin" / ("check_" + id + "_loaded");
}

// The public tests linked with the student's file: all, or all but those of whole scenes.
// @throws UserError where the assignment has none of those, or another file is checked
std::string linked_check(const Command& command, const CheckWords& words) {
  if (!words.first) return "check_" + words.id;
  if (words.file || !words.own_tests.empty())
    throw UserError("--first", "is of the public tests on your file under assignments/",
                    "Leave it out.");
  std::ifstream list(command.build / "first_checks.txt");
  for (std::string line; std::getline(list, line);)
    if (line.starts_with(words.id + " ")) return "check_" + words.id + "_first";
  throw UserError("--first", words.id + " has no tests of whole scenes here", "Leave it out.");
}

bool has_colours() { return shows_colours(STDOUT_FILENO); }

void print_indented(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) fmt::print("    {}\n", line);
}

// Shows the compiler's errors as a verdict.
ExitCode does_not_compile(const fs::path& file, const fs::path& header, const std::string& said) {
  fmt::print("{}does not compile{}: {}\n\n", has_colours() ? "\033[31m" : "",
             has_colours() ? "\033[0m" : "", file.filename().string());
  print_indented(grading::compiler_story(said, file, header));
  fmt::print("\nno test ran: correct the first error first\n");
  return ExitCode::kCheckFailed;
}

void print_warnings(const fs::path& file, const std::string& said) {
  const std::string warnings = grading::compiler_warnings(said, file);
  if (warnings.empty()) return;
  fmt::print("{}the compiler warns{}: {}\n\n", has_colours() ? "\033[33m" : "",
             has_colours() ? "\033[0m" : "", file.filename().string());
  print_indented(warnings);
  fmt::print("\n");
}

// Whether the file as it is now is in the shared object that is named, and a program can load it.
bool is_built(const Command& command, const CheckWords& words, const fs::path& file) {
  std::error_code none, missing;
  const auto made = fs::last_write_time(words.object, none);
  return !none && made >= fs::last_write_time(file, missing) && !missing &&
         fs::exists(loaded_check(command, words.id));
}

// Of every program that runs public tests: titles, and where functions and crashes stand.
void add_public_words(std::vector<std::string>& program, const Command& command,
                      const CheckWords& words) {
  program.insert(program.end(), {"--rubric", public_rubric(command, words).string(), "--source",
                                 checked_file(command, words).string()});
}

ExitCode run_tests(const Command& command, const CheckWords& words,
                   std::vector<std::string> program) {
  add_public_words(program, command, words);
  if (words.all) program.push_back("--all");
  if (!words.results.empty()) program.insert(program.end(), {"--json", words.results.string()});
  program.insert(program.end(), words.patterns.begin(), words.patterns.end());
  std::fflush(stdout);
  const int code = run_program(program, Output::kOurs).code;
  if (code < 0 || code > static_cast<int>(ExitCode::kNotAttempted)) {
    fmt::print(
        "\nthe program with your code ended with code {} before its tests could be judged: look "
        "for code that runs before main\n",
        code);
    return ExitCode::kCheckFailed;
  }
  return static_cast<ExitCode>(code);
}

// ---- The student's own file, built by the build tree ----

/// The compiler's output for the file at its last compilation. Warnings are shown until they are
/// corrected, although an unchanged file is not compiled again: output older than the object
/// belongs to another version, and the file is compiled once more.
class KeptWords {
 public:
  KeptWords(const Command& command, const std::string& id, const std::string& folder)
      : object_(command.build / "assignments" / folder / "CMakeFiles" / (id + "_linked.dir") /
                (folder + ".cpp.o")),
        words_(command.build / "checked" / (id + ".compiler.txt")) {
    std::error_code ignored;
    if (!are_of_object()) fs::remove(object_, ignored);
  }
  /// @param said  output of this build: empty where there was nothing to do
  std::string after_build(const std::string& said) const {
    if (!are_of_object()) write_whole(words_, said);
    return text_of(words_);
  }

 private:
  bool are_of_object() const {
    std::error_code missing;
    const auto compiled = fs::last_write_time(object_, missing);
    if (missing) return false;
    const auto kept = fs::last_write_time(words_, missing);
    return !missing && kept >= compiled;
  }
  fs::path object_, words_;
};

// The initial value of a global object is computed before main: one that does not end would hang
// every test.
bool starts(std::vector<std::string> program) {
  program.insert(program.end(), {"--debug", "--gtest_list_tests"});
  return run_program(program, Output::kDropped, kLoadLimit).in_time;
}

// The public tests by a program that holds the user's own code.
ExitCode run_own(const Command& command, const CheckWords& words, const fs::path& file,
                 const std::vector<std::string>& program) {
  if (starts(program)) return run_tests(command, words, program);
  fmt::print(
      "out of time: {}\n\n    does not start within {:g} s: the initial value of a global or "
      "static variable is a loop that does not end\n\nno test ran\n",
      file.filename().string(), kLoadLimit);
  return ExitCode::kCheckFailed;
}

// After all tests but those of whole scenes.
void print_what_is_left(const CheckWords& words, ExitCode code) {
  if (code == ExitCode::kFine)
    fmt::print("\nLeft are the tests of whole scenes: ./tumble check {}\n", words.id);
  else
    fmt::print(
        "\nThe tests of whole scenes were not run: they follow when the tests above are\n"
        "right, and need an engine, whose first build takes some minutes.\n");
}

ExitCode check_own(const Command& command, const CheckWords& words, const std::string& name,
                   const fs::path& file, const fs::path& header) {
  const KeptWords kept(command, words.id, folder_of(words.id));
  const ProgramOutcome built =
      run_program({"ninja", "-C", command.build.string(), "--quiet", name}, Output::kCaptured);
  if (built.code != 0) return does_not_compile(file, header, built.printed);
  print_warnings(file, kept.after_build(built.printed));
  const ExitCode code = run_own(command, words, file, {(command.build / "bin" / name).string()});
  if (words.first && code != ExitCode::kUserError) print_what_is_left(words, code);
  return code;
}

// ---- The student's own file, of an installed course ----

ExitCode check_installed(const Command& command, const CheckWords& words, const fs::path& file,
                         const fs::path& header) {
  const PrivateFolder folder;
  const fs::path object = folder.path() / (words.id + ".so"),
                 program = command.build / "bin" / ("check_" + words.id);
  const ProgramOutcome built = run_program(
      grading::own_compilation(command.root, command.build, file, object), Output::kCaptured);
  if (built.code != 0) return does_not_compile(file, header, built.printed);
  print_warnings(file, built.printed);
  return run_own(command, words, file, {program.string(), object.string()});
}

// ---- Another file, compiled and called in the sandbox ----

ExitCode check_foreign(const Command& command, const CheckWords& words, const fs::path& file,
                       const fs::path& header) {
  const fs::path program = command.build / "bin" / ("check_" + words.id + "_sandboxed");
  if (!fs::exists(program))
    throw UserError(program.string(), "is not built", "Run ./tumble check, which builds it.");
  const PrivateFolder folder;
  const fs::path object = folder.path() / (words.id + ".so");
  const auto built = grading::build_module(command.root, command.build, words.id,
                                           folder_of(words.id), file, object);
  if (built.outcome == grading::BuiltSubmission::Outcome::kGraderFault)
    throw std::runtime_error("the sandboxed compiler could not be asked: " + built.said);
  if (built.outcome == grading::BuiltSubmission::Outcome::kRefused)
    return does_not_compile(file, header, built.said);
  print_warnings(file, built.said);
  return run_tests(command, words, {program.string(), "--submission", object.string(), "--quick"});
}

// ---- The student's own tests: two sandboxes, as the grader runs them ----

ExitCode check_own_tests(const Command& command, const CheckWords& words, const fs::path& file,
                         const fs::path& header) {
  const fs::path program = command.build / "bin" / ("own_tests_" + words.id),
                 tests = fs::absolute(words.own_tests);
  // of the packages that a file of tests is linked with (compiler/compile.cpp)
  for (const char* needed :
       {"/usr/include/gtest/gtest.h", "/usr/include/fmt/format.h", "/usr/include/openssl/sha.h"})
    if (!fs::exists(needed))
      throw UserError("--my-tests", std::string("there is no ") + needed + " on this machine",
                      "apt install libgtest-dev libfmt-dev libssl-dev");
  if (!fs::exists(program))
    throw UserError(program.string(), "is not built", "Run ./tumble check, which builds it.");
  const PrivateFolder folder;
  const fs::path object = folder.path() / (words.id + ".so"), own = folder.path() / "tests";
  const std::string& name = folder_of(words.id);
  const auto is_built = [&](const grading::BuiltSubmission& built) {
    if (built.outcome == grading::BuiltSubmission::Outcome::kGraderFault)
      throw std::runtime_error("the sandboxed compiler could not be asked: " + built.said);
    return built.outcome == grading::BuiltSubmission::Outcome::kBuilt;
  };
  const auto module =
      grading::build_module(command.root, command.build, words.id, name, file, object);
  if (!is_built(module)) return does_not_compile(file, header, module.said);
  const auto built =
      grading::build_own_tests(command.root, command.build, words.id, name, tests, own);
  if (!is_built(built)) return does_not_compile(tests, header, built.said);
  print_warnings(tests, built.said);
  std::fflush(stdout);
  std::vector<std::string> run = {program.string(), "--tests",       own.string(),
                                  "--submission",   object.string(), "--quick"};
  if (!words.results.empty()) run.insert(run.end(), {"--json", words.results.string()});
  const int code = run_program(run, Output::kOurs).code;
  return code < 0 || code > static_cast<int>(ExitCode::kNotAttempted) ? ExitCode::kCheckFailed
                                                                      : static_cast<ExitCode>(code);
}

}  // namespace

void add_check_words(Verb& verb, GivenWords& given) {
  verb.option("assignment", given.id, "Which, e.g. a1").required().type_name("ID");
  verb.option("what", given.rest,
              "FILE.cpp in place of your file under assignments/, to be run in the sandbox. Other "
              "words choose tests: a part of a title ('Two walls'), a function "
              "(collision_impulse), a pattern of names ('CollisionImpulse.*')")
      .type_name("FILE|TEST");
  verb.flag("-v,--all", given.all, "A line for each test, the right ones too");
}

CheckWords read_check_words(const GivenWords& given) {
  folder_of(given.id);
  CheckWords words;
  words.id = given.id;
  words.all = given.all;
  for (const std::string& word : given.rest) {
    const bool is_file =
        word.ends_with(".cpp") || word.ends_with(".cc") || word.find('/') != std::string::npos;
    if (is_file && words.file) throw UserError(word, "is a second file", "Check one at a time.");
    if (is_file && !fs::is_regular_file(word))
      throw UserError(word, "there is no such file", "Check the path.");
    if (is_file)
      words.file = word;
    else
      words.patterns.push_back(word);
  }
  return words;
}

fs::path public_rubric(const Command& command, const CheckWords& words) {
  return command.root / "assignments" / folder_of(words.id) / "rubric.json";
}

fs::path checked_file(const Command& command, const CheckWords& words) {
  const std::string folder = folder_of(words.id);
  return words.file ? fs::absolute(*words.file) : own_file(command, folder);
}

CheckedTests check_quietly(const Command& command, const CheckWords& words) {
  const std::string &id = words.id, folder = folder_of(id), linked = linked_check(command, words);
  const fs::path file = checked_file(command, words), own = own_file(command, folder),
                 header = command.root / "assignments" / folder / (folder + ".h");
  if (!fs::exists(file)) throw missing_file(command, id, file);
  const PrivateFolder temporary;
  const fs::path object = temporary.path() / (id + ".so"), results = temporary.path() / "results",
                 programs = command.build / "bin";
  std::error_code missing;
  std::vector<std::string> program;
  const bool is_own = fs::equivalent(file, own, missing);
  if (is_own)
    if (const std::string why = grading::why_nothing(file.filename().string(), text_of(file),
                                                     grading::header_in(folder));
        !why.empty())
      return {why + "\n", {}};
  if (!is_own) {  // somebody's: compiled and called in the sandbox
    const auto built = grading::build_module(command.root, command.build, id, folder, file, object);
    if (built.outcome != grading::BuiltSubmission::Outcome::kBuilt)
      return {grading::compiler_story(built.said, file, header), {}};
    program = {(programs / ("check_" + id + "_sandboxed")).string(), "--submission",
               object.string(), "--quick"};
  } else if (!command.is_installed && is_built(command, words, file)) {
    program = {loaded_check(command, id).string(), words.object.string()};
  } else {
    const ProgramOutcome built = run_program(
        command.is_installed
            ? grading::own_compilation(command.root, command.build, file, object)
            : std::vector<std::string>{"ninja", "-C", command.build.string(), "--quiet", linked},
        Output::kCaptured);
    if (built.code != 0) return {grading::compiler_story(built.printed, file, header), {}};
    program = {(programs / linked).string()};
    if (command.is_installed) program.push_back(object.string());
  }
  if (is_own && !starts(program))
    return {fmt::format("does not start within {:g} s: the initial value of a global or static "
                        "variable is a loop that does not end",
                        kLoadLimit),
            {}};
  add_public_words(program, command, words);
  program.insert(program.end(), {"--json", results.string()});
  program.insert(program.end(), words.patterns.begin(), words.patterns.end());
  const ProgramOutcome ran = run_program(program, Output::kCaptured);
  if (ran.code == static_cast<int>(ExitCode::kUserError))  // its words, such as a pattern
    throw UserError("check " + id, ran.printed.substr(0, ran.printed.find_last_not_of('\n') + 1));
  if (!fs::exists(results))
    return {
        "the program with your code ended before its tests could be judged: look for code that "
        "runs before main\n" +
            ran.printed,
        {}};
  return {"", grading::read_results(results.string())};
}

ExitCode check_once(const Command& command, const CheckWords& words) {
  const std::string linked = linked_check(command, words);
  const fs::path file = checked_file(command, words);
  if (!fs::exists(file)) throw missing_file(command, words.id, file);
  const std::string folder = folder_of(words.id);
  const fs::path own = own_file(command, folder),
                 header = command.root / "assignments" / folder / (folder + ".h");
  if (!words.own_tests.empty()) {
    if (!words.patterns.empty())
      throw UserError(words.patterns.front(), "cannot choose among your own tests",
                      "All of the file run.");
    if (!fs::is_regular_file(words.own_tests))
      throw UserError(words.own_tests, "there is no such file",
                      "tumble start makes a folder with one to begin from.");
    return check_own_tests(command, words, file, header);
  }
  std::error_code missing;
  if (!fs::equivalent(file, own, missing)) return check_foreign(command, words, file, header);
  return command.is_installed ? check_installed(command, words, file, header)
                              : check_own(command, words, linked, file, header);
}

}  // namespace tumble::cli
