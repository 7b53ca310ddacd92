// Measures of springs, rods, joints and contacts. Lengths and gaps are computed from the positions
// of the bodies alone, so that an engine is not judged by its own claims.
#include <algorithm>

#include <fmt/format.h>

#include "framework/core/numbers.h"
#include "framework/effects/registry.h"
#include "framework/engines/judging/measures.h"

namespace tumble::engines {
namespace {

/// The error relative to the expected value; absolute where that is 0.
double relative_error(double found, double expected) {
  return std::abs(found - expected) / (expected == 0.0 ? 1.0 : std::abs(expected));
}

template <class Link>
const double* force_in(const std::vector<Link>& links, const std::vector<double>& forces,
                       const std::string& name) {
  for (std::size_t i = 0; i < std::min(links.size(), forces.size()); ++i)
    if (links[i].name == name) return &forces[i];
  return nullptr;
}

}  // namespace

Finding link_error(const effects::Effect& effect, const CheckSpec& check, const Scene& scene,
                   const Trajectory& run) {
  Finding finding{-kInfinity, "there is no such " + effect.name()};
  const std::vector<scene::Link> links = effect.links(scene);
  for (const Frame& frame : run.frames) {
    const auto pose_of = [&](const std::string& body) {
      return body.empty() ? nullptr : &frame.poses[static_cast<std::size_t>(index_of(body, run))];
    };
    for (std::size_t k = 0; k < links.size(); ++k) {
      if (!check.link.empty() && links[k].name != check.link) continue;
      const auto [error, found] = effect.error_of(check.kind, scene, k, pose_of);
      finding.worst(error, found + " " + at_time(frame.time));
    }
  }
  // without anything to judge the check fails
  if (finding.value == -kInfinity) finding.value = kInfinity;
  return finding;
}

Finding link_force(const CheckSpec& check, const Scene& scene, const Trajectory& run) {
  const Frame* frame = frame_at(check.at_s, run);
  if (frame == nullptr)
    return {kInfinity, fmt::format("no frame was recorded {}", at_time(check.at_s))};
  const double* found = nullptr;
  for (const effects::Effect* effect : effects::all())
    if (const auto kept = effect->measured_as(); kept && found == nullptr)
      found = force_in(effect->links(scene), frame->*kept, check.link);
  if (found == nullptr) return {kInfinity, fmt::format("the run has no force of '{}'", check.link)};
  Finding finding;
  finding.worst(relative_error(*found, check.expected[0]),
                fmt::format("{:.9g} N, expected {:.9g} N, {}", *found, check.expected[0],
                            at_time(frame->time)));
  return finding;
}

Finding reaction(const CheckSpec& check, const Scene&, const Trajectory& run) {
  const Frame* frame = frame_at(check.at_s, run);
  if (frame == nullptr)
    return {kInfinity, fmt::format("no frame was recorded {}", at_time(check.at_s))};
  const int body = index_of(check.body, run),
            other = check.other.empty() ? -1 : index_of(check.other, run);
  Vector3d force_world = Vector3d::Zero();
  int points = 0;
  for (const ContactPoint& contact : frame->contacts) {
    const bool is_a = contact.body_a == body, is_b = contact.body_b == body;
    if ((!is_a && !is_b) || (other >= 0 && (is_a ? contact.body_b : contact.body_a) != other))
      continue;
    force_world += (is_a ? 1.0 : -1.0) * contact.force_on_a_world;
    ++points;
  }
  const double found = check.axis->dot(force_world);
  Finding finding;
  finding.worst(relative_error(found, check.expected[0]),
                fmt::format("{:.9g} N in {} points, expected {:.9g} N, {}", found, points,
                            check.expected[0], at_time(frame->time)));
  return finding;
}

}  // namespace tumble::engines
