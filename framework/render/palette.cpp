#include "framework/render/palette.h"

#include <memory>

#include <libimagequant.h>
#include <omp.h>

namespace tumble::render {
namespace {

constexpr int kMostColours = 256;
// Of 100, in libimagequant's measure of what an eye sees: its default for pictures of the web is 65
// to 80. Drawn scenes reach 90 and more.
constexpr int kLowestQuality = 70;

// libimagequant adds up in as many parts as there are processors, and sums of floating-point
// numbers depend on their order.
class OneThread {
 public:
  OneThread() : before_(omp_get_max_threads()) { omp_set_num_threads(1); }
  ~OneThread() { omp_set_num_threads(before_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int before_;
};

template <auto destroy>
struct Destroy {
  template <class T>
  void operator()(T* object) const {
    destroy(object);
  }
};

std::vector<std::uint8_t> with_opacity(const Image& image) {
  std::vector<std::uint8_t> rgba;
  rgba.reserve(image.rgb.size() / 3 * 4);
  for (std::size_t i = 0; i < image.rgb.size(); i += 3)
    rgba.insert(rgba.end(), {image.rgb[i], image.rgb[i + 1], image.rgb[i + 2], 255});
  return rgba;
}

}  // namespace

std::optional<IndexedImage> indexed(const Image& image) {
  const OneThread guard;
  const std::vector<std::uint8_t> rgba = with_opacity(image);
  const std::unique_ptr<liq_attr, Destroy<liq_attr_destroy>> options(liq_attr_create());
  if (!options || liq_set_max_colors(options.get(), kMostColours) != LIQ_OK ||
      liq_set_quality(options.get(), kLowestQuality, 100) != LIQ_OK)
    return std::nullopt;
  const std::unique_ptr<liq_image, Destroy<liq_image_destroy>> source(
      liq_image_create_rgba(options.get(), rgba.data(), image.width, image.height, 0.0));
  liq_result* made = nullptr;
  if (!source || liq_image_quantize(source.get(), options.get(), &made) != LIQ_OK)
    return std::nullopt;
  const std::unique_ptr<liq_result, Destroy<liq_result_destroy>> result(made);
  IndexedImage few;
  few.pixels.resize(rgba.size() / 4);
  if (liq_set_dithering_level(result.get(), 0.0f) != LIQ_OK ||
      liq_write_remapped_image(result.get(), source.get(), few.pixels.data(), few.pixels.size()) !=
          LIQ_OK)
    return std::nullopt;
  const liq_palette& palette = *liq_get_palette(result.get());
  for (unsigned i = 0; i < palette.count; ++i)
    few.colours.insert(few.colours.end(),
                       {palette.entries[i].r, palette.entries[i].g, palette.entries[i].b});
  return few;
}

}  // namespace tumble::render
