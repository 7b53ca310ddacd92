#include "framework/cli/module_choice.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <set>

#include <fmt/format.h>

#include "framework/cli/sandboxed_module.h"
#include "framework/core/nearest_word.h"
#include "framework/core/not_implemented.h"
#include "framework/core/files.h"
#include "framework/effects/registry.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/grading/compiler/build_module.h"
#include "framework/grading/compiler/compiler_words.h"
#include "framework/grading/worker/guarded_calls.h"
#include "framework/core/run_program.h"
#include "framework/modules/bind_laws.h"
#include "framework/modules/load.h"
#include "framework/scene/model_scene.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;
using modules::AnyModule;
using modules::ModuleKind;

fs::path built(const Context& context, const std::string& id, const std::string& word) {
  return context.build / "modules" / (id + '_' + word + ".so");
}

/// Compiles as a submission is compiled, with its precompiled header. The compiler's output goes to
/// stderr.
void compile(const Context& context, const fs::path& source, const fs::path& object) {
  const auto words = grading::own_compilation(context.root, context.build, source, object);
  const int code = run_program(words, Output::kOurs).code;
  if (code == 127) throw UserError("g++", "the compiler cannot be started", "Install g++.");
  if (code != 0)
    throw UserError(source.string(), "does not compile; the compiler says why above",
                    "Correct it, or name another file after --modules.");
}

/// The student's file, for people: from the root of the tree.
std::string student_file(const Context& context, const ModuleKind& kind) {
  const std::string name = kind.folder + ".cpp";
  return context.is_installed ? name : "assignments/" + kind.folder + "/" + name;
}

/// The student's module, built from the current file.
/// @throws UserError with the compiler's output: an old object must not replace a file that does
///   not compile
fs::path build_student(const Context& context, const ModuleKind& kind) {
  static const PrivateFolder folder;  // where the tree cannot be written
  const fs::path object = context.is_installed ? folder.path() / (kind.id + ".so")
                                               : built(context, kind.id, "student"),
                 source = own_file(context, kind.folder);
  static std::set<std::string> fresh;  // ids, built by this process
  if (fresh.contains(kind.id)) return object;
  if (!fs::exists(source)) throw missing_file(context, kind.id, source);
  if (const std::string why = grading::why_nothing(source.filename().string(), text_of(source),
                                                   grading::header_in(kind.folder));
      !why.empty())
    throw UserError(student_file(context, kind), "does not compile:\n" + why,
                    "Correct it, or name another file after --modules.");
  std::error_code missing;
  const auto made = fs::last_write_time(object, missing);
  if (missing || made < fs::last_write_time(source))
    std::fprintf(stderr, "compiling %s\n", student_file(context, kind).c_str());
  // Tasks of a farm do not build, all at once, what the command that started them has built.
  if (std::getenv("TUMBLE_TASK") != nullptr && !missing && made >= fs::last_write_time(source)) {
    fresh.insert(kind.id);
    return object;
  }
  const std::vector<std::string> by_ninja = {"ninja", "-C", context.build.string(), "--quiet",
                                             kind.id + "_student"};
  const auto outcome = run_program(
      context.is_installed ? grading::own_compilation(context.root, context.build, source, object)
                           : by_ninja,
      Output::kCaptured);
  if (outcome.code != 0) {
    const fs::path header = context.root / grading::header_in(kind.folder);
    throw UserError(
        student_file(context, kind),
        "does not compile:\n" + grading::compiler_story(outcome.printed, source, header),
        "Correct it (./tumble check " + kind.id +
            " says the same), or name another file after --modules.");
  }
  fresh.insert(kind.id);
  return object;
}

/// The user's own code in this process, with guards against errors.
/// @param file  what the user knows it by: the source of the object
AnyModule load_own(const ModuleKind& kind, const fs::path& object, const std::string& file) {
  const auto load = [&] {
    try {
      return modules::load_module(kind, object);
    } catch (const UserError& error) {
      if (error.where() != object.string()) throw;
      throw UserError(file, error.problem(), error.remedy());
    }
  };
  return grading::guarded(kind, grading::guarded_load(file, load), file);
}

