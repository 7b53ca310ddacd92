/// Encodes pictures into an MP4 by an ffmpeg process. Internal to framework/render.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>

#include "framework/render/image.h"

namespace tumble::render {

/// @throws UserError when ffmpeg is not on PATH
void expect_ffmpeg(const std::filesystem::path& mp4);

class VideoWriter {
 public:
  /// @param mp4  written as pictures arrive: give a draft's name (core/files.h)
  /// @param width, height  of every picture; odd sizes lose the last column or row
  /// @param crf     x264's constant rate factor
  /// @param record  provenance, stored as the file's comment
  /// @throws UserError when ffmpeg is missing
  VideoWriter(const std::filesystem::path& mp4, int width, int height, double rate_hz, int crf,
              const std::string& record);
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;
  ~VideoWriter();

  /// @throws UserError with ffmpeg's messages when it has ended early
  void add(const Image& image);
  /// Waits until the file is complete.
  /// @throws UserError with ffmpeg's messages when it failed
  void finish();

 private:
  std::string complaints() const;

  std::filesystem::path mp4_;
  int width_, height_;
  int input_ = -1;       // socket into ffmpeg
  int complaints_ = -1;  // what ffmpeg printed
  pid_t ffmpeg_ = -1;
};

}  // namespace tumble::render
