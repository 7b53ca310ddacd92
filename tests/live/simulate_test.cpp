// The process that simulates: what a hand does to a run, and that a saved scene is that run.
#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "framework/core/error.h"
#include "framework/core/not_implemented.h"
#include "framework/live/history.h"
#include "framework/live/recipe.h"
#include "framework/live/records.h"
#include "framework/live/simulate.h"
#include "framework/scene/load_scene.h"

namespace tumble::testing::live_test {
namespace {

using Json = nlohmann::ordered_json;
using live::Record;
using live::RecordKind;

// A box of 2 kg that floats at rest, and one that turns beside it.
constexpr const char* kScene = R"({
  "title": "Two boxes", "duration_s": 3, "step_s": 0.004,
  "bodies": [
    {"name": "box", "shape": {"box": {"size_m": [0.4, 0.6, 0.8]}}, "mass_kg": 2,
     "position_m": [0.1, 0.2, 0.3]},
    {"name": "top", "shape": {"box": {"size_m": [0.2, 0.3, 0.4]}}, "mass_kg": 1,
     "position_m": [3, 0, 0], "angular_velocity_rad_s": [1, 2, 0.1]}
  ]})";

Laws laws_for_hands() {
  Laws laws = library_laws();
  laws.wrench_of_point_force = [](const Vector3d& force, const Vector3d& point,
                                  const Vector3d& com) {
    return Wrench{force, (point - com).cross(force)};
  };
  laws.spring_force = [](const Spring& spring, const AnchorState& a, const AnchorState& b) {
    const Vector3d along = b.point_world - a.point_world;
    const double length = along.norm();
    if (length == 0) return Vector3d(Vector3d::Zero());
    const Vector3d n = along / length;
    return Vector3d((spring.stiffness * (length - spring.rest_length) +
                     spring.damping * (b.velocity_world - a.velocity_world).dot(n)) *
                    n);
  };
  laws.relative_normal_velocity = [](const Contact&, const Body&, const Body&) { return 0.0; };
  laws.collision_impulse = [](const Contact&, const Body&, const Body&, double) { return 0.0; };
  laws.apply_impulse = [](const Body& body, const Vector3d&, const Vector3d&) {
    return Velocity{body.velocity_world, body.omega_world};
  };
  return laws;
}

struct Pipe {
  int ends[2];
  Pipe() { require(::pipe2(ends, O_CLOEXEC) == 0, "a pipe"); }
  ~Pipe() {
    for (const int end : ends)
      if (end >= 0) ::close(end);
  }
  void close(int end) {
    ::close(ends[end]);
    ends[end] = -1;
  }
};

/// A simulation in a thread of its own, with its pipes.
class Running {
 public:
  explicit Running(const live::Recipe& recipe, double speed = 1e30, bool paused = false,
                   std::shared_ptr<const VirtualTimes> times = nullptr,
                   std::function<std::string()> asked = {},
                   const std::function<void(Laws&)>& change = {}) {
    simulation_.times = std::move(times);
    simulation_.asked = std::move(asked);
    simulation_.scene = scene::parse_scene(live::document_of(recipe), "two_boxes.json");
    simulation_.laws = laws_for_hands();
    if (change) change(simulation_.laws);
    simulation_.options.engine = "rd";
    simulation_.speed = speed;
    simulation_.is_paused = paused;
    thread_ = std::thread([this] {
      live::simulate(simulation_, commands_.ends[0], records_.ends[1]);
      records_.close(1);
    });
  }
  ~Running() {
    if (commands_.ends[1] >= 0) commands_.close(1);
    while (next()) {
    }
    thread_.join();
  }

  void say(const Json& command) {
    const std::string line = command.dump() + "\n";
    require(
        ::write(commands_.ends[1], line.data(), line.size()) == static_cast<ssize_t>(line.size()),
        "a command is written");
  }
  std::optional<Record> next() {
    for (;;) {
      if (auto record = reader_.next()) return record;
      char buffer[1 << 14];
      const ssize_t n = ::read(records_.ends[0], buffer, sizeof buffer);
      if (n <= 0) return std::nullopt;
      reader_.feed({buffer, static_cast<std::size_t>(n)});
    }
  }
  /// The next record of a kind. Of pushes on the way the entries are kept.
  std::string until(RecordKind kind) {
    while (auto record = next()) {
      if (record->kind == RecordKind::kHand) {
        Json push = Json::parse(record->bytes);
        push.erase("runs_again");
        pushes.push_back(push.dump());
      }
      if (record->kind == RecordKind::kFrame) frames.push_back(record->bytes);
      if (record->kind == kind) return record->bytes;
    }
    return "";
  }