/// Whether this tree has the module of a word.
bool is_there(const Context& context, const ModuleKind& kind, const std::string& word) {
  return word == "student" ? fs::exists(own_file(context, kind.folder))
                           : fs::exists(built(context, kind.id, word));
}

}  // namespace

AnyModule load_word(const Context& context, const ModuleKind& kind, const std::string& word) {
  if (word == "student")
    return load_own(kind, build_student(context, kind), student_file(context, kind));
  if (word == "reference") {
    if (!is_there(context, kind, word))
      throw UserError("--modules " + kind.id + "=reference",
                      "this tree holds no reference solution of " + kind.id,
                      "Use " + kind.id + "=student, or name a file of your own.");
    return modules::load_module(kind, built(context, kind.id, word));
  }
  const fs::path file = word;
  if (file.extension() != ".cpp" && file.extension() != ".so")
    throw UserError("--modules " + kind.id + "=" + word,
                    "this is none of student, reference, library, PATH.so, PATH.cpp",
                    "Give one of these.");
  if (!fs::exists(file))
    throw UserError("--modules " + kind.id + "=" + word, "there is no such file",
                    "Check the path.");
  if (file.extension() == ".so") return load_own(kind, file, word);
  const PrivateFolder folder;
  const fs::path object = folder.path() / (kind.id + ".so");
  compile(context, file, object);
  return load_own(kind, object, word);
}

namespace {

bool is_path(const std::string& word) {
  return !word.empty() && word != "student" && word != "reference" && word != "library";
}

}  // namespace

fs::path module_file(const Context& context, const ModuleKind& kind, const std::string& word,
                     bool for_all) {
  const std::string flag = "--modules " + (for_all ? word : kind.id + '=' + word);
  const fs::path path = word;
  if (fs::is_directory(path)) {
    const fs::path file = path / (kind.folder + ".cpp");
    if (fs::exists(file)) return file;
    const auto kinds = context.registry.all();
    const bool is_other =
        for_all && std::any_of(kinds.begin(), kinds.end(), [&](const ModuleKind* k) {
          return fs::exists(path / (k->folder + ".cpp"));
        });
    if (!is_other)
      throw UserError(flag, "this folder holds no " + kind.folder + ".cpp",
                      "Name a submission's folder, or its file.");
    return {};
  }
  if (path.extension() != ".cpp" && path.extension() != ".so")
    throw UserError(
        flag,
        "this is none of student, reference, library, PATH.so, PATH.cpp, or a submission's folder",
        "Give one of these.");
  if (!fs::exists(path)) throw UserError(flag, "there is no such file", "Check the path.");
  const auto kinds = context.registry.all();
  const bool is_other =
      for_all && std::any_of(kinds.begin(), kinds.end(), [&](const ModuleKind* k) {
        return k->id != kind.id && path.stem() == k->folder;
      });
  return is_other ? fs::path() : path;
}

