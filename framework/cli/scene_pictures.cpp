#include "framework/cli/scene_pictures.h"

#include <fmt/format.h>

#include "framework/render/picture.h"
#include "framework/render/virtual_times_chart.h"

namespace tumble::cli {

namespace {

void told(const std::string& file) { fmt::print(stderr, "wrote {}\n", file); }

}  // namespace

void write_chart(const scene::Scene& scene, const Trajectory& run, const RunWords& words) {
  if (words.virtual_times.empty()) return;
  render::ChartOptions chart;
  chart.moves = words.moves;
  chart.to_s = words.chart_until_s.value_or(0.0);
  chart.title = scene.title;
  render::write_virtual_times_chart(words.virtual_times, run.virtual_times, chart);
  told(words.virtual_times);
}

void write_pictures(const Context& context, const scene::Scene& scene, const Trajectory& run,
                    const RunWords& words, const PictureSize& size) {
  render::PictureOptions options;
  options.width = size.width;
  options.height = size.height;
  options.speed = words.speed;
  options.root = context.root;
  if (!words.png.empty()) {
    const double end = run.frames.empty() ? 0.0 : run.frames.back().time;
    render::write_picture(words.png, scene, run, words.at_s < 0 ? end : words.at_s, options);
    told(words.png);
  }
  if (!words.sheet.empty()) {
    render::write_contact_sheet(words.sheet, scene, run, 9, options);
    told(words.sheet);
  }
  if (!words.video.empty()) {
    render::write_video(words.video, scene, run, options);
    told(words.video);
  }
}

}  // namespace tumble::cli
