#include "framework/engines/judging/judge.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/core/numbers.h"
#include "framework/dynamics/world.h"
#include "framework/effects/build_world.h"
#include "framework/effects/registry.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/contact/contact_constants.h"
#include "framework/engines/contact/persistent_contacts.h"
#include "framework/engines/judging/measures.h"

namespace tumble::engines {
namespace {

double total_energy(const Frame& frame) { return frame.kinetic_energy + frame.potential_energy; }

/// The scale of energies: the kinetic energy at the beginning plus the deepest fall of the
/// potential energy from there, which is what the forces could give. The potential energy of the
/// highest frame would not do: a run that creates energy would widen its own tolerance by rising.
/// Neither rising nor moving faster counts here.
double energy_scale(const Frame& first, const Trajectory& run) {
  double fall = 0.0;
  for (const Frame& frame : run.frames)
    if (frame.time >= first.time)
      fall = std::max(fall, first.potential_energy - frame.potential_energy);
  const double scale = first.kinetic_energy + fall;
  return scale == 0.0 ? 1.0 : scale;  // a NaN stays NaN, and fails the check
}

/// What rounding may leave of the energy of a frame. [J]
/// Energy is a sum of terms, m v^2 / 2, w I w / 2, -m g.x, k s^2 / 2. Each is rounded by eps of
/// itself, and changed by as much where a step rounds its position or velocity. The roundings of
/// steps are independent: after N steps they add up to eps sqrt(N) of the terms; kDeviations of it
/// cover every practical run. A stack at rest a hundred metres above the origin has terms of
/// megajoules and no other energy to compare with.
class EnergyRounding {
 public:
  EnergyRounding(const Scene& scene, const Trajectory& run)
      : world_(build_world(scene)),
        step_s_(run.info.step_s > 0 ? run.info.step_s : scene.step_s),
        margin_(run.counters.counts.contains("large_island_steps") ? kContact.large_island_margin
                                                                   : kContact.margin) {}

  double operator()(const Frame& frame) const {
    double terms = frame.kinetic_energy;  // all terms are positive
    for (const effects::Effect* effect : effects::all())
      effect->add_energy_terms(world_, states_of(frame), terms);
    return kDeviations * std::numeric_limits<double>::epsilon() *
               (1.0 + std::sqrt(frame.time / step_s_)) * terms +
           lift(frame);
  }

 private:
  /// Positions only.
  static std::vector<RigidBodyState> states_of(const Frame& frame) {
    std::vector<RigidBodyState> states;
    for (const BodyPose& pose : frame.poses)
      states.push_back({pose.com_world, pose.world_from_body, Vector3d::Zero(), Vector3d::Zero()});
    return states;
  }
  double lift(const Frame& frame) const {
    if (frame.contacts.empty() || !world_.gravity_world) return 0.0;
    std::set<int> in_contact;
    for (const ContactPoint& contact : frame.contacts)
      in_contact.insert({contact.body_a, contact.body_b});
    double sizes = 0.0, weight = 0.0;
    for (const int index : in_contact) {
      const WorldBody& body = world_.bodies[static_cast<std::size_t>(index)];
      if (body.immovable()) continue;
      sizes += bounding_radius(body.shape);
      weight += body.inertia.mass * world_.gravity_world->norm();
    }
    return 2.0 * margin_ * sizes * weight;
  }

