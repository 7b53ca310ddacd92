#include "framework/cli/run_page.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "framework/cli/planned_run.h"
#include "framework/cli/stop_by_hand.h"
#include "framework/core/text.h"
#include "framework/engines/run.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/grading/worker/worker_connection.h"
#include "framework/report/player.h"
#include "framework/report/virtual_times_panel.h"
#include "framework/trajectory/fault_words.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExample =
    "For example --beside library, --beside a1=PATH, --beside step-s=0.001 or --beside "
    "recording=FILE.";

struct Second {
  Trajectory run;
  std::string label, label_of_first;
};

std::string short_name(const std::string& source) {
  return source.find('/') == source.npos && source.find('.') == source.npos
             ? source
             : fs::path(source).stem().string();
}

/// The label of a run: the laws that the other run does not have; else its motion, engine or step.
std::string label_of(const ChosenLaws& mine, const ChosenLaws& others, const TrajectoryInfo& info,
                     const TrajectoryInfo& other) {
  std::set<std::string> names;
  for (const ChosenModule& module : mine.modules)
    for (const ChosenModule& theirs : others.modules)
      if (module.id == theirs.id && module.source != theirs.source)
        names.insert(short_name(module.source));
  std::string label;
  for (const std::string& name : names) label += (label.empty() ? "" : ", ") + name;
  if (label.empty() && info.integrator_source != other.integrator_source)
    label = info.integrator_source;  // a method in place of the module's own
  if (info.engine != other.engine) label += (label.empty() ? "" : ", ") + ("engine " + info.engine);
  if (info.step_s != other.step_s)
    label += (label.empty() ? "" : ", ") + fmt::format("step {} s", step_in_words(info.step_s));
  return label;
}

ModuleWords with_changes(ModuleWords words, const ModuleWords& changes) {
  if (changes.contains("")) words.clear();
  for (const auto& [id, word] : changes) words[id] = word;
  return words;
}

Second recorded(const std::string& file, const Trajectory& recording, const scene::Scene& scene) {
  Second second{recording, fs::path(file).stem().string(), "this run"};
  if (const std::string faults = in_words(second.run.counters.faults); !faults.empty())
    fmt::print(stderr, "{}: cannot be trusted: {}\n", file, faults);
  const TrajectoryInfo& info = second.run.info;
  if (info.scene_digest.empty() || scene.digest.empty() || info.scene_digest == scene.digest)
    return second;
  const std::string note =
      fmt::format("the recording is of {}: what differs may be the scene",
                  info.scene_name == scene.name ? "another version of the scene"
                                                : "another scene, " + info.scene_name);
  second.run.counters.notices.push_back(note);  // the page shows them
  fmt::print(stderr, "{}: {}\n", file, note);
  return second;
}

ChosenLaws laws_of_second(const Context& context, const scene::Scene& scene,
                          const BesideWords& beside, const RunWords& words) {
  const ModuleWords mine = parse_module_words(words.modules, context.registry);
  return choose_laws(context, scene,
                     with_changes(mine, parse_module_words(beside.modules, context.registry)),
                     beside.engine.empty() ? words.engine : beside.engine);
}

std::string source_of(const ChosenLaws& chosen, const std::string& id) {
  for (const ChosenModule& module : chosen.modules)
    if (module.id == id) return module.source;
  return "library";
}

/// Whether a module after --beside is to move the bodies of the second run.
/// @param named  the modules after --beside
bool names_motion(const Context& context, const ChosenLaws& first, const ChosenLaws& second,
                  const ModuleWords& named) {
  const auto for_all = named.find("");
  for (const modules::ModuleKind* kind : context.registry.all()) {
    if (kind->methods.empty()) continue;  // it has no integration
    const std::string source = source_of(second, kind->id);
    if (named.contains(kind->id) || source != source_of(first, kind->id) ||
        (for_all != named.end() && for_all->second == source))
      return true;
  }
  return false;
}

