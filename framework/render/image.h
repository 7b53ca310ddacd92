/// A picture in memory, and as a PNG file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace tumble::render {

/// 8-bit sRGB, three bytes per pixel, rows from the top.
struct Image {
  int width = 0, height = 0;      // pixels
  std::vector<std::uint8_t> rgb;  // width * height * 3

  Image() = default;
  Image(int w, int h, std::uint8_t grey = 255)
      : width(w), height(h), rgb(static_cast<std::size_t>(w) * h * 3, grey) {}
  std::uint8_t* pixel(int x, int y) { return &rgb[(static_cast<std::size_t>(y) * width + x) * 3]; }
  const std::uint8_t* pixel(int x, int y) const {
    return &rgb[(static_cast<std::size_t>(y) * width + x) * 3];
  }
};

/// Copies `part` into `whole` with its top left corner at (x, y). @pre it fits
void paste(const Image& part, int x, int y, Image& whole);

/// Text chunks of the file: (keyword, text), e.g. {"Scene digest", "..."}.
using ImageNotes = std::vector<std::pair<std::string, std::string>>;

/// Writes the file whole or not at all, in its 256 best colours where these show it (`palette.h`):
/// less than half of the size. The same pixels and notes give the same bytes (no date is written).
/// @throws UserError when the file cannot be written
void write_png(const std::filesystem::path& file, const Image& image, const ImageNotes& notes = {});

/// Reads a picture, as three bytes per pixel whatever the file holds.
/// @throws UserError when the file is no picture that can be read
Image read_png(const std::filesystem::path& file);

/// Root mean square difference of two pictures' bytes, in [0, 255]. Where their sizes differ, 255.
double colour_distance(const Image& a, const Image& b);

}  // namespace tumble::render
