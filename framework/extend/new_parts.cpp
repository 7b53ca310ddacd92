#include "framework/extend/new_parts.h"

#include <algorithm>
#include <cctype>
#include <regex>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/nearest_word.h"
#include "framework/extend/check_points.h"
#include "framework/extend/first_test.h"
#include "framework/extend/new_assignment.h"
#include "framework/extend/words_of_code.h"

namespace tumble::extend {
namespace {

namespace fs = std::filesystem;

void refuse_name(const std::string& name, const std::string& what) {
  if (!is_plain_name(name))
    throw UserError(name, "is no name of " + what,
                    "Names are lower case words with _ between them: low_wind.");
}

fs::path templates_of(const fs::path& root, const std::string& what) {
  return root / "framework/extend/templates" / what;
}

// The lines of a function's body that stand once in the file: a slip can begin with such a line.
std::string line_to_change(const std::vector<std::string>& lines, const std::string& function) {
  std::size_t at = 0;
  const std::regex head("^[\\w:<>,&* ]+\\b" + function + "\\(");
  while (at < lines.size() && !std::regex_search(lines[at], head)) ++at;
  for (std::string last; ++at < lines.size() && lines[at] != "}";)
    if (lines[at].find(';') != std::string::npos &&
        std::count(lines.begin(), lines.end(), lines[at]) == 1)
      if (lines[at].find("return") != std::string::npos || at + 1 >= lines.size() ||
          lines[at + 1] == "}")
        return lines[at];
  return "";
}

// Puts an entry behind the last one of a rubric, as far from the margin as that.
std::string with_entry(const std::string& rubric, const std::string& entry,
                       const std::string& file) {
  static const std::regex last_entry(R"(\n( *)\{[^{}]*\}(?=\s*\]\s*\}\s*$))");
  std::smatch last;
  if (!std::regex_search(rubric, last, last_entry))
    throw UserError(file, "does not end with an entry and ]}",
                    "Write an entry a line, as the other rubrics have them.");
  return last.prefix().str() + last.str() + ",\n" + last[1].str() + entry + last.suffix().str();
}

// The function that a suite is about, as the header declares it: the one of its name, else the
// first.
Function function_of_suite(const fs::path& root, const std::string& folder, std::string suite) {
  if (suite.starts_with("Hidden")) suite.erase(0, std::string("Hidden").size());
  const std::vector<std::string> names = functions_of_header(root, folder);
  const auto found = std::find_if(names.begin(), names.end(), [&](const std::string& name) {
    return pascal_case(name) == suite;
  });
  const std::string name = found == names.end() ? names.at(0) : *found;
  const fs::path file = fs::path("assignments") / folder / (folder + ".h");
  const std::string header = text_of(root / file);
  const std::regex declaration("\n([A-Za-z][\\w:<>, ]* +" + name + "\\([^;]*;)");
  std::smatch declared;
  if (!std::regex_search(header, declared, declaration))
    throw UserError(file.string(), "declares no function " + name,
                    "TUMBLE_MODULE lists what the header declares.");
  return read_declarations("// Read from the header.\n" + declared[1].str() + "\n", file.string())
      .functions.front();
}

// "SeparatingBodiesGetNone" -> "Separating bodies get none".
std::string as_words(const std::string& name) {
  std::string words;
  for (const char c : name) {
    const bool begins = std::isupper(static_cast<unsigned char>(c)) != 0;
    if (begins && !words.empty()) words += ' ';
    words += begins && !words.empty()
                 ? static_cast<char>(std::tolower(static_cast<unsigned char>(c)))
                 : c;
  }
  return words;
}

}  // namespace

std::vector<NewFile> new_effect(const fs::path& root, const std::string& name) {
  refuse_name(name, "an effect");
  if (fs::exists(root / "framework/effects" / name))
    throw UserError(name, "is an effect already: framework/effects/" + name, "Take another name.");
  const std::vector<NewFile> files =
      files_from(templates_of(root, "effect"),
                 {{"name", name}, {"Name", pascal_case(name)}, {"words", as_title(name)}});
  put_in_place(root, files);
  return files;
}

std::vector<NewFile> new_scene(const fs::path& root, const std::string& id,
                               const std::string& name) {
  const std::string folder = folder_of_assignment(root, id);
  refuse_name(name, "a scene");
  for (const auto& entry : fs::directory_iterator(root / "assignments"))
    if (fs::exists(entry.path() / "scenes" / (name + ".json")))
      throw UserError(name, "is a scene of " + entry.path().filename().string() + " already",
                      "Scenes are run by their names alone: take another one.");
  const std::vector<NewFile> files =
      files_from(templates_of(root, "scene"),
                 {{"id", id}, {"folder", folder}, {"name", name}, {"title", as_title(name)}});
  put_in_place(root, files);
  return files;
}

std::vector<NewFile> new_slip(const fs::path& root, const std::string& id, const std::string& name,
                              const std::string& function) {
  const std::string folder = folder_of_assignment(root, id);
  refuse_name(name, "a slip");
  const std::vector<std::string> functions = functions_of_header(root, folder);
  if (std::find(functions.begin(), functions.end(), function) == functions.end())
    throw UserError(function.empty() ? "--function" : function,
                    "is no function of " + folder + ".h" +
                        (function.empty() ? " to be wrong" : "") + "." +
                        did_you_mean(function, functions),
                    "Name the one that the slip is in.");
  const fs::path reference = fs::path("solutions_private") / folder / (folder + ".cpp");
  const std::string line = line_to_change(lines_of(text_of(root / reference)), function);
  if (line.empty())
    throw UserError(reference.string(), "has no line in " + function + " that stands there once",
                    "Write the slip by hand: framework/grading/course/slip.h shows how.");
  const std::vector<NewFile> files =
      files_from(templates_of(root, "slip"),
                 {{"folder", folder}, {"name", name}, {"function", function}, {"line", line}});
  put_in_place(root, files);
  return files;
}

std::vector<NewFile> new_test(const fs::path& root, const std::string& id, const std::string& test,
                              bool hidden) {
  const std::string folder = folder_of_assignment(root, id);
  static const std::regex shape("([A-Z][A-Za-z0-9]*)\\.([A-Z][A-Za-z0-9]*)");
  std::smatch match;
  if (!std::regex_match(test, match, shape))
    throw UserError(test, "is no name of a test",
                    "It is written Suite.Name and reads as a sentence: "
                    "CollisionImpulse.SeparatingBodiesGetNone.");
  const fs::path rubric = hidden ? fs::path("solutions_private") / folder / "rubric_hidden.json"
                                 : fs::path("assignments") / folder / "rubric.json";
  const std::string before = text_of(root / rubric);
  for (const TestPlace& there : tests_of_sources(root, folder))
    if (there.name == test)
      throw UserError(test, "is there already: " + there.place, "Take another name.");
  // One file a test, named as its suite and name are: any number of them stand side by side.
  std::string file;
  for (const char c : match[1].str() + match[2].str()) {
    if (std::isupper(static_cast<unsigned char>(c)) != 0 && !file.empty()) file += '_';
    file += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  const std::string entry = "{\"test\": \"" + test +
                            "\", \"points\": 0, \"level\": \"intermediate\", \"title\": \"" +
                            as_words(match[2]) + "\"}";
  const std::string after = with_entry(before, entry, rubric.string());
  const fs::path fixtures = fs::path("tests") / folder / (id + "_fixtures.h");
  // The namespace of the assignment's tests is the one that its fixtures open.
  std::smatch opened;
  const std::string header = text_of(root / fixtures);
  const std::string space =
      std::regex_search(header, opened, std::regex("\nnamespace (tumble::[a-z0-9_:]*testing) \\{"))
          ? opened[1].str()
          : "tumble::testing";
  const Function function = function_of_suite(root, folder, match[1]);
  const FirstTest body{"modules::under_test<Module>()", "kUnset", "0.0",
                       "\"handouts/" + folder + ".md\"", "what is set up, with numbers and units"};
  const std::vector<NewFile> files =
      files_from(templates_of(root, "test"),
                 {{"below", hidden ? "solutions_private/" + folder + "/tests" : "tests/" + folder},
                  {"folder", folder},
                  {"id", id},
                  {"file", file},
                  {"space", space},
                  {"body", first_test(function, body)},
                  {"Suite", match[1]},
                  {"Name", match[2]}});
  put_in_place(root, files);
  write_whole(root / rubric, after);
  return files;
}

}  // namespace tumble::extend
