/// Values as bytes, derived from their types: arithmetic, enums, strings, Eigen, optional, vector,
/// and aggregates of these (walked by Boost.PFR). Reading is bounds-checked: bytes from a sandbox
/// are never trusted.
///
/// A std::function argument travels as the number of an entry in the sender's table of callbacks.
#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include <boost/pfr/core.hpp>

#include "framework/core/math.h"
#include "framework/modules/answer_sizes.h"

namespace tumble::modules {

using Bytes = std::vector<std::uint8_t>;

/// The bytes are not a value of the requested type.
class WireError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

template <class T>
struct is_optional : std::false_type {};
template <class T>
struct is_optional<std::optional<T>> : std::true_type {};
template <class T>
struct is_vector : std::false_type {};
template <class T>
struct is_vector<std::vector<T>> : std::true_type {};
template <class T>
inline constexpr bool is_matrix = std::is_base_of_v<Eigen::PlainObjectBase<T>, T>;

class Writer {
 public:
  Bytes bytes;

  void raw(const void* data, std::size_t size) {
    const auto* first = static_cast<const std::uint8_t*>(data);
    bytes.insert(bytes.end(), first, first + size);
  }

  template <class T>
  void value(const T& x) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      raw(&x, sizeof x);
    } else if constexpr (std::is_same_v<T, std::string>) {
      value(static_cast<std::uint32_t>(x.size()));
      raw(x.data(), x.size());
    } else if constexpr (std::is_same_v<T, Quaterniond>) {
      raw(x.coeffs().data(), 4 * sizeof(double));
    } else if constexpr (is_optional<T>::value) {
      value(x.has_value());
      if (x) value(*x);
    } else if constexpr (is_vector<T>::value) {
      value(static_cast<std::uint32_t>(x.size()));
      for (const auto& item : x) value(item);
    } else if constexpr (is_matrix<T>) {
      value(static_cast<std::uint32_t>(x.rows()));
      value(static_cast<std::uint32_t>(x.cols()));
      raw(x.data(), static_cast<std::size_t>(x.size()) * sizeof(typename T::Scalar));
    } else {
      static_assert(std::is_aggregate_v<T>,
                    "a module's argument must be arithmetic, Eigen, optional, vector, or an "
                    "aggregate of these");
      boost::pfr::for_each_field(x, [this](const auto& field) { value(field); });
    }
  }
};

class Reader {
 public:
  explicit Reader(const Bytes& bytes) : at_(bytes.data()), end_(bytes.data() + bytes.size()) {}

  bool at_end() const { return at_ == end_; }
  void expect_end() const {
    if (!at_end()) throw WireError("bytes left over after the last value");
  }

  void raw(void* data, std::size_t size) {
    if (static_cast<std::size_t>(end_ - at_) < size)
      throw WireError("the message ends inside a value");
    if (size > 0) std::memcpy(data, at_, size);
    at_ += size;
  }

  template <class T>
  void value(T& x) {
    if constexpr (std::is_same_v<T, bool>) {
      std::uint8_t byte = 0;
      raw(&byte, 1);
      if (byte > 1) throw WireError("a boolean that is neither 0 nor 1");
      x = byte == 1;
    } else if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      raw(&x, sizeof x);
    } else if constexpr (std::is_same_v<T, std::string>) {
      x.resize(count(1));
      raw(x.data(), x.size());
    } else if constexpr (std::is_same_v<T, Quaterniond>) {
      raw(x.coeffs().data(), 4 * sizeof(double));
    } else if constexpr (is_optional<T>::value) {
      bool has = false;
      value(has);
      if (has)
        value(x.emplace());
      else
        x.reset();
    } else if constexpr (is_vector<T>::value) {
      // The vector grows as it is read: a count alone must not allocate a thousand times the
      // message's size.
      const std::uint32_t n = count(1);
      x.clear();
      for (std::uint32_t i = 0; i < n; ++i) {
        typename T::value_type item;
        value(item);
        x.push_back(std::move(item));
      }
    } else if constexpr (is_matrix<T>) {
      std::uint32_t rows = 0, cols = 0;
      value(rows);
      value(cols);
      const bool fits = (T::RowsAtCompileTime == Eigen::Dynamic ||
                         rows == static_cast<std::uint32_t>(T::RowsAtCompileTime)) &&
                        (T::ColsAtCompileTime == Eigen::Dynamic ||
                         cols == static_cast<std::uint32_t>(T::ColsAtCompileTime));
      // by division: the product of both and of the size of a number may not fit into 64 bits
      const std::uint64_t most =
          static_cast<std::uint64_t>(end_ - at_) / sizeof(typename T::Scalar);
      if (!fits || (cols != 0 && rows > most / cols))
        throw WireError("a matrix of an impossible size");
      x.resize(rows, cols);
      raw(x.data(), std::uint64_t{rows} * cols * sizeof(typename T::Scalar));
    } else {
      static_assert(std::is_aggregate_v<T>);
      boost::pfr::for_each_field(x, [this](auto& field) { value(field); });
    }
  }

 private:
  // A count of items of at least `item_size` bytes each. A count that the message cannot hold is
  // refused before any allocation.
  std::uint32_t count(std::size_t item_size) {
    std::uint32_t n = 0;
    value(n);
    if (n > static_cast<std::size_t>(end_ - at_) / item_size)
      throw WireError("a count that the message cannot hold");
    return n;
  }

  const std::uint8_t* at_;
  const std::uint8_t* end_;
};

}  // namespace tumble::modules
