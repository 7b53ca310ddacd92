#include "framework/cli/run_words.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/render/picture.h"
#include "framework/report/player.h"

namespace tumble::cli {

PictureSize parse_size(const std::string& text) {
  PictureSize size{0, 0};
  char rest = 0;
  const bool is_read = std::sscanf(text.c_str(), "%dx%d%c", &size.width, &size.height, &rest) == 2;
  const auto fits = [](int pixels) { return pixels >= 16 && pixels <= 4096; };
  if (!is_read || !fits(size.width) || !fits(size.height))
    throw UserError("--size " + text, "expected WIDTHxHEIGHT in pixels, each from 16 to 4096",
                    "For example --size 640x480.");
  return size;
}

namespace {

namespace fs = std::filesystem;

/// What a file is shows in its ending: under another one no program would open it.
void expect_ending(const std::string& flag, const std::string& file,
                   const std::vector<std::string>& endings) {
  std::string ending = fs::path(file).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  if (std::find(endings.begin(), endings.end(), ending) != endings.end()) return;
  throw UserError(flag + " " + file, "the name of the file does not end with " + endings.front(),
                  "For example " + flag + " " +
                      fs::path(file).replace_extension(endings.front()).string() + ".");
}

/// The files that the words name end as what they hold, and can be made on this machine.
void expect_kinds(const RunWords& words) {
  const std::vector<std::pair<std::string, std::string>> pictures = {
      {"--png", words.png}, {"--sheet", words.sheet}, {"--virtual-times", words.virtual_times}};
  for (const auto& [flag, file] : pictures)
    if (!file.empty()) expect_ending(flag, file, {".png"});
  if (!words.video.empty()) expect_ending("--video", words.video, {".mp4"});
  if (!words.html.empty()) expect_ending("--html", words.html, {".html", ".htm"});
  if (!words.png.empty() || !words.sheet.empty()) render::expect_pictures();
  if (!words.video.empty()) render::expect_video(words.video);
  if (!words.html.empty()) report::expect_player();
}

}  // namespace

RunWords with_outputs(RunWords words, double duration_s) {
  std::map<fs::path, std::string> flags;
  const std::vector<std::pair<std::string, std::string*>> outputs = {
      {"--png", &words.png},     {"--sheet", &words.sheet},
      {"--video", &words.video}, {"--trajectory", &words.trajectory},
      {"--html", &words.html},   {"--virtual-times", &words.virtual_times}};
  for (const auto& [flag, file] : outputs) {
    if (file->empty()) continue;
    expect_writable(*file);
    *file = behind_links(*file).string();
    std::error_code failed;
    const auto [first, is_new] =
        flags.emplace(fs::weakly_canonical(fs::absolute(*file), failed), flag);
    if (!is_new)
      throw UserError(flag + " " + *file, "is the file of " + first->second + ", too",
                      "Give each its own.");
  }
  expect_kinds(words);
  if (words.at_s > duration_s)
    throw UserError(fmt::format("--at-s {:g}", words.at_s),
                    fmt::format("the run ends at {:g} s", duration_s),
                    "Give an earlier instant, or leave it out for the end.");
  return words;
}

Vector3d parse_vector(const std::string& flag, const std::string& text) {
  Vector3d v;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf%c", &v.x(), &v.y(), &v.z(), &rest) != 3 ||
      !v.allFinite())
    throw UserError(flag + " " + text,
                    "expected three numbers with commas between them and no spaces",
                    "For example " + flag + " 0,0,5.");
  return v;
}

}  // namespace tumble::cli
