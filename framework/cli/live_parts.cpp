#include "framework/cli/live_parts.h"

#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <list>
#include <regex>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/check_program.h"
#include "framework/cli/find_scene.h"
#include "framework/cli/module_choice.h"
#include "framework/cli/pick_face.h"
#include "framework/cli/planned_run.h"
#include "framework/core/files.h"
#include "framework/core/not_implemented.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/core/run_program.h"
#include "framework/grading/verdicts/mend_order.h"
#include "framework/grading/verdicts/own_functions.h"
#include "framework/grading/verdicts/rubric.h"
#include "framework/grading/worker/guarded_calls.h"
#include "framework/live/records.h"
#include "framework/live/recipe.h"
#include "framework/live/simulate.h"
#include "framework/modules/call_counts.h"
#include "framework/modules/names.h"
#include "framework/scene/load_scene.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// A call that takes longer is an endless loop: right ones take microseconds. [s]
constexpr double kCallLimit = 2.0;
// A run goes on for so long at least, where its engine goes step by step. [s]
constexpr double kLongEnough = 120.0;

std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

scene::Scene scene_of(const Context& context, const RunWords& words, const live::Recipe& recipe) {
  if (!recipe.document.empty()) return scene::parse_scene(live::document_of(recipe), recipe.file);
  scene::Scene scene = scene_of_words(context, words, true);
  live::apply(recipe, scene);
  return scene;
}

/// What is asked of the modules of a run.
struct Asked {
  struct Module {
    Module(const modules::ModuleKind& of, const std::string& word)
        : kind(&of), source(word), counts(of.functions), laws(of.functions_of_laws()) {}
    const modules::ModuleKind* kind;
    std::string source;
    modules::CallCounts counts;
    std::vector<std::string> laws;
  };
  std::list<Module> all;  // watched by their addresses

  modules::AnyModule counted(const modules::ModuleKind& kind, const std::string& source,
                             const modules::AnyModule& module) {
    for (Module& one : all)  // a sandbox has three copies of a module
      if (one.kind == &kind) return kind.watched(module, one.counts);
    Module& one = all.emplace_back(kind, source);
    return kind.watched(module, one.counts);
  }
  std::string as_json() const {
    Json modules = Json::array();
    for (const Module& one : all) {
      Json functions = Json::array();
      for (std::size_t k = 0; k < one.counts.functions().size(); ++k)
        functions.push_back({one.counts.functions()[k], one.counts.count(k)});
      modules.push_back({{"id", one.kind->id},
                         {"source", one.source},
                         {"functions", functions},
                         {"laws", one.laws}});
    }
    return dumped(modules);
  }
};

// What a run asks, for a signal handler: of the one run of this process.
std::shared_ptr<const Asked> asked_here;

// "called a1 collision_impulse 12": live::Simulator reads it.
void say_calls() {
  if (!asked_here) return;
  for (const Asked::Module& one : asked_here->all)
    for (std::size_t k = 0; k < one.counts.functions().size(); ++k) {
      if (one.counts.count(k) == 0) continue;
      grading::say_in_handler("called ");
      grading::say_in_handler(one.kind->id.c_str());
      grading::say_in_handler(" ");
      grading::say_in_handler(one.counts.functions()[k].c_str());
      grading::say_in_handler(" ");
      grading::say_in_handler(one.counts.count(k));
      grading::say_in_handler("\n");
    }
}

live::Simulation simulation_of(const Context& context, RunWords words, const Json& asked,
                               ChosenLaws& chosen) {
  const live::Recipe recipe = live::recipe_of(asked.at("recipe"));
  live::Simulation simulation;
  simulation.scene = scene_of(context, words, recipe);
  if (!recipe.changes.engine.empty()) words.engine = recipe.changes.engine;
  if (!recipe.changes.method.empty()) words.method = recipe.changes.method;
  if (recipe.changes.step_s) words.step_s = recipe.changes.step_s;
  const auto counts = std::make_shared<Asked>();
  chosen = choose_laws(
      context, simulation.scene, parse_module_words(words.modules, context.registry), words.engine,
      [counts](const modules::ModuleKind& kind, const std::string& word,
               const modules::AnyModule& module) { return counts->counted(kind, word, module); });
  const PlannedRun plan = plan_run(context, simulation.scene, chosen, words);
  simulation.laws = plan.laws;
  simulation.options = plan.options;
  if (simulation.options.engine.empty())
    simulation.options.engine = simulation.scene.engine.empty() ? "rd" : simulation.scene.engine;
  simulation.root = context.root;
  for (const ChosenModule& module : chosen.modules)
    simulation.modules += (simulation.modules.empty() ? "" : ",") + module.id + "=" + module.source;
  const auto times = std::make_shared<VirtualTimes>();
  simulation.options.timewarp = engines::fast_timewarp(times.get());
  simulation.times = times;
  // Of many bodies fewer pictures a second are enough.
  constexpr std::size_t kMany = 100;
  simulation.options.frame_rate_hz = simulation.scene.bodies.size() > kMany ? 30.0 : 60.0;
  // Step by step a run goes on until it is ended; but a saved one ends where it ended.
  if (simulation.options.engine == "rd" && !recipe.duration_s)
    simulation.options.duration_s = std::max(kLongEnough, simulation.scene.duration_s);
  simulation.from_s = asked.at("from_s");
  simulation.speed = asked.at("speed");
  simulation.is_paused = asked.at("paused");
  simulation.pick = [root = context.root, laws = simulation.laws](
                        const scene::Scene& posed, const Ray& ray) -> std::optional<live::Hit> {
    const auto hit = pick_face(posed, laws, ray, root);
    if (!hit) return std::nullopt;
    return live::Hit{hit->body, hit->face, hit->point_world};
  };
  // Whether a function is written was tried out above: that is no call of the run.
  for (Asked::Module& one : counts->all) one.counts.clear();
  asked_here = counts;
  simulation.asked = [counts] { return counts->as_json(); };
  return simulation;
}

