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

void refuse_function(const fs::path& root, const std::string& folder, const std::string& function,
                     const std::string& why, const std::string& remedy) {
  const std::vector<std::string> functions = functions_of_header(root, folder);
  if (std::find(functions.begin(), functions.end(), function) == functions.end())
    throw UserError(function.empty() ? "--function" : function,
                    "is no function of " + folder + ".h" + (function.empty() ? why : "") + "." +
                        did_you_mean(function, functions),
                    remedy);
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

fs::path header_of(const std::string& folder) {
  return fs::path("assignments") / folder / (folder + ".h");
}

// The function that a suite is about, as the header declares it: the one of its name, else the
// first.
Function function_of_suite(const fs::path& root, const std::string& folder, std::string suite) {
  if (suite.starts_with("Hidden")) suite.erase(0, std::string("Hidden").size());
  const std::vector<std::string> names = functions_of_header(root, folder);
  const auto found = std::find_if(names.begin(), names.end(), [&](const std::string& name) {
    return pascal_case(name) == suite;
  });
  const fs::path file = header_of(folder);
  return read_function(text_of(root / file), found == names.end() ? names.at(0) : *found,
                       file.string());
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

/// A function of an assignment that a new effect asks: its law, and what is written of it where.
struct AskedFunction {
  std::string id, folder;
  Function function;
  std::string law;  // of the effect: "LowLiftLaw"
};

/// @param words  "a6.plate_drag"
AskedFunction asked_function(const fs::path& root, const std::string& effect,
                             const std::string& words) {
  const std::size_t dot = words.find('.');
  if (dot == std::string::npos)
    throw UserError("--function " + words, "names no assignment",
                    "It is written  --function a6.plate_drag");
  AskedFunction asked;
  asked.id = words.substr(0, dot);
  asked.folder = folder_of_assignment(root, asked.id);
  const std::string name = words.substr(dot + 1);
  refuse_function(root, asked.folder, name, "", "Name one that the effect asks.");
  const fs::path header = header_of(asked.folder);
  asked.function = read_function(text_of(root / header), name, header.string());
  asked.law = pascal_case(effect) + "Law";
  return asked;
}

// The headers of types that the framework hands to the functions of an assignment.
std::string includes_of_types(const fs::path& root, const std::string& folder) {
  std::string includes;
  for (const std::string& line : lines_of(text_of(root / header_of(folder))))
    if (line.starts_with("#include \"framework/dynamics/")) includes += line + "\n";
  return includes;
}

// What a first force makes of an answer.
std::string first_ask(const Function& function) {
  const std::string call = function.name + "_(" + first_arguments(function) + ")";
  if (function.returns == "Vector3d") return "wrenches[place].force_world += " + call + ";";
  if (function.returns == "double")
    return "wrenches[place].force_world -= " + call + " * bodies[place].velocity_world;";
  return "[[maybe_unused]] const auto answer = " + call + ";";
}

Marks marks_of(const fs::path& root, const AskedFunction& asked) {
  const Function& function = asked.function;
  std::string parameters;
  for (const Parameter& parameter : function.parameters)
    parameters += (parameters.empty() ? "" : ", ") + parameter.type + " " + parameter.name;
  return {{"id", asked.id},
          {"function", function.name},
          {"Law", asked.law},
          {"signature", function.returns + "(" + parameters + ")"},
          {"includes", includes_of_types(root, asked.folder)},
          {"ask", first_ask(function)},
          {"returns", function.returns},
          {"zero", function.returns == "Wrench" ? "{Vector3d::Zero(), Vector3d::Zero()}"
                                                : zero_of(function.returns)}};
}

/// The binding of an assignment that sets the law, too.
NewFile with_law_set(const fs::path& root, const AskedFunction& asked, const std::string& effect) {
  static const std::regex head(R"(void bind\(const Module&( module)?, Laws&( laws)?\) \{(\})?)");
  const fs::path file = fs::path("assignments") / asked.folder / (asked.id + "_binding.cpp");
  const std::string own =
      "#include \"assignments/" + asked.folder + "/" + asked.id + "_binding.h\"\n\n";
  const std::string law = "#include \"framework/effects/" + effect + "/" + effect + ".h\"\n";
  const std::string set =
      "laws.set<effects::" + asked.law + ">(module." + asked.function.name + ");";
  std::string text = text_of(root / file);
  std::smatch bind;
  if (!text.starts_with(own) || !std::regex_search(text, bind, head))
    throw UserError(file.string(), "does not begin with its own header, or has no function bind",
                    "Without --function the effect asks nothing. Then bind() sets its law: " + set);
  text = bind.prefix().str() + "void bind(const Module& module, Laws& laws) {\n  " + set +
         (bind[3].matched ? "\n}" : "") + bind.suffix().str();
  text.insert(own.size(), text.substr(own.size()).starts_with("#include") ? law : law + "\n");
  return {file, text};
}

}  // namespace

std::vector<NewFile> new_effect(const fs::path& root, const std::string& name,
                                const std::string& function) {
  refuse_name(name, "an effect");
  if (fs::exists(root / "framework/effects" / name))
    throw UserError(name, "is an effect already: framework/effects/" + name, "Take another name.");
  std::string in_words = name;
  std::replace(in_words.begin(), in_words.end(), '_', ' ');
  Marks marks = {{"name", name},
                 {"in_words", in_words},
                 {"Name", pascal_case(name)},
                 {"words", as_title(name)},
                 {"asked", ""},
                 {"laws", ""}};
  if (function.empty()) {
    const std::vector<NewFile> files = files_from(templates_of(root, "effect"), marks);
    put_in_place(root, files);
    return files;
  }
  const AskedFunction asked = asked_function(root, name, function);
  marks["asked"] = asked.function.name + "_(acting.laws.of<" + asked.law + ">()), ";
  marks["laws"] = ", laws_with_" + name + "()";
  std::vector<NewFile> files =
      files_from(templates_of(root, "effect"), marks, {marks_of(root, asked)});
  const NewFile binding = with_law_set(root, asked, name);
  put_in_place(root, files);
  write_whole(root / binding.file, binding.text);
  files.push_back(binding);
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
  refuse_function(root, folder, function, " to be wrong", "Name the one that the slip is in.");
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
