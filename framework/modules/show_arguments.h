/// The arguments of a call in words, derived from their types like the wire format: for the story
/// of a call that never returned.
///   (0, 0, 5) for vectors, {time: 1, point: (0, 0, 5)} for structs, [n: ..., ...] for lists
/// Fields have the names of their types. Names of parameters are in no type, and so not here.
#pragma once

#include <algorithm>
#include <cstdio>
#include <functional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "framework/modules/wire.h"

namespace tumble::modules {

namespace detail {

inline constexpr std::size_t kArgumentShown = 600;  // characters
// of a list, and of a vector without fixed size
inline constexpr int kItemsShown = 4;

#if defined(__GNUC__) && !defined(__clang__)
// An object that is nowhere: only the addresses of its fields are named, by the compiler.
template <class T>
struct Absent {
  const T value;
};
template <class T>
extern const Absent<T> absent;

template <auto* field>
constexpr std::string_view spelled() {
  return __PRETTY_FUNCTION__;  // "... field = (& absent<Hit>.Absent<Hit>::value.Hit::time); ..."
}

/// The name of a struct's field in its source; empty where the compiler does not tell.
template <class T, std::size_t number>
constexpr std::string_view name_of_field() {
  constexpr std::string_view text = spelled<&boost::pfr::get<number>(absent<T>.value)>();
  constexpr std::size_t end = text.find(");");
  if (end == std::string_view::npos) return {};
  constexpr std::size_t begin = text.rfind("::", end);
  return begin == std::string_view::npos ? std::string_view()
                                         : text.substr(begin + 2, end - begin - 2);
}
#else
template <class T, std::size_t number>
constexpr std::string_view name_of_field() {
  return {};
}
#endif

inline void show(std::string& text, double x) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.6g", x);
  text += digits;
}

// Items between brackets, at most the first few.
template <class Item>
void show_items(std::string& text, const char* brackets, Eigen::Index count, Eigen::Index shown,
                const Item& item) {
  text += brackets[0];
  if (shown < count) text += std::to_string(count) + ": ";
  for (Eigen::Index i = 0; i < std::min(count, shown); ++i) {
    if (i > 0) text += ", ";
    item(i);
  }
  if (shown < count) text += ", ...";
  text += brackets[1];
}

template <class T>
void show_argument(std::string& text, const T& x) {
  if (text.size() > kArgumentShown) return;
  if constexpr (is_function<T>::value) {
    text += "a function";
  } else if constexpr (std::is_same_v<T, bool>) {
    text += x ? "true" : "false";
  } else if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
    show(text, static_cast<double>(x));
  } else if constexpr (std::is_same_v<T, std::string>) {
    text += '"' + x + '"';
  } else if constexpr (std::is_same_v<T, Quaterniond>) {
    show_argument(text, Eigen::Vector4d(x.w(), x.x(), x.y(), x.z()));
  } else if constexpr (is_optional<T>::value) {
    if (x)
      show_argument(text, *x);
    else
      text += "nothing";
  } else if constexpr (is_vector<T>::value) {
    show_items(text, "[]", static_cast<Eigen::Index>(x.size()), kItemsShown,
               [&](Eigen::Index i) { show_argument(text, x[static_cast<std::size_t>(i)]); });
  } else if constexpr (is_matrix<T>) {
    const Eigen::Index shown = T::SizeAtCompileTime == Eigen::Dynamic ? 2 * kItemsShown : x.rows();
    if (x.cols() == 1)
      show_items(text, "()", x.rows(), shown,
                 [&](Eigen::Index i) { show(text, static_cast<double>(x(i, 0))); });
    else
      show_items(text, "()", x.rows(), shown, [&](Eigen::Index i) {
        show_items(text, "()", x.cols(), shown,
                   [&](Eigen::Index k) { show(text, static_cast<double>(x(i, k))); });
      });
  } else {
    static_assert(std::is_aggregate_v<T>);
    bool is_first = true;
    text += '{';
    boost::pfr::for_each_field(x, [&](const auto& field, auto number) {
      if (!is_first) text += ", ";
      is_first = false;
      if (constexpr auto name = name_of_field<T, decltype(number)::value>(); !name.empty())
        (text += name) += ": ";
      show_argument(text, field);
    });
    text += '}';
  }
}

}  // namespace detail

/// Each argument in words: "{origin: (0, 0, 5), direction: (0, 0, -1)}", "0.5". A long one is cut
/// and ends with "...".
template <class... A>
std::vector<std::string> show_arguments(const A&... arguments) {
  std::vector<std::string> all;
  const auto show_one = [&all](const auto& a) {
    std::string& text = all.emplace_back();
    detail::show_argument(text, a);
    if (text.size() <= detail::kArgumentShown) return;
    text.resize(detail::kArgumentShown);
    text += " ...";
  };
  (show_one(arguments), ...);
  return all;
}

/// The arguments as bytes, without functions, and from bytes to words: for a call that crashes its
/// process.
template <class... A>
void write_arguments(Writer& writer, const A&... arguments) {
  const auto write = [&writer](const auto& a) {
    if constexpr (!is_function<std::decay_t<decltype(a)>>::value) writer.value(a);
  };
  (write(arguments), ...);
}

template <class... A>
std::vector<std::string> show_written_arguments(const Bytes& bytes) {
  Reader reader(bytes);
  std::tuple<std::decay_t<A>...> arguments;
  const auto read = [&reader](auto& a) {
    if constexpr (!is_function<std::decay_t<decltype(a)>>::value) reader.value(a);
  };
  std::apply([&](auto&... a) { (read(a), ...); }, arguments);
  return std::apply([](const auto&... a) { return show_arguments(a...); }, arguments);
}

}  // namespace tumble::modules
