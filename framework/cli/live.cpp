// tumble live SCENE|aN: a page on this machine that runs the scene on the user's own code, to be
// pushed, pulled and changed while it goes.
#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <regex>

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
/// @throws UserError for an assignment that there is not
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
  if (std::regex_match(word, std::regex("a[0-9]+")) && !fs::exists(word)) {
    std::string known;
    for (const modules::ModuleKind* kind : context.registry.all())
      known += (known.empty() ? "" : ", ") + kind->id;
    throw UserError(word, "there is no such assignment",
                    "Known: " + known + ". A scene has a name: tumble scenes lists them.");
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
/// @param program  as it is called where the user is
std::string again(const std::string& program, const LiveWords& words, const fs::path& file,
                  const live::Changes& changes, const std::string& modules) {
  std::string command = program + " run " + grading::shell_word(file.string());
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

live::SceneStart start_of(const Context& context, const LiveWords& words) {
  const scene::Scene scene = scene_of_words(context, words, true);
  live::SceneStart start;
  start.name = scene.name;
  start.title = scene.title;
  start.recipe.file = scene.file;
  if (fs::is_regular_file(scene.file) && scene.file.extension() == ".json")
    start.recipe.document = text_of(scene.file);
  start.simulator = words_of_part(words, "simulate", "");
  start.locate = words_of_part(words, "locate", "");
  start.again = [words, program = context.is_installed ? "tumble" : "./tumble"](
                    const fs::path& file, const live::Changes& changes, const std::string& laws) {
    return again(program, words, file, changes, laws);
  };
  return start;
}

/// Those of a module's laws that a file says are not written.
bool lacks_laws(const modules::ModuleKind& kind, const fs::path& file) {
  if (!fs::is_regular_file(file)) return true;
  const std::string text = text_of(file);
  const std::vector<std::string> laws = kind.functions_of_laws();
  return std::any_of(laws.begin(), laws.end(), [&](const std::string& law) {
    return std::regex_search(text, std::regex("NotImplemented\\s*\\(\\s*\"" + law + "\""));
  });
}

/// The scenes that can be chosen in the page, on the code that the sitting is about.
class Choice {
 public:
  /// @param own  id of the assignment that the sitting is about; empty: none
  Choice(const Context& context, const LiveWords& words, const std::string& own,
         const live::SceneStart& first)
      : context_(context), words_(words), first_name_(first.name), own_(own) {
    std::map<std::string, std::string> ids;  // by folder
    for (const modules::ModuleKind* kind : context.registry.all()) ids[kind->folder] = kind->id;
    for (const ListedScene& listed : listed_scenes(context)) {
      if (!listed.problem.empty()) continue;
      const auto home = ids.find(listed.folder);
      scenes_.push_back({.name = listed.name,
                         .title = listed.title,
                         .home = home == ids.end() ? "" : home->second,
                         .needs = listed.needs,
                         .unwritten = {}});
    }
    const bool is_listed = std::any_of(scenes_.begin(), scenes_.end(),
                                       [&](const auto& one) { return one.name == first.name; });
    if (!is_listed) scenes_.insert(scenes_.begin(), {first.name, first.title, "", {}, {}});
    // Other scenes run on the same file as the first one.
    const ModuleWords modules = parse_module_words(words.modules, context.registry);
    modules_ = words.modules;
    if (!own.empty() && !modules.contains(own) && !modules.contains(""))
      modules_ += (modules_.empty() ? "" : ",") + own + "=student";
  }

  std::vector<live::OfferedScene> offered() const {
    std::map<std::string, bool> is_stub;  // of the student's file, by id
    for (const modules::ModuleKind* kind : context_.registry.all())
      is_stub[kind->id] = lacks_laws(*kind, own_file(context_, kind->folder));
    std::vector<live::OfferedScene> all = scenes_;
    for (live::OfferedScene& scene : all) {
      std::vector<std::string> asked = scene.needs;
      if (!scene.home.empty() && std::find(asked.begin(), asked.end(), scene.home) == asked.end())
        asked.push_back(scene.home);
      for (const std::string& id : asked)
        if (id != own_ && runs_on_student(scene, id) && is_stub[id]) scene.unwritten.push_back(id);
    }
    return all;
  }

  /// @throws UserError for a name that was not offered
  live::SceneStart named(const std::string& name) const {
    if (name == first_name_) return start_of(context_, words_);
    if (std::none_of(scenes_.begin(), scenes_.end(),
                     [&](const auto& one) { return one.name == name; }))
      throw UserError(name, "there is no such scene", "");
    LiveWords words;
    words.scene = name;
    words.modules = modules_;
    return start_of(context_, words);
  }

 private:
  /// Else on a reference, on a file that was named, or on the library. As choose_laws has it: a
  /// scene of no assignment runs on the student's files.
  bool runs_on_student(const live::OfferedScene& scene, const std::string& id) const {
    const ModuleWords modules = parse_module_words(modules_, context_.registry);
    const auto word = modules.contains(id) ? modules.find(id) : modules.find("");
    if (word != modules.end()) return word->second == "student";
    const auto kinds = context_.registry.all();
    const bool is_for_scheduler = std::any_of(kinds.begin(), kinds.end(), [&](const auto* kind) {
      return kind->is_scheduler && modules.contains(kind->id);
    });
    const bool is_of_none = scene.home.empty() && !is_for_scheduler;
    return scene.home == id || is_of_none ||
           !fs::exists(context_.build / "modules" / (id + "_reference.so"));
  }

  const Context& context_;
  LiveWords words_;
  std::string first_name_, own_, modules_;
  std::vector<live::OfferedScene> scenes_;
};

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
  static_cast<live::SceneStart&>(sitting) = start_of(context, words);
  sitting.port = words.port;
  expect_saves(words, !sitting.recipe.document.empty());
  sitting.watched = watched_files(context, modules);
  sitting.judge = [words](const std::string& judged) {
    return words_of_part(words, "judge", judged);
  };
  // The assignment that was named, or the one that the scene stands in, where its code is the
  // user's own: a run on the reference says nothing of the file beside it.
  for (const live::Watched& one : sitting.watched) {
    const fs::path folder = context.root / "assignments" / context.registry.find(one.id).folder;
    if (id.empty() ? fs::absolute(scene.file).parent_path().parent_path() == fs::absolute(folder)
                   : one.id == id)
      sitting.first_judged = one.id;
  }
  sitting.saves = words.saves.value_or(kSaves);
  const Choice choice(context, words, sitting.first_judged, sitting);
  sitting.offered = [&choice] { return choice.offered(); };
  sitting.scene_named = [&choice](const std::string& name) { return choice.named(name); };
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
    fmt::print(
        stderr,
        "not kept: what was done by hand since {}; 'Save scene' in the page keeps it, and says "
        "'not saved' beside it until then\n",
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
      "push it; what was done by hand can be saved as a scene, which runs again byte for byte.\n"
      "Example: tumble live a1\n         tumble live drop_a_box --modules student");
  verb.runs([&context, words] { live_verb(context, *words); });
}

}  // namespace tumble::cli
