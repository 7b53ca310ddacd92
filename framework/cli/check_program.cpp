#include "framework/cli/check_program.h"

#include <cstdio>
#include <sstream>

#include <fmt/format.h>
#include <unistd.h>

#include "framework/grading/build_submission.h"
#include "framework/grading/run_program.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;
using grading::Output;
using grading::ProgramOutcome;

// Shows the compiler's errors as the verdict that they are.
ExitCode does_not_compile(const fs::path& file, const std::string& said) {
  const bool colours = ::isatty(STDOUT_FILENO) == 1;
  fmt::print("{}does not compile{}: {}\n\n", colours ? "\033[31m" : "", colours ? "\033[0m" : "", file.filename().string());
  std::istringstream story(grading::compiler_story(said, file));
  for (std::string line; std::getline(story, line);) fmt::print("    {}\n", line);
  fmt::print("\nno test ran: the first error is the one to mend\n");
  return ExitCode::kCheckFailed;
}

// The student's own stub: the build knows how.
ProgramOutcome build_stub(const Context& context, const std::string& id) {
  return grading::run_program({"ninja", "-C", context.build.string(), "--quiet", "check_" + id}, Output::kCaptured);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) text.replace(at, from.size(), to);
  return text;
}

std::string quoted(const std::string& word) { return "'" + replaced(word, "'", "'\\''") + "'"; }

// Another file in the stub's place: the build's own two commands, to compile the stub and to link, with other names in them.
struct OtherFile {
  std::string compile, link;
  fs::path program;
};

OtherFile commands_for(const Context& context, const CheckWords& words) {
  const std::string folder = context.registry.find(words.id).folder;
  const std::string object = "assignments/" + folder + "/CMakeFiles/" + words.id + "_linked.dir/" + folder + ".cpp.o";
  const fs::path stub = context.root / "assignments" / folder / (folder + ".cpp");
  const ProgramOutcome listed = grading::run_program({"ninja", "-C", context.build.string(), "--quiet", "-t", "commands", "check_" + words.id}, Output::kCaptured);
  const fs::path place = context.build / "checked";
  fs::create_directories(place);
  OtherFile other;
  other.program = place / ("check_" + words.id);
  const std::string own_object = (place / (folder + ".o")).string();
  std::istringstream lines(listed.printed);
  for (std::string line; std::getline(lines, line);) {
    if (line.find("-o " + object + " -c ") != std::string::npos) {
      other.compile = replaced(replaced(line, object, own_object), "-c " + stub.string(), "-c " + quoted(fs::absolute(*words.file).string()));
      other.compile += " -I " + quoted(stub.parent_path().string());
    } else if (line.find("-o bin/check_" + words.id + " ") != std::string::npos) {
      other.link = replaced(replaced(line, object, own_object), "-o bin/check_" + words.id + " ", "-o " + other.program.string() + " ");
    }
  }
  if (other.compile.empty() || other.link.empty()) throw std::runtime_error("the build has no rule for check_" + words.id);
  return other;
}

ExitCode run_tests(const Context& context, const CheckWords& words, const fs::path& program) {
  std::vector<std::string> command = {program.string(), "--rubric", (context.root / "assignments" / context.registry.find(words.id).folder / "rubric.json").string()};
  command.insert(command.end(), words.patterns.begin(), words.patterns.end());
  std::fflush(stdout);
  const int code = grading::run_program(command, Output::kOurs).code;
  if (code < 0 || code > static_cast<int>(ExitCode::kNotAttempted)) {
    fmt::print("\nthe program that holds your code ended with code {} before its tests could be judged: look for code that runs before main\n", code);
    return ExitCode::kCheckFailed;
  }
  return static_cast<ExitCode>(code);
}

}  // namespace

void add_check_words(Verb& verb, std::vector<std::string>& rest, std::string& id) {
  verb.option("assignment", id, "Which, e.g. a1").required().type_name("ID");
  verb.option("what", rest, "FILE.cpp: instead of your file under assignments/; other words choose tests, e.g. 'CollisionImpulse.*'").type_name("[FILE] [PATTERN]");
}

CheckWords read_check_words(const Context& context, const std::string& id, const std::vector<std::string>& rest) {
  context.registry.find(id);
  CheckWords words{id, {}, {}};
  for (const std::string& word : rest) {
    const bool is_file = word.ends_with(".cpp") || word.ends_with(".cc") || word.find('/') != std::string::npos;
    if (is_file && words.file) throw UserError(word, "is a second file", "Check one at a time.");
    if (is_file && !fs::is_regular_file(word)) throw UserError(word, "there is no such file", "Check the path.");
    if (is_file) words.file = word;
    else words.patterns.push_back(word);
  }
  return words;
}

fs::path checked_file(const Context& context, const CheckWords& words) {
  const std::string folder = context.registry.find(words.id).folder;
  return words.file ? fs::absolute(*words.file) : context.root / "assignments" / folder / (folder + ".cpp");
}

ExitCode check_once(const Context& context, const CheckWords& words) {
  const fs::path file = checked_file(context, words);
  if (!fs::exists(file)) throw UserError(file.string(), "is not there", "Put your file back, or take it from the starter tree.");
  if (!words.file) {
    const ProgramOutcome built = build_stub(context, words.id);
    if (built.code != 0) return does_not_compile(file, built.printed);
    return run_tests(context, words, context.build / "bin" / ("check_" + words.id));
  }
  // The tests must be built; the stub beside them need not compile, so that nobody's half-written file is in the way.
  grading::run_program({"ninja", "-C", context.build.string(), "--quiet", "-k", "0", "check_" + words.id}, Output::kDropped);
  const OtherFile other = commands_for(context, words);
  const std::string script = "cd " + quoted(context.build.string()) + " && " + other.compile + " && " + other.link;
  const ProgramOutcome built = grading::run_program({"/bin/sh", "-c", script}, Output::kCaptured);
  if (built.code != 0) return does_not_compile(file, built.printed);
  return run_tests(context, words, other.program);
}

}  // namespace tumble::cli
