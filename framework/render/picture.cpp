#include "framework/render/picture.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/render/frame_painter.h"
#include "framework/render/gl_context.h"
#include "framework/render/text.h"
#include "framework/trajectory/record.h"

namespace tumble::render {
namespace {

const PictureOptions& checked(const PictureOptions& options) {
  const auto fits = [](int pixels) { return pixels >= 16 && pixels <= 8192; };
  if (!fits(options.width) || !fits(options.height))
    throw UserError(fmt::format("picture of {} x {}", options.width, options.height),
                    "a side is not between 16 and 8192 pixels", "Choose another size.");
  if (options.samples != 1 && options.samples != 2 && options.samples != 4)
    throw UserError("picture", fmt::format("{} samples per pixel", options.samples),
                    "Choose 1, 2 or 4.");
  return options;
}

// Width of the line between views side by side [pixels].
constexpr int kSeam = 2;

}  // namespace

void expect_pictures() {
  make_gl_context();
  const TextWriter fonts;
}

FramePainter::FramePainter(const scene::Scene& scene, const Trajectory& run,
                           const PictureOptions& options, std::string label, Words words)
    : scene_(scene),
      run_(run),
      options_(checked(options)),
      label_(std::move(label)),
      words_(words),
      stage_(scene, run, options_),
      painter_(make_gl_context(options.gl), stage_.geometries(), options.width, options.height,
               options.samples) {}

FramePainter::Wordless FramePainter::paint_wordless(std::size_t frame) {
  Wordless painted{frame, stage_.moment(frame), {}};
  painted.image = painter_.paint(painted.moment.drawing);
  return painted;
}

FramePainter::Wordless FramePainter::paint_wordless(std::size_t frame, const FramePainter& other,
                                                    const Wordless& drawn) {
  Wordless painted{frame, stage_.moment(frame), {}};
  const bool is_same = painted.moment.drawing == drawn.moment.drawing &&
                       stage_.geometries() == other.stage_.geometries();
  painted.image = is_same ? drawn.image : painter_.paint(painted.moment.drawing);
  return painted;
}

Image FramePainter::with_words(Wordless painted) const {
  if (options_.captions)
    write_captions(painted.image, writer_, scene_, run_, stage_, painted.frame, painted.moment,
                   label_, words_);
  return std::move(painted.image);
}

std::vector<std::unique_ptr<FramePainter>> painters_side_by_side(
    const scene::Scene& scene, const std::vector<LabelledRun>& runs,
    const PictureOptions& options) {
  std::vector<std::unique_ptr<FramePainter>> painters;
  CommonScale common;
  for (const LabelledRun& run : runs) {
    painters.push_back(std::make_unique<FramePainter>(scene, run.trajectory, options, run.label));
    common.include(painters.back()->scale());
  }
  for (const auto& painter : painters) painter->set_scale(common);
  return painters;
}

ImageNotes notes_of(const scene::Scene& scene, const Trajectory& run, double time_s) {
  return {{"Title", scene.title.empty() ? scene.name : scene.title},
          {"Scene", run.info.scene_name},
          {"Scene digest", run.info.scene_digest},
          {"Record", record_of(run.info)},
          {"Engine", run.info.engine},
          {"Step", fmt::format("{:.17g} s", run.info.step_s)},
          {"Time", fmt::format("{:.17g} s", time_s)},
          {"Software", "Tumble " + run.info.version}};
}

Image make_picture(const scene::Scene& scene, const Trajectory& run, double time_s,
                   const PictureOptions& options) {
  return FramePainter(scene, run, options).paint_at(time_s);
}

void write_picture(const std::filesystem::path& png, const scene::Scene& scene,
                   const Trajectory& run, double time_s, const PictureOptions& options) {
  FramePainter painter(scene, run, options);
  write_png(png, painter.paint_at(time_s), notes_of(scene, run, painter.drawn_s(time_s)));
}

void write_contact_sheet(const std::filesystem::path& png, const scene::Scene& scene,
                         const Trajectory& run, int count, const PictureOptions& options) {
  if (count < 1 || count > 100)
    throw UserError(png.string(), fmt::format("a sheet of {} pictures", count), "Choose 1 to 100.");
  PictureOptions half = options;
  half.width = options.width / 2;
  half.height = options.height / 2;
  FramePainter painter(scene, run, half, "", Words::kTimeOnly);
  const int columns = static_cast<int>(std::ceil(std::sqrt(count))),
            rows = (count + columns - 1) / columns;
  Image sheet(columns * half.width + (columns - 1) * kSeam,
              rows * half.height + (rows - 1) * kSeam);
  for (int i = 0; i < count; ++i) {
    const double time = count == 1 ? painter.end_s() : painter.end_s() * i / (count - 1);
    paste(painter.paint_at(time), (i % columns) * (half.width + kSeam),
          (i / columns) * (half.height + kSeam), sheet);
  }
  write_png(png, sheet, notes_of(scene, run, 0.0));
}

void write_side_by_side_picture(const std::filesystem::path& png, const scene::Scene& scene,
                                const std::vector<LabelledRun>& runs, double time_s,
                                const PictureOptions& options) {
  if (runs.empty()) throw UserError(png.string(), "there is no run to draw", "Give at least one.");
  Image whole(
      static_cast<int>(runs.size()) * options.width + (static_cast<int>(runs.size()) - 1) * kSeam,
      options.height);
  const auto painters = painters_side_by_side(scene, runs, options);
  for (std::size_t i = 0; i < runs.size(); ++i)
    paste(painters[i]->paint_at(time_s), static_cast<int>(i) * (options.width + kSeam), 0, whole);
  // The file has the provenance of the first run.
  write_png(png, whole,
            notes_of(scene, runs.front().trajectory, painters.front()->drawn_s(time_s)));
}

double distance_of_views(const Image& both) {
  // titles of two lines and the label above, what the picture shows in two lines below
  const int top = both.height / 5, bottom = both.height - both.height / 8;
  Image left((both.width - kSeam) / 2, bottom - top), right = left;
  for (int y = top; y < bottom; ++y) {
    const std::size_t row = static_cast<std::size_t>(left.width) * 3;
    std::copy_n(both.pixel(0, y), row, left.pixel(0, y - top));
    std::copy_n(both.pixel(both.width - left.width, y), row, right.pixel(0, y - top));
  }
  return colour_distance(left, right);
}

double telling_instant(const Trajectory& run) {
  if (run.frames.empty()) return 0.0;
  const double end = run.frames.back().time;
  const Event* strongest = nullptr;
  for (const Event& event : run.events)
    if (event.kind == EventKind::kCollision && (!strongest || event.impulse > strongest->impulse))
      strongest = &event;
  // Two frames later the bodies have visibly rebounded, and the flash of the impact is still shown.
  const double frame =
      run.frames.size() > 1 ? end / static_cast<double>(run.frames.size() - 1) : 0.0;
  return strongest ? std::min(end, strongest->time + 2 * frame) : end / 3;
}

}  // namespace tumble::render
