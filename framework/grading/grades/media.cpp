#include "framework/grading/grades/media.h"

#include <algorithm>
#include <atomic>
#include <future>
#include <set>

#include "framework/engines/judging/judge.h"
#include "framework/engines/run.h"
#include "framework/grading/verdicts/call_log.h"
#include "framework/grading/course/laws_around.h"
#include "framework/grading/verdicts/plain_text.h"
#include "framework/render/picture.h"
#include "framework/report/player.h"
#include "framework/report/virtual_times_panel.h"
#include "framework/scene/load_scene.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;
using modules::AnyModule;
using modules::ModuleKind;

constexpr const char* kThree = "three.js";
// A page of a few hundred bodies keeps every third frame or so: a fifth of its size.
constexpr std::size_t kMostPoses = 120'000, kMostContacts = 120'000;
// x264's constant quality: half the size of the 21 that a single run has, for many small videos.
constexpr int kVideoQuality = 26;

struct Run {
  Trajectory trajectory;
  std::string story;
  bool attempted = true;
  bool is_answered = false;  // some function of the submission gave an answer
  std::set<std::string> functions;
};

// Notes the names of functions that are called, and whether any gave an answer.
class CalledFunctions : public modules::CallWatcher {
 public:
  const char* begin(const char* function) override {
    ++calls_;
    if (function != last_) names.insert(last_ = function);
    return nullptr;
  }
  void end(const char*) override {}
  void threw(const char*, const std::exception&) override { ++throws_; }
  bool is_answered() const { return calls_ > throws_; }

  std::set<std::string> names;

 private:
  std::size_t calls_ = 0, throws_ = 0;
  const char* last_ = nullptr;
};

// Runs to the end, or until the submission fails; the recording up to there is kept.
Run run(const scene::Scene& scene, const Laws& laws) {
  Run result;
  TrajectoryRecorder recorder;
  try {
    engines::RunOptions options;
    options.instants_s = engines::instants_of_checks(scene);
    engines::run_scene(scene, laws, options, recorder);
  } catch (const NotImplemented& missing) {
    result.story = missing.what();
    result.attempted = false;
  } catch (const std::exception& error) {
    result.story = error.what();
  }
  result.trajectory = recorder.trajectory();
  if (result.story.empty()) result.story = result.trajectory.stopped_by;
  // it may be text from a submission
  else
    result.trajectory.stopped_by = plain_text(result.story);
  return result;
}

Run run_submission(const Course& course, const ModuleKind& kind, const fs::path& submission,
                   const scene::Scene& scene, const MediaOptions& options) {
  WorkerOptions worker;
  worker.id = kind.id;
  worker.module = submission;
  worker.programs = course.build / "bin";
  worker.session_own_s = options.wall_s;
  // a scene has thousands of steps; above what the wall-clock limit allows
  worker.callback_budget = 100'000'000;
  const OwnCallLog log;
  WorkerConnection connection(worker);
  CalledFunctions called;
  const Laws laws = laws_around(course, kind, kind.watched(kind.make_proxy(connection), called),
                                "submission", scene);
  Run result = run(scene, laws);
  result.functions = called.names;
  result.is_answered = called.is_answered();
  return result;
}

void draw(const scene::Scene& scene, const std::vector<render::LabelledRun>& runs,
          const fs::path& folder, const MediaOptions& options, const Course& course,
          SceneMedia& media) {
  render::PictureOptions picture;
  picture.width = options.width;
  picture.height = options.height;
  picture.samples = options.samples;
  picture.video_rate_hz = options.rate_hz;
  picture.video_crf = kVideoQuality;
  picture.root = course.root;
  media.picture = scene.name + ".png";
  render::write_side_by_side_picture(folder / media.picture, scene, runs,
                                     render::telling_instant(runs.back().trajectory), picture);
  if (!options.video) return;
  media.video = scene.name + ".mp4";
  render::write_side_by_side_video(folder / media.video, scene, runs, picture);
}

report::PlayerOptions player_of(const MediaOptions& options, const Course& course) {
  report::PlayerOptions player;
  player.root = course.root;
  player.three_file = options.three_file.empty() ? fs::path(kThree) : options.three_file;
  player.most_poses = kMostPoses;
  player.most_contacts = kMostContacts;
  return player;
}