namespace {

template <class Law, class Call>
std::string stand_in(Law& law, const Law& library, const Call& call) {
  try {
    call(law);
  } catch (const NotImplemented& missing) {
    law = library;
    return missing.function();
  } catch (const std::exception&) {  // it is written; whether it is right is not checked here
  }
  return "";
}

/// Replaces stubs of the laws of motion by the library's. @return the replaced functions, or
/// nothing
std::vector<std::string> stand_in_for_stubs(Laws& laws) {
  const Laws library = library_laws();
  const VectorXd y = VectorXd::Constant(1, 1.0);
  const OdeFunction decay = [](double, const VectorXd& at) -> VectorXd { return -at; };
  const ScalarFunction line = [](double t) { return 0.5 - t; }, slope = [](double) { return -1.0; };
  const RigidBodyState rest{Vector3d::Zero(), Quaterniond::Identity(), Vector3d::Zero(),
                            Vector3d::Zero()};
  const Inertia unit{1.0, 1.0, Matrix3d::Identity(), Matrix3d::Identity()};
  std::vector<std::string> missing = {
      stand_in(laws.integrate_step, library.integrate_step,
               [&](auto& law) { law(decay, 0.0, y, 0.1); }),
      stand_in(laws.state_derivative, library.state_derivative,
               [&](auto& law) {
                 law(rest, unit, {Vector3d::Zero(), Vector3d::Zero()});
               }),
      stand_in(laws.renormalize, library.renormalize,
               [](auto& law) { law(Quaterniond::Identity()); }),
      stand_in(laws.find_impact_time, library.find_impact_time,
               [&](auto& law) { law(line, slope, 0.0, 1.0, 1e-9); })};
  std::erase(missing, "");
  return missing;
}

/// Reference where this tree has one, else the student's.
std::string best_available(const Context& context, const std::string& id) {
  return fs::exists(built(context, id, "reference")) ? "reference" : "student";
}

bool is_own(const scene::Scene& scene, const ModuleKind& kind) {
  const fs::path scenes = fs::absolute(scene.file).parent_path();
  return scenes.filename() == "scenes" && scenes.parent_path().filename() == kind.folder;
}

/// The word of a module without one; empty: the scene does not need it.
std::string default_word(const Context& context, const scene::Scene& scene, const ModuleKind& kind,
                         bool scene_has_home) {
  if (is_own(scene, kind)) return "student";
  // moved by the written module, or by the library
  if (scene::names_model(scene.file.string()) && !kind.methods.empty())
    return best_available(context, kind.id);
  if (std::find(scene.needs.begin(), scene.needs.end(), kind.id) == scene.needs.end()) return "";
  return scene_has_home ? best_available(context, kind.id) : "student";
}

}  // namespace

ModuleWords parse_module_words(const std::string& text, const modules::Registry& registry) {
  ModuleWords words;
  std::size_t start = 0;
  while (start < text.size()) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    const std::string part = text.substr(start, end - start);
    start = end + 1;
    const std::size_t equals = part.find('=');
    const std::string id = equals == std::string::npos ? "" : part.substr(0, equals);
    const std::string word = equals == std::string::npos ? part : part.substr(equals + 1);
    if (!id.empty()) registry.find(id);  // throws, with the known ids
    if (word.empty())
      throw UserError("--modules " + text, "nothing stands after '" + id + "='",
                      "Give student, reference, library, PATH.so or PATH.cpp.");
    if (!words.emplace(id, word).second)
      throw UserError("--modules " + text,
                      id.empty() ? "more than one word for all modules" : id + " is named twice",
                      "Name each module once: a1=student,a2=library");
  }
  return words;
}

