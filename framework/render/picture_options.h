/// How pictures and videos of a run are drawn.
#pragma once

#include <filesystem>
#include <string>

namespace tumble::render {

struct PictureOptions {
  int width = 640, height = 480;  // pixels of one view; even, for video
  int samples = 4;                // per pixel: 1 is fast and jagged, 4 smooth
  double video_rate_hz = 30.0;    // frames per second of video
  int video_crf = 21;             // x264's constant rate factor: higher is smaller and coarser
  // seconds of the run shown in a second of video: 0.25 is slow motion
  double speed = 1.0;
  bool marks = true;     // arrows of impulses and forces
  bool paths = true;     // of centres of mass
  bool captions = true;  // title, time, engine, scale
  std::string gl;        // "osmesa", "egl", or empty: see make_gl_context
  // source root, where models are searched; empty: see scene::build_solid
  std::filesystem::path root;
};

}  // namespace tumble::render
