#include "framework/render/video_writer.h"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "framework/core/error.h"

namespace tumble::render {
namespace {

std::vector<std::string> ffmpeg_words(const std::filesystem::path& mp4, int width, int height,
                                      double rate_hz, int crf, const std::string& record) {
  return {"ffmpeg", "-nostdin", "-hide_banner", "-loglevel", "error", "-y", "-f", "rawvideo",
          "-pix_fmt", "rgb24", "-video_size", fmt::format("{}x{}", width, height), "-framerate",
          fmt::format("{:g}", rate_hz), "-i", "pipe:0", "-an", "-vf",
          "crop=trunc(iw/2)*2:trunc(ih/2)*2",
          // Plays in every browser while it loads; without date and encoder's name, so that the
          // same pictures give the same file.
          "-c:v", "libx264", "-preset", "veryfast", "-crf", std::to_string(crf), "-pix_fmt",
          "yuv420p", "-threads", "2", "-movflags", "+faststart", "-fflags", "+bitexact", "-flags:v",
          "+bitexact", "-map_metadata", "-1", "-metadata", "comment=" + record, "-f", "mp4",
          // Without "file:", ffmpeg takes what precedes a colon in a name for a protocol.
          "file:" + mp4.string()};
}

UserError no_ffmpeg(const std::filesystem::path& mp4) {
  return {mp4.string(), "ffmpeg is not installed",
          "Install it (apt-get install ffmpeg), or choose pictures instead of a video."};
}

}  // namespace

// As execvp searches.
void expect_ffmpeg(const std::filesystem::path& mp4) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "/bin:/usr/bin");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::filesystem::path file =
        std::filesystem::path(folder.empty() ? "." : folder) / "ffmpeg";
    std::error_code failed;
    if (std::filesystem::is_regular_file(file, failed) && ::access(file.c_str(), X_OK) == 0) return;
  }
  throw no_ffmpeg(mp4);
}

VideoWriter::VideoWriter(const std::filesystem::path& mp4, int width, int height, double rate_hz,
                         int crf, const std::string& record)
    : mp4_(mp4), width_(width), height_(height) {
  int ends[2];
  complaints_ = memfd_create("ffmpeg", MFD_CLOEXEC);
  if (complaints_ < 0 || socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw UserError(mp4.string(), "no connection to ffmpeg can be made",
                    "Close some programs and try again.");
  const std::vector<std::string> words = ffmpeg_words(mp4, width, height, rate_hz, crf, record);
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  ffmpeg_ = fork();
  if (ffmpeg_ == 0) {
    dup2(ends[0], 0);
    dup2(complaints_, 1);
    dup2(complaints_, 2);
    execvp(arguments[0], arguments.data());
    _exit(127);
  }
  close(ends[0]);
  input_ = ends[1];
  if (ffmpeg_ < 0)
    throw UserError(mp4.string(), "no process can be created for ffmpeg",
                    "Close some programs and try again.");
}

VideoWriter::~VideoWriter() {
  if (input_ >= 0) close(input_);
  if (complaints_ >= 0) close(complaints_);
  if (ffmpeg_ > 0) {
    kill(ffmpeg_, SIGKILL);
    waitpid(ffmpeg_, nullptr, 0);
  }
}

std::string VideoWriter::complaints() const {
  std::string text(2000, '\0');
  const ssize_t count = pread(complaints_, text.data(), text.size(), 0);
  text.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

void VideoWriter::finish() {
  close(input_);
  input_ = -1;
  int status = 0;
  while (waitpid(ffmpeg_, &status, 0) < 0 && errno == EINTR) {
  }
  ffmpeg_ = -1;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127) throw no_ffmpeg(mp4_);
  const std::string words = complaints();
  throw UserError(mp4_.string(), "ffmpeg failed" + (words.empty() ? std::string() : ": " + words),
                  "Check the disk's free space and ffmpeg's message.");
}

void VideoWriter::add(const Image& image) {
  if (image.width != width_ || image.height != height_)
    throw std::logic_error("all pictures of a video must have the same size");
  const auto* bytes = image.rgb.data();
  for (std::size_t left = image.rgb.size(); left > 0;) {
    // without a reader an error, not a SIGPIPE that ends the process
    const ssize_t written = send(input_, bytes, left, MSG_NOSIGNAL);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return finish();  // ffmpeg ended early: finish() reports why
    bytes += written;
    left -= static_cast<std::size_t>(written);
  }
}

}  // namespace tumble::render
