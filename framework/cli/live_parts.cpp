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

/// The line of a file on which a function is defined: the first at which its name stands before a
/// bracket and behind a type. 0: none
int line_of_function(const std::string& text, const std::string& function) {
  if (function.empty() || !std::all_of(function.begin(), function.end(),
                                       [](unsigned char c) { return std::isalnum(c) || c == '_'; }))
    return 0;
  const std::regex definition(R"(^[A-Za-z_:<>&\* 0-9]+[ &\*])" + function + R"(\()");
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (std::regex_search(line, definition) && !line.starts_with("  return")) return number;
  }
  return 0;
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

struct Symbol {
  std::string name;
  std::uint64_t start = 0;
};
/// What nm says of the code in an object, by where it begins.
std::vector<Symbol> symbols_of(const fs::path& object) {
  const auto listed =
      run_program({"nm", "--numeric-sort", object.string()}, Output::kCaptured, 20.0);
  std::vector<Symbol> symbols;
  std::istringstream lines(listed.printed);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream parts(line);
    std::uint64_t start = 0;
    std::string kind, name;
    if (parts >> std::hex >> start >> kind >> name && (kind == "t" || kind == "T" || kind == "W"))
      symbols.push_back({name, start});
  }
  return symbols;
}

/// The line of an offset into a shared object: the file is compiled once more, with lines, to the
/// same code, and looked up by function and distance from its start.
/// @return 0: not found
int line_of_offset(const Context& context, const fs::path& source, const fs::path& object,
                   std::uint64_t offset) {
  Symbol function;
  for (const Symbol& symbol : symbols_of(object))
    if (symbol.start <= offset) function = symbol;
  if (function.name.empty()) return 0;
  const PrivateFolder folder;
  const fs::path with_lines = folder.path() / "with_lines.o";
  const auto compiled = run_program(
      {"g++", "-std=c++20", "-O2", "-g1", "-fPIC", "-ffp-contract=off", "-fno-finite-loops",
       "-fno-gnu-unique", "-DTUMBLE_BUILDING_MODULE", "-I", context.root.string(), "-isystem",
       TUMBLE_EIGEN_INCLUDE, "-c", source.string(), "-o", with_lines.string()},
      Output::kCaptured, 60.0);
  if (compiled.code != 0) return 0;
  for (const Symbol& symbol : symbols_of(with_lines)) {
    if (symbol.name != function.name) continue;
    const auto told = run_program({"addr2line", "-i", "-e", with_lines.string(),
                                   fmt::format("{:#x}", symbol.start + offset - function.start)},
                                  Output::kCaptured, 20.0);
    // Innermost first; inlined library code is passed over.
    std::istringstream lines(told.printed);
    for (std::string line; std::getline(lines, line);)
      if (line.find(source.filename().string() + ":") != std::string::npos)
        return std::atoi(line.c_str() + line.rfind(':') + 1);
  }
  return 0;
}

void print_line(const fs::path& file, int number) {
  std::ifstream in(file);
  std::string text;
  for (int k = 0; k < number && std::getline(in, text); ++k) {
  }
  text.erase(0, text.find_first_not_of(" \t"));
  fmt::print("{}:{}: {}\n", file.filename().string(), number, text);
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
      if (const int number = line_of_offset(context, source.file, object, offset); number > 0)
        return print_line(source.file, number);
    }
  }
  for (const OwnSource& source : sources)
    for (const std::string& function : source.functions) {
      const std::regex named("\\b" + function + "\\b");
      if (!std::regex_search(said, named)) continue;
      if (const int number = line_of_function(text_of(source.file), function); number > 0)
        return print_line(source.file, number);
    }
}

void simulate_for_page(Context& context, const RunWords& words) {
  ::signal(SIGPIPE, SIG_IGN);  // a page that is gone is a write that fails
  // What the student's code prints to stdout must not stand between records.
  const int records = ::dup(STDOUT_FILENO);
  ::dup2(STDERR_FILENO, STDOUT_FILENO);
  grading::guard_for_another(kCallLimit);
  std::string line;
  for (char c = 0; ::read(STDIN_FILENO, &c, 1) == 1 && c != '\n';) line += c;
  ChosenLaws chosen;
  try {
    live::Simulation simulation = simulation_of(context, words, Json::parse(line), chosen);
    live::simulate(simulation, STDIN_FILENO, records);
  } catch (const UserError& error) {
    refuse(records, error.where(), error.problem(), error.remedy(), false);
  } catch (const NotImplemented& missing) {
    refuse(records, missing.function(), missing.what(), "", true);
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
  if (word != modules.end() && word->second.ends_with(".cpp")) check.file = word->second;
  const fs::path file = checked_file(context, check);
  const CheckedTests checked = check_quietly(context, check);
  const grading::Rubric rubric =
      grading::read_rubric(context.root / "assignments" / name.folder / "rubric.json");
  const std::string source = text_of(file);
  Json tests = Json::array();
  for (const grading::TestResult& result : checked.results) {
    const grading::RubricItem* item = rubric.find(result.test);
    Json one{{"test", result.test},
             {"group", result.test.substr(0, result.test.find('.'))},
             {"title", item != nullptr ? item->title : result.test},
             {"points", item != nullptr ? item->points : 0.0},
             {"verdict", grading::words(result.verdict)}};
    if (result.verdict != grading::Verdict::kRight) {
      one["story"] = result.story;
      one["printed"] = result.printed;
      one["function"] = result.last_call;
      one["line"] = line_of_function(source, result.last_call);
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
