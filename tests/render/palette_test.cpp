// Pictures in few colours: what they keep, and that their bytes depend on nothing but the pixels.
#include <unistd.h>

#include <random>

#include <gtest/gtest.h>

#include "framework/render/palette.h"
#include "framework/render/picture.h"
#include "tests/render/render_fixtures.h"

namespace tumble::render {
namespace {

Image shown(const IndexedImage& few, int width, int height) {
  Image image(width, height);
  for (std::size_t i = 0; i < few.pixels.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      image.rgb[3 * i + c] = few.colours[3 * std::size_t{few.pixels[i]} + c];
  return image;
}

Image noise() {
  std::mt19937 random(7);
  Image image(64, 64);
  for (std::uint8_t& byte : image.rgb) byte = static_cast<std::uint8_t>(random());
  return image;
}

TEST(Palette, FewColoursStayAsTheyAre) {
  Image image(32, 8);
  for (int x = 0; x < 32; ++x)
    for (int y = 0; y < 8; ++y)
      for (int c = 0; c < 3; ++c)
        image.pixel(x, y)[c] = static_cast<std::uint8_t>((8 * x + 40 * c * (y % 2)) & 255);
  const auto few = indexed(image);
  ASSERT_TRUE(few.has_value());
  EXPECT_LE(few->colours.size(), 3u * 64);
  EXPECT_EQ(shown(*few, 32, 8).rgb, image.rgb);
}

TEST(Palette, ADrawnSceneLooksAsBefore) {
  const Image image = make_picture(falling_ball(), ball_at(2.0), 0.5, small());
  const auto few = indexed(image);
  ASSERT_TRUE(few.has_value());
  // Of 255. Measured 0.4 to 0.9 for the scenes of the handouts; a palette of 64 colours has 2 to 3.
  EXPECT_LT(colour_distance(image, shown(*few, image.width, image.height)), 1.5);
}

TEST(Palette, EqualViewsSideBySideStayEqual) {
  const Image view = make_picture(falling_ball(), ball_at(2.0), 0.5, small());
  Image both(2 * view.width, view.height);
  paste(view, 0, 0, both);
  paste(view, view.width, 0, both);
  const auto few = indexed(both);
  ASSERT_TRUE(few.has_value());
  for (int y = 0; y < both.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * both.width + x;
      ASSERT_EQ(few->pixels[at], few->pixels[at + view.width]) << x << ", " << y;
    }
}

TEST(Palette, WhatFewColoursShowBadlyIsWrittenWithAll) {
  const Image image = noise();
  EXPECT_FALSE(indexed(image).has_value());
  const auto file = std::filesystem::temp_directory_path() /
                    ("tumble_palette_" + std::to_string(getpid()) + ".png");
  write_png(file, image);
  EXPECT_EQ(read_png(file).rgb, image.rgb);
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace tumble::render
