/// Pictures, videos and player pages of scenes, run by a submission beside the reference.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/engines/judging/judge.h"
#include "framework/grading/course/course.h"
#include "framework/grading/worker/worker_connection.h"

namespace tumble::grading {

struct MediaOptions {
  int width = 400, height = 300;  // pixels of one of the two views; even
  int samples = 4;                // per pixel
  double rate_hz = 25.0;          // frames per second of video
  // of all calls into the submission in one scene: right ones take seconds
  double wall_s = 60.0;
  bool video = true;  // false: only a picture
  bool page = true;   // a page that plays the run: 0.1 MB per scene
  // The file with three.js and the player's scripts, seen from the folder of the pages; whoever
  // names one writes it (report::write_three). Empty: one in each folder, which may then be handed
  // on by itself.
  std::filesystem::path three_file = {};
};

/// One scene, run by a submission.
struct SceneMedia {
  std::string scene, title, about;
  std::filesystem::path picture, video;  // file names in the folder; empty if there is none
  // why there is no run of the submission, or why it ended early; empty: complete
  std::string story;
  // false: the scene needs a function that is still a stub
  bool attempted = true;
  std::vector<engines::CheckResult> checks;  // the scene's checks on the submission's run
  std::filesystem::path page{};              // plays the run; empty if there is none
  std::vector<std::string> functions{};      // of the submission that the run called, by name
};

/// Runs each scene on the submission (in its sandbox) and on the reference (in this process;
/// skipped if the tree has none) and writes SCENE.png, SCENE.mp4 and SCENE.html into `folder`. Of a
/// scene in which only stubs were called there is no picture: nothing of the submission would be
/// in it. A submission that fails in a scene loses only its half of that scene's picture. Laws that
/// the submission's module does not implement come from the reference if the scene needs them, else
/// from the library.
/// @param submission  a shared object; never loaded into this process
/// @throws UserError when this machine cannot draw pictures, or a file cannot be written
std::vector<SceneMedia> make_media(const Course& course, const std::string& id,
                                   const std::vector<std::filesystem::path>& scenes,
                                   const std::filesystem::path& submission,
                                   const std::filesystem::path& folder,
                                   const MediaOptions& options = {});

}  // namespace tumble::grading