void refuse(int records, const std::string& where, const std::string& problem,
            const std::string& remedy, bool not_attempted) {
  live::write_record(records, live::RecordKind::kRefused,
                     dumped({{"where", where},
                             {"problem", problem},
                             {"remedy", remedy},
                             {"not_attempted", not_attempted}}));
}

/// A user's file among the modules, with the functions that it has to have.
struct OwnSource {
  std::string id;
  fs::path file;
  std::vector<std::string> functions;
};
std::vector<OwnSource> own_sources(const Context& context, const RunWords& words) {
  const ModuleWords modules = parse_module_words(words.modules, context.registry);
  std::vector<OwnSource> sources;
  for (const modules::ModuleKind* kind : context.registry.all()) {
    const auto word = modules.contains(kind->id) ? modules.find(kind->id) : modules.find("");
    const bool is_path = word != modules.end() && word->second.ends_with(".cpp");
    if (is_path || word == modules.end() || word->second == "student")
      sources.push_back({kind->id,
                         is_path ? fs::path(word->second) : own_file(context, kind->folder),
                         kind->functions});
  }
  return sources;
}

/// The line of an offset into a shared object: those of students are compiled with lines.
/// @return 0: not found
int line_of_offset(const fs::path& source, const fs::path& object, std::uint64_t offset) {
  const auto told =
      run_program({"addr2line", "-i", "-e", object.string(), fmt::format("{:#x}", offset)},
                  Output::kCaptured, 20.0);
  // Innermost first; inlined library code is passed over.
  std::istringstream lines(told.printed);
  for (std::string line; std::getline(lines, line);)
    if (line.find(source.filename().string() + ":") != std::string::npos)
      return std::atoi(line.c_str() + line.rfind(':') + 1);
  return 0;
}

std::string line_in(const fs::path& file, int number) {
  std::ifstream in(file);
  std::string text;
  for (int k = 0; k < number && std::getline(in, text); ++k) {
  }
  return text.substr(std::min(text.find_first_not_of(" \t"), text.size()));
}

/// The line in which a call of the module ended, where its story names it; 0: it does not.
int exact_line_of(const grading::TestResult& result) {
  const std::string place = grading::exact_place_of(result);
  return place.empty() ? 0 : std::atoi(place.c_str() + place.rfind(':') + 1);
}

/// With the place of the hints where other stories have what to read.
std::string story_for_page(const grading::TestResult& result) {
  constexpr std::string_view kHints = "theory and hints: ";
  const std::size_t at = result.story.find(kHints);
  if (result.verdict != grading::Verdict::kNotAttempted || at == std::string::npos)
    return result.story;
  const std::size_t begin = at + kHints.size();
  return result.story + "\n  read:     " +
         result.story.substr(begin, result.story.find_first_of(" \n", begin) - begin);
}

}  // namespace

void locate_for_page(Context& context, const RunWords& words) {
  const std::string said{std::istreambuf_iterator<char>(std::cin), {}};
  const std::vector<OwnSource> sources = own_sources(context, words);
  std::istringstream lines(said);
  const std::string program = fs::read_symlink("/proc/self/exe").filename().string();
  int outside = 0;  // frames since those of the program's own handler
  for (std::string line; std::getline(lines, line);) {
    std::istringstream parts(line);
    std::string word, object;
    std::uint64_t offset = 0;
    if (!(parts >> word >> object >> std::hex >> offset) || word != "frame") continue;
    // Behind the handler comes the kernel's way into it, then the place that was interrupted: not
    // behind a call, as the others are.
    if (outside > 0 || fs::path(object).filename() != program) ++outside;
    if (outside == 2) ++offset;
    for (const OwnSource& source : sources) {
      const std::string name = fs::path(object).filename().string();
      if (name != source.id + "_student.so" && name != source.id + ".so") continue;
      if (const int number = line_of_offset(source.file, object, offset); number > 0) {
        fmt::print("{}:{}: {}\n", source.file.filename().string(), number,
                   line_in(source.file, number));
        return;
      }
    }
  }
  // Of several functions that are named any may be the one.
  for (const OwnSource& source : sources) {
    std::string places, first;
    for (const std::string& function : source.functions) {
      const std::regex named("\\b" + function + "\\b");
      if (!std::regex_search(said, named)) continue;
      const int number = grading::line_of_definition(text_of(source.file), function);
      if (number == 0) continue;
      places += fmt::format("{}{}, which begins in line {}", places.empty() ? "in " : ", or in ",
                            function, number);
      if (first.empty()) first = line_in(source.file, number);
    }
    if (places.empty()) continue;
    fmt::print("{} of {}: {}\n", places, source.file.filename().string(), first);
    return;
  }
}

