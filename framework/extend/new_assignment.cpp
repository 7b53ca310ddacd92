#include "framework/extend/new_assignment.h"

#include <algorithm>
#include <regex>
#include <set>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/nearest_word.h"
#include "framework/core/text.h"
#include "framework/extend/declarations.h"
#include "framework/extend/first_test.h"
#include "framework/extend/words_of_code.h"

namespace tumble::extend {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kColumns = 100;  // of the house's code
constexpr int kPublicPoints = 60, kHiddenPoints = 40;
// each function has a whole point at least, public and hidden
constexpr std::size_t kMostFunctions = kHiddenPoints;

std::string joined(const std::vector<std::string>& parts, const std::string& between) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : between) + part;
  return text;
}

// "double f(" and its parameters, broken at commas as the formatter does.
std::string wrapped_call(const std::string& head, const std::vector<std::string>& parts,
                         const std::string& end) {
  const std::string one = head + joined(parts, ", ") + end;
  if (one.size() <= kColumns) return one;
  return head + joined(parts, ",\n" + std::string(head.size(), ' ')) + end;
}

std::string documentation(const Function& function, const Marks& marks) {
  std::string text;
  for (const std::string& line : function.about) text += "/// " + line + "\n";
  const std::string number = "(" + marks.at("ID") + "." + marks.at("n") + ")";
  std::string equation =
      function.equation.empty() ? "(to be written: its equation, in ASCII)" : function.equation;
  // The number stands at the end of its line, as far right as it goes.
  const std::string line = "///   " + equation;
  text +=
      line +
      std::string(
          line.size() + 2 + number.size() < kColumns ? kColumns - line.size() - number.size() : 2,
          ' ') +
      number + "\n";
  for (const Parameter& parameter : function.parameters)
    text += "/// @param " + parameter.name + "  (to be written: meaning, shape, frame [unit])\n";
  text += "/// @return (to be written: meaning, frame [unit], sign)\n";
  return text + "/// Tests: " + marks.at("Suite") + ".*   Hints: handouts/" + marks.at("folder") +
         ".md#hint-" + marks.at("anchor");
}

std::string throw_line(const Function& function, const Marks& marks) {
  const std::string head = "  throw NotImplemented(";
  return wrapped_call(head,
                      {"\"" + function.name + "\"", "\"handouts/" + marks.at("folder") +
                                                        ".md#hint-" + marks.at("anchor") + "\""},
                      ");");
}

// Whole points, which sum to `all`: the first ones have one more.
int share(int all, std::size_t count, std::size_t i) {
  const int n = static_cast<int>(count);
  return all / n + (static_cast<int>(i) < all % n ? 1 : 0);
}

Marks marks_of(const Function& function, const Marks& general, std::size_t i, std::size_t count) {
  Marks marks = general;
  std::vector<std::string> named, unnamed;
  for (const Parameter& parameter : function.parameters) {
    named.push_back(parameter.type + " " + parameter.name);
    unnamed.push_back(parameter.type);
  }
  marks["function"] = function.name;
  marks["Suite"] = pascal_case(function.name);
  marks["words"] = as_title(function.name);
  marks["anchor"] = with_dashes(function.name);
  marks["n"] = std::to_string(i + 1);
  marks["about"] = joined(function.about, " ");
  marks["handout_equation"] = function.equation.empty()
                                  ? "(to be written: the equation, and where it comes from)"
                                  : "    " + function.equation;
  marks["points"] = std::to_string(share(kPublicPoints, count, i));
  marks["hidden_points"] = std::to_string(share(kHiddenPoints, count, i));
  marks["comma"] = i + 1 < count ? "," : "";
  const std::string head = function.returns + " " + function.name + "(";
  marks["declaration"] = wrapped_call(head, named, ")");
  marks["stub"] = wrapped_call(head, unnamed, ")");
  marks["throw"] = throw_line(function, marks);
  marks["flawed_body"] = i == 0 ? "  return " + zero_of(function.returns) + ";" : marks["throw"];
  marks["documentation"] = documentation(function, marks);
  FirstTest test{"student()", "kUnwritten", "kRoundoff", "equation(" + marks["n"] + ")",
                 "what is set up, with numbers and units"};
  marks["expectation"] = first_test(function, test);
  test.scene = "what is drawn, from which seed";
  marks["hidden_expectation"] = first_test(function, test);
  return marks;
}