  std::vector<std::string> pushes, frames;

 private:
  live::Simulation simulation_;
  Pipe commands_, records_;
  live::RecordReader reader_;
  std::thread thread_;
};

/// @param x_m  how far along x all is away from where the scene has it
live::Recipe recipe_with(std::vector<std::string> pushes, double x_m = 0.0) {
  Json scene = Json::parse(kScene);
  for (Json& body : scene["bodies"]) {
    Json& x = body["position_m"][0];
    x = x.get<double>() + x_m;
  }
  live::Recipe recipe;
  recipe.document = scene.dump();
  recipe.file = "two_boxes.json";
  recipe.pushes = std::move(pushes);
  recipe.duration_s = 3.0;
  return recipe;
}

// A run that is pushed and pulled while it goes, and stopped by closing its pipe.
struct Handled {
  std::vector<std::string> pushes, frames;
};
Handled run_by_hand(double x_m = 0.0) {
  Running run(recipe_with({}, x_m), 1.0, true);
  run.until(RecordKind::kFrame);
  const auto frames = [&](int count) {
    for (int i = 0; i < count; ++i) {
      run.say({{"do", "step"}});
      run.until(RecordKind::kFrame);
    }
  };
  frames(3);
  run.say({{"do", "aim"}, {"body", 0}, {"point_body_m", {0.1, 0.3, -0.2}}});
  run.until(RecordKind::kAimed);
  run.say({{"do", "push"}, {"force_n", {3.0, -5.0, 7.0}}, {"duration_s", 0.05}});
  frames(6);
  run.say({{"do", "aim"}, {"body", 1}, {"point_body_m", {0.1, 0.15, 0.2}}});
  run.until(RecordKind::kAimed);
  for (int i = 0; i < 5; ++i) {
    run.say({{"do", "pull"}, {"to_m", {3.2 + x_m, 0.1 * i, 0.4}}});
    frames(2);
  }
  run.say({{"do", "release"}});
  frames(4);
  return {run.pushes, run.frames};
}

TEST(LiveHand, PushAcceleratesByForceOverMass) {
  Running run(recipe_with({}), 1.0, true);
  run.until(RecordKind::kFrame);
  run.say({{"do", "aim"}, {"body", 0}, {"point_body_m", {0.1, 0.3, -0.2}}});
  run.until(RecordKind::kAimed);
  const Vector3d force(3.0, -5.0, 7.0);
  run.say({{"do", "push"}, {"force_n", {3.0, -5.0, 7.0}}, {"duration_s", 0.1}});
  std::vector<Frame> frames;
  for (int i = 0; i < 12; ++i) {
    run.say({{"do", "step"}});
    frames.push_back(live::unpack_frame(run.until(RecordKind::kFrame)));
  }
  ASSERT_EQ(run.pushes.size(), 1u);
  // While the force acts, v changes by F / m times the time between two frames: exact for a constant
  // force and any consistent method, 1e-12 for the rounding of 60 steps at 0.5 m/s.
  const Vector3d change = frames[4].poses[0].velocity_world - frames[2].poses[0].velocity_world;
  const Vector3d expected = force / 2.0 * (frames[4].time - frames[2].time);
  EXPECT_LT((change - expected).norm(), 1e-12);
  // Afterwards m v is force times time, and the other body has got nothing.
  EXPECT_LT((2.0 * frames[11].poses[0].velocity_world - 0.1 * force).norm(), 1e-12);
  EXPECT_EQ(frames[11].poses[1].velocity_world.norm(), 0.0);
  // Off the centre it turns, too: L = r x F T about the centre, as far as the arm keeps its
  // direction (it turns by less than 0.05 rad in 0.1 s: |w| T < 1 x 0.1 / 2).
  EXPECT_GT(frames[11].poses[0].omega_world.norm(), 0.5);
}

