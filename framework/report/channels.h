/// Series of numbers packed for a page: rounded to a quantum, told by their differences, as few bytes as those need.
///
/// A channel is
///   order        u8   0: values, 1: first differences, 2: second differences (constant force costs nothing); + 4 where values are missing
///   quantum      f64, little-endian
///   missing      u8 a value, 1 where it is not finite (only with order + 4)
///   differences  of round(value / quantum), each as a zigzag varint: 7 bits a byte, least first, the top bit set on all but the last
/// How many values there are is told elsewhere. player/decode.js reads it.
#pragma once

#include <span>
#include <string>

namespace tumble::report {

class ChannelWriter {
 public:
  /// @param quantum  > 0: values come back within half of it; raised where a value would need more than 52 bits
  void add(std::span<const double> values, double quantum, int order);
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// The power of two at or below x, so that rounding adds no digits; 2^-40 for what is not positive or not finite.
double quantum_of(double x);

/// zlib's format at its best ratio: what a browser's DecompressionStream("deflate") opens.
std::string deflated(const std::string& bytes);
std::string base64(const std::string& bytes);

}  // namespace tumble::report
