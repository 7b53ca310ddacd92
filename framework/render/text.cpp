#include "framework/render/text.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H

#include "framework/core/error.h"

namespace tumble::render {
namespace {

constexpr const char* kRegular = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
constexpr const char* kBold = "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf";
constexpr double kFixed = 64.0;  // FreeType counts in 1/64 pixel

// Decodes UTF-8; an invalid byte becomes U+FFFD.
std::u32string characters(const std::string& text) {
  std::u32string out;
  for (std::size_t i = 0; i < text.size();) {
    const auto first = static_cast<unsigned char>(text[i]);
    const std::size_t length = first < 0x80   ? 1
                               : first < 0xc2 ? 0
                               : first < 0xe0 ? 2
                               : first < 0xf0 ? 3
                               : first < 0xf5 ? 4
                                              : 0;
    char32_t code = length == 1 ? first : first & (0xff >> (length + 1));
    bool fine = length > 0 && i + length <= text.size();
    for (std::size_t k = 1; fine && k < length; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      fine = (next & 0xc0) == 0x80;
      code = (code << 6) | (next & 0x3f);
    }
    out += fine ? code : U'\ufffd';
    i += fine ? length : 1;
  }
  return out;
}

void blend(std::uint8_t* pixel, const Ink& ink, double opacity) {
  const std::uint8_t color[] = {ink.red, ink.green, ink.blue};
  for (int i = 0; i < 3; ++i)
    pixel[i] = static_cast<std::uint8_t>(std::lround(pixel[i] + (color[i] - pixel[i]) * opacity));
}

// What a glyph covers of a picture, pixel by pixel: rendered once for the letter and its halo.
class Letter {
 public:
  Letter(const FT_Bitmap& glyph, int left, int top)
      : left_(left), top_(top), width_(static_cast<int>(glyph.width)) {
    for (int row = 0; row < static_cast<int>(glyph.rows); ++row) {
      const std::uint8_t* first = glyph.buffer + row * glyph.pitch;
      coverage_.insert(coverage_.end(), first, first + width_);
    }
  }

  void stamp(Image& image, int dx, int dy, const Ink& ink, double opacity) const {
    int x = left_ + dx, y = top_ + dy;
    const int end = x + width_;
    for (const int coverage : coverage_) {
      if (coverage > 0 && x >= 0 && y >= 0 && x < image.width && y < image.height)
        blend(image.pixel(x, y), ink, opacity * coverage / 255.0);
      if (++x == end) x = left_ + dx, ++y;
    }
  }

 private:
  int left_, top_, width_;  // pixels
  std::vector<std::uint8_t> coverage_;
};

// Relative luminance of sRGB [0, 1], and contrast as WCAG 2.1 defines them.
double luminance(const double* rgb) {
  double sum = 0.0;
  constexpr double kShare[] = {0.2126, 0.7152, 0.0722};
  for (int i = 0; i < 3; ++i) {
    const double c = rgb[i] / 255.0;
    sum += kShare[i] * (c <= 0.03928 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
  }
  return sum;
}

double contrast(double light, double dark) { return (light + 0.05) / (dark + 0.05); }

constexpr Ink kLight{250, 251, 252, 0.0};  // of outlines and plates
constexpr double kLegible = 4.5;           // contrast that WCAG 2.1 asks of text
constexpr double kDarkPart = 0.1;          // of the pixels behind a text: darker ones do not count

// Lightens what is behind a text, as far as it takes to read it. Nothing on a light background.
void lay_plate(Image& image, double left, double top, double right, double bottom, const Ink& ink) {
  const int x0 = std::clamp(static_cast<int>(std::floor(left)), 0, image.width),
            x1 = std::clamp(static_cast<int>(std::ceil(right)), 0, image.width),
            y0 = std::clamp(static_cast<int>(std::floor(top)), 0, image.height),
            y1 = std::clamp(static_cast<int>(std::ceil(bottom)), 0, image.height);
  if (x0 >= x1 || y0 >= y1) return;
  std::vector<std::pair<int, const std::uint8_t*>> behind;  // by lightness, about
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      const std::uint8_t* pixel = image.pixel(x, y);
      behind.emplace_back(2 * pixel[0] + 7 * pixel[1] + pixel[2], pixel);
    }
  const auto dark = behind.begin() + static_cast<long>(kDarkPart * double(behind.size()));
  std::nth_element(behind.begin(), dark, behind.end());
  const double of_ink[] = {double(ink.red), double(ink.green), double(ink.blue)};
  const std::uint8_t* pixel = dark->second;
  double opacity = 0.0;
  for (constexpr double kStep = 0.05; opacity < 1.0; opacity += kStep) {
    const double mixed[] = {pixel[0] + (kLight.red - pixel[0]) * opacity,
                            pixel[1] + (kLight.green - pixel[1]) * opacity,
                            pixel[2] + (kLight.blue - pixel[2]) * opacity};
    if (contrast(luminance(mixed), luminance(of_ink)) >= kLegible) break;
  }
  if (opacity == 0.0) return;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) blend(image.pixel(x, y), kLight, std::min(opacity, 1.0));
}

}  // namespace

