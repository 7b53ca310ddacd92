#include "framework/core/text.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace tumble {
namespace {

bool is_small(char c) { return c >= 'a' && c <= 'z'; }

std::size_t letters_from(const std::string& text, std::size_t at) {
  std::size_t end = at;
  while (end < text.size() && std::isalpha(static_cast<unsigned char>(text[end])) != 0) ++end;
  return end - at;
}

// "the kinetic energy", "a ball", "round-off"; not "e = 1", "a t^2", "mu = 0.5", "w' = 0",
// "rk4_step".
bool begins_with_a_word(const std::string& text) {
  const std::size_t length = letters_from(text, 0);
  if (length == text.size()) return length > 1;
  const char end = text[length], next = length + 1 < text.size() ? text[length + 1] : ' ';
  if (end == '-' || end == '\'') return length > 1 && letters_from(text, length + 1) > 0;
  if (end != ' ') return length > 1 && std::string_view(",:;.").find(end) != std::string_view::npos;
  if (length == 1) return text[0] == 'a' && letters_from(text, 2) > 1;
  return std::string_view("=<>+*/^").find(next) == std::string_view::npos;
}

}  // namespace

std::string lowercase(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::string counted(std::size_t n, const std::string& noun) {
  return std::to_string(n) + ' ' + noun + (n == 1 ? "" : "s");
}

std::string sentence(std::string text) {
  if (text.empty()) return text;
  if (is_small(text[0])) {
    if (begins_with_a_word(text))
      text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    else
      text.insert(0, "Here ");
  }
  if (std::string_view(".!?").find(text.back()) == std::string_view::npos) text += '.';
  return text;
}

std::string sentences(const std::string& first, const std::string& second) {
  return sentence(first) + (first.empty() || second.empty() ? "" : " ") + sentence(second);
}

std::string few_digits(double x, int digits) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*e", digits - 1, x == 0.0 ? 0.0 : x);
  std::snprintf(text, sizeof text, "%.6g", std::strtod(text, nullptr));
  std::string shown = text;
  // "1e-09", "1e+06"
  const std::size_t power = shown.find('e');
  if (power == std::string::npos || power + 2 >= shown.size()) return shown;
  while (power + 3 < shown.size() && shown[power + 2] == '0') shown.erase(power + 2, 1);
  if (shown[power + 1] == '+') shown.erase(power + 1, 1);
  return shown;
}

std::string three_digits(double x) { return few_digits(x, 3); }

std::string step_in_words(double step_s) {
  constexpr double kRounding = 1e-6;  // of what decimals leave
  constexpr double kMost = 1e5;       // "1e-7" is read sooner than "1/10000000"
  const double whole = std::round(1.0 / step_s);
  const bool is_part = whole >= 2 && whole < kMost && std::abs(step_s * whole - 1.0) < kRounding;
  return is_part ? "1/" + std::to_string(std::llround(whole)) : three_digits(step_s);
}

std::string capitalised(std::string text) {
  const std::size_t end = std::min(text.find_first_of(" ,:"), text.size());
  const bool is_word = end > 2 && std::all_of(text.begin(), text.begin() + static_cast<long>(end),
                                              [](char c) { return (c >= 'a' && c <= 'z'); });
  if (is_word) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

std::string without_middle(const std::string& text, std::size_t width) {
  if (text.size() <= width) return text;
  const std::size_t head = (width - 2) / 2;
  return text.substr(0, head) + ".." + text.substr(text.size() - (width - 2 - head));
}

std::vector<std::string> at_commas(const std::string& text) {
  std::vector<std::string> parts(1);
  int depth = 0;
  for (const char c : text) {
    if (c == '<' || c == '(' || c == '[' || c == '{') ++depth;
    if (c == '>' || c == ')' || c == ']' || c == '}') --depth;
    if (c == ',' && depth == 0)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

}  // namespace tumble
