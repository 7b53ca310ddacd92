#include "framework/cli/scene_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "framework/cli/json_output.h"
#include "framework/cli/judgement_table.h"
#include "framework/cli/kept_frames.h"
#include "framework/cli/planned_run.h"
#include "framework/cli/run_page.h"
#include "framework/cli/scene_pictures.h"
#include "framework/cli/stop_by_hand.h"
#include "framework/core/cpu_time.h"
#include "framework/core/nearest_word.h"
#include "framework/core/text.h"
#include "framework/effects/registry.h"
#include "framework/engines/base/run_counters.h"
#include "framework/engines/judging/judge.h"
#include "framework/engines/run.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/grading/worker/worker_connection.h"
#include "framework/scene/load_scene.h"
#include "framework/scene/sized_scenes.h"
#include "framework/trajectory/record.h"
#include "framework/trajectory/run_progress.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;
using engines::CheckResult;

std::string modules_line(const scene::Scene& scene, const Laws& laws) {
  std::vector<std::string> authors = authors_of_laws(scene, laws);
  if (laws.scheduling) authors.push_back("scheduled by " + laws.scheduling_source);
  return fmt::format("{}", fmt::join(authors, " · "));
}

const char* name_of(EventKind kind) {
  switch (kind) {
    case EventKind::kCollision: return "collisions";
    case EventKind::kRest: return "coming to rest";
    case EventKind::kForceOn: return "force on";
    case EventKind::kForceOff: return "force off";
    case EventKind::kContact: return "contact";
    case EventKind::kBreak: return "contact ends";
    case EventKind::kStick: return "sticks";
    case EventKind::kSlide: return "slides";
    case EventKind::kSleep: return "sleeps";
    case EventKind::kWake: return "wakes";
    case EventKind::kControl: return "control";
  }
  return "other";
}

std::map<std::string, int> count_events(const Trajectory& run) {
  std::map<std::string, int> counts;
  for (const Event& event : run.events) ++counts[name_of(event.kind)];
  return counts;
}

/// Counters that are not 0, three per line, aligned; --json has all.
void print_counts(const std::map<std::string, std::uint64_t>& counts) {
  constexpr int kColumns = 3;
  int column = 0;
  const char* head = "counts";
  for (const auto& [name, count] : counts) {
    if (count == 0) continue;
    std::string words = name;
    std::replace(words.begin(), words.end(), '_', ' ');
    if (column == 0) fmt::print("  {:<9}", std::exchange(head, ""));
    fmt::print("{:<24}{:>9}{}", words, count, column + 1 == kColumns ? "\n" : "   ");
    column = (column + 1) % kColumns;
  }
  if (column != 0) fmt::print("\n");
}

void print_summary(const scene::Scene& scene, const Laws& laws, const Trajectory& run,
                   const std::vector<CheckResult>& checks, const std::string& left_out,
                   const std::string& extra, const std::string& searched) {
  fmt::print("{}\n", scene.title);
  if (!extra.empty()) fmt::print("  {}\n", extra);
  if (!scene.about.empty()) fmt::print("  {}\n", scene.about);
  fmt::print("  laws     {}\n", modules_line(scene, laws));
  fmt::print("{}", searched);
  const double end = run.frames.empty() ? 0.0 : run.frames.back().time;
  fmt::print("  run      engine {}, step {} s, {:.6g} s simulated, {}, {} frames\n",
             run.info.engine, step_in_words(run.info.step_s), end,
             run.bodies.size() == 1 ? "1 body" : fmt::format("{} bodies", run.bodies.size()),
             run.frames.size());
  std::string events;
  for (const auto& [name, count] : count_events(run))
    events += fmt::format("{}{} {}", events.empty() ? "" : " · ", name, count);
  fmt::print("  events   {}\n", events.empty() ? "none" : events);
  print_counts(run.counters.counts);
  fmt::print(
      "  w h      {:.3g}: discontinuities (w, per body and second) in the largest step (h); the "
      "larger, the more timewarp saves{}\n",
      engines::discontinuities_a_body_and_step(run),
      run.counters.counts.contains("sliding_changes")
          ? "; without the sliding changes above, for which no engine ends a step of all bodies"
          : "");
  for (const auto& notice : run.counters.notices) fmt::print("  note     {}\n", notice);
  if (!run.stopped_by.empty()) fmt::print("  STOPPED  {}\n", run.stopped_by);
  fmt::print("{}", judgement_table(checks));
  if (!left_out.empty()) fmt::print("  {}\n", left_out);
  const bool all_right = std::all_of(checks.begin(), checks.end(),
                                     [](const CheckResult& check) { return check.passed; });
  if (!searched.empty() && run.stopped_by.empty() && !all_right)
    fmt::print(
        "  the run meets the requested error or time, but some of the scene's own checks failed: "
        "try a smaller --accuracy or a larger --budget-s\n");
}

