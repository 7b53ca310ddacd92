#include "framework/engines/run.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/core/nearest_word.h"
#include "framework/core/version.h"
#include "framework/dynamics/world.h"
#include "framework/effects/build_world.h"
#include "framework/effects/registry.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/rest_speed.h"
#include "framework/engines/base/run_counters.h"
#include "framework/engines/events/advancement.h"
#include "framework/engines/events/ordered.h"
#include "framework/engines/rd/retroactive.h"
#include "framework/engines/stepping/far_points.h"
#include "framework/engines/stepping/linked_bodies.h"
#include "framework/engines/stepping/local_origin.h"
#include "framework/engines/stepping/shared_forces.h"
#include "framework/engines/stepping/start_overlaps.h"
#include "framework/engines/stepping/start_watch.h"
#include "framework/engines/timewarp/taught_timewarp.h"

namespace tumble::engines {
namespace {

template <class Law>
void need(const Law& law, const scene::Scene& scene, const char* what, const char* assignment) {
  if (!law) refuse_without_law(scene.name, what, assignment);
}

bool may_meet(const scene::Scene& scene) {
  return std::count_if(scene.bodies.begin(), scene.bodies.end(),
                       [](const scene::BodySpec& body) { return body.collides; }) > 1;
}

void check_laws(const scene::Scene& scene, const Laws& laws) {
  need(laws.integrate_step, scene, "a step of integration", "a2 (or the framework's library laws)");
  need(laws.state_derivative, scene, "the derivative of a rigid body's state",
       "a2 (or the framework's library laws)");
  need(laws.renormalize, scene, "the renormalisation of quaternions",
       "a2 (or the framework's library laws)");
  const bool asks_no_rows = scene.coordinates == scene::Coordinates::kReduced && !scene.contact &&
                            goes_without_rows(build_world(scene));
  for (const effects::Effect* effect : effects::all())
    if (effect->is_asked(scene) && !(asks_no_rows && effect->traits().constrains))
      for (const effects::NeededLaw& law : effect->needed_laws(scene, laws))
        need(law.is_there, scene, law.what.c_str(), law.assignment.c_str());
  if (scene.contact) {
    need(laws.ends_in_contact, scene, "the beginning of a persistent contact", "a3");
    need(laws.contact_forces, scene, "the forces of persistent contacts", "a3");
  }
  if (may_meet(scene)) {
    need(laws.relative_normal_velocity, scene, "the relative normal velocity of two bodies", "a1");
    need(laws.collision_impulse, scene, "the impulse of a collision", "a1");
    need(laws.apply_impulse, scene, "the effect of an impulse", "a1");
  }
}

/// The scene in the coordinates that "auto" stands for: those that rods and joints leave free,
/// unless a module's rows of these are what the run shows.
scene::Scene in_chosen_coordinates(const scene::Scene& scene, const Laws& laws) {
  scene::Scene chosen = scene;
  chosen.coordinates = laws.constraint_multipliers && !laws.rows_are_given
                           ? scene::Coordinates::kMaximal
                           : scene::Coordinates::kReduced;
  return chosen;
}

scene::Scene at_its_rest_speed(const scene::Scene& scene) {
  scene::Scene chosen = scene;
  chosen.rest_speed_m_s = rest_speed_of(scene);
  chosen.gives_rest_speed = true;
  return chosen;
}

// A step of the smallest world takes a microsecond; a frame takes some hundred bytes a body, and
// all are kept.
constexpr double kMostSteps = 1e8, kMostFrames = 1e7;

void refuse_endless(const scene::Scene& scene, double step, double duration, double frame_rate_hz) {
  const std::string where = scene.file.empty() ? scene.name : scene.file.string();
  if (duration / step > kMostSteps)
    throw UserError(
        where,
        fmt::format("{:.3g} s in steps of {:.3g} s are {:.2g} steps, which would take too long",
                    duration, step, duration / step),
        fmt::format("Take a longer step (\"step_s\") or a shorter run (\"duration_s\"): at most "
                    "{:.0e} steps.",
                    kMostSteps));
  if (duration * frame_rate_hz > kMostFrames)
    throw UserError(
        where,
        fmt::format(
            "{:.3g} s at {:g} frames a second are {:.2g} frames, which memory would not hold",
            duration, frame_rate_hz, duration * frame_rate_hz),
        fmt::format("Take a shorter run (\"duration_s\"): at most {:.0e} frames.", kMostFrames));
}

void check_callbacks(const std::vector<Callback>& callbacks, const scene::Scene& scene) {
  for (std::size_t k = 0; k < callbacks.size(); ++k) {
    const std::vector<int>& bodies = callbacks[k].bodies;
    require(!bodies.empty() && std::is_sorted(bodies.begin(), bodies.end()) &&
                (k == 0 || callbacks[k - 1].time <= callbacks[k].time),
            "callbacks come in order of time, each with its bodies in order");
    for (const int body : bodies)
      require(
          body >= 0 && body < static_cast<int>(scene.bodies.size()) &&
              !scene.bodies[static_cast<std::size_t>(body)].immovable,
          fmt::format("a callback acts on movable bodies of the scene, and body {} is none", body));
  }
}

Engine engine_of(const RunOptions& options, const Laws& laws) {
  if (options.engine == "rd") return run_retroactive;
  if (options.engine == "ca") return run_advancement;
  if (options.engine == "ordered") return run_ordered;
  if (options.engine == "tw") {
    if (laws.scheduling) return run_taught_timewarp;
    if (options.timewarp) return options.timewarp;
    throw UserError("--engine tw", "nobody has written a scheduler for it: that is assignment a4",
                    "use rd or ca, or run with a module that has one");
  }
  std::string known;
  std::vector<std::string> words;
  for (const auto& [word, meaning] : engine_words()) {
    known += (known.empty() ? "" : ", ") + word + " (" + meaning + ")";
    words.push_back(word);
  }
  throw UserError("--engine " + options.engine,
                  "there is no engine of that name." + did_you_mean(options.engine, words),
                  "Use one of these: " + known + ".");
}

// What a callback sees and may do is the same in every engine: places of the world, of which none
// is moved; and what goes wrong names it and the body.
std::vector<Callback> guarded_callbacks(const std::vector<Callback>& callbacks,
                                        const scene::Scene& scene, const Vector3d& origin_world) {
  std::vector<Callback> all = callbacks;
  for (Callback& callback : all)
    callback.act = [act = callback.act, time = callback.time, &scene, origin_world](
                       int body, RigidBodyState& state) {
      const auto who = [&] {
        return fmt::format("body '{}': the callback at {:.6g} s",
                           scene.bodies[static_cast<std::size_t>(body)].name, time);
      };
      RigidBodyState seen = state;
      seen.com_world += origin_world;
      try {
        act(body, seen);
      } catch (const std::exception& error) {
        throw StoppedRun(who() + " failed: " + error.what());
      }
      state.momentum_world = seen.momentum_world;
      state.angular_momentum_world = seen.angular_momentum_world;
      if (!pack(state).allFinite())
        throw StoppedRun(who() + " gave it a state that is not a number");
    };
  return all;
}

// moving bodies apart turns nothing, so that one shift does where contacts are flat
constexpr int kMostBeginnings = 20;

/// Runs the engine. Where bodies overlap at the start by no more than the rounding of what a scene
/// says, they are moved apart, the run begins again, and `watch` tells of it.
void run_from_apart(const Engine& engine, const scene::Scene& scene, const Laws& laws,
                    const RunOptions& options, StartWatch& watch, TrajectorySink& sink) {
  scene::Scene apart;
  const scene::Scene* now = &scene;
  for (int beginning = 0; beginning < kMostBeginnings; ++beginning) {
    try {
      return engine(*now, laws, options, sink);
    } catch (const OverlapAtStart& overlap) {
      auto moved = overlap.is_explained() ? moved_apart(*now, overlap.near()) : std::nullopt;
      if (!moved || beginning + 1 == kMostBeginnings) throw;
      // the first shift is what the scene's places are off by
      if (beginning == 0) watch.add(moved->notice);
      apart = std::move(moved->scene);
      now = &apart;
    }
  }
}

}  // namespace

const std::vector<std::pair<std::string, std::string>>& engine_words() {
  static const std::vector<std::pair<std::string, std::string>> words = {
      {"rd", "retroactive detection with fixed step"},
      {"ca", "conservative advancement"},
      {"tw", "timewarp"},
      {"ordered", "one event after the other, the reference"}};
  return words;
}

void run_scene(const scene::Scene& scene, const Laws& laws, const RunOptions& asked,
               TrajectorySink& sink) {
  if (scene.coordinates == scene::Coordinates::kAutomatic)
    return run_scene(in_chosen_coordinates(scene, laws), laws, asked, sink);
  if (!scene.gives_rest_speed) return run_scene(at_its_rest_speed(scene), laws, asked, sink);
  RunOptions options = asked;
  if (options.engine.empty()) options.engine = scene.engine.empty() ? "rd" : scene.engine;
  const Engine engine = engine_of(options, laws);
  if (!options.propagator.empty() && options.propagator != "laws" && options.propagator != "auto")
    throw UserError("--propagator " + options.propagator,
                    "expected laws (the laws' integration) or auto (closed forms where nothing but "
                    "gravity acts)",
                    "For example --propagator auto.");
  if (options.propagator == "laws" && options.engine != "rd")
    throw UserError("--propagator laws",
                    "--engine " + options.engine + " moves bodies in closed form only",
                    "Use --engine rd to see a method of integration at work.");
  const double step = options.step_s.value_or(scene.step_s),
               duration = options.duration_s.value_or(scene.duration_s);
  if (!(step > 0) || !std::isfinite(step))
    throw UserError(scene.name, "the step must be a positive time", "give \"step_s\" in seconds");
  if (!(duration >= 0) || !std::isfinite(duration))
    throw UserError(scene.name, "the duration must not be negative",
                    "give \"duration_s\" in seconds");
  refuse_endless(scene, step, duration, options.frame_rate_hz);
  if (!(options.frame_rate_hz > 0))
    throw UserError("--frame-rate-hz", "must be positive", "60 suits most scenes");
  check_callbacks(options.callbacks, scene);
  require(!options.hand || options.engine == "rd", "a hand acts in rd only");
  check_laws(scene, laws);

  TrajectoryInfo info;
  info.command = options.command;
  info.scene_name = scene.name;
  info.version = kProgramVersion;
  info.scene_digest = scene.digest;
  info.seeds = scene.seeds;
  info.engine = options.engine;
  info.impulse_source = laws.impulse_source;
  info.integrator_source = laws.integrator_source;
  // A scene without springs, rods and resting contact calls no law of a3.
  if (scene.contact || effects::asks_laws_of("a3", scene))
    info.constraint_source = laws.constraint_source;
  else
    info.constraint_source = "none";
  if (options.engine == "tw") info.scheduling_source = laws.scheduling_source;
  if (!laws.link_solver.empty()) info.constraint_source += ", links by " + laws.link_solver;
  if (!laws.contact_solver.empty())
    info.constraint_source += ", contacts by " + laws.contact_solver;
  for (const std::string& author : effects::authors_of_listed_laws(scene, laws))
    info.constraint_source += ", " + author;
  info.step_s = step;
  info.frame_rate_hz = options.frame_rate_hz;
  std::vector<TrajectoryBody> bodies;
  for (const scene::BodySpec& body : scene.bodies) bodies.push_back({body.name, body.immovable});
  std::set<int> pushed;  // velocities at the start are what a callback has made of them
  for (const Callback& callback : options.callbacks)
    if (callback.time <= 0) pushed.insert(callback.bodies.begin(), callback.bodies.end());
  StartWatch watch(scene, std::move(pushed), sink);
  if (const auto shared = notice_of_shared_forces(scene, laws)) watch.add(*shared);
  if (const auto far = notice_of_far_points(scene)) watch.add(*far);
  if (const auto stretched = notice_of_stretched_links(scene, laws)) watch.add(*stretched);
  DiscontinuityCount counted(watch);
  counted.begin(info, bodies);
  const Vector3d origin_world = local_origin(scene);
  options.callbacks = guarded_callbacks(asked.callbacks, scene, origin_world);
  if (asked.hand)
    options.hand = [&asked, origin_world](const HandMoment& moment) {
      return asked.hand({moment.time, moment.world, moment.states, origin_world});
    };
  if (origin_world.isZero(0.0)) return run_from_apart(engine, scene, laws, options, watch, counted);
  const scene::Scene local = seen_from(origin_world, scene);
  double mass = 0.0;
  const World seen = build_world(local);
  for (const WorldBody& body : seen.bodies)
    if (!body.immovable()) mass += body.inertia.mass;
  WorldSink world(counted, origin_world, mass, seen.gravity_world.value_or(Vector3d::Zero()));
  run_from_apart(engine, local, laws, options, watch, world);
}

}  // namespace tumble::engines
