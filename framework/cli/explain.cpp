// tumble explain SCENE: the effects of a scene, the entries that call for each, the stages of a
// run, and their cost.
#include <algorithm>
#include <cstdio>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/find_scene.h"
#include "framework/cli/json_output.h"
#include "framework/cli/module_choice.h"
#include "framework/cli/rest_speed.h"
#include "framework/effects/build_world.h"
#include "framework/engines/run.h"
#include "framework/engines/stepping/linked_bodies.h"
#include "framework/scene/effects.h"
#include "framework/core/version.h"
#include "framework/trajectory/fault_words.h"

namespace tumble::cli {
namespace {

using scene::EffectUse;

struct ExplainWords {
  std::string scene, modules;
  bool run = false, json = false;
  std::optional<double> duration_s;
};

/// A part of a run, built where an effect needs it.
struct Stage {
  std::string name;
  std::string does;
  bool is_built;
  std::vector<std::string> counts;  // names in Counters
};

bool is_on(const std::vector<EffectUse>& effects, const std::string& name) {
  return std::any_of(effects.begin(), effects.end(), [&](const EffectUse& effect) {
    return effect.name == name && effect.is_on();
  });
}

bool is_stage_asked(const std::vector<EffectUse>& effects, const std::string& stage) {
  return std::any_of(effects.begin(), effects.end(), [&](const EffectUse& effect) {
    return effect.stage == stage && effect.is_on();
  });
}

/// Counters of the effects in a stage, and those of the stage itself.
std::vector<std::string> counts_of(const std::vector<EffectUse>& effects, const std::string& stage,
                                   std::vector<std::string> before,
                                   const std::vector<std::string>& after) {
  for (const EffectUse& effect : effects)
    if (effect.stage == stage) before.push_back(effect.counter);
  before.insert(before.end(), after.begin(), after.end());
  return before;
}

std::vector<Stage> stages_of(const std::vector<EffectUse>& effects) {
  const bool constrained = is_stage_asked(effects, "constraints"),
             colliding = is_on(effects, "collision"), sleeping = is_on(effects, "sleep");
  const bool forced = constrained || is_stage_asked(effects, "forces");
  return {
      {"integration", "moves bodies by their forces, and back to the first impact", true,
       counts_of(effects, "integration",
                 {"steps", "synchronisations", "shortened_steps", "integrations",
                  "undone_integrations", "derivative_evaluations", "rollbacks"},
                 {})},
      {"forces", "forces on bodies that are linked or do not fly freely, with their gravity",
       forced, counts_of(effects, "forces", {}, {})},
      {"constraints", "constraint forces of rods and joints, and their projection", constrained,
       counts_of(effects, "constraints", {}, {"constraint_solves", "constraint_corrections"})},
      {"control", "motors are sampled and set their torques", is_stage_asked(effects, "control"),
       counts_of(effects, "control", {}, {})},
      {"collision",
       "candidate pairs, gaps, times of impact",
       colliding,
       {"candidate_pairs", "gap_evaluations", "root_findings"}},
      {"impacts", "impulses of collisions", colliding,
       sleeping ? std::vector<std::string>{"impacts", "impulses", "micro_impacts",
                                           "position_corrections"}
                : std::vector<std::string>{"impacts", "impulses", "micro_impacts",
                                           "position_corrections", "bodies_put_to_rest",
                                           "bodies_woken"}},
      {"contacts",
       "forces of resting, sliding and rolling contacts",
       is_on(effects, "persistent contact"),
       {"contact_solves", "contact_points", "contact_sweeps", "contact_factorisations",
        "contact_unsolved", "contacts_begun", "contacts_ended", "friction_points"}},
      {"sleep",
       "bodies at rest are skipped until something would move them",
       sleeping,
       {"bodies_put_to_sleep", "bodies_woken", "body_steps_asleep"}},
      {"recording", "frames and events", true, {}},
  };
}

std::uint64_t count_of(const Trajectory& run, const std::string& name) {
  const auto found = run.counters.counts.find(name);
  return found == run.counters.counts.end() ? 0 : found->second;
}

/// Counters of a run that no stage lists.
std::vector<std::string> other_counts(const std::vector<Stage>& stages, const Trajectory& run) {
  std::vector<std::string> names;
  for (const auto& [name, value] : run.counters.counts)
    if (value > 0 && std::none_of(stages.begin(), stages.end(), [&name = name](const Stage& stage) {
          return std::find(stage.counts.begin(), stage.counts.end(), name) != stage.counts.end();
        }))
      names.push_back(name);
  return names;
}

/// A number with groups of digits: "1,234,567".
std::string grouped(std::uint64_t value) {
  std::string digits = std::to_string(value);
  for (int at = static_cast<int>(digits.size()) - 3; at > 0; at -= 3)
    digits.insert(static_cast<std::size_t>(at), 1, ' ');
  return digits;
}

/// The entries that call for an effect; those of one entry (a chain, a lattice) share a line.
struct AskerLine {
  std::string pointer, place, what;
  std::size_t count;
};
std::vector<AskerLine> lines_of(const EffectUse& effect, const scene::Scene& scene) {
  const std::string file = scene.file.filename().string();
  std::vector<AskerLine> lines;
  for (const auto& asker : effect.askers) {
    if (!lines.empty() && lines.back().pointer == asker.pointer && !asker.pointer.empty())
      ++lines.back().count;
    else
      lines.push_back({asker.pointer,
                       asker.line > 0 ? fmt::format("{}:{}: {}", file, asker.line, asker.pointer)
                                      : asker.pointer,
                       asker.what, 1});
  }
  for (AskerLine& line : lines)
    if (line.count > 1) line.what += fmt::format(" ... ({} like it)", line.count);
  return lines;
}

constexpr std::size_t kMostLines = 6;  // of one effect

/// Width of the column with the positions of entries.
std::size_t width_of_places(const std::vector<EffectUse>& effects, const scene::Scene& scene) {
  constexpr std::size_t kLeast = 20, kMost = 60;
  std::size_t width = kLeast;
  for (const EffectUse& effect : effects) {
    const auto lines = lines_of(effect, scene);
    for (std::size_t i = 0; i < std::min(lines.size(), kMostLines); ++i)
      width = std::max(width, lines[i].place.size());
  }
  return std::min(width, kMost);
}

void print_effects(const scene::Scene& scene, const std::vector<EffectUse>& effects,
                   const Trajectory* run) {
  const std::size_t width = width_of_places(effects, scene);
  fmt::print("\n  {:<16} {:<{}} {}\n", "effects", "asked for by", width, "that is");
  for (const EffectUse& effect : effects) {
    if (!effect.is_on()) continue;
    const auto lines = lines_of(effect, scene);
    std::string name = effect.name;
    for (std::size_t i = 0; i < std::min(lines.size(), kMostLines); ++i) {
      fmt::print("  {:<16} {:<{}} {}\n", name, lines[i].place, width, lines[i].what);
      name.clear();
    }
    if (lines.size() > kMostLines)
      fmt::print("  {:<16} {:<{}} (--json lists all)\n", "",
                 fmt::format("... and {} more", lines.size() - kMostLines), width);
    if (run != nullptr)
      fmt::print("  {:<16} {:<{}} called {} times ({})\n", "", "", width,
                 grouped(count_of(*run, effect.counter)), effect.counter);
    if (!effect.note.empty()) fmt::print("  {:<16} note: {}\n", "", effect.note);
  }
  std::string off, notes;
  std::uint64_t calls = 0;
  for (const EffectUse& effect : effects) {
    if (effect.is_on()) continue;
    off += (off.empty() ? "" : ", ") + effect.name;
    if (!effect.note.empty())
      notes += fmt::format("  {:<16} {}: {}\n", "", effect.name, effect.note);
    if (run != nullptr) calls += count_of(*run, effect.counter);
  }
  if (off.empty()) return;
  fmt::print("  {:<16} {}\n{}", "not there", off, notes);
  if (run != nullptr)
    fmt::print("  {:<16} their code was called {} times{}\n", "", grouped(calls),
               calls == 0 ? "" : ", and should not have been");
}

void print_counts(const std::vector<std::string>& names, const Trajectory& run) {
  constexpr std::size_t kColumns = 110;
  const std::string indent(27, ' ');
  std::string line;
  for (const auto& name : names) {
    const std::uint64_t value = count_of(run, name);
    if (value == 0) continue;
    std::string word = name;
    std::replace(word.begin(), word.end(), '_', ' ');
    const std::string part = fmt::format("{} {}", word, grouped(value));
    if (!line.empty() && indent.size() + line.size() + 3 + part.size() > kColumns) {
      fmt::print("{}{} ·\n", indent, line);
      line.clear();
    }
    line += (line.empty() ? "" : " · ") + part;
  }
  if (!line.empty()) fmt::print("{}{}\n", indent, line);
}

void print_stages(const std::vector<Stage>& stages, const Trajectory* run) {
  fmt::print("\n  {:<16} {}\n", "stages", run != nullptr ? "time" : "");
  std::string absent;
  for (const Stage& stage : stages) {
    if (!stage.is_built) {
      absent += (absent.empty() ? "" : ", ") + stage.name;
      continue;
    }
    std::string time;
    if (run != nullptr && run->counters.stage_seconds.contains(stage.name))
      time = fmt::format("{:.3f} s", run->counters.stage_seconds.at(stage.name));
    fmt::print("  {:<16} {}{}\n", stage.name, run != nullptr ? fmt::format("{:<9}", time) : "",
               stage.does);
    if (run != nullptr) print_counts(stage.counts, *run);
  }
  if (!absent.empty()) fmt::print("  {:<16} {}\n", "not built", absent);
  if (run == nullptr) return;
  const auto others = other_counts(stages, *run);
  if (!others.empty()) {
    fmt::print("  {:<16}\n", "other counts");
    print_counts(others, *run);
  }
  fmt::print(
      "\n  A stage's time includes that of the stages it calls: integration of linked bodies calls "
      "forces and constraints.\n"
      "  Gravity and point forces on free bodies are counted, not timed: a clock would cost more "
      "than they do.\n");
}

std::string bodies_line(const scene::Scene& scene) {
  const auto immovable = std::count_if(scene.bodies.begin(), scene.bodies.end(),
                                       [](const scene::BodySpec& body) { return body.immovable; });
  const auto movable = static_cast<std::ptrdiff_t>(scene.bodies.size()) - immovable;
  return fmt::format("{} {} move{}, {} immovable", movable, movable == 1 ? "body" : "bodies",
                     movable == 1 ? "s" : "", immovable);
}

void print_page(const scene::Scene& scene, const std::vector<EffectUse>& effects,
                const std::vector<Stage>& stages, const Trajectory* run) {
  fmt::print("{}\n  {}, {:g} s in steps of {:.6g} s\n", scene.title, bodies_line(scene),
             scene.duration_s, scene.step_s);
  if (scene.stabilisation) {
    static const char* const kinds[] = {"nothing", "Baumgarte's term", "projection"};
    fmt::print("  rods and joints are kept together by {}\n",
               kinds[static_cast<int>(scene.stabilisation->kind)]);
  }
  if (scene.coordinates != scene::Coordinates::kMaximal) {
    scene::Scene reduced = scene;
    reduced.coordinates = scene::Coordinates::kReduced;
    for (const std::string& words : engines::coordinates_in_words(build_world(reduced)))
      fmt::print("  {}; in persistent contact six coordinates a body{}\n", words,
                 scene.coordinates == scene::Coordinates::kAutomatic
                     ? ", and where a module's rows are what the run shows"
                     : "");
  }
  print_effects(scene, effects, run);
  print_stages(stages, run);
  if (run == nullptr)
    fmt::print("\n  --run runs it and adds what each costs.\n");
  else if (!run->stopped_by.empty())
    fmt::print("\n  STOPPED: {}\n", run->stopped_by);
  if (run != nullptr)
    for (const RunFault& fault : run->counters.faults)
      fmt::print("\n  NOT TO BE TRUSTED: {}. Likely remedy: {}\n", in_words(fault), fault.remedy);
}

void print_json(const Context& context, const scene::Scene& scene,
                const std::vector<EffectUse>& effects, const std::vector<Stage>& stages,
                const Trajectory* run) {
  nlohmann::ordered_json page;
  page["command"] = context.command_line;
  page["version"] = kProgramVersion;
  page["scene"] = scene.name;
  page["title"] = scene.title;
  page["file"] = scene.file.string();
  page["scene_digest"] = scene.digest;
  page["seeds"] = scene.seeds;
  for (const EffectUse& effect : effects) {
    nlohmann::ordered_json entry = {{"name", effect.name},
                                    {"on", effect.is_on()},
                                    {"stage", effect.stage},
                                    {"asked_for_by", nlohmann::json::array()},
                                    {"note", effect.note}};
    for (const auto& asker : effect.askers)
      entry["asked_for_by"].push_back(
          {{"pointer", asker.pointer}, {"line", asker.line}, {"what", asker.what}});
    if (run != nullptr) entry["calls"] = count_of(*run, effect.counter);
    page["effects"].push_back(entry);
  }
  for (const Stage& stage : stages) {
    nlohmann::ordered_json entry = {
        {"name", stage.name}, {"built", stage.is_built}, {"does", stage.does}};
    if (run != nullptr) {
      if (run->counters.stage_seconds.contains(stage.name))
        entry["seconds"] = run->counters.stage_seconds.at(stage.name);
      for (const auto& name : stage.counts) entry["counts"][name] = count_of(*run, name);
    }
    page["stages"].push_back(entry);
  }
  if (run != nullptr) {
    page["stopped_by"] = run->stopped_by;
    page["faults"] = in_words(run->counters.faults);
  }
  fmt::print("{}\n", json_text(page, 2));
}

void explain(Context& context, const ExplainWords& words) {
  const scene::Scene scene = find_scene(context, words.scene);
  auto effects = scene::effects_of(scene);
  for (EffectUse& effect : effects)
    if (effect.name == "collision" && effect.is_on()) effect.note = note_of_rest_speed(scene);
  const auto stages = stages_of(effects);
  TrajectoryRecorder recorder;
  if (words.run) {
    const ChosenLaws chosen =
        choose_laws(context, scene, parse_module_words(words.modules, context.registry));
    for (const auto& notice : chosen.notices) fmt::print(stderr, "{}\n", notice);
    engines::RunOptions options;
    options.duration_s = words.duration_s;
    options.command = context.command_line;
    engines::run_scene(scene, chosen.laws, options, recorder);
    if (!recorder.trajectory().stopped_by.empty() || !recorder.trajectory().counters.faults.empty())
      context.exit = ExitCode::kCheckFailed;
  }
  const Trajectory* run = words.run ? &recorder.trajectory() : nullptr;
  if (words.json)
    print_json(context, scene, effects, stages, run);
  else
    print_page(scene, effects, stages, run);
}

}  // namespace

void add_explain(CLI::App& app, Context& context) {
  auto words = std::make_shared<ExplainWords>();
  Verb verb(app, "explain",
            "Say which effects a scene has, which entry asked for each, and what each costs");
  verb.option("scene", words->scene,
              "A scene file, or the bare name of one under assignments/*/scenes")
      .required()
      .type_name("SCENE");
  const Word run = verb.flag("--run", words->run, "Run it, and add times and counts");
  verb.option("--modules", words->modules, "Whose laws, as for tumble run")
      .type_name("WORDS")
      .needs(run);
  verb.option("--duration-s", words->duration_s, "Simulated time [s] instead of the scene's")
      .positive()
      .needs(run);
  verb.flag("--json", words->json, "For machines");
  verb.footer(
      "Example: tumble explain bouncing_ball --run\nExit: 0 fine, 1 the run was stopped or "
      "cannot be trusted, 2 something to repair, 4 not attempted.");
  verb.runs([&context, words] { explain(context, *words); });
}

}  // namespace tumble::cli