/// The words of the first run but for what --beside changes. What a search has chosen for the first
/// run is not taken over, nor is a method that would stand in place of a module after --beside, nor
/// what the second run's engine or sandbox would be refused for.
PlannedRun plan_of_second(const Context& context, const scene::Scene& scene,
                          const ChosenLaws& first, const ChosenLaws& chosen,
                          const BesideWords& beside, RunWords words) {
  words.accuracy_m.reset();
  words.budget_s.reset();
  if (names_motion(context, first, chosen, parse_module_words(beside.modules, context.registry))) {
    words.method.clear();
    words.tolerance.reset();
  }
  if (!beside.engine.empty()) {
    words.engine = beside.engine;
    if (words.engine != "rd" && words.propagator == "laws") words.propagator.clear();
  }
  if (!chosen.connections.empty()) words.threads = 1;  // which gives the same run
  if (beside.step_s) words.step_s = beside.step_s;
  return plan_run(context, scene, chosen, words);
}

/// Ends a run at its first frame: until then an engine refuses what it cannot do.
class OnlyTheStart final : public TrajectorySink {
 public:
  struct Reached {};
  void begin(const TrajectoryInfo&, const std::vector<TrajectoryBody>&) override {}
  void frame(const Frame&) override { throw Reached{}; }
  void event(const Event&) override { throw Reached{}; }
  void beat(double) override { throw Reached{}; }
  void end(const Counters&, const std::string& stopped_by) override { stopped_by_ = stopped_by; }
  const std::string& stopped_by() const { return stopped_by_; }

 private:
  std::string stopped_by_;
};

/// @throws UserError where the second run would not come to its first frame
void expect_start(const PlannedRun& plan, const RunWords& words) {
  OnlyTheStart start;
  std::string why;
  try {
    engines::run_scene(plan.scene, plan.laws, plan.options, start);
    why = start.stopped_by();
  } catch (const OnlyTheStart::Reached&) {
    return;
  } catch (const grading::CallEnded& error) {
    why = error.what();
  }
  throw UserError("--beside " + words.beside, "this run has no first frame: " + why,
                  "Mend what it says, or leave --beside out.");
}

Second second_run(const Context& context, const scene::Scene& scene, const ChosenLaws& chosen,
                  const PreparedPage& prepared, const Trajectory& first, const RunWords& words) {
  const BesideWords beside = parse_beside(words.beside);
  if (prepared.recording) return recorded(beside.recording, *prepared.recording, scene);
  // Ctrl-C, which has ended the first run, has reached the submissions' processes, too.
  const ChosenLaws other =
      StopByHand::is_asked() ? laws_of_second(context, scene, beside, words) : *prepared.laws;
  PlannedRun plan = plan_of_second(context, scene, chosen, other, beside, words);
  VirtualTimes times;  // of the fast scheduler; the teaching timewarp sends them to the recorder
  plan.options.timewarp = engines::fast_timewarp(&times);
  TrajectoryRecorder recorder;
  std::string ended;
  try {
    engines::run_scene(plan.scene, plan.laws, plan.options, recorder);
  } catch (const grading::CallEnded& error) {
    ended = error.what();
  }
  Second second{recorder.trajectory(), "", ""};
  if (!ended.empty()) second.run.stopped_by = ended;
  if (second.run.virtual_times.moves.empty()) second.run.virtual_times = std::move(times);
  second.label_of_first = label_of(chosen, other, first.info, second.run.info);
  second.label = label_of(other, chosen, second.run.info, first.info);
  if (second.label.empty()) second.label_of_first = "first", second.label = "second, alike";
  return second;
}

/// The chart of a run's local virtual times, where it has any.
void add_panel(const report::PlayedRun& played, report::PlayerOptions& options) {
  if (played.run.virtual_times.moves.empty()) return;
  options.panels.push_back(report::virtual_times_panel(played.run.virtual_times));
  if (!played.label.empty()) options.panels.back().title += ", " + played.label;
}

}  // namespace

