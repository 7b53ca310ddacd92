/// Pictures, videos and pages that play, of scenes as a submission moves them, beside the reference.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "framework/engines/judging/judge.h"
#include "framework/grading/course/course.h"
#include "framework/grading/worker/worker_connection.h"

namespace tumble::grading {

struct MediaOptions {
  int width = 400, height = 300;   // pixels of one of the two views; even
  int samples = 4;                 // a pixel
  double rate_hz = 25.0;           // pictures a second of video
  double wall_s = 60.0;            // of all calls into the submission in one scene: correct ones take seconds
  bool video = true;               // false: the picture only
  bool page = true;                // one that plays the run: 0.4 MB a scene
};

/// One scene, run by a submission.
struct SceneMedia {
  std::string scene, title, about;
  std::filesystem::path picture, video;         // names in the folder given; empty where there is none
  std::string story;                            // why there is no run of the submission, or what ended it early; empty: ran whole
  bool attempted = true;                        // false: the scene needs a function whose stub is still there
  std::vector<engines::CheckResult> checks;     // the submission's run judged by the scene's numbers
  std::filesystem::path page{};                 // plays the run; empty: there is none
};

/// Runs each scene on the submission (in its sandbox) and on the reference (here; skipped where the tree has none) and
/// writes SCENE.png, SCENE.mp4 and SCENE.html into `folder`. A submission that fails in a scene costs that scene's left half alone.
/// What the submission's module is not about runs on the reference where the scene needs it, else on the library's laws.
/// @param submission  a shared object; never loaded into this process
/// @param told        called with each scene's title before it runs; may be empty
/// @throws UserError when pictures cannot be made here at all, or a file cannot be written
std::vector<SceneMedia> make_media(const Course& course, const std::string& id, const std::vector<std::filesystem::path>& scenes,
                                   const std::filesystem::path& submission, const std::filesystem::path& folder,
                                   const MediaOptions& options = {}, const std::function<void(const std::string&)>& told = {});

}  // namespace tumble::grading
