// tumble new assignment|effect|scene|slip|test: a part of the course, ready to be written; and
// points and mutations of one. Of the instructor's source tree alone.
#include <memory>

#include <fmt/format.h>

#include "framework/cli/command.h"
#include "framework/cli/words.h"
#include "framework/core/files.h"
#include "framework/core/nearest_word.h"
#include "framework/core/text.h"
#include "framework/extend/check_points.h"
#include "framework/extend/mutations.h"
#include "framework/extend/new_assignment.h"
#include "framework/extend/new_parts.h"
#include "framework/extend/unwritten.h"

namespace tumble::cli {
namespace {

using extend::NewFile;

struct NewWords {
  std::string what, first, second, functions, function;
  bool hidden = false;
};

void refuse_missing(const std::string& word, const std::string& what, const std::string& example) {
  if (word.empty())
    throw UserError("tumble new " + what, "lacks a word", "It is written  tumble new " + example);
}

// The words after the kind, and what is to be done next.
struct Kind {
  std::string name, example;
  int words;  // after the name of the kind
  std::function<std::vector<NewFile>(const Command&, const NewWords&)> make;
  std::function<std::string(const Command&, const NewWords&)> next;
};

std::string next_of_assignment(const Command& command, const NewWords& words) {
  const std::string folder = words.first + "_" + words.second;
  return fmt::format(
      "{} to be written; ./tumble audit {} lists the places.\n"
      "next:  ./tumble check {}      every stub is \"not attempted\"\n"
      "       framework/EXTEND.md     what to write, in which order\n",
      counted(extend::unwritten_of(command.root, folder).size(), "place"), words.first,
      words.first);
}

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> kinds = {
      {"assignment", "assignment a5 plausible --functions FILE", 2,
       [](const Command& command, const NewWords& words) {
         refuse_missing(words.functions, "assignment", "assignment a5 plausible --functions FILE");
         return extend::new_assignment(command.root, words.first, words.second, words.functions);
       },
       next_of_assignment},
      {"effect", "effect low_wind", 1,
       [](const Command& command, const NewWords& words) {
         return extend::new_effect(command.root, words.first, words.function);
       },
       [](const Command&, const NewWords& words) {
         return fmt::format(
             "next:  its equation in framework/effects/{0}, then: ninja -C build "
             "test_more_effects && build/bin/test_more_effects\n",
             words.first);
       }},
      {"scene", "scene a5 tall_drop", 2,
       [](const Command& command, const NewWords& words) {
         return extend::new_scene(command.root, words.first, words.second);
       },
       [](const Command&, const NewWords& words) {
         return "next:  ./tumble run " + words.second + "\n";
       }},
      {"slip", "slip a5 half_forgotten --function energy_of", 2,
       [](const Command& command, const NewWords& words) {
         return extend::new_slip(command.root, words.first, words.second, words.function);
       },
       [](const Command&, const NewWords& words) {
         return fmt::format("next:  the wrong line, then: ./tumble audit {} --only {}\n",
                            words.first, words.second);
       }},
      {"test", "test a5 EnergyOf.IsLinearInTheMass [--hidden]", 2,
       [](const Command& command, const NewWords& words) {
         return extend::new_test(command.root, words.first, words.second, words.hidden);
       },
       [](const Command&, const NewWords& words) {
         return fmt::format(
             "next:  the test; its entry in the rubric is worth 0 points until it is "
             "given some. ./tumble check {}\n",
             words.first);
       }},
      {"points", "points a5", 1,
       [](const Command& command, const NewWords& words) {
         const std::string folder = extend::folder_of_assignment(command.root, words.first);
         const auto handout = std::filesystem::path("handouts") / (folder + ".md");
         write_whole(command.root / handout, extend::with_points_of_rubrics(command.root, folder));
         return std::vector<NewFile>{{handout, ""}};
       },
       [](const Command&, const NewWords&) { return "its table has the points of the rubrics\n"; }},
      {"mutations", "mutations a5 FOLDER", 2,
       [](const Command& command, const NewWords& words) {
         return extend::new_mutations(command.root, words.first, words.second);
       },
       [](const Command&, const NewWords& words) {
         return fmt::format("next:  ./tumble audit {} --mutants {}      which of them survive?\n",
                            words.first, words.second);
       }}};
  return kinds;
}

const Kind& kind_of(const std::string& word) {
  std::vector<std::string> known;
  std::string list;
  for (const Kind& kind : kinds()) {
    if (kind.name == word) return kind;
    known.push_back(kind.name);
    list += (list.empty() ? "" : ", ") + kind.name;
  }
  throw UserError(word, "is nothing that can be made new." + did_you_mean(word, known),
                  "Known: " + list + ".");
}

void make_new(const Command& command, const NewWords& words) {
  if (command.is_installed || !std::filesystem::exists(command.root / "solutions_private"))
    throw UserError("tumble new", "works in the instructor's source tree",
                    "A tree with solutions_private/ is one.");
  const Kind& kind = kind_of(words.what);
  refuse_missing(words.first, kind.name, kind.example);
  if (kind.words == 2) refuse_missing(words.second, kind.name, kind.example);
  if (kind.words == 1 && !words.second.empty())
    throw UserError(words.second, "is a word too many",
                    "It is written  tumble new " + kind.example);
  for (const NewFile& file : kind.make(command, words)) fmt::print("{}\n", file.file.string());
  fmt::print("{}", kind.next(command, words));
}

}  // namespace

void add_new(CLI::App& app, Command& command) {
  auto words = std::make_shared<NewWords>();
  Verb verb(app, "new", "Write the files of a new assignment, effect, scene, slip or test");
  verb.option("what", words->what, "assignment, effect, scene, slip, test, mutations, points")
      .required()
      .type_name("WORD");
  verb.option("first", words->first, "The assignment, e.g. a5; of an effect its name")
      .type_name("WORD");
  verb.option("second", words->second, "The name; of a test Suite.Name; of mutations a folder")
      .type_name("WORD");
  verb.option("--functions", words->functions,
              "Of an assignment: a list of C++ declarations, a line of comment above each")
      .type_name("FILE");
  verb.option("--function", words->function,
              "Of a slip: the function that it is in; of an effect: one of an assignment that it "
              "asks, a5.energy_of")
      .type_name("NAME");
  verb.flag("--hidden", words->hidden, "Of a test: students do not see it");
  verb.footer(
      "No file is replaced (points writes the numbers of a handout's table after the rubrics), and "
      "nothing is left behind where a name is taken or wrong. What "
      "only its author can write is marked \"(to be written: ...)\"; tumble audit aN lists these "
      "places. framework/EXTEND.md follows one afternoon.\n"
      "Example: tumble new assignment a5 plausible --functions plausible.h\n"
      "         tumble new effect low_wind\n"
      "         tumble new scene a5 tall_drop\n"
      "         tumble new slip a5 half_forgotten --function energy_of\n"
      "         tumble new test a5 EnergyOf.IsLinearInTheMass --hidden\n"
      "         tumble new mutations a5 out/mutations     the reference, changed in one place "
      "each");
  verb.runs([&command, words] { make_new(command, *words); });
}

}  // namespace tumble::cli
