#include <algorithm>
#include <cmath>
#include <future>
#include <memory>
#include <optional>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/render/frame_painter.h"
#include "framework/render/picture.h"
#include "framework/render/video_writer.h"
#include "framework/trajectory/record.h"

namespace tumble::render {
namespace {

constexpr int kViewSeam = 2;  // width of the line between views side by side [pixels]

// A rendered picture of one view.
struct Part {
  std::size_t view;
  FramePainter::Wordless painted;
};

// Instants of the run for the frames of a video; the last one is held long enough to be seen.
std::vector<double> instants(double end_s, const PictureOptions& options) {
  if (!(options.video_rate_hz > 0) || !(options.speed > 0))
    throw UserError("video", "the rate and the speed must be above 0", "Choose positive values.");
  std::vector<double> times;
  const double step = options.speed / options.video_rate_hz;
  const auto count = static_cast<std::size_t>(std::floor(end_s / step + 1e-9)) + 1;
  for (std::size_t i = 0; i < count; ++i) times.push_back(static_cast<double>(i) * step);
  times.insert(times.end(), static_cast<std::size_t>(std::ceil(options.video_rate_hz / 2)), end_s);
  return times;
}

}  // namespace

void expect_video(const std::filesystem::path& mp4) {
  expect_pictures();
  expect_ffmpeg(mp4);
}

void write_side_by_side_video(const std::filesystem::path& mp4, const scene::Scene& scene,
                              const std::vector<LabelledRun>& runs, const PictureOptions& options) {
  if (runs.empty()) throw UserError(mp4.string(), "there is no run to draw", "Give at least one.");
  const auto painters = painters_side_by_side(scene, runs, options);
  double end = 0.0;
  for (const auto& painter : painters) end = std::max(end, painter->end_s());
  const int count = static_cast<int>(runs.size());
  Image whole(count * options.width + (count - 1) * kViewSeam, options.height);
  make_whole(mp4, [&](const std::filesystem::path& draft) {
    VideoWriter video(draft, whole.width, whole.height, options.video_rate_hz, options.video_crf,
                      record_of(runs.front().trajectory.info));
    std::vector<std::optional<std::size_t>> shown(painters.size());  // frame
    // writes the text of the previous picture and encodes it while this one is rendered
    std::future<void> before;
    for (const double time : instants(end, options)) {
      std::vector<Part> fresh;  // a view without changes is kept
      for (std::size_t i = 0; i < painters.size(); ++i) {
        const std::size_t frame = painters[i]->frame_at(time);
        if (shown[i] == frame) continue;
        shown[i] = frame;
        fresh.push_back({i, fresh.empty()
                                ? painters[i]->paint_wordless(frame)
                                : painters[i]->paint_wordless(frame, *painters[fresh[0].view],
                                                              fresh[0].painted)});
      }
      if (before.valid()) before.get();
      before = std::async(std::launch::async, [&, fresh = std::move(fresh)]() mutable {
        for (Part& part : fresh)
          paste(painters[part.view]->with_words(std::move(part.painted)),
                static_cast<int>(part.view) * (options.width + kViewSeam), 0, whole);
        video.add(whole);
      });
    }
    if (before.valid()) before.get();
    video.finish();
  });
}

void write_video(const std::filesystem::path& mp4, const scene::Scene& scene, const Trajectory& run,
                 const PictureOptions& options) {
  write_side_by_side_video(mp4, scene, {{run, ""}}, options);
}

}  // namespace tumble::render