void add_page_words(Verb& verb, RunWords& words) {
  verb.option("--html", words.html,
              "Write a page that plays the run: motion, curves, events; opens in any browser, "
              "needs no network")
      .file();
  verb.option("--beside", words.beside,
              "Show a second run in the page, and where the two first differ: whose laws (as "
              "--modules), engine=, step-s=, or recording=FILE")
      .type_name("WORDS");
}

BesideWords parse_beside(const std::string& text) {
  BesideWords beside;
  std::stringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const auto value = [&](const char* key) {
      return part.starts_with(key) ? part.substr(std::string(key).size()) : "";
    };
    if (part.starts_with("engine="))
      beside.engine = value("engine=");
    else if (part.starts_with("recording="))
      beside.recording = value("recording=");
    else if (part.starts_with("step-s=")) {
      char* end = nullptr;
      const std::string number = value("step-s=");
      beside.step_s = std::strtod(number.c_str(), &end);
      if (number.empty() || *end != '\0' || !(*beside.step_s > 0))
        throw UserError("--beside " + text,
                        "a step must be a positive number of seconds, not '" + number + "'",
                        kExample);
    } else
      beside.modules += (beside.modules.empty() ? "" : ",") + part;
  }
  if (!beside.recording.empty() &&
      (!beside.modules.empty() || !beside.engine.empty() || beside.step_s))
    throw UserError("--beside " + text,
                    "a recording is as it was made: nothing can be chosen for it", kExample);
  return beside;
}

PreparedPage prepare_page(const Context& context, const scene::Scene& scene,
                          const ChosenLaws& chosen, const RunWords& words) {
  PreparedPage prepared;
  if (words.beside.empty()) return prepared;
  if (words.html.empty())
    throw UserError("--beside " + words.beside,
                    "shows a second run in a page, and no page was asked for", "Add --html FILE.");
  const BesideWords beside = parse_beside(words.beside);
  expect_engine("--beside engine=", beside.engine);
  if (beside.recording.empty()) {
    prepared.laws = laws_of_second(context, scene, beside, words);
    expect_start(plan_of_second(context, scene, chosen, *prepared.laws, beside, words), words);
    return prepared;
  }
  if (!fs::exists(beside.recording))
    throw UserError(beside.recording, "there is no such recording",
                    "Make one with --trajectory FILE.");
  Trajectory recording = read_trajectory(beside.recording);
  if (recording.frames.empty())
    throw UserError(beside.recording,
                    "has no frame" + (recording.stopped_by.empty()
                                          ? std::string()
                                          : ": its run stopped: " + recording.stopped_by),
                    "Record a run that comes to its first frame.");
  const std::size_t bodies = recording.bodies.size();
  if (bodies != scene.bodies.size())
    throw UserError(beside.recording,
                    fmt::format("has {} bodies, and the scene has {}", bodies, scene.bodies.size()),
                    "Record a run of this scene with --trajectory FILE.");
  prepared.recording = std::move(recording);
  return prepared;
}

void write_page(const Context& context, const scene::Scene& scene, const ChosenLaws& chosen,
                const PreparedPage& prepared, const Trajectory& run, const RunWords& words) {
  if (words.html.empty()) return;
  report::PlayerOptions options;
  options.root = context.root;
  std::vector<report::PlayedRun> runs;
  Second second;
  if (!words.beside.empty()) second = second_run(context, scene, chosen, prepared, run, words);
  runs.push_back({run, second.label_of_first});
  if (!words.beside.empty()) runs.push_back({second.run, second.label});
  for (const report::PlayedRun& played : runs) add_panel(played, options);
  const auto start = std::chrono::steady_clock::now();
  const std::size_t bytes = report::write_player(words.html, scene, runs, options);
  fmt::print(stderr, "wrote {} ({:.2f} MB) in {:.2f} s\n", words.html,
             1e-6 * static_cast<double>(bytes),
             std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
}

}  // namespace tumble::cli