void print_json(const scene::Scene& scene, const PlannedRun& plan, const Trajectory& run,
                const std::vector<CheckResult>& checks, const std::string& left_out, double cpu_s) {
  nlohmann::ordered_json page;
  page["scene"] = scene.name;
  page["title"] = scene.title;
  page["scene_digest"] = scene.digest;
  page["seeds"] = scene.seeds;
  page["command"] = run.info.command;
  page["version"] = run.info.version;
  page["engine"] = run.info.engine;
  page["impulse_source"] = plan.laws.impulse_source;
  page["integrator_source"] = plan.laws.integrator_source;
  page["step_s"] = run.info.step_s;
  page["end_s"] = run.frames.empty() ? 0.0 : run.frames.back().time;
  page["bodies"] = run.bodies.size();
  page["events"] = count_events(run);
  page["counts"] = run.counters.counts;
  page["w_h"] = engines::discontinuities_a_body_and_step(run);
  page["notices"] = run.counters.notices;
  page["stopped_by"] = run.stopped_by;
  if (plan.search) page["search"] = search_as_json(*plan.search, run, cpu_s);
  page["checks"] = nlohmann::json::array();
  for (const auto& check : checks)  // a value that is not finite becomes null
    page["checks"].push_back({{"kind", check.kind},
                              {"subject", check.subject},
                              {"value", check.value},
                              {"threshold", check.threshold},
                              {"unit", check.unit},
                              {"right_when", check.at_least ? ">=" : "<="},
                              {"passed", check.passed},
                              {"detail", check.detail},
                              {"why", check.why}});
  page["checks_left_out"] = left_out;
  fmt::print("{}\n", json_text(page, 2));
}

constexpr double kSameDuration = 1e-12;  // relative: an end that steps add up to

/// Whether a check of a run that lasts as long as its scene holds for another duration, too.
bool holds_until(double duration_s, const scene::CheckSpec& check) {
  const double end_s = duration_s * (1.0 + kSameDuration);
  if (check.at_s > 0.0) return check.at_s <= end_s;
  if (check.kind == "impact_times")  // of the first impacts
    return std::all_of(check.expected.begin(), check.expected.end(),
                       [&](double time_s) { return time_s <= end_s; });
  const std::set<std::string> of_the_end = {"at_rest", "stands", "falls"};
  return check.expected.empty() && !of_the_end.contains(check.kind);
}

struct Judged {
  scene::Scene scene;    // with the checks that apply to the run
  std::string left_out;  // how many do not, in words; empty: all apply
};

/// A run that is shorter or longer than its scene says is judged by the checks that still hold.
Judged judged_part(scene::Scene scene, double duration_s) {
  Judged judged{std::move(scene), ""};
  const double own_s = judged.scene.duration_s;
  if (std::abs(duration_s - own_s) <= kSameDuration * own_s) return judged;
  const std::size_t all = judged.scene.checks.size();
  const std::size_t out = std::erase_if(judged.scene.checks, [&](const scene::CheckSpec& check) {
    return !holds_until(duration_s, check);
  });
  if (out > 0)
    judged.left_out =
        fmt::format("{} of {} checks {} about the scene's whole duration and {} left out", out, all,
                    out == 1 ? "is" : "are", out == 1 ? "is" : "are");
  return judged;
}

/// Runs the plan until its end or Ctrl-C. @return why it ended before; empty: it did not
std::string simulate(const PlannedRun& plan, double duration_s, TrajectoryRecorder& recorder) {
  std::string ended;
  StopByHand stoppable(recorder);  // in here only: later a Ctrl-C ends the program
  try {
    RunProgress progress(stoppable, duration_s);
    engines::run_scene(plan.scene, plan.laws, plan.options, progress);
  } catch (const grading::CallEnded& error) {  // a submission gave no answer
    ended = error.what();
  } catch (const StoppedByHand&) {
  }
  // Ctrl-C reaches a submission's process, too, which then gives no answer.
  if (StopByHand::is_asked())
    ended = fmt::format(
        "Ctrl-C at {:.6g} of {:.6g} s: the files hold the run up to there",
        recorder.trajectory().frames.empty() ? 0.0 : recorder.trajectory().frames.back().time,
        duration_s);
  return ended;
}

