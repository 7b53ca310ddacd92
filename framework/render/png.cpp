#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <memory>

#include <png.h>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/render/image.h"
#include "framework/render/palette.h"

namespace tumble::render {
namespace {

// A fixed level, so that the bytes do not depend on a library's default. Drawn surfaces repeat
// themselves: without a filter files are a tenth smaller than with differences along the rows.
constexpr int kCompressionLevel = 9;

void append(png_structp png, png_bytep data, png_size_t size) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(data), size);
}

// What libpng is given: rows of pixels of three bytes, or of one where there are colours.
struct Encoded {
  int width, height;
  std::vector<png_bytep> rows;
  std::vector<png_color> colours;
};

// libpng reports errors by longjmp, so no object with a destructor is created after setjmp.
bool encode(Encoded& image, std::vector<png_text>& notes, std::string& bytes) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  if (info == nullptr || setjmp(png_jmpbuf(png)) != 0) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_set_write_fn(png, &bytes, append, nullptr);
  png_set_compression_level(png, kCompressionLevel);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_NONE);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width),
               static_cast<png_uint_32>(image.height), 8,
               image.colours.empty() ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_PALETTE,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (!image.colours.empty())
    png_set_PLTE(png, info, image.colours.data(), static_cast<int>(image.colours.size()));
  png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_set_text(png, info, notes.data(), static_cast<int>(notes.size()));
  png_set_rows(png, info, image.rows.data());
  png_write_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
  png_destroy_write_struct(&png, &info);
  return true;
}

}  // namespace

void paste(const Image& part, int x, int y, Image& whole) {
  require(x >= 0 && y >= 0 && x + part.width <= whole.width && y + part.height <= whole.height,
          "paste: the part does not fit");
  for (int row = 0; row < part.height; ++row)
    std::memcpy(whole.pixel(x, y + row), part.pixel(0, row),
                static_cast<std::size_t>(part.width) * 3);
}

void write_png(const std::filesystem::path& file, const Image& image, const ImageNotes& notes) {
  require(image.width > 0 && image.height > 0, "write_png: an empty picture");
  ImageNotes held = notes;
  std::vector<png_text> texts;
  for (auto& [keyword, text] : held) {
    // PNG's limit for keywords
    if (keyword.empty() || keyword.size() > 79 || text.empty()) continue;
    png_text note{};
    note.compression = PNG_ITXT_COMPRESSION_NONE;  // UTF-8
    note.key = keyword.data();
    note.text = text.data();
    texts.push_back(note);
  }
  Encoded encoded{image.width, image.height, {}, {}};
  const auto few = indexed(image);
  for (int y = 0; y < image.height; ++y)
    encoded.rows.push_back(const_cast<png_bytep>(
        few ? &few->pixels[static_cast<std::size_t>(y) * image.width] : image.pixel(0, y)));
  for (std::size_t i = 0; few && i < few->colours.size(); i += 3)
    encoded.colours.push_back({few->colours[i], few->colours[i + 1], few->colours[i + 2]});
  std::string bytes;
  if (!encode(encoded, texts, bytes)) throw UserError(file.string(), "cannot be encoded as PNG");
  write_whole(file, bytes);
}

Image read_png(const std::filesystem::path& file) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  constexpr png_uint_32 kMostPixels = 1u << 14;  // a side: far above any picture made here
  const bool is_png = png_image_begin_read_from_file(&png, file.c_str()) != 0;
  png.format = PNG_FORMAT_RGB;
  if (!is_png || png.width > kMostPixels || png.height > kMostPixels) {
    png_image_free(&png);
    throw UserError(file.string(), "cannot be read as PNG");
  }
  Image image(static_cast<int>(png.width), static_cast<int>(png.height));
  if (png_image_finish_read(&png, nullptr, image.rgb.data(), 0, nullptr) == 0)
    throw UserError(file.string(), "cannot be read as PNG: it ends early");
  return image;
}

double colour_distance(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height) return 255.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) {
    const double difference = static_cast<double>(a.rgb[i]) - static_cast<double>(b.rgb[i]);
    sum += difference * difference;
  }
  return a.rgb.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(a.rgb.size()));
}

}  // namespace tumble::render
