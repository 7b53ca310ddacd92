#include "framework/cli/engines_all.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/engine_rows.h"
#include "framework/cli/find_scene.h"
#include "framework/cli/json_output.h"
#include "framework/cli/kept_at_stop.h"
#include "framework/cli/record.h"
#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/engines/judging/judge.h"
#include "framework/render/picture.h"
#include "framework/report/engines_index.h"
#include "framework/report/player.h"
#include "framework/report/tables_json.h"
#include "framework/report/virtual_times_panel.h"
#include "framework/scene/sized_scenes.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;
using report::EngineRow;
using report::EnginesScene;

/// A scene of the page. Shares are the relative times of its runs and pictures, for the estimate of
/// the remaining time.
struct Shown {
  const char* name;
  int small_n, n, paper_n;  // 0: not shown
  double paper_duration;    // compared duration at the paper's size [s]; 0: the scene's
  double speed;             // seconds of the run per second of video
  double share, paper_share;
};
constexpr Shown kShown[] = {
    {"atoms", 60, 100, 300, 0, 0.5, 5, 60},  {"cars", 9, 40, 400, 0, 0.5, 10, 100},
    {"robots", 1, 4, 20, 0.8, 0.5, 14, 250}, {"avalanche", 5, 16, 300, 0.7, 1.0, 20, 400},
    {"pong", 0, 200, 2000, 0, 0.5, 5, 200},  {"dominoes_row", 0, 12, 50, 0, 1.0, 14, 250},
    {"cradle", 0, 8, 20, 0, 1.0, 5, 20}};

// The slides' sizes are 100 and 200 atoms; both are in every list of sizes. The others are ours.
const std::vector<int> kSmallLadder = {50, 100, 200}, kLadder = {25, 50, 100, 200},
                       kPaperLadder = {50, 100, 200, 400};
// ours: the slides show Pong, without these sizes
const std::vector<int> kSmallPong = {1, 50}, kPong = {1, 200, 2000};
// s of CPU: a slower engine is left out at that size
constexpr double kMostOfPong = 10.0;
constexpr double kLadderShare = 12, kPaperLadderShare = 150, kPongShare = 10;
// s of CPU: a slower engine is left out of the paper's sizes for that scene
constexpr double kMostOfPaper = 60.0;
// frames per second: of shown runs, and of others
constexpr double kPlayedRate = 60.0, kEnergyRate = 10.0;
constexpr int kWidth = 960, kHeight = 540;

/// Reports the current scene and the estimated remaining time.
class TableProgress {
 public:
  explicit TableProgress(double total) : total_(total), begun_(std::chrono::steady_clock::now()) {}
  void begin(const std::string& what) const {
    const double spent =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begun_).count();
    const std::string left = done_ > 0 ? fmt::format(" · about {:.0f} s left",
                                                     std::ceil(spent / done_ * (total_ - done_)))
                                       : "";
    fmt::print(stderr, "[{:3.0f} %] {}{}\n", 100.0 * done_ / total_, what, left);
  }
  void finish(double share) { done_ += share; }

 private:
  double total_, done_ = 0.0;
  std::chrono::steady_clock::time_point begun_;
};

int size_of(const EnginesWords& words, const Shown& shown) {
  return words.full ? shown.paper_n : words.small ? shown.small_n : shown.n;
}

std::string modules_of(const Context& context, const EnginesWords& words) {
  if (!words.modules.empty()) return words.modules;
  // engines are compared, not submissions
  return fs::is_directory(context.root / "solutions_private") ? "reference" : "";
}

/// Each engine as shown on the page. rd uses closed forms where the others do, so that a ratio
/// compares scheduling and not integration.
std::vector<EngineChoice> choices_of(const EnginesWords& words) {
  std::vector<EngineChoice> choices = engines_named(words.engines);
  for (EngineChoice& choice : choices) {
    choice.propagator = words.propagator.empty() ? "auto" : words.propagator;
    for (const char c : choice.engine) choice.label += static_cast<char>(std::toupper(c));
    choice.frame_rate_hz = choice.engine == "ca" ? kEnergyRate : kPlayedRate;
    if (words.full) choice.most_s = kMostOfPaper;
  }
  return choices;
}