[[noreturn]] void refuse_virtual_times(const RunWords& words) {
  throw UserError("--virtual-times " + words.virtual_times,
                  "there is no move of a scheduler to draw",
                  "Run with --engine tw and a scheduler module: --modules a4=student.");
}

/// A chart of virtual times shows the moves of a scheduler that a module decides, or, with a page,
/// of the fast one.
void refuse_without_scheduler(const ChosenLaws& chosen, const RunWords& words) {
  if (!words.virtual_times.empty() && !chosen.laws.scheduling && words.html.empty())
    refuse_virtual_times(words);
}

/// The engine, which a search may have chosen, has such moves.
void check_virtual_times(const PlannedRun& plan, const RunWords& words) {
  const std::string& engine = plan.options.engine.empty() ? plan.scene.engine : plan.options.engine;
  if (!words.virtual_times.empty() && engine != "tw") refuse_virtual_times(words);
}

/// Threads, and a cap on the states that are kept, are the fast timewarp's: no other engine has
/// them, nor has a timewarp on a module's decisions.
/// @throws UserError
void check_words_of_fast_timewarp(const PlannedRun& plan, const RunWords& words) {
  const std::string word = words.threads != 1 ? fmt::format("--threads {}", words.threads)
                           : words.most_states != 0
                               ? fmt::format("--most-states {}", words.most_states)
                               : "";
  if (word.empty()) return;
  const std::string flag = word.substr(0, word.find(' '));
  const std::string& engine = plan.options.engine.empty() ? plan.scene.engine : plan.options.engine;
  if (engine != "tw")
    throw UserError(word,
                    fmt::format("the engine is {}, and this is a word of timewarp",
                                engine.empty() ? "rd" : engine),
                    fmt::format("Run with --engine tw, or leave out {}.", flag));
  if (plan.laws.scheduling)
    throw UserError(
        word, "the scheduler of a module makes one move after the other, and keeps all",
        fmt::format("Leave out {}, or the module of a4: the fast timewarp takes it.", flag));
}

bool is_shown(const RunWords& words) {
  for (const std::string* file : {&words.png, &words.sheet, &words.video, &words.trajectory,
                                  &words.html, &words.virtual_times})
    if (!file->empty()) return true;
  return false;
}

}  // namespace

void add_run_words(Verb& verb, RunWords& words) {
  verb.option("scene", words.scene,
              "A scene file, the bare name of one under assignments/*/scenes, or a .3ds file")
      .required()
      .type_name("SCENE");
  verb.option("--modules", words.modules,
              "Whose laws: student, reference, library, or a submission (PATH.cpp, PATH.so, a "
              "folder: in the sandbox); for all or each: a1=student,a2=library")
      .type_name("WORDS");
  verb.option("--engine", words.engine,
              "rd: retroactive detection with fixed step; ca: conservative advancement; tw: "
              "timewarp; ordered: event by event, the reference; default: the scene's own, or rd")
      .type_name("WORD");
  verb.option("--propagator", words.propagator,
              "laws: bodies go by the laws' integration (rd's default); auto: in closed form where "
              "nothing but gravity acts")
      .type_name("WORD");
  verb.option("--coordinates", words.coordinates,
              "In which rods and joints are integrated: maximal (six a body, and rows), reduced "
              "(those that rods and joints leave free), auto; default: the scene's own")
      .type_name("WORD");
  verb.option("--threads", words.threads,
              "Of --engine tw: how many; the run is the same with any number. Laws must keep "
              "nothing from one call to the next")
      .between(1, 64)
      .shows_default();
  verb.option("--most-states", words.most_states,
              "Of --engine tw: how many states of a body it keeps at most, 8 or more; 0: as many "
              "as it takes")
      .shows_default();
  verb.option("--n", words.n,
              "Size of a scene whose size is a parameter: such as atoms, pong, cars, avalanche")
      .positive();
  verb.option("--scale", words.scale,
              "Of a .3ds file: length of its unit [m]: 0.001 for millimetres; default 1")
      .positive();
  verb.option("--density", words.density, "Of a .3ds file: density [kg/m^3]; default 1000")
      .positive();
  verb.flag("--drop", words.drop,
            "Of a .3ds file: drop it on a floor; without this word it is free in space");
  verb.option("--step-s", words.step_s, "Step of the integrator [s] instead of the scene's")
      .positive();
  const Word png = verb.option("--png", words.png, "Write one picture").file();
  verb.option("--at-s", words.at_s, "Instant of the picture [s]; default the end")
      .not_negative()
      .needs(png);
  verb.option("--sheet", words.sheet, "Write a contact sheet (.png)").file();
  const Word video = verb.option("--video", words.video, "Write a video (.mp4)").file();
  verb.option("--trajectory", words.trajectory, "Write the recorded run, every frame and event")
      .file();
  const Word chart =
      verb.option("--virtual-times", words.virtual_times,
                  "Of a timewarp on a module's decisions: write a chart (.png) of local virtual "
                  "times, rollbacks and global virtual time")
          .file();
  verb.option("--moves", words.moves,
              "Of --virtual-times: after which moves of the scheduler, such as 3,8,9; default: "
              "before and after the first rollbacks")
      .separated_by(',')
      .needs(chart)
      .type_name("LIST");
  verb.option("--chart-until-s", words.chart_until_s, "Of --virtual-times: how far it goes [s]")
      .positive()
      .needs(chart);
  add_page_words(verb, words);
  verb.option("--speed", words.speed,
              "Seconds of the run in a second of video: 0.25 is slow motion")
      .between(1e-6, 1e6)
      .needs(video)
      .shows_default();
  verb.option("--size", words.size, "Of pictures and video, in pixels")
      .type_name("WxH")
      .shows_default();
  verb.flag("--json", words.json, "For machines");
}