TEST(LiveHand, WhatWasDoneByHandRunsAgainByteForByte) {
  const Handled handled = run_by_hand();
  ASSERT_GT(handled.pushes.size(), 5u);  // the push, and a force for each 60th of the pull
  Running again(recipe_with(handled.pushes));
  for (std::size_t k = 0; k < handled.frames.size(); ++k)
    ASSERT_EQ(again.until(RecordKind::kFrame), handled.frames[k]) << "frame " << k;
}

// More moves than are kept: told once, with the moves or behind them.
TEST(LiveTimes, ThatAreCutSaySo) {
  const auto times = std::make_shared<VirtualTimes>();
  times->processes = {"box", "top"};
  times->moves = {{0, 0.0, 0.5, 0.0}, {1, 0.0, 0.25, 0.25}};
  times->is_cut = true;
  Running run(recipe_with({}), 1e30, false, times);
  const Json told = Json::parse(run.until(RecordKind::kTimes));
  EXPECT_EQ(told.at("moves").size(), 2u);
  EXPECT_TRUE(told.value("is_cut", false)) << told;
  EXPECT_EQ(run.until(RecordKind::kTimes), "");  // nothing new until the end of the run
}

TEST(LiveHand, FarFromTheOriginPushesAreRecordedInTheWorld) {
  constexpr double kFar = 1e6;  // m: the engine takes an origin of its own
  const Handled handled = run_by_hand(kFar);
  ASSERT_GT(handled.pushes.size(), 5u);
  // The box is at rest before its push. Two roundings of a place at 1e6 m: 1.2e-10 m each.
  const Json point = Json::parse(handled.pushes.front()).at("point_m");
  const Vector3d expected(kFar + 0.2, 0.5, 0.1);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(point.at(i).get<double>(), expected[i], 1e-9);
  Running again(recipe_with(handled.pushes, kFar));
  for (std::size_t k = 0; k < handled.frames.size(); ++k)
    ASSERT_EQ(again.until(RecordKind::kFrame), handled.frames[k]) << "frame " << k;
}

TEST(LiveHand, SavedFileIsASceneWithThePushes) {
  const Handled handled = run_by_hand();
  const double end_s = live::unpack_frame(handled.frames.back()).time;
  live::Recipe recipe = recipe_with(handled.pushes);
  recipe.duration_s.reset();
  const std::string file = live::saved_document(recipe, end_s, "tumble run it.json");
  EXPECT_NEAR(scene::parse_scene(file, "it.json").duration_s, end_s, 0.01);  // two steps
  live::Recipe written;
  written.document = file;
  written.file = "it.json";
  Running again(written);
  while (!again.until(RecordKind::kFrame).empty()) {
  }
  // Two steps later, which are less than a frame, comes the frame at the run's end.
  ASSERT_EQ(again.frames.size(), handled.frames.size() + 1);
  EXPECT_NEAR(live::unpack_frame(again.frames.back()).time, end_s, 0.01);
  again.frames.pop_back();
  EXPECT_EQ(again.frames, handled.frames);
}

TEST(LiveHand, NothingHappensWhileItIsPaused) {
  Running run(recipe_with({}), 1.0, true);
  const Frame first = live::unpack_frame(run.until(RecordKind::kFrame));
  run.say({{"do", "aim"}, {"body", 1}, {"point_body_m", {0, 0, 0}}});
  run.until(RecordKind::kAimed);
  EXPECT_EQ(run.frames.size(), 1u);
  run.say({{"do", "step"}});
  EXPECT_GT(live::unpack_frame(run.until(RecordKind::kFrame)).time, first.time);
}

TEST(LiveHand, ImmovableBodyAndNoBodyAreNotAimedAt) {
  Running run(recipe_with({}), 1.0, true);
  run.until(RecordKind::kFrame);
  run.say({{"do", "aim"}, {"body", 7}, {"point_body_m", {0, 0, 0}}});
  EXPECT_EQ(Json::parse(run.until(RecordKind::kAimed)).at("body"), -1);
  run.say({{"do", "push"}, {"force_n", {1, 0, 0}}, {"duration_s", 0.1}});
  run.say({{"do", "step"}});
  run.until(RecordKind::kFrame);
  EXPECT_TRUE(run.pushes.empty());
}

