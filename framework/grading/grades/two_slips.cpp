#include "framework/grading/grades/two_slips.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>

namespace tumble::grading {
namespace {

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

double of_both(Together rule, double right, double a, double b) {
  switch (rule) {
    case Together::kFactors: return right == 0.0 ? (a == 0.0 ? b : a) : a * b / right;
    case Together::kTerms: return a + b - right;
    case Together::kTermsBelow: break;
  }
  return 1.0 / (1.0 / a + 1.0 / b - 1.0 / right);  // 0 where one of them is 0
}

bool is_same(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), is_same_number);
}

}  // namespace

const char* number_at(const char* begin, const char* at, double& value) {
  if (at != begin && is_word(at[-1])) return nullptr;
  char* end = nullptr;
  value = std::strtod(at, &end);
  return end == at ? nullptr : end;
}

bool is_same_number(double a, double b) {
  constexpr double kSame = 1e-6;  // relative
  if (std::isnan(a) && std::isnan(b)) return true;
  return a == b || std::abs(a - b) <= kSame * std::max(std::abs(a), std::abs(b));
}

Answer answer_of(const std::string& text) {
  Answer answer;
  const char* at = text.c_str();
  while (*at != '\0') {
    double value = 0.0;
    if (const char* end = number_at(text.c_str(), at, value)) {
      answer.numbers.push_back(value);
      answer.words += '#';
      at = end;
    } else {
      answer.words += *at++;
    }
  }
  return answer;
}

bool is_answer_of_both(Together rule, const Answer& right, const Answer& a, const Answer& b,
                       const Answer& found) {
  if (right.numbers.empty() || right.words != found.words || a.words != found.words ||
      b.words != found.words || is_same(found.numbers, a.numbers) ||
      is_same(found.numbers, b.numbers) || is_same(found.numbers, right.numbers))
    return false;
  // Parts of a vector that cancel leave round-off of its largest number.
  double scale = 0.0;
  for (const Answer* answer : {&right, &a, &b})
    for (const double number : answer->numbers) scale = std::max(scale, std::abs(number));
  constexpr double kRoundOff = 2e-7;  // of four numbers shown in 8 digits: half a unit each
  for (std::size_t i = 0; i < found.numbers.size(); ++i) {
    const double both = of_both(rule, right.numbers[i], a.numbers[i], b.numbers[i]);
    if (!is_same_number(found.numbers[i], both) &&
        !(std::abs(found.numbers[i] - both) <= kRoundOff * scale))
      return false;
  }
  return true;
}

}  // namespace tumble::grading
