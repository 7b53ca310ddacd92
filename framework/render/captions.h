/// Text over a rendered picture. Internal to framework/render.
#pragma once

#include <string>
#include <vector>

#include "framework/render/image.h"
#include "framework/render/stage.h"
#include "framework/render/text.h"

namespace tumble::render {

/// kTimeOnly is for the views of a sheet: labels, the time, and what stopped the run.
enum class Words { kAll, kTimeOnly };

/// "timewarp, step 1/10 s · scheduler: submission · impulses, motion: reference": the engine, and
/// whose laws it ran on, those that the scene needs.
std::string made_by(const TrajectoryInfo& info);

/// A word in a picture that another must not cover. [pixels]
struct WordInPicture {
  double left, top, baseline;  // top: of what belongs to it, such as the bar of a scale
};

/// The lowest baseline up to the given one at which a line of words covers none of these.
/// @param right, size  where the line ends, and the height of its font [pixels]
double clear_baseline(double baseline, double right, double size,
                      const std::vector<WordInPicture>& words);

/// "t = 0.25 s": at least two decimals, and so many that successive frames have different times
/// (nine at most).
/// @pre the run has a frame
std::string time_text(const Trajectory& run, std::size_t frame);

/// Writes title, time, engine and step, the grid's scale, labels, and what stopped the run.
/// @param label  at the top right, e.g. "reference"; may be empty
void write_captions(Image& image, const TextWriter& writer, const scene::Scene& scene,
                    const Trajectory& run, const Stage& stage, std::size_t frame,
                    const Moment& moment, const std::string& label, Words words);

}  // namespace tumble::render
