#include "framework/report/channels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "framework/core/error.h"

namespace tumble::report {
namespace {

constexpr int kMissing = 4;
// 2^52: integers that doubles represent exactly, with room for a second difference
constexpr double kLargest = 4503599627370496.0;

void add_varint(std::int64_t value, std::string& bytes) {
  auto zigzag = (static_cast<std::uint64_t>(value) << 1) ^ static_cast<std::uint64_t>(value >> 63);
  for (; zigzag >= 128; zigzag >>= 7) bytes += static_cast<char>((zigzag & 127) | 128);
  bytes += static_cast<char>(zigzag);
}

}  // namespace

double quantum_of(double x) {
  return std::isfinite(x) && x > 0 ? std::exp2(std::floor(std::log2(x))) : std::exp2(-40);
}

void ChannelWriter::add(std::span<const double> values, double quantum, int order) {
  require(quantum > 0 && order >= 0 && order <= 2,
          "report: a channel needs a positive quantum and an order from 0 to 2");
  double largest = 0.0;
  bool missing = false;
  for (const double v : values)
    std::isfinite(v) ? void(largest = std::max(largest, std::abs(v))) : void(missing = true);
  quantum = std::max(quantum, quantum_of(2.0 * largest / kLargest * 4.0));
  bytes_ += static_cast<char>(order + (missing ? kMissing : 0));
  char raw[sizeof quantum];
  std::memcpy(raw, &quantum, sizeof quantum);
  bytes_.append(raw, sizeof raw);
  if (missing)
    for (const double v : values) bytes_ += static_cast<char>(std::isfinite(v) ? 0 : 1);

  // the last two integers; a missing value is coded as their linear extrapolation
  std::int64_t before = 0, earlier = 0;
  for (const double v : values) {
    const std::int64_t guess = order == 0 ? 0 : order == 1 ? before : 2 * before - earlier;
    const std::int64_t whole = std::isfinite(v) ? std::llround(v / quantum) : before;
    add_varint(whole - guess, bytes_);
    earlier = before;
    before = whole;
  }
}

std::string base64(const std::string& bytes) {
  static constexpr char kLetters[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k <= bytes.size() ? kLetters[three >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

}  // namespace tumble::report