// A page that plays run and reference, with the first difference.
void write_page(const scene::Scene& scene, const std::vector<render::LabelledRun>& runs,
                const fs::path& folder, const MediaOptions& options, const Course& course,
                SceneMedia& media) {
  report::PlayerOptions player = player_of(options, course);
  std::vector<report::PlayedRun> played;
  if (!runs.empty() && !runs.front().trajectory.virtual_times.moves.empty())
    player.panels.push_back(report::virtual_times_panel(runs.front().trajectory.virtual_times));
  for (const render::LabelledRun& run : runs) played.push_back({run.trajectory, run.label});
  media.page = scene.name + ".html";
  report::write_player(folder / media.page, scene, played, player);
}

// A scene with what submission and reference made of it.
struct RunScene {
  scene::Scene scene;
  Run theirs, ours;
  SceneMedia media;
  bool is_stub = false;  // only stubs were called
};

RunScene run_both(const Course& course, const ModuleKind& kind, const AnyModule& reference,
                  const fs::path& submission, const fs::path& file, const MediaOptions& options) {
  RunScene both{scene::load_scene(file), {}, {}, {}};
  both.theirs = run_submission(course, kind, submission, both.scene, options);
  both.is_stub = !both.theirs.attempted && !both.theirs.is_answered;
  if (reference && !both.is_stub)
    both.ours = run(both.scene, laws_around(course, kind, reference, "reference", both.scene));
  SceneMedia& media = both.media;
  media.scene = both.scene.name;
  media.title = both.scene.title;
  media.about = both.scene.about;
  media.story = both.theirs.story;
  media.attempted = both.theirs.attempted;
  media.functions.assign(both.theirs.functions.begin(), both.theirs.functions.end());
  if (media.story.empty()) media.checks = engines::judge_run(both.scene, both.theirs.trajectory);
  return both;
}

SceneMedia draw_both(RunScene both, const fs::path& folder, const MediaOptions& options,
                     const Course& course) {
  SceneMedia& media = both.media;
  std::vector<render::LabelledRun> runs;
  if (!both.theirs.trajectory.frames.empty() && !both.is_stub)
    runs.push_back({both.theirs.trajectory, "submission"});
  if (!both.ours.trajectory.frames.empty()) runs.push_back({both.ours.trajectory, "reference"});
  MediaOptions own = options;
  // without an implementation nothing moves: a picture is enough
  own.video = options.video && media.attempted;
  if (!runs.empty()) draw(both.scene, runs, folder, own, course, media);
  if (!runs.empty() && options.page && media.attempted)
    write_page(both.scene, runs, folder, options, course, media);
  return std::move(media);
}

}  // namespace

std::vector<SceneMedia> make_media(const Course& course, const std::string& id,
                                   const std::vector<fs::path>& scenes, const fs::path& submission,
                                   const fs::path& folder, const MediaOptions& options) {
  const ModuleKind& kind = course.registry->find(id);
  const AnyModule reference = reference_of(course, kind);
  fs::create_directories(folder);
  // A scene waits for its worker, for memory and for ffmpeg as often as it computes.
  constexpr int kAtOnce = 3;  // scenes; each holds its runs in memory
  std::vector<SceneMedia> all(scenes.size());
  std::atomic<std::size_t> next = 0;
  const auto take_scenes = [&] {
    try {
      for (std::size_t i = next++; i < scenes.size(); i = next++)
        all[i] = draw_both(run_both(course, kind, reference, submission, scenes[i], options),
                           folder, options, course);
    } catch (...) {
      next = scenes.size();  // ends the others after their scene
      throw;
    }
  };
  std::vector<std::future<void>> at_once;
  for (int i = 0; i < kAtOnce; ++i) at_once.push_back(std::async(std::launch::async, take_scenes));
  for (std::future<void>& one : at_once) one.get();
  const bool has_page = std::any_of(all.begin(), all.end(),
                                    [](const SceneMedia& media) { return !media.page.empty(); });
  // also where an earlier program wrote one: it holds the scripts of these pages
  if (has_page && options.three_file.empty())
    report::write_three(folder / kThree, player_of(options, course));
  return all;
}

}  // namespace tumble::grading
