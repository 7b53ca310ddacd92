#include "framework/engines/contact/normal_watch.h"

#include <cmath>

#include <fmt/format.h>

namespace tumble::engines {

void watch_normal(double t, const MeetingBodies& bodies, const collision::Gap& gap,
                  RunWatch& watch) {
  if (watch.has_said(kNormalOfImpact, t)) return;
  const auto other =
      collision::other_normal(bodies.shape_a, bodies.pose_a, bodies.shape_b, bodies.pose_b, gap);
  if (!other) return;
  const auto words = [](const Vector3d& n) {
    constexpr double kZero = 1e-9;  // a rounding is not to be read
    const auto part = [&](double x) { return std::abs(x) < kZero ? 0.0 : x; };
    return fmt::format("({:.3g}, {:.3g}, {:.3g})", part(n.x()), part(n.y()), part(n.z()));
  };
  watch.say(
      kNormalOfImpact, t,
      fmt::format("at t = {:.6g} s '{}' meets '{}' corner on corner, or edge on parallel "
                  "edge: more than one normal keeps them apart there. The impact acts along "
                  "{}, and {} would do as well: a rounding decides, and what is symmetric "
                  "does not stay so",
                  t, bodies.a.name, bodies.b.name, words(gap.normal_b_to_a_world), words(*other)));
}

}  // namespace tumble::engines
