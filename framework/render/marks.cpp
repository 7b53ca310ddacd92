// What a drawing adds to the bodies: impulses, forces, paths, the scale of the grid.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/render/stage.h"
#include "framework/render/stage_geometries.h"
#include "framework/render/surfaces.h"

namespace tumble::render {
namespace {

constexpr double kFlashSeconds = 0.22;       // of video: about seven pictures, long enough to be noticed
constexpr double kForceLinger = 0.12;        // s of video after a push has ended, for pushes shorter than a picture
constexpr std::size_t kMaxFlashes = 40;      // the latest; more would hide the bodies
constexpr std::size_t kMaxPaths = 6;         // moving bodies; the paths of more would be a tangle
constexpr std::size_t kPathSegments = 160;
const Vector3d kImpulseColor(0.72, 0.10, 0.01);
const Vector3d kFlashColor(1.0, 0.78, 0.22);
const Vector3d kForceColor(0.45, 0.02, 0.20);
const Vector3d kBarColor(0.03, 0.05, 0.07);

}  // namespace

void Stage::add_scale_bar(Moment& moment) const {
  if (scale_bar_m_ <= 0.0) return;
  const Vector3d lift(0, 0, 2e-3 * sight_m());
  const Vector3d from = scale_bar_from_ + lift, to = from + Vector3d(scale_bar_m_, 0, 0);
  const double width = 1.6 * metres_per_pixel(moment.drawing.view, options_.height, from);
  const Vector3d tick(0, 3.5 * width, 0);
  Batch bar{kTube, Pass::kLine, {}};
  bar.instances = {laid_between(from, to, width, kBarColor), laid_between(from - tick, from + tick, width, kBarColor),
                   laid_between(to - tick, to + tick, width, kBarColor)};
  moment.drawing.batches.push_back(bar);
  moment.labels.push_back({0.5 * (from + to), fmt::format("{:g} m", scale_bar_m_)});
}

void Stage::add_path(std::size_t last, Drawing& drawing) const {
  std::vector<std::size_t> moving;
  for (std::size_t i = 0; i < actors_.size(); ++i)
    if (!actors_[i].immovable) moving.push_back(i);
  if (moving.empty() || moving.size() > kMaxPaths) return;
  const std::size_t stride = std::max<std::size_t>(1, run_.frames.size() / kPathSegments);
  const double width = 0.9 * metres_per_pixel(drawing.view, options_.height, drawing.view.eye_world + sight_m() * drawing.view.forward_world);
  Batch path{kTube, Pass::kLine, {}};
  for (const std::size_t i : moving) {
    const Vector3d color = 0.75 * actors_[i].color;
    Vector3d from = run_.frames.front().poses[i].com_world;
    for (std::size_t f = stride; f < last + stride; f += stride) {
      const Vector3d to = run_.frames[std::min(f, last)].poses[i].com_world;
      if (!to.allFinite() || !((to - from).norm() > 0.5 * width)) continue;
      path.instances.push_back(laid_between(from, to, width, color, 0.55));
      from = to;
    }
  }
  if (!path.instances.empty()) drawing.batches.push_back(std::move(path));
}

void Stage::add_impacts(const Frame& frame, Drawing& drawing) const {
  const double life = kFlashSeconds * options_.speed;
  Batch flashes{kBall + 1, Pass::kMark, {}}, arrows{kArrow, Pass::kMark, {}};
  const auto add_arrow = [&](const Event& event, int body, double sign, double opacity) {
    const Actor& actor = actors_[static_cast<std::size_t>(body)];
    if (actor.immovable) return;
    const double strength = strongest_impulse_ > 0.0 ? std::sqrt(event.impulse / strongest_impulse_) : 1.0;
    const double length = strength * std::min(0.17 * sight_m(), 2.6 * actor.radius_m);
    if (!(length > 4e-3 * sight_m())) return;
    const Vector3d tip = event.point_world + sign * length * event.normal_b_to_a_world;
    arrows.instances.push_back(laid_between(event.point_world, tip, length, kImpulseColor, opacity));
  };
  for (auto event = run_.events.rbegin(); event != run_.events.rend() && flashes.instances.size() < kMaxFlashes; ++event) {
    const double age = frame.time - event->time;
    if (event->kind != EventKind::kCollision || age < -1e-9) continue;
    if (age >= life) break;   // events are in order of time
    const double opacity = 1.0 - std::max(0.0, age) / life;
    const double pixel = metres_per_pixel(drawing.view, options_.height, event->point_world);
    if (!(pixel > 0.0) || !(event->impulse > 0.0)) continue;
    const double radius = (2.5 + 3.5 * (1.0 - opacity)) * pixel * options_.height / 480.0;
    flashes.instances.push_back(placed(event->point_world, Eigen::Matrix3d::Identity(), Vector3d::Constant(radius), kFlashColor, 0.9 * opacity));
    add_arrow(*event, event->body_a, 1.0, opacity);
    if (event->body_b >= 0) add_arrow(*event, event->body_b, -1.0, opacity);
  }
  for (Batch* batch : {&arrows, &flashes})
    if (!batch->instances.empty()) drawing.batches.push_back(std::move(*batch));
}

// A force is an arrow that pushes: its head at the point, which moves with the body.
void Stage::add_forces(const Frame& frame, Moment& moment) const {
  double strongest = 0.0;
  for (const auto& force : scene_.point_forces) strongest = std::max(strongest, force.force_n.norm());
  Batch arrows{kArrow, Pass::kMark, {}};
  for (const auto& force : scene_.point_forces) {
    const double end = force.start_s + force.duration_s + kForceLinger * options_.speed;
    if (frame.time < force.start_s - 1e-9 || frame.time > end || !(force.force_n.norm() > 0.0)) continue;
    const auto body = std::find_if(scene_.bodies.begin(), scene_.bodies.end(), [&](const auto& spec) { return spec.name == force.body; });
    if (body == scene_.bodies.end()) continue;
    const auto index = static_cast<std::size_t>(body - scene_.bodies.begin());
    const BodyPose& then = run_.frames[frame_at(force.start_s)].poses[index];
    const BodyPose& now = frame.poses[index];
    const Vector3d tip = now.com_world + now.world_from_body * (then.world_from_body.conjugate() * (force.point_m - then.com_world));
    const double length = 0.17 * sight_m() * std::sqrt(force.force_n.norm() / strongest);
    const Vector3d tail = tip - length * force.force_n.normalized();
    arrows.instances.push_back(laid_between(tail, tip, length, kForceColor));
    moment.labels.push_back({tail, fmt::format("{:.3g} N", force.force_n.norm())});
  }
  if (!arrows.instances.empty()) moment.drawing.batches.push_back(std::move(arrows));
}

}  // namespace tumble::render
