/// Series of numbers packed for a page: rounded to a quantum, then coded by their differences in a
/// variable number of bytes.
///
/// A channel is
///   order        u8   0: values, 1: first differences, 2: second differences (constant force costs
///                nothing); + 4 where values are missing
///   quantum      f64, little-endian
///   missing      one u8 per value, 1 where it is not finite (only with order + 4)
///   differences  of round(value / quantum), each as a zigzag varint: 7 bits per byte, lowest
///                first, the top bit set in all but the last
/// The number of values is stored elsewhere. player/decode.js reads channels.
#pragma once

#include <span>
#include <string>

namespace tumble::report {

class ChannelWriter {
 public:
  /// @param quantum  > 0: values are restored to within half of it; increased where a value would
  ///   need more than 52 bits
  void add(std::span<const double> values, double quantum, int order);
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// The power of two at or below x, so that rounding adds no digits; 2^-40 where x is not positive
/// or not finite.
double quantum_of(double x);

std::string base64(const std::string& bytes);

}  // namespace tumble::report
