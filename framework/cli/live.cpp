// tumble live SCENE|aN: a page on this machine that runs the scene on the user's own code, to be
// pushed, pulled and changed while it goes.
#include <algorithm>
#include <cstdio>
#include <memory>

#include <fmt/format.h>

#include "framework/cli/find_scene.h"
#include "framework/cli/live_parts.h"
#include "framework/cli/module_choice.h"
#include "framework/cli/planned_run.h"
#include "framework/core/files.h"
#include "framework/grading/course/course.h"
#include "framework/grading/verdicts/plain_text.h"
#include "framework/core/run_program.h"
#include "framework/live/session.h"
#include "framework/live/showcase.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSaves = "out/live";

struct LiveWords : RunWords {
  int port = 0;
  std::optional<std::string> saves;  // nothing: kSaves
  std::string part, id;              // of the other processes (live_parts.h)
};

/// "a3" becomes a scene of it. @return the assignment's id; empty for a scene
std::string scene_of_assignment(const Context& context, std::string& word) {
  for (const modules::ModuleKind* kind : context.registry.all())
    if (kind->id == word) {
      word = kind->note<live::Showcase>().scene;
      if (!word.empty()) return kind->id;
      const auto scenes =
          grading::scenes_of({context.root, context.build, &context.registry, ""}, kind->id);
      if (scenes.empty())
        throw UserError(kind->id, "has no scene",
                        "Name a scene of another assignment, or write one: tumble new scene " +
                            kind->id + " NAME");
      word = scenes.front().stem().string();
      return kind->id;
    }
  return "";
}

/// The words of this command for a process of the same program.
/// @param id  of the assignment that is judged; empty: none
std::vector<std::string> words_of_part(const LiveWords& words, const std::string& part,
                                       const std::string& id) {
  std::vector<std::string> all = {fs::read_symlink("/proc/self/exe").string(), "live", words.scene};
  const auto add = [&](const char* flag, const std::string& value) {
    if (!value.empty()) all.insert(all.end(), {flag, value});
  };
  const auto number = [](const std::optional<double>& x) {
    return x ? fmt::format("{}", *x) : std::string();
  };
  add("--modules", words.modules);
  add("--engine", words.engine);
  add("--method", words.method);
  add("--tolerance", number(words.tolerance));
  add("--n", words.n ? std::to_string(*words.n) : "");
  add("--scale", number(words.scale));
  add("--density", number(words.density));
  if (words.drop) all.push_back("--drop");
  add("--step-s", number(words.step_s));
  add("--part", part);
  add("--id", id);
  return all;
}

/// The user's files whose saving begins the scene anew.
std::vector<live::Watched> watched_files(const Context& context, const ModuleWords& modules) {
  std::vector<live::Watched> watched;
  for (const modules::ModuleKind* kind : context.registry.all()) {
    const auto word = modules.contains(kind->id) ? modules.find(kind->id) : modules.find("");
    const fs::path own = own_file(context, kind->folder);
    if (word == modules.end() || word->second == "student") {
      if (fs::exists(own)) watched.push_back({own, kind->id});
    } else if (fs::is_regular_file(word->second) && word->second.ends_with(".cpp")) {
      watched.push_back({fs::absolute(word->second), kind->id});
    }
  }
  return watched;
}

/// A handout as a page, made by pandoc; as it is written where that is missing.
std::string handout_page(const Context& context, const std::string& name) {
  const bool is_plain = std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '_' || c == '.';
  });
  const fs::path folder = context.root / "handouts",
                 file = folder / (fs::path(name).stem().string() + ".md");
  if (!is_plain || name.starts_with('.') || !fs::is_regular_file(file)) return "";
  if (name.ends_with(".md")) return text_of(file);
  const fs::path drawn = context.root / "out" / "handouts" / name;
  if (fs::is_regular_file(drawn)) return text_of(drawn);
  const auto made =
      run_program({"pandoc", "--from=markdown", "--to=html5", "--mathml", "--standalone", "--quiet",
                   "--metadata=title:" + file.stem().string(), file.string()},
                  Output::kCaptured, 30.0);
  return made.code == 0 ? made.printed : "";
}

/// What was changed in the page comes first. Its engine and its step stand in the saved file; those
/// of the command line do not.
std::string again(const LiveWords& words, const fs::path& file, const live::Changes& changes,
                  const std::string& modules) {
  std::string command = "tumble run " + grading::shell_word(file.string());
  const auto add = [&](const std::string& flag, const std::string& value) {
    if (!value.empty()) command += " " + flag + " " + value;
  };
  add("--modules", modules);
  if (changes.engine.empty()) add("--engine", words.engine);
  if (words.step_s && !changes.step_s) add("--step-s", fmt::format("{}", *words.step_s));
  add("--method", changes.method.empty() ? words.method : changes.method);
  if (words.tolerance) add("--tolerance", fmt::format("{}", *words.tolerance));
  return command;
}