std::vector<std::string> folders_below(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

void refuse_taken(const fs::path& root, const std::string& id, const std::string& name) {
  static const std::regex shape("a[1-9][0-9]?");
  if (!std::regex_match(id, shape))
    throw UserError(id, "is no id of an assignment", "Ids are a and a number: a5.");
  if (!is_plain_name(name))
    throw UserError(name, "is no name of an assignment",
                    "Names are lower case words with _ between them: plausible_motion.");
  for (const char* room : {"assignments", "solutions_private", "tests", "handouts"})
    for (const std::string& there : folders_below(root / room))
      if (there.starts_with(id + "_"))
        throw UserError(id, "is taken by " + std::string(room) + "/" + there,
                        "Take the next number.");
  for (const std::string& folder : folders_below(root / "assignments")) {
    if (fs::exists(root / "assignments" / folder / "scenes" / (name + ".json")))
      throw UserError(name, "is the name of a scene of " + folder,
                      "A scene of that name comes with the assignment: take another name.");
  }
}

// #include <...> first, then the course's, which every module needs.
std::string includes_of(const Declarations& read) {
  std::set<std::string> system,
      own = {"#include \"framework/core/math.h\"", "#include \"framework/core/not_implemented.h\"",
             "#include \"framework/modules/module.h\""};
  for (const std::string& line : read.includes)
    (line.find('<') == std::string::npos ? own : system).insert(line);
  std::string text;
  for (const std::string& line : system) text += line + "\n";
  if (!system.empty()) text += "\n";
  for (const std::string& line : own) text += line + "\n";
  return text;
}

}  // namespace

std::vector<NewFile> new_assignment(const fs::path& root, const std::string& id,
                                    const std::string& name, const fs::path& functions_file) {
  refuse_taken(root, id, name);
  if (!fs::is_regular_file(functions_file))
    throw UserError(functions_file.string(), "is no file",
                    "Name a list of declarations; framework/EXTEND.md shows one.");
  const Declarations read = read_declarations(text_of(functions_file), functions_file.string());
  const std::size_t count = read.functions.size();
  if (count > kMostFunctions)
    throw UserError(functions_file.string(),
                    "declares " + counted(count, "function") + ": there are no points for so many",
                    "An assignment has at most " + std::to_string(kMostFunctions) + ".");
  std::vector<std::string> names;
  for (const Function& function : read.functions) names.push_back(function.name);
  Marks marks = {{"id", id},
                 {"ID", "A" + id.substr(1)},
                 {"number", id.substr(1)},
                 {"name", name},
                 {"folder", id + "_" + name},
                 {"title", as_title(name)},
                 {"how_many", counted(count, "function")},
                 {"functions", joined(names, ", ")},
                 {"includes", includes_of(read)},
                 {"types", read.types},
                 {"public_sum", std::to_string(kPublicPoints)},
                 {"hidden_sum", std::to_string(kHiddenPoints)}};
  std::vector<Marks> functions;
  for (std::size_t i = 0; i < count; ++i)
    functions.push_back(marks_of(read.functions[i], marks, i, count));
  marks["first"] = names.front();
  marks["first_zero"] = zero_of(read.functions.front().returns);
  marks["first_taken_out"] =
      "-" + std::regex_replace(functions.front().at("throw"), std::regex("\n"), "\n-");
  const std::vector<NewFile> files =
      files_from(root / "framework/extend/templates/assignment", marks, functions);
  put_in_place(root, files);
  return files;
}

std::string folder_of_assignment(const fs::path& root, const std::string& id) {
  std::vector<std::string> known;
  for (const std::string& folder : folders_below(root / "assignments")) {
    if (!fs::exists(root / "assignments" / folder / "rubric.json")) continue;
    known.push_back(folder.substr(0, folder.find('_')));
    if (known.back() == id) return folder;
  }
  throw UserError(id, "there is no assignment of this name",
                  "Known: " + joined(known, ", ") + "." + did_you_mean(id, known));
}

}  // namespace tumble::extend