  World world_;
  double step_s_;
  double margin_;  // that contacts are kept at, of the bodies' sizes
};

Finding energy(const CheckSpec& check, const Scene& scene, const Trajectory& run) {
  Finding finding;
  const Frame* first = nullptr;
  double scale = kUnset;
  // computed only for a run that would fail without it, because it has to read the models
  std::optional<EnergyRounding> rounding;
  for (const Frame& frame : run.frames) {
    if (frame.time < check.at_s) continue;
    if (first == nullptr) {
      first = &frame;
      scale = energy_scale(*first, run);
    }
    double change = std::abs(total_energy(frame) - total_energy(*first));
    if (change > check.tolerance * scale) {
      if (!rounding) rounding.emplace(scene, run);
      change = std::max(0.0, change - (*rounding)(frame) - (*rounding)(*first));
    }
    finding.worst(change / scale, at_time(frame.time));
  }
  if (first == nullptr) finding.worst(kInfinity, "the run ended before at_s");
  return finding;
}

Finding energy_not_rising(const CheckSpec& check, const Scene& scene, const Trajectory& run) {
  Finding finding;
  double least = kInfinity, scale = kUnset;
  std::optional<EnergyRounding> rounding;  // as above
  if (run.frames.back().time < check.at_s) finding.worst(kInfinity, "the run ended before at_s");
  for (const Frame& frame : run.frames) {
    if (frame.time < check.at_s) continue;
    if (least == kInfinity) scale = energy_scale(frame, run);
    double rise = total_energy(frame) - std::min(least, total_energy(frame));
    if (rise > check.tolerance * scale) {
      if (!rounding) rounding.emplace(scene, run);
      // that of the least energy is of the same size
      rise = std::max(0.0, rise - 2.0 * (*rounding)(frame));
    }
    finding.worst(rise / scale, at_time(frame.time));
    least = std::min(least, total_energy(frame));
  }
  return finding;
}

/// Constancy from at_s on, or the expected value at at_s.
Finding conserved(const CheckSpec& check, const Trajectory& run, Vector3d Frame::*quantity) {
  Finding finding;
  if (!check.expected.empty()) {
    const Frame* frame = frame_at(check.at_s, run);
    if (frame == nullptr)
      return {kInfinity, fmt::format("no frame was recorded {}", at_time(check.at_s))};
    const Vector3d& found = frame->*quantity;
    finding.worst((found - Eigen::Map<const Vector3d>(check.expected.data())).norm(),
                  fmt::format("({:.6g}, {:.6g}, {:.6g}) {}", found.x(), found.y(), found.z(),
                              check.at_s == 0.0 ? "at the end" : at_time(frame->time)));
    return finding;
  }
  const Frame* first = nullptr;
  for (const Frame& frame : run.frames) {
    if (frame.time < check.at_s) continue;
    if (first == nullptr) first = &frame;
    finding.worst((frame.*quantity - first->*quantity).norm(), at_time(frame.time));
  }
  if (first == nullptr) finding.worst(kInfinity, "the run ended before at_s");
  return finding;
}
Finding momentum(const CheckSpec& check, const Scene&, const Trajectory& run) {
  return conserved(check, run, &Frame::momentum_world);
}
Finding angular_momentum(const CheckSpec& check, const Scene&, const Trajectory& run) {
  return conserved(check, run, &Frame::angular_momentum_world);
}

/// By how much the gap of two touching bodies may be below 0: a few roundings of their sizes and
/// positions (gap.h). [m]
double rounding_of_gaps(const Scene& scene, const Trajectory& run) {
  double scale = 0.0;
  for (const WorldBody& body : build_world(scene).bodies)
    if (const double radius = bounding_radius(body.shape); std::isfinite(radius))
      scale = std::max(scale, radius);
  for (const Frame& frame : run.frames)
    for (const BodyPose& pose : frame.poses)
      scale = std::max(scale, pose.com_world.cwiseAbs().maxCoeff());
  return kFewRoundings * std::numeric_limits<double>::epsilon() * scale;
}

Finding gap(const CheckSpec& check, const Scene& scene, const Trajectory& run) {
  Finding finding{kInfinity, "no pair may collide"};
  for (const Frame& frame : run.frames) {
    // NaN is not >=: it is kept
    if (std::isnan(finding.value) || frame.smallest_gap >= finding.value) continue;
    finding = {frame.smallest_gap, at_time(frame.time)};
  }
  if (finding.value < -check.tolerance) finding.rounding = rounding_of_gaps(scene, run);
  return finding;
}

Finding vector_at(const CheckSpec& check, const Trajectory& run, Vector3d BodyPose::*quantity) {
  const Frame* frame = frame_at(check.at_s, run);
  if (frame == nullptr)
    return {kInfinity, fmt::format("no frame was recorded {}", at_time(check.at_s))};
  const Vector3d& found =
      frame->poses[static_cast<std::size_t>(index_of(check.body, run))].*quantity;
  Finding finding;
  finding.worst((found - Eigen::Map<const Vector3d>(check.expected.data())).norm(),
                fmt::format("({:.6g}, {:.6g}, {:.6g}) {}", found.x(), found.y(), found.z(),
                            at_time(frame->time)));
  return finding;
}
Finding final_position(const CheckSpec& check, const Scene&, const Trajectory& run) {
  return vector_at(check, run, &BodyPose::com_world);
}
Finding final_velocity(const CheckSpec& check, const Scene&, const Trajectory& run) {
  return vector_at(check, run, &BodyPose::velocity_world);
}

/// Collisions of the bodies that the check names; all collisions where it names none.
std::vector<const Event*> collisions(const CheckSpec& check, const Trajectory& run) {
  const int body = check.body.empty() ? -1 : index_of(check.body, run);
  const int other = check.other.empty() ? -1 : index_of(check.other, run);
  const auto takes_part = [](const Event& event, int who) {
    return who < 0 || event.body_a == who || event.body_b == who;
  };
  std::vector<const Event*> found;
  for (const Event& event : run.events)
    if (event.kind == EventKind::kCollision && takes_part(event, body) && takes_part(event, other))
      found.push_back(&event);
  return found;
}

Finding impact_times(const CheckSpec& check, const Scene&, const Trajectory& run) {
  const auto impacts = collisions(check, run);
  if (impacts.size() < check.expected.size())
    return {kInfinity, fmt::format("{} impacts, expected {}: the next at {:.6g} s", impacts.size(),
                                   check.expected.size(), check.expected[impacts.size()])};
  Finding finding;
  for (std::size_t i = 0; i < check.expected.size(); ++i)
    finding.worst(std::abs(impacts[i]->time - check.expected[i]),
                  fmt::format("impact {} at {:.9g} s, expected {:.9g} s", i + 1, impacts[i]->time,
                              check.expected[i]));
  return finding;
}

Finding event_count(const CheckSpec& check, const Scene&, const Trajectory& run) {
  const double count = static_cast<double>(collisions(check, run).size());
  return {std::abs(count - check.expected[0]),
          fmt::format("{} collisions, expected {}", count, check.expected[0])};
}

Finding restitution_law(const CheckSpec& check, const Scene& scene, const Trajectory& run) {
  auto events = collisions(check, run);
  // A pair that met without approach got no impulse: the law says nothing about it.
  std::erase_if(events, [](const Event* event) {
    return event->impulse == 0.0 && event->normal_velocity_before == 0.0;
  });
  if (events.empty()) return {kInfinity, "no collision: there is nothing to judge"};
  Finding finding{0.0, fmt::format("all {} collisions", events.size())};
  for (const Event* event : events) {
    const double e = std::min(scene.bodies[static_cast<std::size_t>(event->body_a)].restitution,
                              scene.bodies[static_cast<std::size_t>(event->body_b)].restitution);
    const double before = event->normal_velocity_before;
    // also before a transition to rest, which begins with the next event
    const double wanted = -e * before;
    finding.worst(std::abs(event->normal_velocity_after - wanted) / std::abs(before),
                  fmt::format("{}: {:.6g} m/s before, {:.6g} m/s after, e = {:.6g}",
                              at_time(event->time), before, event->normal_velocity_after, e));
  }
  return finding;
}

Finding side_of_wall(const CheckSpec& check, const Scene&, const Trajectory& run) {
  const auto body = static_cast<std::size_t>(index_of(check.body, run)),
             other = static_cast<std::size_t>(index_of(check.other, run));
  const auto along = [&](const Frame& frame) {
    return check.axis->dot(frame.poses[body].com_world - frame.poses[other].com_world);
  };
  const double side = along(run.frames.front()) < 0 ? -1.0 : 1.0;
  Finding finding{kInfinity, ""};
  for (const Frame& frame : run.frames) {
    const double distance = side * along(frame);
    if (!std::isnan(finding.value) && !(distance >= finding.value))
      finding = {distance, at_time(frame.time)};
  }
  return finding;
}

Finding flips(const CheckSpec& check, const Scene&, const Trajectory& run) {
  const auto body = static_cast<std::size_t>(index_of(check.body, run));
  const Vector3d first = run.frames.front().poses[body].world_from_body * *check.axis;
  int count = 0;
  bool is_over = false;
  std::string times;
  for (const Frame& frame : run.frames) {
    const double cosine = first.dot(frame.poses[body].world_from_body * *check.axis);
    // A body counts as flipped beyond 120 degrees, and as back below 60: oscillation about 90
    // degrees is no flip.
    if (is_over ? cosine > 0.5 : cosine < -0.5) {
      is_over = !is_over;
      ++count;
      times += fmt::format("{}{:.3g}", times.empty() ? "" : ", ", frame.time);
    }
  }
  return {std::abs(count - check.expected[0]),
          fmt::format("{} flips, expected {}{}", count, check.expected[0],
                      times.empty() ? "" : "; at t = " + times + " s")};
}

// value <= tolerance, >= tolerance, >= -tolerance
enum class Right { kAtMost, kAtLeast, kAtLeastMinus };

struct Kind {
  Measure measure;
  std::string unit;
  Right right = Right::kAtMost;
};

std::map<std::string, Kind> with_those_of_effects(std::map<std::string, Kind> table) {
  for (const effects::Effect* effect : effects::all())
    for (const scene::LinkCheck& check : effect->link_checks())
      table[check.kind] = {
          [effect](const CheckSpec& spec, const Scene& scene, const Trajectory& run) {
            return link_error(*effect, spec, scene, run);
          },
          check.unit};
  return table;
}

const std::map<std::string, Kind>& kinds() {
  static const std::map<std::string, Kind> table = with_those_of_effects({
      {"energy", {energy, ""}},
      {"energy_not_rising", {energy_not_rising, ""}},
      {"momentum", {momentum, "kg m/s"}},
      {"angular_momentum", {angular_momentum, "kg m^2/s"}},
      {"gap", {gap, "m", Right::kAtLeastMinus}},
      {"final_position", {final_position, "m"}},
      {"final_velocity", {final_velocity, "m/s"}},
      {"centre_of_mass", {centre_of_mass, "m"}},
      {"impact_times", {impact_times, "s"}},
      {"event_count", {event_count, ""}},
      {"restitution_law", {restitution_law, ""}},
      {"side_of_wall", {side_of_wall, "m", Right::kAtLeastMinus}},
      {"flips", {flips, ""}},
      {"link_force", {link_force, ""}},
      {"reaction", {reaction, ""}},
      {"drift", {drift, "m"}},
      {"tilt", {tilt, "rad"}},
      {"at_rest", {at_rest, "J/kg"}},
      {"distance_travelled", {distance_travelled, "m"}},
      {"angle_at", {angle_at, "rad"}},
      {"stands", {stands, "rad"}},
      {"falls", {falls, "rad", Right::kAtLeast}},
      {"order_of_falls", {order_of_falls, ""}},
  });
  return table;
}

std::string subject_of(const CheckSpec& check) {
  if (!check.link.empty()) return check.link;
  if (!check.bodies.empty()) return check.bodies.front() + " ... " + check.bodies.back();
  if (check.body.empty()) return "all";
  return check.other.empty() ? check.body : check.body + ", " + check.other;
}

CheckResult judge(const CheckSpec& check, const Scene& scene, const Trajectory& run) {
  const auto found = kinds().find(check.kind);
  if (found == kinds().end())
    throw UserError(scene.file.string(), "unknown kind of check '" + check.kind + "'");
  const Kind& kind = found->second;
  const Finding finding = run.frames.empty() ? Finding{kUnset, "the run has no frame"}
                                             : kind.measure(check, scene, run);
  CheckResult result;
  result.kind = check.kind;
  result.subject = subject_of(check);
  result.value = finding.value;
  result.at_least = kind.right != Right::kAtMost;
  result.threshold = kind.right == Right::kAtLeastMinus ? 0.0 - check.tolerance - finding.rounding
                                                        : check.tolerance;
  result.unit = check.unit.empty() ? kind.unit : check.unit;
  // false for NaN
  result.passed =
      result.at_least ? result.value >= result.threshold : result.value <= result.threshold;
  result.why = check.why;
  result.detail = finding.detail;
  return result;
}

// Faults that the run's own watch found are added to the scene's checks.
CheckResult judge(const RunFault& fault) {
  CheckResult result;
  result.kind = fault.kind;
  result.subject = fault.subject;
  result.value = fault.worst;
  result.threshold = fault.allowed;
  result.unit = fault.unit;
  result.passed = false;
  result.why = fault.meaning + ". Likely remedy: " + fault.remedy;
  result.detail = fmt::format("first {}, {} in all, worst {}", at_time(fault.first_s),
                              fault.count == 1 ? "once" : fmt::format("{} times", fault.count),
                              at_time(fault.worst_s));
  return result;
}

}  // namespace

bool is_off_by(const CheckResult& check) {
  static const std::set<std::string> kinds = {
      "flips",          "event_count",        "impact_times", "final_position", "final_velocity",
      "centre_of_mass", "distance_travelled", "angle_at",     "link_force",     "reaction"};
  return kinds.contains(check.kind);
}

void refuse_other_units(const Scene& scene) {
  for (std::size_t i = 0; i < scene.checks.size(); ++i) {
    const CheckSpec& check = scene.checks[i];
    const auto kind = kinds().find(check.kind);
    if (check.unit.empty() || kind == kinds().end()) continue;
    const std::string own = kind->second.unit;
    // An expected force of 0 is compared absolutely, any other relative to itself.
    const bool is_zero = std::all_of(check.expected.begin(), check.expected.end(),
                                     [](double expected) { return expected == 0.0; });
    const bool is_force =
        check.unit == "N" && is_zero && (check.kind == "reaction" || check.kind == "link_force");
    if (check.unit == own || is_force) continue;
    throw UserError(place_of(scene, "/checks/" + std::to_string(i) + "/unit"),
                    "a check of kind '" + check.kind + "' is in " +
                        (own.empty() ? "no unit" : own) + ", not in '" + check.unit +
                        "': nothing is converted",
                    own.empty() ? "Leave \"unit\" out."
                                : "Write its numbers in " + own + ", and leave \"unit\" out.");
  }
}

namespace {

/// Right laws leave roundings of velocities, relative to the kinetic energy before; in long chains
/// of links some 1e-12. Checks every impact of every run; no result where all are right.
std::optional<CheckResult> judge_impacts(const Trajectory& run) {
  const Event* worst = nullptr;
  long wrong = 0;
  for (const Event& event : run.events) {
    if (event.kind != EventKind::kCollision || !(event.energy_excess > kNegligible)) continue;
    ++wrong;
    if (worst == nullptr || event.energy_excess > worst->energy_excess) worst = &event;
  }
  if (worst == nullptr) return std::nullopt;
  const auto name = [&](int body) {
    return body < 0 ? std::string("-") : run.bodies.at(static_cast<std::size_t>(body)).name;
  };
  CheckResult result;
  result.kind = "impact_energy";
  result.subject = name(worst->body_a) + ", " + name(worst->body_b);
  result.value = worst->energy_excess;
  result.threshold = kNegligible;
  result.passed = false;
  result.why =
      "an impact takes from the kinetic energy what restitution and friction say, and never adds "
      "to it; looked at in every run";
  result.detail =
      fmt::format("{}: the kinetic energy changes by {:.6g} J; {} impact{} wrong",
                  at_time(worst->time), worst->energy_change, wrong, wrong == 1 ? " is" : "s are");
  return result;
}

}  // namespace

std::vector<double> instants_of_checks(const scene::Scene& scene) {
  std::vector<double> instants;
  for (const CheckSpec& check : scene.checks)
    if (check.at_s > 0.0) instants.push_back(check.at_s);
  return instants;
}

std::vector<CheckResult> judge_run(const Scene& scene, const Trajectory& run) {
  refuse_other_units(scene);
  std::vector<CheckResult> results;
  for (const CheckSpec& check : scene.checks) results.push_back(judge(check, scene, run));
  if (auto impacts = judge_impacts(run)) results.push_back(std::move(*impacts));
  for (const RunFault& fault : run.counters.faults) results.push_back(judge(fault));
  return results;
}

}  // namespace tumble::engines
