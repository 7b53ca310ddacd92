/// Pictures into an MP4 by ffmpeg, a process of its own. Internal to framework/render.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>

#include "framework/render/image.h"

namespace tumble::render {

class VideoWriter {
 public:
  /// @param mp4  written as pictures come: give a draft's name (core/files.h)
  /// @param width, height  of every picture; odd ones lose their last column or row
  /// @throws UserError when ffmpeg is not there
  /// @param record  what made it, as the file's comment
  VideoWriter(const std::filesystem::path& mp4, int width, int height, double rate_hz, const std::string& record);
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;
  ~VideoWriter();

  /// @throws UserError with ffmpeg's words when it has given up
  void add(const Image& image);
  /// Waits for the file. @throws UserError with ffmpeg's words when it failed
  void finish();

 private:
  std::string complaints() const;

  std::filesystem::path mp4_;
  int width_, height_;
  int input_ = -1;      // pipe into ffmpeg
  int complaints_ = -1; // what ffmpeg printed
  pid_t ffmpeg_ = -1;
};

}  // namespace tumble::render
