#include "framework/render/captions.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace tumble::render {
namespace {

std::string engine_name(const std::string& id) {
  if (id == "rd") return "retroactive detection";
  if (id == "ca") return "conservative advancement";
  if (id == "tw") return "timewarp";
  return id.empty() ? "unknown engine" : id;
}

// 1/60 reads better than 0.0166667.
std::string step_text(double step_s) {
  const double per_second = step_s > 0.0 ? 1.0 / step_s : 0.0;
  const bool is_fraction = per_second >= 2.0 && std::abs(per_second - std::round(per_second)) < 1e-6 * per_second;
  return is_fraction ? fmt::format("1/{:.0f} s", per_second) : fmt::format("{:g} s", step_s);
}

std::string made_by(const TrajectoryInfo& info) {
  std::string text = engine_name(info.engine) + ", step " + step_text(info.step_s);
  if (!info.impulse_source.empty() && info.impulse_source != "none") text += " · impulses: " + info.impulse_source;
  if (!info.integrator_source.empty() && info.integrator_source != "none") text += " · motion: " + info.integrator_source;
  return text;
}

}  // namespace

void write_captions(Image& image, const TextWriter& writer, const scene::Scene& scene, const Trajectory& run, const Stage& stage,
                    std::size_t frame, const Moment& moment, const std::string& label, Words words) {
  const double w = image.width, h = image.height;
  const double unit = std::min(w / 640.0, h / 480.0);           // sizes are for 640 x 480
  const double margin = 14.0 * unit, small = std::max(11.0 * unit, 9.5), large = std::max(17.0 * unit, 11.0);
  for (const Label& place : moment.labels)
    if (const auto at = project(moment.drawing.view, image.width, image.height, place.point_world))
      writer.write(image, place.text, at->x(), at->y() + 1.5 * small + place.drop_pixels, small * 1.08, kDark, Align::kCentre, true);

  const std::string time = fmt::format("t = {:.2f} s", run.frames[frame].time);
  writer.write(image, time, margin, h - margin, words == Words::kAll ? 15.0 * unit : small, kDark, Align::kLeft, true);
  if (words == Words::kTimeOnly) return;

  double label_width = 0.0;
  if (!label.empty()) {
    label_width = writer.width(label, large * 0.9, true) + margin;
    writer.write(image, label, w - margin, margin + large * 0.8, large * 0.9, kDark, Align::kRight, true);
  }
  const std::string& title = scene.title.empty() ? scene.name : scene.title;
  writer.write(image, writer.fitted(title, large, w - 2 * margin - label_width, true), margin, margin + large * 0.8, large, kDark, Align::kLeft, true);

  std::string right = made_by(run.info);
  if (stage.grid_spacing_m() > 0.0 && !stage.has_scale_bar()) right = fmt::format("grid {:g} m · ", stage.grid_spacing_m()) + right;
  const double room = w - 3 * margin - writer.width(time, 15.0 * unit, true);
  writer.write(image, writer.fitted(right, small, room), w - margin, h - margin, small, kSoft, Align::kRight);

  if (!run.stopped_by.empty() && frame + 1 == run.frames.size())
    writer.write(image, writer.fitted("stopped: " + run.stopped_by, small * 1.15, w - 2 * margin, true), margin, h - margin - 22.0 * unit, small * 1.15,
                 kAlarm, Align::kLeft, true);
}

}  // namespace tumble::render