void run_and_tell(Context& context, const scene::Scene& scene, const ChosenLaws& chosen,
                  const RunWords& said, const std::string& extra) {
  const RunWords words = with_outputs(said, said.duration_s.value_or(scene.duration_s));
  const PictureSize size = parse_size(words.size);  // refused before the run, not after it
  engines::refuse_other_units(scene);
  refuse_without_scheduler(chosen, words);
  const PreparedPage page = prepare_page(context, scene, chosen, words);
  for (const auto& notice : chosen.notices) fmt::print(stderr, "{}\n", notice);
  // The run.
  PlannedRun plan = plan_run(context, scene, chosen, words);
  check_virtual_times(plan, words);
  check_words_of_fast_timewarp(plan, words);
  VirtualTimes times;  // of the fast scheduler; the teaching timewarp sends them to the recorder
  if (!words.html.empty()) plan.options.timewarp = engines::fast_timewarp(&times);
  const double duration_s = plan.options.duration_s.value_or(plan.scene.duration_s);
  // a search's error is that of all frames
  const KeptFrames kept = kept_frames(plan.options.frame_rate_hz, duration_s,
                                      plan.scene.bodies.size(), is_shown(words) || plan.search);
  plan.options.frame_rate_hz = kept.rate_hz;
  if (!kept.warning.empty()) fmt::print(stderr, "tumble: {}\n", kept.warning);
  TrajectoryRecorder recorder;
  const auto start = std::chrono::steady_clock::now();
  const double cpu_before = cpu_seconds();
  const std::string ended = simulate(plan, duration_s, recorder);
  const double cpu_s = cpu_seconds() - cpu_before;
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  Trajectory run = recorder.take();
  if (!kept.notice.empty()) run.counters.notices.push_back(kept.notice);
  if (!ended.empty()) run.stopped_by = ended;
  if (run.virtual_times.moves.empty()) run.virtual_times = std::move(times);

  // Judgement and summary.
  const Judged judged = judged_part(scene, duration_s);
  const auto checks = engines::judge_run(judged.scene, run);
  const std::string searched = plan.search ? search_in_words(*plan.search, run, cpu_s) : "";
  if (words.json)
    print_json(scene, plan, run, checks, judged.left_out, cpu_s);
  else
    print_summary(scene, plan.laws, run, checks, judged.left_out, extra, searched);
  std::fflush(stdout);

  fmt::print(stderr, "{}\nran in {:.2f} s", record_of(run.info), seconds);
  for (const auto& [stage, spent] : run.counters.stage_seconds)
    fmt::print(stderr, " · {} {:.2f} s", stage, spent);
  fmt::print(stderr, "\n");
  // Files.
  if (!words.trajectory.empty()) {
    write_trajectory(words.trajectory, run);
    fmt::print(stderr, "wrote {}\n", words.trajectory);
  }
  if (!run.frames.empty()) write_pictures(context, scene, run, words, size);
  if (!run.frames.empty()) write_page(context, scene, chosen, page, run, words);
  if (!run.frames.empty()) write_chart(scene, run, words);

  bool passed = run.stopped_by.empty();
  for (const auto& check : checks) passed = passed && check.passed;
  context.exit = passed ? ExitCode::kFine : ExitCode::kCheckFailed;
}

}  // namespace tumble::cli