struct TextWriter::Fonts {
  FT_Library library = nullptr;
  FT_Face regular = nullptr, bold = nullptr;

  Fonts() {
    const bool fine = FT_Init_FreeType(&library) == 0 &&
                      FT_New_Face(library, kRegular, 0, &regular) == 0 &&
                      FT_New_Face(library, kBold, 0, &bold) == 0;
    if (fine) return;
    if (library != nullptr) FT_Done_FreeType(library);
    throw UserError(kRegular, "this font cannot be read", "Install the package fonts-dejavu-core.");
  }
  ~Fonts() { FT_Done_FreeType(library); }  // with its faces

  // Calls visit(glyph slot, pen) for each glyph; returns the final pen position. Without hinting,
  // so that glyphs keep their shapes at every size.
  template <class Visit>
  double walk(const std::string& text, double size, bool is_bold, Visit visit) const {
    FT_Face face = is_bold ? bold : regular;
    FT_Set_Char_Size(face, 0, static_cast<FT_F26Dot6>(std::lround(size * kFixed)), 72, 72);
    double pen = 0.0;
    FT_UInt before = 0;
    for (const char32_t code : characters(text)) {
      const FT_UInt glyph = FT_Get_Char_Index(face, code);
      FT_Vector kerning{};
      FT_Get_Kerning(face, before, glyph, FT_KERNING_UNFITTED, &kerning);
      pen += static_cast<double>(kerning.x) / kFixed;
      if (FT_Load_Glyph(face, glyph, FT_LOAD_NO_HINTING) == 0) {
        visit(face->glyph, pen);
        pen += static_cast<double>(face->glyph->linearHoriAdvance) / 65536.0;
      }
      before = glyph;
    }
    return pen;
  }
};

TextWriter::TextWriter() : fonts_(std::make_unique<Fonts>()) {}
TextWriter::~TextWriter() = default;

double TextWriter::width(const std::string& text, double size, bool bold) const {
  return fonts_->walk(text, size, bold, [](FT_GlyphSlot, double) {});
}

std::string TextWriter::fitted(const std::string& text, double size, double room, bool bold) const {
  if (width(text, size, bold) <= room) return text;
  std::string kept = text;
  while (!kept.empty() && width(kept + "…", size, bold) > room) {
    while (!kept.empty() && (static_cast<unsigned char>(kept.back()) & 0xc0) == 0x80)
      kept.pop_back();
    if (!kept.empty()) kept.pop_back();
  }
  return kept + "…";
}

void TextWriter::write(Image& image, const std::string& text, double x, double baseline,
                       double size, const Ink& ink, Align align, bool bold) const {
  const double wide = width(text, size, bold);
  if (align != Align::kLeft) x -= wide * (align == Align::kCentre ? 0.5 : 1.0);
  const double beside = 0.2 * size, above = 0.95 * size, below = 0.3 * size;
  lay_plate(image, x - beside, baseline - above, x + wide + beside, baseline + below, ink);
  std::vector<Letter> letters;
  fonts_->walk(text, size, bold, [&](FT_GlyphSlot slot, double pen) {
    const double place = x + pen, whole = std::floor(place);
    FT_Outline_Translate(&slot->outline, std::lround((place - whole) * kFixed), 0);
    if (FT_Render_Glyph(slot, FT_RENDER_MODE_NORMAL) != 0) return;
    letters.emplace_back(slot->bitmap, static_cast<int>(whole) + slot->bitmap_left,
                         static_cast<int>(std::lround(baseline)) - slot->bitmap_top);
  });
  const auto draw = [&](const Ink& color, double opacity, int dx, int dy) {
    for (const Letter& letter : letters) letter.stamp(image, dx, dy, color, opacity);
  };
  if (ink.halo > 0.0) {
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        if (dx != 0 || dy != 0) draw(kLight, ink.halo * 0.35, dx, dy);
  }
  draw(ink, 1.0, 0, 0);
}

}  // namespace tumble::render
