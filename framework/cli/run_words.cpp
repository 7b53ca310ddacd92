#include "framework/cli/run_words.h"

#include <cstdio>

#include "framework/core/error.h"

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
