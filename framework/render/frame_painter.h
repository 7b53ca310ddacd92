/// One run, drawn frame by frame: stage, painter and captions together. Internal to framework/render.
#pragma once

#include "framework/render/captions.h"
#include "framework/render/image.h"
#include "framework/render/painter.h"
#include "framework/render/stage.h"

namespace tumble::render {

class FramePainter {
 public:
  /// @throws UserError as make_picture
  FramePainter(const scene::Scene& scene, const Trajectory& run, const PictureOptions& options, std::string label = "", Words words = Words::kAll);

  /// A picture whose words are still to be written: drawing and writing can then go on in two threads.
  struct Wordless {
    std::size_t frame;
    Moment moment;
    Image image;
  };

  Image paint(std::size_t frame) { return with_words(paint_wordless(frame)); }
  /// OpenGL draws here; calls must come one after the other.
  Wordless paint_wordless(std::size_t frame);
  /// May run while the next is painted; calls must come one after the other.
  Image with_words(Wordless painted) const;
  std::size_t frame_at(double time_s) const { return stage_.frame_at(time_s); }
  Image paint_at(double time_s) { return paint(stage_.frame_at(time_s)); }
  double end_s() const { return run_.frames.back().time; }

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

/// What a PNG of this run says of itself.
ImageNotes notes_of(const scene::Scene& scene, const Trajectory& run, double time_s);

}  // namespace tumble::render
