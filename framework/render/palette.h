/// A picture with few colours, as PNG stores it: a table of up to 256 colours, and a byte a pixel.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "framework/render/image.h"

namespace tumble::render {

struct IndexedImage {
  std::vector<std::uint8_t> colours;  // 8-bit sRGB, three bytes each, 1 to 256 of them
  std::vector<std::uint8_t> pixels;   // an index into colours each, rows from the top
};

/// The picture in its 256 best colours; a picture that has no more keeps them. Equal pixels get
/// equal colours: nothing is dithered, so that two views that were equal stay equal. The same
/// pixels give the same bytes, whatever the number of processors.
/// @return nothing where 256 colours show it badly
/// Source: libimagequant (median cut after Heckbert, refined by k-means).
std::optional<IndexedImage> indexed(const Image& image);

}  // namespace tumble::render
