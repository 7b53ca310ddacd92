/// Pictures and videos of a recorded run. Reads a scene and a trajectory, never an engine.
///
/// The same scene, trajectory and options give the same PNG bytes, whatever the number of threads.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/render/image.h"
#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::render {

struct PictureOptions {
  int width = 640, height = 480;    // pixels of one view; even, for video
  int samples = 4;                  // a pixel: 1 draws fast and jagged, 4 smooth
  double video_rate_hz = 30.0;      // pictures a second of video
  double speed = 1.0;               // seconds of the run shown in a second of video: 0.25 is slow motion
  bool marks = true;                // arrows of impulses and forces
  bool paths = true;                // where the centre of mass has been
  bool captions = true;             // title, time, engine, scale
  std::string gl;                   // "osmesa", "egl", or empty: see make_gl_context
  std::filesystem::path root;       // source root, where models are looked for; empty: see scene::build_solid
};

/// What one video or picture shows beside another.
struct LabelledRun {
  const Trajectory& trajectory;
  std::string label;                // e.g. "submission", "reference"
};

/// The run at one instant (the last recorded frame that is not later).
/// @throws UserError when the run has no frame, belongs to another scene, or pictures do not work here
Image make_picture(const scene::Scene& scene, const Trajectory& run, double time_s, const PictureOptions& options = {});
/// @throws UserError as make_picture, and when the file cannot be written
void write_picture(const std::filesystem::path& png, const scene::Scene& scene, const Trajectory& run, double time_s,
                   const PictureOptions& options = {});

/// `count` instants from start to end in a grid, as one picture; each says its time. Views are half as large as `options` says.
void write_contact_sheet(const std::filesystem::path& png, const scene::Scene& scene, const Trajectory& run, int count = 9,
                         const PictureOptions& options = {});

/// H.264 in MP4. @throws UserError also when ffmpeg is missing or fails (with what it said)
void write_video(const std::filesystem::path& mp4, const scene::Scene& scene, const Trajectory& run, const PictureOptions& options = {});

/// Several runs of one scene side by side, each under its label; the one that ended earlier stands still.
void write_side_by_side_picture(const std::filesystem::path& png, const scene::Scene& scene, const std::vector<LabelledRun>& runs,
                                double time_s, const PictureOptions& options = {});
void write_side_by_side_video(const std::filesystem::path& mp4, const scene::Scene& scene, const std::vector<LabelledRun>& runs,
                              const PictureOptions& options = {});

/// The instant at which a run shows most: just after its strongest collision, else a third of the way. For posters. [s]
double telling_instant(const Trajectory& run);

}  // namespace tumble::render
