/// Text in pictures. Internal to framework/render; only text.cpp uses FreeType.
#pragma once

#include <memory>
#include <string>

#include "framework/render/image.h"

namespace tumble::render {

struct Ink {
  std::uint8_t red = 28, green = 39, blue = 51;
  double halo = 0.0;  // opacity of the light outline that keeps text legible over bodies [0, 1]
};
inline constexpr Ink kDark{28, 39, 51, 0.75};
inline constexpr Ink kSoft{70, 84, 98, 0.6};
inline constexpr Ink kAlarm{168, 44, 0, 0.9};

enum class Align { kLeft, kCentre, kRight };

class TextWriter {
 public:
  /// @throws UserError when the font (Debian's fonts-dejavu-core) is missing
  TextWriter();
  ~TextWriter();

  /// Writes one line. Where it could not be read on what is behind it, that is lightened.
  /// @param text         UTF-8
  /// @param x, baseline  position [pixels]
  /// @param size         height of the font [pixels]
  void write(Image& image, const std::string& text, double x, double baseline, double size,
             const Ink& ink = kDark, Align align = Align::kLeft, bool bold = false) const;
  /// Width of the text. [pixels]
  double width(const std::string& text, double size, bool bold = false) const;
  /// The text, shortened with an ellipsis where it is wider than `room` pixels.
  std::string fitted(const std::string& text, double size, double room, bool bold = false) const;

 private:
  struct Fonts;
  std::unique_ptr<Fonts> fonts_;
};

}  // namespace tumble::render