/// Retroactive detection at the two steps of the slides, and the others at the scene's own step.
std::vector<EngineChoice> choices_of_refinement(const EnginesWords& words) {
  std::vector<EngineChoice> choices;
  for (EngineChoice choice : choices_of(words)) {
    choice.frame_rate_hz = kEnergyRate;
    if (choice.engine != "rd") {
      choices.push_back(choice);
      continue;
    }
    for (const int rate : {30, 60}) {
      choice.label = fmt::format("RD-1/{}", rate);
      choice.step_s = 1.0 / rate;
      choices.push_back(choice);
    }
  }
  return choices;
}

/// The page that plays timewarp's run beside that of retroactive detection, with every change of
/// the local virtual times.
void write_players(const Context& context, const scene::Scene& scene,
                   const std::vector<EngineRun>& runs, const fs::path& three_file,
                   const fs::path& file) {
  report::PlayerOptions options;
  options.root = context.root;
  std::vector<report::PlayedRun> played;
  for (const char* engine : {"tw", "rd"})
    for (const EngineRun& run : runs) {
      if (run.row.engine != engine || run.run.frames.empty()) continue;
      played.push_back({run.run, run.row.label});
      if (!run.run.virtual_times.moves.empty())
        options.panels.push_back(report::virtual_times_panel(run.run.virtual_times));
    }
  if (played.empty()) return;
  // one for all scenes, in the report's folder
  options.three_file = three_file.empty() ? fs::path("../three.js") : three_file;
  if (three_file.empty()) report::write_three(file.parent_path() / options.three_file, options);
  report::write_player(file, scene, played, options);
}

/// Timewarp's run of the whole scene where engines were compared over a part of it: for pictures,
/// as far as it gets in a few minutes.
std::optional<EngineRun> whole_run(const Context& context, const scene::Scene& scene,
                                   const ChosenLaws& chosen, const EnginesWords& words) {
  constexpr double kMost = 200.0;  // s of CPU
  for (EngineChoice choice : choices_of(words)) {
    if (choice.engine != "tw") continue;
    fmt::print(stderr, "        {} by tw, the whole of it\n", scene.name);
    choice.is_timed = false;
    choice.most_s = kMost;
    return measure_engine(context, scene, chosen, choice);
  }
  return std::nullopt;
}

const EngineRun* run_to_show(const std::vector<EngineRun>& runs) {
  for (const char* engine : {"tw", "ca", "rd", "ordered"})
    for (const EngineRun& run : runs)
      if (run.row.engine == engine && run.run.frames.size() > 1) return &run;
  return nullptr;
}

void add_judgement(const scene::Scene& scene, const std::vector<EngineRun>& runs,
                   EnginesScene& shown) {
  shown.is_right = std::any_of(runs.begin(), runs.end(),
                               [](const EngineRun& run) { return !run.run.frames.empty(); });
  for (const EngineRun& run : runs) {
    if (run.run.frames.empty()) continue;
    for (const engines::CheckResult& check : engines::judge_run(scene, run.run)) {
      shown.checks.push_back(fmt::format(
          "{}: {} {:.3g} {}(allowed {} {:.3g})", run.row.label, check.kind,
          check.value == 0.0 ? 0.0 : check.value, check.unit.empty() ? "" : check.unit + " ",
          check.at_least ? "\u2265" : "\u2264", check.threshold == 0.0 ? 0.0 : check.threshold));
      shown.is_right = shown.is_right && check.passed;
    }
  }
}

