#include "framework/live/simulate.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <numbers>
#include <thread>

#include <nlohmann/json.hpp>

#include "framework/core/error.h"
#include "framework/core/not_implemented.h"
#include "framework/effects/build_world.h"
#include "framework/engines/run.h"
#include "framework/engines/stepping/local_origin.h"
#include "framework/live/records.h"
#include "framework/report/player_parts.h"
#include "framework/scene/write_entries.h"
#include "framework/trajectory/fault_words.h"

namespace tumble::live {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

// The spring of a hand: a body on it alone swings at this frequency, damped well below critically,
// so that it follows the hand and is seen to swing.
constexpr double kPullFrequency = 1.2;  // Hz
constexpr double kPullDamping = 0.35;   // of critical
// A pull is renewed so often, constant in between [s].
constexpr double kPullPeriod = 1.0 / 60.0;

/// Thrown through the engine where nobody reads or writes any more.
struct PageIsGone {};

Json json_of(const Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

Vector3d vector_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

std::string line_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Vector3d place_of(const engines::HandMoment& moment, int body, const Vector3d& point_body) {
  const RigidBodyState& state = moment.states[static_cast<std::size_t>(body)];
  return state.com_world + state.world_from_body.normalized() * point_body;
}

/// Lines from a descriptor.
class LineReader {
 public:
  explicit LineReader(int fd) : fd_(fd) {}

  /// Waits for at most so long. @return false where the other end is closed
  bool wait(int timeout_ms) {
    pollfd waiting{fd_, POLLIN, 0};
    const int ready = ::poll(&waiting, 1, timeout_ms);
    if (ready <= 0) return true;
    char buffer[1 << 14];
    const ssize_t n = ::read(fd_, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) return true;
    if (n <= 0) return false;
    text_.append(buffer, static_cast<std::size_t>(n));
    return true;
  }
  std::optional<std::string> next() {
    const std::size_t end = text_.find('\n');
    if (end == std::string::npos) return std::nullopt;
    std::string line = text_.substr(0, end);
    text_.erase(0, end + 1);
    return line;
  }

 private:
  int fd_;
  std::string text_;
};

/// The sink of the run, and the hand that acts on it: both at the instants at which the engine
/// comes by.
class LiveRun final : public TrajectorySink {
 public:
  LiveRun(Simulation& simulation, int commands, int records)
      : simulation_(simulation), lines_(commands), records_(records) {
    step_ = simulation.options.step_s.value_or(simulation.scene.step_s);
  }

  // TrajectorySink
  void begin(const TrajectoryInfo& info, const std::vector<TrajectoryBody>&) override {
    info_ = info;
  }
  void frame(const Frame& frame) override;
  void event(const Event& event) override {
    if (event.time >= simulation_.from_s) send(RecordKind::kEvent, pack(event));
  }
  void virtual_times(const VirtualTimes& times) override { send_times(times, moves_sent_); }
  void end(const Counters& counters, const std::string& stopped_by) override;

  /// The hand of run_options.h.
  std::optional<scene::Scene> act(const engines::HandMoment& moment);

  void send(RecordKind kind, std::string_view bytes) const {
    if (!write_record(records_, kind, bytes)) throw PageIsGone{};
  }
  void send_asked(bool is_now);

 private:
  void send_head(const Frame& first);
  void send_times(const VirtualTimes& times, std::size_t from);
  void keep_pace(double time);
  void obey_waiting();
  void obey(const std::string& line);
  void aim(const Json& command);
  void push(const Json& command);
  struct PointForce {
    int body;
    Vector3d force_world, point_world;
    double start, duration;
  };
  void put_on(PointForce force, const Vector3d& origin_world, scene::Scene& more);
  bool pull(const engines::HandMoment& moment, scene::Scene& more);

  Simulation& simulation_;
  LineReader lines_;
  int records_;
  double step_;
  TrajectoryInfo info_;
  bool has_head_ = false;
  std::size_t moves_sent_ = 0;
  bool is_cut_sent_ = false;
  Frame last_;         // that has come
  std::string asked_;  // as it was sent last
  Clock::time_point asked_at_;
  // The pace: at base_wall_ the run was at base_s_.
  Clock::time_point base_wall_;
  double base_s_ = kUnset;
  int single_steps_ = 0;
  // The hand.
  int aimed_ = -1;                        // body
  Vector3d aimed_body_ = unset_vector();  // body frame [m]
  struct Push {
    int body;
    Vector3d point_body, force_world;
    double duration;
  };
  std::vector<Push> pushes_;  // that wait for the engine to come by
  std::optional<Vector3d> pull_to_;
  double pulled_until_ = 0.0;  // [s]
};

void LiveRun::frame(const Frame& frame) {
  if (!has_head_) send_head(frame);
  last_ = frame;
  constexpr double kRounding = 1e-9;  // s, of frame times
  if (frame.time < simulation_.from_s - kRounding) {
    obey_waiting();
    return;
  }
  send(RecordKind::kFrame, pack(frame));
  if (simulation_.times) send_times(*simulation_.times, moves_sent_);
  send_asked(simulation_.is_paused);
  keep_pace(frame.time);
}

void LiveRun::send_asked(bool is_now) {
  constexpr double kEvery = 0.3;  // s
  const auto now = Clock::now();
  if (!simulation_.asked || (!is_now && now - asked_at_ < std::chrono::duration<double>(kEvery)))
    return;
  asked_at_ = now;
  std::string asked = simulation_.asked();
  if (asked == asked_) return;
  asked_ = std::move(asked);
  send(RecordKind::kAsked, asked_);
}

void LiveRun::send_head(const Frame& first) {
  has_head_ = true;
  const World world = build_world(simulation_.scene);
  Json head;
  head["scene"] =
      Json::parse(report::player_scene_text(simulation_.scene, simulation_.root, first));
  head["engine"] = info_.engine;
  head["step_s"] = info_.step_s;
  head["frame_rate_hz"] = info_.frame_rate_hz;
  head["modules"] = simulation_.modules;
  head["impulses"] = info_.impulse_source;
  head["motion"] = info_.integrator_source;
  head["constraints"] = info_.constraint_source;
  head["duration_s"] = simulation_.options.duration_s.value_or(simulation_.scene.duration_s);
  head["from_s"] = simulation_.from_s;
  head["can_pull"] = info_.engine == "rd" && simulation_.laws.spring_force;
  head["gravity_m_s2"] = world.gravity_world ? json_of(*world.gravity_world) : Json();
  head["bodies"] = Json::array();
  for (const WorldBody& body : world.bodies) {
    Json one{{"restitution", body.restitution}, {"friction", body.friction}};
    if (!body.immovable()) {
      one["mass_kg"] = body.inertia.mass;
      Json rows = Json::array();
      for (int i = 0; i < 3; ++i) rows.push_back(json_of(body.inertia.inertia_body.row(i)));
      one["inertia_kg_m2"] = rows;
    }
    head["bodies"].push_back(one);
  }
  send(RecordKind::kHead, line_of(head));
}

void LiveRun::send_times(const VirtualTimes& times, std::size_t from) {
  const bool tells_cut = times.is_cut && !is_cut_sent_;
  if (times.moves.size() <= from && !tells_cut) return;
  Json moves = Json::array();
  for (std::size_t k = from; k < times.moves.size(); ++k) {
    const VirtualTimes::Move& move = times.moves[k];
    moves.push_back({move.process, move.from_s, move.to_s, move.global_virtual_time_s});
  }
  moves_sent_ = times.moves.size();
  Json record{{"processes", times.processes}, {"from", from}, {"moves", std::move(moves)}};
  if (times.is_cut) is_cut_sent_ = record["is_cut"] = true;
  send(RecordKind::kTimes, line_of(record));
}

void LiveRun::end(const Counters& counters, const std::string& stopped_by) {
  if (simulation_.times) send_times(*simulation_.times, moves_sent_);
  send_asked(true);
  Json end{{"stopped_by", stopped_by}, {"time_s", has_head_ ? last_.time : 0.0}};
  end["faults"] = in_words(counters.faults);
  end["notices"] = counters.notices;
  send(RecordKind::kEnd, line_of(end));
}

// Waits until the clock is where the frame is; obeys what is said meanwhile.
void LiveRun::keep_pace(double time) {
  constexpr double kMostLag = 0.1;  // s: a run that is slower than the clock is not hurried
  constexpr int kForever = -1;
  if (std::isnan(base_s_)) base_s_ = time, base_wall_ = Clock::now();
  obey_waiting();
  for (;;) {
    int timeout_ms = kForever;
    if (!simulation_.is_paused) {
      const double ahead = (time - base_s_) / simulation_.speed -
                           std::chrono::duration<double>(Clock::now() - base_wall_).count();
      if (ahead < -kMostLag) base_s_ = time, base_wall_ = Clock::now();
      if (ahead <= 0) return;
      timeout_ms = std::max(1, static_cast<int>(1000.0 * ahead));
    } else if (single_steps_ > 0) {
      --single_steps_;
      return;
    }
    if (!lines_.wait(timeout_ms)) throw PageIsGone{};
    while (const auto line = lines_.next()) obey(*line);
  }
}

void LiveRun::obey_waiting() {
  if (!lines_.wait(0)) throw PageIsGone{};
  while (const auto line = lines_.next()) obey(*line);
}

void LiveRun::obey(const std::string& line) {
  const Json command = Json::parse(line);
  const std::string what = command.at("do");
  if (what == "pace") {
    simulation_.is_paused = command.at("paused");
    if (simulation_.is_paused && has_head_) send_asked(true);
    simulation_.speed = command.at("speed");
    base_s_ = last_.time;
    base_wall_ = Clock::now();
    single_steps_ = 0;
  } else if (what == "step") {
    ++single_steps_;
  } else if (what == "aim") {
    aim(command);
  } else if (what == "push") {
    push(command);
  } else if (what == "pull") {
    if (aimed_ >= 0) pull_to_ = vector_of(command.at("to_m"));
  } else if (what == "release") {
    pull_to_.reset();
  }
}

void LiveRun::aim(const Json& command) {
  Json answer;
  aimed_ = -1;
  try {
    if (command.contains("ray")) {
      scene::Scene posed = simulation_.scene;
      for (std::size_t i = 0; i < posed.bodies.size(); ++i) {
        posed.bodies[i].position_m = last_.poses[i].com_world;
        posed.bodies[i].world_from_body = last_.poses[i].world_from_body;
      }
      const Json& ray = command.at("ray");
      const auto number = [&](std::size_t i) { return ray.at(i).get<double>(); };
      const Vector3d origin(number(0), number(1), number(2)),
          direction(number(3), number(4), number(5));
      if (const auto hit = simulation_.pick(posed, {origin, direction})) {
        aimed_ = hit->body;
        const BodyPose& pose = last_.poses[static_cast<std::size_t>(hit->body)];
        aimed_body_ = pose.world_from_body.conjugate() * (hit->point_world - pose.com_world);
        answer["face"] = hit->face;
      }
    } else {
      aimed_ = command.at("body");
      aimed_body_ = vector_of(command.at("point_body_m"));
    }
  } catch (const NotImplemented& missing) {
    answer["problem"] = std::string("not attempted: ") + missing.what();
  } catch (const UserError& error) {
    answer["problem"] = error.what();
  }
  const auto count = static_cast<int>(simulation_.scene.bodies.size());
  if (aimed_ < 0 || aimed_ >= count ||
      simulation_.scene.bodies[static_cast<std::size_t>(aimed_)].immovable)
    aimed_ = -1;
  answer["body"] = aimed_;
  if (aimed_ >= 0) answer["point_body_m"] = json_of(aimed_body_);
  send(RecordKind::kAimed, line_of(answer));
}

void LiveRun::push(const Json& command) {
  const Vector3d force = vector_of(command.at("force_n"));
  const double duration = command.at("duration_s");
  if (aimed_ < 0 || !force.allFinite() || !(duration > 0) || !std::isfinite(duration)) return;
  if (simulation_.options.hand) {
    pushes_.push_back({aimed_, aimed_body_, force, duration});
    return;
  }
  // An engine that goes from event to event runs again, with the push from its start on: it begins
  // at the frame that is seen.
  const BodyPose& pose = last_.poses[static_cast<std::size_t>(aimed_)];
  const Vector3d point = pose.com_world + pose.world_from_body * aimed_body_;
  scene::Scene unused;
  put_on({aimed_, force, point, last_.time, duration}, Vector3d::Zero(), unused);
}

std::optional<scene::Scene> LiveRun::act(const engines::HandMoment& moment) {
  if (pushes_.empty() && !pull_to_) return std::nullopt;
  scene::Scene more;
  more.name = simulation_.scene.name;
  more.bodies = simulation_.scene.bodies;
  bool has_any = !pushes_.empty();
  for (const Push& push : pushes_)
    put_on({push.body, push.force_world, place_of(moment, push.body, push.point_body), moment.time,
            push.duration},
           moment.origin_world, more);
  pushes_.clear();
  if (pull_to_ && aimed_ >= 0 && moment.time >= pulled_until_) has_any |= pull(moment, more);
  return has_any ? std::optional(std::move(more)) : std::nullopt;
}

// The spring of assignment a3 from the point that is held to the hand, for a short while constant.
bool LiveRun::pull(const engines::HandMoment& moment, scene::Scene& more) {
  // The time on the grid of steps at which it is renewed, so that no step is cut; next - time is
  // exact, so that the force ends at that time to the last bit.
  const double steps = std::max(1.0, std::round(kPullPeriod / step_));
  const double next = (std::floor(moment.time / step_ + 1e-6) + steps) * step_;
  pulled_until_ = next;
  const Inertia& inertia = moment.world.bodies[static_cast<std::size_t>(aimed_)].inertia;
  const RigidBodyState& state = moment.states[static_cast<std::size_t>(aimed_)];
  const double frequency = 2 * std::numbers::pi * kPullFrequency;
  Spring spring;
  spring.stiffness = inertia.mass * frequency * frequency;
  spring.damping = 2 * kPullDamping * inertia.mass * frequency;
  spring.rest_length = 0.0;
  const Vector3d held = place_of(moment, aimed_, aimed_body_);
  const Vector3d velocity = inertia.inverse_mass * state.momentum_world +
                            omega_of(state, inertia).cross(held - state.com_world);
  Vector3d force;
  try {
    force = simulation_.laws.spring_force(spring, {held, velocity},
                                          {*pull_to_ - moment.origin_world, Vector3d::Zero()});
  } catch (const NotImplemented& missing) {
    pull_to_.reset();
    send(RecordKind::kAimed,
         line_of({{"body", -1}, {"problem", std::string("not attempted: ") + missing.what()}}));
    return false;
  }
  if (!force.allFinite()) return false;
  put_on({aimed_, force, held, moment.time, next - moment.time}, moment.origin_world, more);
  return true;
}

// The record has the point in the world, as a scene has it. The engine gets the point that it will
// read from that scene: far from the world's origin it is rounded there.
// @param force  its point seen from the origin
// @param origin_world  of the engine's coordinates [m]
void LiveRun::put_on(PointForce force, const Vector3d& origin_world, scene::Scene& more) {
  const std::string& name = simulation_.scene.bodies[static_cast<std::size_t>(force.body)].name;
  const bool is_by_engine = static_cast<bool>(simulation_.options.hand);
  const Vector3d recorded_world = force.point_world + origin_world;
  if (!origin_world.isZero(0.0)) {
    scene::Scene probe = simulation_.scene;  // whose links say how a decimal is read
    probe.bodies.front().position_m = recorded_world;
    force.point_world =
        engines::seen_from(origin_world, std::move(probe)).bodies.front().position_m;
  }
  if (is_by_engine)
    scene::EntryWriter{more}("point_forces", {{"body", name},
                                              {"force_n", force.force_world},
                                              {"point_m", force.point_world},
                                              {"start_s", force.start},
                                              {"duration_s", force.duration}});
  send(RecordKind::kHand, line_of({{"body", name},
                                   {"force_n", json_of(force.force_world)},
                                   {"point_m", json_of(recorded_world)},
                                   {"start_s", force.start},
                                   {"duration_s", force.duration},
                                   {"runs_again", !is_by_engine}}));
}

}  // namespace

void simulate(Simulation& simulation, int commands, int records) {
  LiveRun run(simulation, commands, records);
  try {
    try {
      if (simulation.options.engine == "rd")
        simulation.options.hand = [&run](const engines::HandMoment& moment) {
          return run.act(moment);
        };
      engines::run_scene(simulation.scene, simulation.laws, simulation.options, run);
    } catch (const UserError& error) {
      run.send(RecordKind::kRefused, line_of({{"where", error.where()},
                                              {"problem", error.problem()},
                                              {"remedy", error.remedy()}}));
    } catch (const NotImplemented& missing) {
      run.send_asked(true);  // for that function, too
      run.send(RecordKind::kRefused, line_of({{"where", missing.function()},
                                              {"problem", missing.what()},
                                              {"remedy", ""},
                                              {"not_attempted", true}}));
    } catch (const std::exception& error) {  // a module that gives no answer any more
      run.end({}, error.what());
    }
  } catch (const PageIsGone&) {
  }
}

}  // namespace tumble::live