TEST(LiveRecipe, ChangesStandInTheDocument) {
  live::Recipe recipe = recipe_with({});
  live::change(recipe.changes, R"({"gravity_m_s2": [0, 0, -2]})");
  live::change(recipe.changes, R"({"restitution": 0.25, "friction": 0.5, "step_s": 0.01})");
  live::change(recipe.changes, R"({"mass_kg": {"box": 5}, "engine": "ca"})");
  const Json document = Json::parse(live::document_of(recipe));
  EXPECT_EQ(document.at("gravity_m_s2"), Json::array({0.0, 0.0, -2.0}));
  EXPECT_EQ(document.at("engine"), "ca");
  EXPECT_EQ(document.at("step_s"), 0.01);
  EXPECT_EQ(document.at("bodies").at(0).at("mass_kg"), 5.0);
  EXPECT_EQ(document.at("bodies").at(1).at("mass_kg"), 1);
  EXPECT_EQ(document.at("bodies").at(1).at("restitution"), 0.25);
  EXPECT_NO_THROW(scene::parse_scene(document.dump(), "changed.json"));
  // To the other process and back it is the same.
  EXPECT_EQ(live::document_of(live::recipe_of(live::as_text(recipe))), document.dump(2) + "\n");
  live::change(recipe.changes, R"({"coordinates": "reduced"})");  // of scenes with links
  const live::Recipe there = live::recipe_of(live::as_text(recipe));
  EXPECT_EQ(Json::parse(live::document_of(there)).at("coordinates"), "reduced");
  live::change(recipe.changes, R"({"all": null})");
  EXPECT_FALSE(Json::parse(live::document_of(recipe)).contains("gravity_m_s2"));
}

// On the page a run goes on after the end of its scene: what was done there stays done.
TEST(LiveRecipe, ASceneLastsUntilTheLastPush) {
  const auto push_at = [](double start_s) {
    return Json{{"body", "box"},
                {"force_n", {1, 0, 0}},
                {"point_m", {0, 0, 0}},
                {"start_s", start_s},
                {"duration_s", 0.25}}
        .dump();
  };
  live::Recipe recipe = recipe_with({push_at(1)});
  recipe.duration_s.reset();  // as in the page
  EXPECT_EQ(Json::parse(live::document_of(recipe)).at("duration_s"), 3);
  recipe.pushes.push_back(push_at(7));
  const scene::Scene scene = scene::parse_scene(live::document_of(recipe), "pushed.json");
  EXPECT_EQ(scene.duration_s, 7.25);
  scene::Scene made = scene::parse_scene(kScene, "made.json");
  live::apply(recipe, made);
  EXPECT_EQ(made.duration_s, 7.25);
}

TEST(LiveRecipe, ImpossibleChangesAreRefused) {
  live::Changes changes;
  for (const char* change :
       {R"({"coordinates": "polar"})", R"({"restitution": 1.5})", R"({"friction": -1})",
        R"({"step_s": 0})", R"({"mass_kg": {"box": 0}})", R"({"restitution": "much"})",
        R"({"camera": 1})"})
    EXPECT_THROW(live::change(changes, change), UserError) << change;
}

// Single precision is 6 cm at a million metres.
TEST(LiveRecords, PlacesForThePageAreFromItsOrigin) {
  const Vector3d origin(1e6, -2e6, 0), place(0.25, 0.5, 0.125);  // exact sums
  const auto frame_at = [&](const Vector3d& from) {
    Frame frame{};
    frame.poses.push_back(
        {from + place, Quaterniond::Identity(), Vector3d::UnitX(), Vector3d::Zero()});
    frame.contacts.push_back({0, 1, from - place, Vector3d::UnitZ(), Vector3d::UnitZ()});
    return live::pack(frame);
  };
  const auto event_at = [&](const Vector3d& from) {
    return live::pack(
        Event{1.0, EventKind::kCollision, 0, 1, from + place, Vector3d::UnitZ(), 1.0, -1.0, 1.0});
  };
  const Vector3d here = Vector3d::Zero();
  EXPECT_EQ(live::frame_for_page(frame_at(origin), frame_at(origin), origin),
            live::frame_for_page(frame_at(here), frame_at(here), here));
  EXPECT_EQ(live::event_for_page(event_at(origin), origin),
            live::event_for_page(event_at(here), here));
}