/// Refuses a named folder in which scenes cannot be saved. Without a name the page is of use in a
/// folder that cannot be written, too.
/// @param can_save  whether the page can save its scene at all
void expect_saves(const LiveWords& words, bool can_save) {
  try {
    expect_writable(fs::path(words.saves.value_or(kSaves)) / "scene.json");
  } catch (const UserError& error) {
    if (words.saves) throw;
    if (can_save)
      fmt::print(stderr, "Save in the page will fail: {}: {}. --saves FOLDER names another\n",
                 error.where(), error.problem());
  }
}

void live_verb(Context& context, LiveWords& words) {
  if (words.part == "judge") return judge_for_page(context, words, words.id);
  if (words.part == "locate") return locate_for_page(context, words);
  if (words.part == "simulate") return simulate_for_page(context, words);
  const std::string id = scene_of_assignment(context, words.scene);
  const scene::Scene scene = scene_of_words(context, words, true);
  const ModuleWords modules = parse_module_words(words.modules, context.registry);
  // Refused here, and not in the page.
  expect_module_files(context, modules);
  expect_engine("--engine ", words.engine);
  check_plan_words(words);

  live::Sitting sitting;
  sitting.name = scene.name;
  sitting.port = words.port;
  sitting.recipe.file = scene.file;
  if (fs::is_regular_file(scene.file) && scene.file.extension() == ".json")
    sitting.recipe.document = text_of(scene.file);
  expect_saves(words, !sitting.recipe.document.empty());
  sitting.simulator = words_of_part(words, "simulate", "");
  sitting.locate = words_of_part(words, "locate", "");
  sitting.watched = watched_files(context, modules);
  sitting.judge = [words](const std::string& judged) {
    return words_of_part(words, "judge", judged);
  };
  // The assignment that was named, or the one that the scene stands in.
  sitting.first_judged = id;
  for (const live::Watched& one : sitting.watched) {
    const fs::path folder = context.root / "assignments" / context.registry.find(one.id).folder;
    if (id.empty() && fs::absolute(scene.file).parent_path().parent_path() == fs::absolute(folder))
      sitting.first_judged = one.id;
  }
  sitting.saves = words.saves.value_or(kSaves);
  sitting.again = [words](const fs::path& file, const live::Changes& changes,
                          const std::string& laws) { return again(words, file, changes, laws); };
  sitting.handout = [&context](const std::string& name) { return handout_page(context, name); };
  const live::Left left = live::serve(sitting, [&](const std::string& address) {
    fmt::print("{}\n", address);
    std::fflush(stdout);
    fmt::print(stderr,
               "open this address in a browser on this machine; Ctrl-C ends. Saved files begin the "
               "scene anew.\n");
  });
  fmt::print(stderr, "\nended; nothing is left running\n");
  for (const fs::path& kept : left.scenes) fmt::print(stderr, "kept: {}\n", kept.string());
  if (left.has_unsaved)
    fmt::print(stderr, "not kept: what was done by hand since {}; Save in the page keeps it\n",
               left.scenes.empty() ? "the start" : "the last scene was saved");
}

}  // namespace

void add_live(CLI::App& app, Context& context) {
  auto words = std::make_shared<LiveWords>();
  Verb verb(app, "live", "A page that runs a scene on your code: push, pull, change, save, see");
  verb.option("scene", words->scene,
              "A scene file, the bare name of one, a .3ds file, or an assignment: a1")
      .required()
      .type_name("SCENE");
  verb.option(
          "--modules", words->modules,
          "Whose laws, as in tumble run: student, reference, library, PATH.cpp; for all or each")
      .type_name("WORDS");
  verb.option("--engine", words->engine, "rd, ca, tw, ordered; default: the scene's own, or rd")
      .type_name("WORD");
  verb.option("--n", words->n, "Size of a scene whose size is a parameter").positive();
  verb.option("--scale", words->scale, "Of a .3ds file: length of its unit [m]").positive();
  verb.option("--density", words->density, "Of a .3ds file: density [kg/m^3]").positive();
  verb.flag("--drop", words->drop, "Of a .3ds file: drop it on a floor");
  verb.option("--step-s", words->step_s, "Step of the integrator [s] instead of the scene's")
      .positive();
  verb.option("--method", words->method, "Method of integration in place of the laws' own")
      .type_name("WORD");
  verb.option("--tolerance", words->tolerance, "Of a method that chooses its steps by one")
      .positive();
  verb.option("--port", words->port, "Port of the page; default: any that is free")
      .between(0, 65535)
      .type_name("PORT");
  verb.option("--saves", words->saves, "Folder of scenes that are saved in the page")
      .type_name("FOLDER")
      .default_text(kSaves);
  verb.option("--part", words->part, "").hidden();
  verb.option("--id", words->id, "").hidden();
  verb.footer(
      "The page is served to this machine alone, at an address that holds a token. Drag a body to "
      "push it; what was done by\nhand can be saved as a scene, which runs again byte for byte.\n"
      "Example: tumble live a1\n         tumble live drop_a_box --modules student");
  verb.runs([&context, words] { live_verb(context, *words); });
}

}  // namespace tumble::cli
