// Marks of a drawing: impulses, forces, paths, the scale bar of the grid.
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "framework/render/path.h"
#include "framework/render/stage.h"
#include "framework/render/stage_geometries.h"
#include "framework/render/surfaces.h"

namespace tumble::render {
namespace {

// of video: about seven frames, long enough to be noticed
constexpr double kFlashSeconds = 0.22;
// s of video after a force has ended, for forces shorter than a frame
constexpr double kForceLinger = 0.12;
constexpr std::size_t kMaxFlashes = 40;  // the latest; more would hide the bodies
constexpr std::size_t kMaxPaths = 6;     // moving bodies; more paths would be confusing
// of a body's path: the last ones; all of a longer path would cover the picture, and take its time
constexpr std::ptrdiff_t kMaxPathPieces = 1000;
// pixels at the camera's target: no frame is farther than half a pixel from its path
constexpr double kPathSlack = 0.3;
const Vector3d kImpulseColor(0.72, 0.10, 0.01);
const Vector3d kFlashColor(1.0, 0.78, 0.22);
const Vector3d kForceColor(0.45, 0.02, 0.20);
constexpr double kSheetReach = 2.6;  // of the sight
constexpr double kSheetOpacity = 0.35;
const Vector3d kBarColor(0.03, 0.05, 0.07);

}  // namespace

// The bar lies between two lines of the grid, at the lower left of the picture, where no immovable
// body occludes it.
void Stage::place_scale_bar() {
  scale_bar_m_ = 0.0;
  if (!ground_.shown || ground_.spacing_m <= 0.0 || followed_ >= 0 || !options_.captions) return;
  const View view = view_of(scene_.camera);
  const double w = options_.width, h = options_.height, step = ground_.spacing_m;
  const Vector2d wanted(0.22 * w, 0.80 * h);
  const auto is_seen = [&](const Vector3d& point) {
    for (std::size_t i = 0; i < actors_.size(); ++i)
      if (actors_[i].immovable &&
          hides(surface(actors_[i]), run_.frames.front().poses[i], view.eye_world, point))
        return false;
    return true;
  };
  double best = std::numeric_limits<double>::infinity();
  const double ci = std::round(scene_.camera.target_m.x() / step),
               cj = std::round(scene_.camera.target_m.y() / step);
  for (int i = -30; i <= 30; ++i) {
    for (int j = -30; j <= 30; ++j) {
      const Vector3d from((ci + i) * step, (cj + j) * step, ground_.height_m),
          to = from + Vector3d(step, 0, 0);
      const auto a = project(view, options_.width, options_.height, from),
                 b = project(view, options_.width, options_.height, to);
      if (!a || !b || (*a - *b).norm() < 0.045 * w) continue;
      const bool inside =
          std::min(a->x(), b->x()) > 0.04 * w && std::max(a->x(), b->x()) < 0.96 * w &&
          std::min(a->y(), b->y()) > 0.15 * h && std::max(a->y(), b->y()) < 0.86 * h;
      const double distance = (0.5 * (*a + *b) - wanted).norm();
      if (!inside || distance >= best || !is_seen(from) || !is_seen(0.5 * (from + to)) ||
          !is_seen(to))
        continue;
      best = distance;
      scale_bar_from_ = from;
      scale_bar_m_ = step;
    }
  }
}

void Stage::add_scale_bar(Moment& moment) const {
  if (scale_bar_m_ <= 0.0) return;
  const Vector3d lift(0, 0, 2e-3 * sight_m());
  const Vector3d from = scale_bar_from_ + lift, to = from + Vector3d(scale_bar_m_, 0, 0);
  const double width = 1.6 * metres_per_pixel(moment.drawing.view, options_.height, from);
  const Vector3d tick(0, 3.5 * width, 0);
  const auto line = [&](const Vector3d& a, const Vector3d& b) {
    return laid_between(moment.drawing.from_origin(a), moment.drawing.from_origin(b), width,
                        kBarColor);
  };
  Batch bar{kTube, Pass::kLine, {}};
  bar.instances = {line(from, to), line(from - tick, from + tick), line(to - tick, to + tick)};
  moment.drawing.batches.push_back(bar);
  const auto a = project(moment.drawing.view, options_.width, options_.height, from),
             b = project(moment.drawing.view, options_.width, options_.height, to);
  // The text of a slanting bar is placed below its lower end.
  const double slant = a && b ? 0.5 * std::abs(a->y() - b->y()) : 0.0;
  moment.labels.push_back({0.5 * (from + to), fmt::format("{:g} m", scale_bar_m_), slant});
}

void Stage::find_paths() {
  if (!options_.paths) return;
  std::vector<std::size_t> moving;
  for (std::size_t i = 0; i < actors_.size(); ++i)
    if (!actors_[i].immovable) moving.push_back(i);
  if (moving.size() > kMaxPaths) return;
  const double slack = kPathSlack * metres_per_pixel(view_of(scene_.camera), options_.height,
                                                     scene_.camera.target_m);
  for (const std::size_t i : moving) paths_.push_back({i, path_frames(run_, i, slack)});
}

void Stage::add_paths(std::size_t last, Drawing& drawing) const {
  const double width =
      0.9 * metres_per_pixel(drawing.view, options_.height,
                             drawing.view.eye_world + sight_m() * drawing.view.forward_world);
  Batch pieces{kTube, Pass::kLine, {}};
  for (const Path& path : paths_) {
    const auto place = [&](std::size_t frame) -> const Vector3d& {
      return run_.frames[frame].poses[path.body].com_world;
    };
    std::size_t tip = last;  // the last finite frame
    while (tip > 0 && !place(tip).allFinite()) --tip;
    auto end = std::lower_bound(path.frames.begin(), path.frames.end(), tip);
    if (end == path.frames.begin()) continue;
    std::vector<std::size_t> shown(end - std::min(kMaxPathPieces, end - path.frames.begin()), end);
    shown.push_back(tip);
    for (std::size_t k = 1; k < shown.size(); ++k) {
      const Vector3d from = drawing.from_origin(place(shown[k - 1])),
                     to = drawing.from_origin(place(shown[k]));
      if (!((to - from).norm() > 0.0)) continue;
      pieces.instances.push_back(
          laid_between(from, to, width, 0.75 * actors_[path.body].color, 0.55));
    }
  }
  if (!pieces.instances.empty()) drawing.batches.push_back(std::move(pieces));
}

void Stage::add_impacts(const Frame& frame, Drawing& drawing) const {
  const double life = kFlashSeconds * options_.speed;
  Batch flashes{kBall + ball_level(6.0 * options_.height / 480.0), Pass::kMark, {}},
      arrows{kArrow, Pass::kMark, {}};
  const auto add_arrow = [&](const Event& event, int body, double sign, double opacity) {
    const Actor& actor = actors_[static_cast<std::size_t>(body)];
    if (actor.immovable) return;
    const double strength =
        scale_.strongest_impulse > 0.0 ? std::sqrt(event.impulse / scale_.strongest_impulse) : 1.0;
    const double length = strength * std::min(0.17 * sight_m(), 2.6 * actor.radius_m);
    if (!(length > 4e-3 * sight_m())) return;
    const Vector3d tip = event.point_world + sign * length * event.normal_b_to_a_world;
    arrows.instances.push_back(laid_between(drawing.from_origin(event.point_world),
                                            drawing.from_origin(tip), length, kImpulseColor,
                                            opacity));
  };
  for (auto event = run_.events.rbegin();
       event != run_.events.rend() && flashes.instances.size() < kMaxFlashes; ++event) {
    const double age = frame.time - event->time;
    if (event->kind != EventKind::kCollision || age < -1e-9) continue;
    if (age >= life) break;  // events are in order of time
    const double opacity = 1.0 - std::max(0.0, age) / life;
    const double pixel = metres_per_pixel(drawing.view, options_.height, event->point_world);
    if (!(pixel > 0.0) || !(event->impulse > 0.0)) continue;
    const double radius = (2.5 + 3.5 * (1.0 - opacity)) * pixel * options_.height / 480.0;
    flashes.instances.push_back(placed(drawing.from_origin(event->point_world),
                                       Eigen::Matrix3d::Identity(), Vector3d::Constant(radius),
                                       kFlashColor, 0.9 * opacity));
    add_arrow(*event, event->body_a, 1.0, opacity);
    if (event->body_b >= 0) add_arrow(*event, event->body_b, -1.0, opacity);
  }
  for (Batch* batch : {&arrows, &flashes})
    if (!batch->instances.empty()) drawing.batches.push_back(std::move(*batch));
}

// So wide that its edges are far beyond what is looked at.
void Stage::add_sheets(Drawing& drawing) const {
  if (drawables_.sheets.empty()) return;
  const double half = kSheetReach * sight_m();
  Batch sheets{kPlate, Pass::kGlass, {}};
  for (const effects::DrawnSheet& sheet : drawables_.sheets) {
    const Vector3d middle(scene_.camera.target_m.x(), scene_.camera.target_m.y(), sheet.height_m);
    sheets.instances.push_back(placed(drawing.from_origin(middle), Eigen::Matrix3d::Identity(),
                                      Vector3d(half, half, 1.0), sheet.color, kSheetOpacity));
  }
  drawing.batches.push_back(std::move(sheets));
}

// A force is an arrow with its head at the point of application, which moves with the body.
void Stage::add_forces(const Frame& frame, Moment& moment) const {
  double strongest = 0.0;
  for (const effects::DrawnArrow& force : drawables_.arrows)
    strongest = std::max(strongest, force.force_world.norm());
  Batch arrows{kArrow, Pass::kMark, {}};
  for (const effects::DrawnArrow& force : drawables_.arrows) {
    const double end = force.start_s + force.duration_s + kForceLinger * options_.speed;
    if (frame.time < force.start_s - 1e-9 || frame.time > end || !(force.force_world.norm() > 0.0))
      continue;
    const auto body = std::find_if(scene_.bodies.begin(), scene_.bodies.end(),
                                   [&](const auto& spec) { return spec.name == force.body; });
    if (body == scene_.bodies.end()) continue;
    const auto index = static_cast<std::size_t>(body - scene_.bodies.begin());
    const BodyPose& then = run_.frames[frame_at(force.start_s)].poses[index];
    const BodyPose& now = frame.poses[index];
    const Vector3d tip =
        now.com_world + now.world_from_body * (then.world_from_body.conjugate() *
                                               (force.point_world - then.com_world));
    const double length = 0.17 * sight_m() * std::sqrt(force.force_world.norm() / strongest);
    const Vector3d tail = tip - length * force.force_world.normalized();
    arrows.instances.push_back(laid_between(moment.drawing.from_origin(tail),
                                            moment.drawing.from_origin(tip), length, kForceColor));
    moment.labels.push_back({tail, fmt::format("{:.3g} N", force.force_world.norm()), 0.0});
  }
  if (!arrows.instances.empty()) moment.drawing.batches.push_back(std::move(arrows));
}

}  // namespace tumble::render
