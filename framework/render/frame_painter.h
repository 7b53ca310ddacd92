/// Draws a run frame by frame: stage, painter and captions together. Internal to framework/render.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "framework/render/captions.h"
#include "framework/render/image.h"
#include "framework/render/painter.h"
#include "framework/render/stage.h"

namespace tumble::render {

struct LabelledRun;  // picture.h

class FramePainter {
 public:
  /// @throws UserError as make_picture
  FramePainter(const scene::Scene& scene, const Trajectory& run, const PictureOptions& options,
               std::string label = "", Words words = Words::kAll);

  /// A picture without its text, so that rendering and text can run in two threads.
  struct Wordless {
    std::size_t frame;
    Moment moment;
    Image image;
  };

  Image paint(std::size_t frame) { return with_words(paint_wordless(frame)); }
  /// Renders with OpenGL; not to be called concurrently.
  Wordless paint_wordless(std::size_t frame);
  /// The same, without rendering where `drawn`, of `other`, shows the same: as of a right
  /// submission beside the reference.
  Wordless paint_wordless(std::size_t frame, const FramePainter& other, const Wordless& drawn);
  /// May run while the next picture is rendered; not to be called concurrently.
  Image with_words(Wordless painted) const;
  std::size_t frame_at(double time_s) const { return stage_.frame_at(time_s); }
  Image paint_at(double time_s) { return paint(stage_.frame_at(time_s)); }
  /// Time of the frame that is drawn for `time_s`.
  double drawn_s(double time_s) const { return run_.frames[stage_.frame_at(time_s)].time; }
  double end_s() const { return run_.frames.back().time; }
  const CommonScale& scale() const { return stage_.scale(); }
  void set_scale(const CommonScale& scale) { stage_.set_scale(scale); }

 private:
  const scene::Scene& scene_;
  const Trajectory& run_;
  PictureOptions options_;
  std::string label_;
  Words words_;
  Stage stage_;
  Painter painter_;
  TextWriter writer_;
};

/// Painters of views side by side: the same impulse has the same length in all of them, and their
/// grids lie at the same height.
/// @throws UserError as make_picture
std::vector<std::unique_ptr<FramePainter>> painters_side_by_side(
    const scene::Scene& scene, const std::vector<LabelledRun>& runs, const PictureOptions& options);

/// Provenance of this run, for the text chunks of a PNG.
/// @param time_s  of the drawn frame
ImageNotes notes_of(const scene::Scene& scene, const Trajectory& run, double time_s);

}  // namespace tumble::render
