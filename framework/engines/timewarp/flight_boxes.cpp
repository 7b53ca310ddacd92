#include "framework/engines/timewarp/flight_boxes.h"

#include "framework/engines/base/tolerances.h"

namespace tumble::engines {
namespace {

// Box of a body whose centre of mass stays between `low` and `high`, up to `bulge` beyond.
Box with_margin(double radius, const Vector3d& bulge, const Vector3d& way, const Vector3d& first,
                const Vector3d& last, const Vector3d& low, const Vector3d& high) {
  const Vector3d margin = bulge + Vector3d::Constant(radius * (1 + kNegligible)) +
                          kNegligible * way +
                          kCoordinateRounding * (first.cwiseAbs() + last.cwiseAbs());
  return {low - margin, high + margin};
}

}  // namespace

// A parabola deviates from the box of its end points by at most a s^2 / 8; a rotating body stays in
// its bounding ball.
Box swept_box(const FlightWorld& world, int body, const Flight& flight, double from, double to) {
  if (flight.segment >= 0) {
    Box way;
    world.extend_by_path(body, flight, from, to, way.low, way.high);
    return with_margin(world.radius(body), Vector3d::Zero(), way.high - way.low, way.low, way.high,
                       way.low, way.high);
  }
  const double s = to - from;
  const Vector3d first = world.position(body, flight, from),
                 last = world.position(body, flight, to);
  return with_margin(world.radius(body), world.acceleration(body, flight).cwiseAbs() * (s * s / 8),
                     (last - first).cwiseAbs(), first, last, first.cwiseMin(last),
                     first.cwiseMax(last));
}

Box box_of_immovable(const FlightWorld& world, int body, double duration) {
  const Box box = box_around(world.shape(body), world.first_flight(body).world_from_body);
  if (world.is_half_space(body)) return box;
  const scene::PrescribedMotion& m = world.world().bodies[static_cast<std::size_t>(body)].motion;
  const Vector3d start = world.first_flight(body).com_world,
                 end = start + m.velocity_m_s * duration;
  const Vector3d reach =
      m.amplitude_m.cwiseAbs() + Vector3d::Constant(kNegligible * world.radius(body));
  return {start.cwiseMin(end) + box.low - reach, start.cwiseMax(end) + box.high + reach};
}

}  // namespace tumble::engines