namespace {

bool is_about(const scene::Scene& scene, const ModuleKind& kind) {
  return is_own(scene, kind) ||
         std::find(scene.needs.begin(), scene.needs.end(), kind.id) != scene.needs.end();
}

/// Adds one module, chosen by a word, to the laws.
void add_module(const Context& context, const scene::Scene& scene, const ModuleKind& kind,
                const std::string& word, const fs::path& file, const InPlaceOf& in_place_of,
                ChosenLaws& result) {
  result.modules.push_back({kind.id, word});
  if (word == "library") return;
  if (!file.empty()) {
    SandboxedModule sandboxed = load_sandboxed(context, kind, file);
    for (auto* depth : {&sandboxed.search, &sandboxed.step, &sandboxed.derivative})
      depth->module = in_place_of(kind, word, depth->module);
    Laws step, derivative;  // from workers of their own, for calls within calls
    modules::bind_laws(kind, sandboxed.search.module, kind.id + " " + word, result.laws);
    kind.bind(sandboxed.step.module, step);
    kind.bind(sandboxed.derivative.module, derivative);
    if (step.integrate_step) result.laws.integrate_step = step.integrate_step;
    if (derivative.renormalize) result.laws.renormalize = derivative.renormalize;
    if (derivative.state_derivative) result.laws.state_derivative = derivative.state_derivative;
    // Effects ask their laws within a step.
    if (step.integrate_step) result.laws.take_listed(derivative, kind.id + " " + word);
    for (const auto& depth : {sandboxed.search, sandboxed.step, sandboxed.derivative})
      result.connections.push_back(depth.connection);
    return;
  }
  const Laws before = result.laws;
  modules::bind_laws(kind, in_place_of(kind, word, load_word(context, kind, word)),
                     kind.id + " " + word, result.laws);
  const bool may_stand_in = word == "student" && !is_about(scene, kind) &&
                            before.integrator_source != result.laws.integrator_source;
  if (!may_stand_in) return;
  const auto missing = stand_in_for_stubs(result.laws);
  if (missing.empty()) return;
  std::string names;
  for (const auto& name : missing) names += (names.empty() ? "" : ", ") + name;
  result.notices.push_back(kind.id + " is not written yet (" + names +
                           "): the library's laws of motion stand in");
  if (missing.size() == 4) result.laws.integrator_source = before.integrator_source;
}

}  // namespace

namespace {

void refuse_unknown_needs(const scene::Scene& scene, const std::vector<const ModuleKind*>& kinds) {
  std::vector<std::string> ids;
  std::string known;
  for (const ModuleKind* kind : kinds) {
    ids.push_back(kind->id);
    known += (known.empty() ? "" : ", ") + kind->id;
  }
  for (std::size_t i = 0; i < scene.needs.size(); ++i)
    if (std::find(ids.begin(), ids.end(), scene.needs[i]) == ids.end())
      throw UserError(
          place_of(scene, "/needs/" + std::to_string(i)),
          "there is no assignment '" + scene.needs[i] + "'." + did_you_mean(scene.needs[i], ids),
          "Known: " + known + ".");
}

}  // namespace

namespace {

/// A module that the scene does not need, for later calls: from the existing build, if it compiles.
void bind_spare(const Context& context, const ModuleKind& kind, const InPlaceOf& in_place_of,
                ChosenLaws& result) {
  const std::string word = best_available(context, kind.id);
  if (kind.is_scheduler || !is_there(context, kind, word)) return;
  try {
    modules::bind_laws(kind, in_place_of(kind, word, load_word(context, kind, word)),
                       kind.id + " " + word, result.laws);
  } catch (const UserError& error) {
    result.notices.push_back(error.where() + " does not compile; this scene does not need it");
  }
}

}  // namespace

void expect_module_files(const Context& context, const ModuleWords& words) {
  for (const ModuleKind* kind : context.registry.all()) {
    const auto told = words.contains(kind->id) ? words.find(kind->id) : words.find("");
    if (told != words.end() && is_path(told->second))
      module_file(context, *kind, told->second, told->first.empty());
  }
}

ChosenLaws choose_laws(const Context& context, const scene::Scene& scene, const ModuleWords& words,
                       const std::string& engine) {
  return choose_laws(
      context, scene, words, engine,
      [](const ModuleKind&, const std::string&, const AnyModule& module) { return module; });
}