void simulate_for_page(Context& context, const RunWords& words) {
  ::signal(SIGPIPE, SIG_IGN);  // a page that is gone is a write that fails
  // What the student's code prints to stdout must not stand between records.
  const int records = ::dup(STDOUT_FILENO);
  ::dup2(STDERR_FILENO, STDOUT_FILENO);
  grading::guard_for_another(kCallLimit, &say_calls);
  std::string line;
  for (char c = 0; ::read(STDIN_FILENO, &c, 1) == 1 && c != '\n';) line += c;
  ChosenLaws chosen;
  try {
    live::Simulation simulation = simulation_of(context, words, Json::parse(line), chosen);
    live::simulate(simulation, STDIN_FILENO, records);
  } catch (const UserError& error) {
    refuse(records, error.where(), error.problem(), error.remedy(), false);
  } catch (const NotImplemented& missing) {
    refuse(records, missing.function(), missing.what(),
           "Nothing is wrong with it: it is yet to be written. The page goes on when you save it.",
           true);
  } catch (const std::exception& error) {
    refuse(records, "tumble live", error.what(), "", false);
  }
}

void judge_for_page(Context& context, const RunWords& words, const std::string& id) {
  const modules::ModuleName& name = modules::find_name(assignment_names(), id);
  const ModuleWords modules = parse_module_words(words.modules, context.registry);
  CheckWords check;
  check.id = id;
  const auto word = modules.contains(id) ? modules.find(id) : modules.find("");
  if (word != modules.end() && word->second.ends_with(".cpp"))
    check.file = word->second;
  else  // which the process that simulates has built
    check.object = context.build / "modules" / (id + "_student.so");
  // The motion comes first.
  constexpr int kLater = 5;
  [[maybe_unused]] const int is_nice = ::nice(kLater);
  const fs::path file = checked_file(context, check);
  const CheckedTests checked = check_quietly(context, check);
  const grading::Rubric rubric =
      grading::read_rubric(context.root / "assignments" / name.folder / "rubric.json");
  const std::string source = text_of(file);
  const std::vector<std::string> headings = grading::headings_of(checked.results, source);
  std::vector<double> points;
  for (const grading::TestResult& result : checked.results) {
    const grading::RubricItem* item = rubric.find(result.test);
    points.push_back(item != nullptr ? item->points : 0.0);
  }
  // By result: its place in the order of mending.
  std::map<std::size_t, std::size_t> place;
  for (const grading::HeadingGroup& group :
       grading::in_order_of_mending(checked.results, headings, points))
    for (const std::size_t i : group.tests) place.emplace(i, place.size());
  const auto follows = grading::what_follows(checked.results, source);
  const std::string used_up = grading::what_used_the_time(checked.results);
  Json tests = Json::array();
  for (std::size_t i = 0; i < checked.results.size(); ++i) {
    const grading::TestResult& result = checked.results[i];
    const bool is_cut_off = grading::is_cut_off(result);
    const std::string& function = is_cut_off ? used_up : result.last_call;
    const grading::RubricItem* item = rubric.find(result.test);
    Json one{{"test", result.test},
             {"group", result.test.substr(0, result.test.find('.'))},
             {"title", item != nullptr ? item->title : result.test},
             {"points", points[i]},
             {"verdict", is_cut_off ? "not run" : grading::words(result.verdict)}};
    if (result.verdict != grading::Verdict::kRight) {
      const int line = exact_line_of(result);
      const bool is_written = result.verdict != grading::Verdict::kNotAttempted;
      one["story"] = story_for_page(result);
      one["printed"] = result.printed;
      // The one line that is known: where the call ended, or else where its function begins.
      one["line"] = line;
      one["function"] =
          line == 0 && is_written ? grading::with_its_line(source, function) : function;
      one["heading"] = headings[i];
      const auto other = follows.find(result.last_call);
      if (other != follows.end()) one["follows_from"] = other->second;
      if (const auto at = place.find(i); at != place.end()) one["place"] = at->second;
    }
    tests.push_back(std::move(one));
  }
  fmt::print("{}\n", dumped({{"id", id},
                             {"title", rubric.title},
                             {"file", file.filename().string()},
                             {"handout", "handouts/" + name.folder},
                             {"said", checked.said},
                             {"tests", tests}}));
}

}  // namespace tumble::cli