EnginesScene show(const Context& context, const EnginesWords& words, const Shown& which,
                  const fs::path& out) {
  EnginesScene shown;
  shown.name = which.name;
  try {
    const int n = size_of(words, which);
    const scene::Scene scene = find_scene(context, which.name, n);
    shown.title = scene.title;
    shown.about = scene.about;
    shown.command = fmt::format("./tumble engines {} --n {}", which.name, n);
    const bool in_part = words.full && which.paper_duration > 0;
    if (in_part) shown.command += fmt::format(" --duration-s {:g}", which.paper_duration);
    const ChosenLaws chosen = choose_laws(
        context, scene, parse_module_words(modules_of(context, words), context.registry),
        words.engines);
    // Runs of all engines, their agreement and judgement.
    std::vector<EngineRun> runs;
    for (EngineChoice choice : choices_of(words)) {
      if (in_part) choice.duration_s = which.paper_duration;
      fmt::print(stderr, "        {} by {}\n", which.name, choice.engine);
      runs.push_back(measure_engine(context, scene, chosen, choice));
    }
    tell_agreement(runs);
    shown.rows = rows_of(runs);
    add_judgement(scene, runs, shown);
    // Table, player, picture and video.
    const fs::path folder = out / which.name;
    report::write_engines_page(scene.title, scene.about, shown.rows, {}, record_of(context, scene),
                               folder / "index.html");
    shown.page = fs::path(which.name) / "index.html";
    const auto whole = in_part ? whole_run(context, scene, chosen, words) : std::nullopt;
    const EngineRun* best = whole && whole->run.frames.size() > 1 ? &*whole : run_to_show(runs);
    if (best == nullptr) return shown;
    write_players(context, scene, runs, words.three_file, folder / "player.html");
    shown.player = fs::path(which.name) / "player.html";
    render::PictureOptions picture;
    picture.width = kWidth;
    picture.height = kHeight;
    picture.speed = which.speed;
    picture.root = context.root;
    render::write_picture(folder / "picture.png", scene, best->run,
                          render::telling_instant(best->run), picture);
    shown.figure.picture = fs::path(which.name) / "picture.png";
    shown.figure.caption =
        fmt::format("{} by {}{}", scene.title, best->row.meaning,
                    which.speed < 1 ? fmt::format(", at {:g} of its speed", which.speed) : "");
    if (words.no_videos) return shown;
    render::write_video(folder / "video.mp4", scene, best->run, picture);
    shown.figure.video = fs::path(which.name) / "video.mp4";
  } catch (const std::exception& error) {  // an error in one scene is shown in its place
    shown.problem = error.what();
  }
  return shown;
}

std::vector<std::vector<EngineRow>> climb(const Context& context, const EnginesWords& words,
                                          const char* name, const std::vector<int>& sizes,
                                          double most_s) {
  std::vector<std::vector<EngineRow>> ladder;
  for (const int n : sizes) {
    const scene::Scene scene = find_scene(context, name, n);
    const ChosenLaws chosen = choose_laws(
        context, scene, parse_module_words(modules_of(context, words), context.registry),
        words.engines);
    std::vector<EngineRun> runs;
    for (EngineChoice choice : choices_of_refinement(words)) {
      choice.most_s = std::min(choice.most_s, most_s);
      runs.push_back(measure_engine(context, scene, chosen, choice));
    }
    tell_agreement(runs);
    ladder.push_back(rows_of(runs));
  }
  return ladder;
}

/// Refuses before the runs what could not be drawn after them. JSON has every row without a picture
/// too, and names the problem at each scene: there a warning does.
/// @throws UserError
void expect_drawing(const EnginesWords& words) {
  try {
    render::expect_pictures();
    report::expect_player();
    if (words.no_videos) return;
    try {
      render::expect_video(words.out);
    } catch (const UserError& error) {
      throw UserError(error.where(), error.problem(),
                      error.remedy() + " The page without videos: --no-videos.");
    }
  } catch (const UserError& error) {
    if (!words.json) throw;
    fmt::print(stderr,
               "tumble: {}: {}. Rows are made all the same; \"problem\" of each scene names it\n",
               error.where(), error.problem());
  }
}

