/// Text over a rendered picture. Internal to framework/render.
#pragma once

#include "framework/render/image.h"
#include "framework/render/stage.h"
#include "framework/render/text.h"

namespace tumble::render {

enum class Words { kAll, kTimeOnly };

/// Writes title, time, engine and step, the grid's scale, labels, and what stopped the run.
/// @param label  at the top right, e.g. "reference"; may be empty
void write_captions(Image& image, const TextWriter& writer, const scene::Scene& scene,
                    const Trajectory& run, const Stage& stage, std::size_t frame,
                    const Moment& moment, const std::string& label, Words words);

}  // namespace tumble::render
