/// Pictures and videos of a recorded run. Reads a scene and a trajectory, never an engine.
///
/// The same scene, trajectory and options give the same PNG bytes, whatever the number of threads.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/render/image.h"
#include "framework/render/picture_options.h"
#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::render {

/// One of the runs that a video or picture shows side by side.
struct LabelledRun {
  const Trajectory& trajectory;
  std::string label;  // e.g. "submission", "reference"
};

/// Refuses before a run what pictures of it would be refused for after it. Draws nothing.
/// @throws UserError when neither OSMesa nor EGL works here, or a font is missing
void expect_pictures();
/// The same for a video.
/// @throws UserError also when ffmpeg is not installed
void expect_video(const std::filesystem::path& mp4);

/// The run at one instant: the last recorded frame that is not later.
/// @throws UserError when the run has no frame, belongs to another scene, or pictures do not work
///         here
Image make_picture(const scene::Scene& scene, const Trajectory& run, double time_s,
                   const PictureOptions& options = {});
/// @throws UserError as make_picture, and when the file cannot be written
void write_picture(const std::filesystem::path& png, const scene::Scene& scene,
                   const Trajectory& run, double time_s, const PictureOptions& options = {});

/// `count` instants from start to end in a grid, as one picture, each with its time. Views have
/// half the size of `options`.
void write_contact_sheet(const std::filesystem::path& png, const scene::Scene& scene,
                         const Trajectory& run, int count = 9, const PictureOptions& options = {});

/// H.264 in MP4.
/// @throws UserError also when ffmpeg is missing or fails (with its message)
void write_video(const std::filesystem::path& mp4, const scene::Scene& scene, const Trajectory& run,
                 const PictureOptions& options = {});

/// Several runs of one scene side by side, each under its label; a run that ends earlier keeps its
/// last frame.
void write_side_by_side_picture(const std::filesystem::path& png, const scene::Scene& scene,
                                const std::vector<LabelledRun>& runs, double time_s,
                                const PictureOptions& options = {});
void write_side_by_side_video(const std::filesystem::path& mp4, const scene::Scene& scene,
                              const std::vector<LabelledRun>& runs,
                              const PictureOptions& options = {});

/// How far the two views of a picture by write_side_by_side_picture are apart: root mean square
/// difference of their bytes, in [0, 255]. 0 for two runs that are drawn alike: the bands at the
/// top and at the bottom, where the words differ, do not count.
double distance_of_views(const Image& both);

/// An instructive instant of a run, for poster frames: just after its strongest collision, else a
/// third of its duration. [s]
double telling_instant(const Trajectory& run);

}  // namespace tumble::render