void print_scene(const EnginesScene& scene) {
  if (!scene.problem.empty()) return fmt::print("{}: FAILED {}\n\n", scene.name, scene.problem);
  fmt::print("{}\n", scene.title);
  print_rows(scene.rows);
  fmt::print("\n");
}

}  // namespace

void engines_of_all(Context& context, const EnginesWords& words) {
  if (words.n || words.duration_s || words.step_s || !words.sizes.empty())
    throw UserError("tumble engines", "sizes, durations and steps belong to one scene",
                    "Name a scene, or leave --n, --sizes, --duration-s and --step-s out.");
  engines_named(words.engines);
  // What each scene would fail for is refused before the first.
  expect_module_files(context, parse_module_words(modules_of(context, words), context.registry));
  const fs::path out = words.out;
  expect_writable(out / "index.html");
  if (!words.quiet) expect_drawing(words);  // a larger report shows what is missing in its place
  // The scenes of the page, and their shares of the time.
  std::vector<Shown> all;
  for (const Shown& shown : kShown)
    if (size_of(words, shown) > 0) all.push_back(shown);
  const auto share_of = [&](const Shown& shown) {
    return words.full ? shown.paper_share : shown.share;
  };
  const double ladder_share = words.full ? kPaperLadderShare : kLadderShare;
  double total = ladder_share + kPongShare;
  for (const Shown& shown : all) total += share_of(shown);
  TableProgress progress(total);
  std::optional<KeptAtStop> stop;  // a larger report has its own end
  if (!words.quiet) stop.emplace("scenes");
  report::EnginesIndex index;
  index.record = record_of(context);
  index.is_full = words.full;
  // Runs over several sizes.
  progress.begin("atoms at several sizes");
  index.ladder = climb(context, words, "atoms",
                       words.full    ? kPaperLadder
                       : words.small ? kSmallLadder
                                     : kLadder,
                       std::numeric_limits<double>::infinity());
  progress.finish(ladder_share);
  progress.begin("pong at several sizes");
  index.ghosts =
      climb(context, words, "pong_ghosts", words.small ? kSmallPong : kPong, kMostOfPong);
  index.pong = climb(context, words, "pong", words.small ? kSmallPong : kPong, kMostOfPong);
  progress.finish(kPongShare);
  // The scenes.
  for (const Shown& shown : all) {
    progress.begin(shown.name);
    index.scenes.push_back(show(context, words, shown, words.out));
    progress.finish(share_of(shown));
    const EnginesScene& scene = index.scenes.back();
    if (!scene.problem.empty() || !scene.is_right) context.exit = ExitCode::kCheckFailed;
    // after each scene: a stopped run leaves the page of all scenes so far
    const auto write = [&] { report::write_engines_index(index, out / "index.html"); };
    stop ? stop->keep(index.scenes.size(), all.size(), (out / "index.html").string(), write)
         : write();
    if (!words.quiet && !words.json) print_scene(scene);
  }
  if (words.quiet) return;
  if (words.json) {
    nlohmann::ordered_json scenes = nlohmann::ordered_json::array(), sizes = scenes;
    for (const EnginesScene& scene : index.scenes)
      scenes.push_back({{"scene", scene.name},
                        {"problem", scene.problem},
                        {"right", scene.is_right},
                        {"engines", report::json_of(scene.rows)}});
    for (const std::vector<EngineRow>& rows : index.ladder)
      sizes.push_back({{"n", rows.front().bodies}, {"engines", report::json_of(rows)}});
    return print_json(context, {{"scenes", std::move(scenes)},
                                {"sizes", std::move(sizes)},
                                {"page", (fs::path(words.out) / "index.html").string()}});
  }
  for (const std::vector<EngineRow>& rows : index.ladder) {
    fmt::print("atoms (n = {})\n", rows.front().bodies);
    print_rows(rows);
  }
  fmt::print("{}\n", (fs::path(words.out) / "index.html").string());
}

}  // namespace tumble::cli