ChosenLaws choose_laws(const Context& context, const scene::Scene& scene, const ModuleWords& words,
                       const std::string& engine, const InPlaceOf& in_place_of) {
  const auto kinds = context.registry.all();
  refuse_unknown_needs(scene, kinds);
  const bool has_home = std::any_of(kinds.begin(), kinds.end(),
                                    [&](const ModuleKind* kind) { return is_own(scene, *kind); });
  // A named scheduler is the user's current work in any scene: unfinished earlier assignments must
  // not prevent the run.
  const bool is_for_scheduler = std::any_of(
      kinds.begin(), kinds.end(),
      [&](const ModuleKind* kind) { return kind->is_scheduler && words.contains(kind->id); });
  const bool needs_scheduler =
      (engine.empty() ? scene.engine : engine).find("tw") != std::string::npos &&
      !engines::fast_timewarp();
  std::map<std::string, std::string> chosen;  // by id
  std::map<std::string, fs::path> files;
  for (const ModuleKind* kind : kinds) {
    const auto told = words.contains(kind->id) ? words.find(kind->id) : words.find("");
    const bool is_asked = kind->is_scheduler && needs_scheduler;
    const std::string otherwise =
        is_asked ? best_available(context, kind->id)
                 : default_word(context, scene, *kind, has_home || is_for_scheduler);
    chosen[kind->id] = told != words.end() ? told->second : otherwise;
    // One word for all modules applies to those that the scene is about and those that exist:
    // "reference" is not applied where an assignment has none yet. A scheduler is included where
    // the engine needs it: a tree without the fast one runs timewarp by the student's.
    const bool for_all = told != words.end() && told->first.empty() &&
                         (told->second == "reference" || told->second == "student");
    const bool left_out = kind->is_scheduler
                              ? !needs_scheduler
                              : !is_there(context, *kind, told == words.end() ? "" : told->second);
    if (for_all && !is_about(scene, *kind) && left_out) chosen[kind->id] = otherwise;
    if (told == words.end() || !is_path(told->second)) continue;
    files[kind->id] = module_file(context, *kind, told->second, told->first.empty());
    // The submission is another assignment's: this one must not make it fail, so it is right where
    // possible.
    if (files[kind->id].empty())
      chosen[kind->id] = otherwise.empty() ? "" : best_available(context, kind->id);
  }

  ChosenLaws result;
  // Modules that the scene does not need may still be called (a push by hand): from the existing
  // build, if there is one.
  for (const ModuleKind* kind : kinds) {
    if (chosen[kind->id].empty()) bind_spare(context, *kind, in_place_of, result);
  }
  modules::set_library_motion(result.laws);
  result.laws.rows_are_given = true;
  for (const ModuleKind* kind : kinds) {
    const std::string& word = chosen[kind->id];
    if (word.empty()) continue;
    const std::string before = result.laws.constraint_source;
    add_module(context, scene, *kind, word, files[kind->id], in_place_of, result);
    // Rows of the reference, or of a finished assignment in a scene of another, are not looked at.
    if (result.laws.constraint_source != before)
      result.laws.rows_are_given =
          word == "reference" ||
          (has_home && !is_own(scene, *kind) && !words.contains(kind->id) && !words.contains(""));
  }
  return result;
}

std::vector<std::string> authors_of_laws(const scene::Scene& scene, const Laws& laws) {
  std::vector<std::string> authors{"impulses by " + laws.impulse_source,
                                   "motion by " + laws.integrator_source};
  if (scene.contact || effects::asks_laws_of("a3", scene))
    authors.push_back(fmt::format(
        "springs, rods and contact by {}{}", laws.constraint_source,
        scene.contact ? ", where it rubs, is linked or is one of many by the framework" : ""));
  for (std::string& author : effects::authors_of_listed_laws(scene, laws))
    authors.push_back(std::move(author));
  return authors;
}

void refuse_library(const ModuleKind& kind, const std::string& functions, const std::string& more) {
  throw UserError(
      "--modules " + kind.id + "=library", "the library has no " + functions,
      "Use " + kind.id + "=student, or name a file." + (more.empty() ? "" : " " + more));
}

void refuse_threads_of_sandboxes(const ChosenLaws& chosen, int threads) {
  if (threads > 1 && !chosen.connections.empty())
    throw UserError("--threads " + std::to_string(threads),
                    "a submission in the sandbox answers one call at a time",
                    "Run it with --threads 1, or take the modules student or reference.");
}

}  // namespace tumble::cli