TEST(LiveRecords, OfARunThatIsTooLongToBeKeptSayUpToWhere) {
  Frame frame{};
  frame.poses.push_back(
      {Vector3d::Zero(), Quaterniond::Identity(), Vector3d::Zero(), Vector3d::Zero()});
  const std::string head =
      R"({"scene": {"camera": {"eye": [0, -5, 0], "target": [0, 0, 0]}, "bodies": []}})";
  live::History history(head, 2 * live::pack(frame).size());
  for (const double time : {0.0, 0.25, 0.5}) {
    EXPECT_EQ(history.limit_in_words(), "") << time;
    frame.time = time;
    history.add_frame(live::pack(frame));
  }
  EXPECT_EQ(history.frames().size(), 2U);
  const std::string told = history.limit_in_words();
  EXPECT_NE(told.find("up to 0.25 s only, because"), std::string::npos) << told;
  history.cut(0.25);  // from an earlier instant on there is room again
  EXPECT_EQ(history.limit_in_words(), "");
}

TEST(LiveRecords, ComeApartPieceByPiece) {
  Pipe pipe;
  Frame frame;
  frame.time = 0.1;
  frame.kinetic_energy = 1.0 / 3.0;
  frame.potential_energy = -2.0;
  frame.momentum_world = {1, 2, 3};
  frame.angular_momentum_world = {4, 5, 6};
  frame.smallest_gap = std::numeric_limits<double>::infinity();
  frame.poses.push_back({{1, 2, 3}, Quaterniond(0.5, 0.5, -0.5, 0.5), {7, 8, 9}, {1, 0, 1}});
  frame.rod_tensions = {2.5};
  frame.contacts.push_back({0, -1, {1, 1, 1}, {0, 0, 1}, {0, 0, 9}});
  const std::string packed = live::pack(frame);
  ASSERT_TRUE(live::write_record(pipe.ends[1], RecordKind::kFrame, packed));
  ASSERT_TRUE(live::write_record(pipe.ends[1], RecordKind::kEnd, "{}"));
  pipe.close(1);
  live::RecordReader reader;
  std::vector<Record> records;
  for (char c = 0; ::read(pipe.ends[0], &c, 1) == 1;) {
    reader.feed({&c, 1});
    while (auto record = reader.next()) records.push_back(*record);
  }
  ASSERT_EQ(records.size(), 2u);
  EXPECT_EQ(records[0].bytes, packed);
  EXPECT_EQ(live::pack(live::unpack_frame(packed)), packed);
  EXPECT_EQ(records[1].bytes, "{}");
  EXPECT_THROW(live::unpack_frame(packed.substr(0, 40)), std::runtime_error);
}

TEST(LiveRun, WhatItHasAskedOfTheModulesIsSentWhenItChangesAndAtTheEnd) {
  const auto calls = std::make_shared<std::atomic<int>>(7);
  Running run(recipe_with({}), 1e30, true, nullptr,
              [calls] { return "[" + std::to_string(*calls) + "]"; });
  EXPECT_EQ(run.until(RecordKind::kAsked), "[7]");
  *calls = 8;
  run.say({{"do", "pace"}, {"speed", 1e30}, {"paused", false}});
  std::string last;
  while (auto record = run.next()) {
    if (record->kind == RecordKind::kEnd) break;
    if (record->kind != RecordKind::kAsked) continue;
    EXPECT_TRUE(last.empty()) << "sent twice: " << record->bytes;
    last = record->bytes;
  }
  EXPECT_EQ(last, "[8]");
}

// Else the page says that the run asks nothing of the assignment, beside the name of the function
// that is yet to be written.
TEST(LiveRun, AFunctionThatEndsItBecauseItIsYetToBeWrittenWasAskedFor) {
  const auto calls = std::make_shared<std::atomic<int>>(0);
  Running run(
      recipe_with({}), 1e30, false, nullptr, [calls] { return "[" + std::to_string(*calls) + "]"; },
      [calls](Laws& laws) {
        laws.renormalize = [calls](const Quaterniond& q) {
          if (++*calls == 3) throw NotImplemented("renormalize", "a2_integration.md");
          return q;
        };
      });
  std::string last;
  while (auto record = run.next()) {
    if (record->kind == RecordKind::kRefused) break;
    if (record->kind == RecordKind::kAsked) last = record->bytes;
  }
  EXPECT_EQ(last, "[3]");
}

}  // namespace
}  // namespace tumble::testing::live_test
