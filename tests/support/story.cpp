#include "tests/support/story.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <sstream>

#include <gtest/gtest.h>

#include "framework/core/math.h"

namespace tumble::testing {
namespace {

using Values = Eigen::Map<const MatrixXd>;
Values values_of(const Numbers& m) { return {m.data, m.rows, m.columns}; }

constexpr const char* kNoNumber =
    "no number came out (NaN or infinity): a variable that was never set, 0 / 0, an infinite mass "
    "multiplied, or the root of a negative number";

bool is_float(const Values& values) {
  for (Eigen::Index i = 0; i < values.size(); ++i)
    if (static_cast<double>(static_cast<float>(values.data()[i])) != values.data()[i]) return false;
  return true;
}

// A tolerance in two digits, with the reason that its size gives it: what is left of 16 digits
// after the roundings of a formula, or what the test allows a method.
std::string allowance(double tolerance, double scale, const std::string& with_unit) {
  constexpr double kRoundings = 1e-10;  // of the scale: a thousand times what a long formula loses
  std::ostringstream text;
  text.precision(2);
  text << " (allowed " << tolerance << with_unit;
  if (tolerance > 0 && scale > 0 && tolerance <= kRoundings * scale) text << ", for rounding";
  text << ')';
  return text.str();
}

constexpr int kAllDigits = 12;  // of the 16 of a double: what a formula's roundings leave

double size_of(const Values& values) {
  return values.size() > 0 ? values.cwiseAbs().maxCoeff() : 0;
}

double largest_difference(const Values& a, const Values& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

// How many digits of an answer say something: three of its error, or two more than its tolerance
// leaves. Graded pages find known slips by answers that agree to a millionth, also those of two
// slips together: eight digits are the least.
int digits_of(const Values& found, const Values& expected, double tolerance) {
  constexpr int kLeast = 8;
  if (!found.allFinite() || found.size() != expected.size()) return kLeast;
  const double size = std::max(size_of(expected), size_of(found)),
               told = std::max(tolerance / 100, largest_difference(found, expected) / 1000);
  if (!(told > 0) || !(size > 0)) return kAllDigits;
  return std::clamp(static_cast<int>(std::ceil(std::log10(size / told))), kLeast, kAllDigits);
}

// The digits asked for, and those before the point in any case: 98100, never 9.81e+04.
int with_whole_part(int digits, double size) {
  constexpr int kReadable = 7;
  if (!(size >= 1) || !std::isfinite(size)) return digits;
  return std::max(digits, std::min(static_cast<int>(std::floor(std::log10(size))) + 1, kReadable));
}

std::string in_digits(double x, int digits) {
  if (std::isnan(x)) return "nan";  // its sign says nothing
  std::ostringstream text;
  text.precision(with_whole_part(digits, std::abs(x)));
  text << x;
  return text.str();
}

std::string in_digits(const Numbers& m, int digits) {
  // a vector as scenes and x-rays have it, (1, 2, 3); rows of a matrix stand between semicolons
  const char* between_rows = m.columns == 1 ? ", " : "; ";
  const Eigen::IOFormat format(with_whole_part(digits, size_of(values_of(m))), Eigen::DontAlignCols,
                               ", ", between_rows, "", "", "(", ")");
  std::ostringstream text;
  const MatrixXd without_signs = values_of(m).unaryExpr(
      [](double x) { return std::isnan(x) ? std::numeric_limits<double>::quiet_NaN() : x; });
  text << without_signs.format(format);
  return text.str();
}

}  // namespace

Story with_slip(Story story, const Mistake& slip) {
  if (!slip.empty() && (slip.is_shown || !story.slip.is_shown)) story.slip = slip;
  return story;
}

std::string tell(const Story& story, const std::string& expected, const std::string& found,
                 const std::string& unit, const std::string& difference) {
  std::ostringstream text;
  text << "\n  scene:    " << story.scene;
  if (!story.steps.empty()) text << "\n  steps:    " << story.steps;
  const std::string with_unit = unit.empty() ? "" : ' ' + unit;
  text << "\n  expected: " << expected << with_unit << "\n  found:    " << found << with_unit;
  if (!difference.empty()) text << "\n  off by:   " << difference;
  if (!story.slip.empty())
    text << (story.slip.is_shown ? "\n  likely:   " : "\n  look at:  ") << story.slip.words;
  if (!story.handout.empty()) text << "\n  read:     " << story.handout;
  return text.str();
}

std::string show(double x) { return in_digits(x, kAllDigits); }

std::string show_scale(double x) {
  int exponent = 0;
  constexpr int kReadable = 10;  // 1024 and 1/1024 are read as numbers
  if (std::frexp(x, &exponent) == 0.5 && std::abs(exponent - 1) > kReadable)
    return "2^" + std::to_string(exponent - 1);
  std::ostringstream text;
  text.precision(3);
  text << x;
  return text.str();
}

std::string show(const Numbers& m) { return in_digits(m, kAllDigits); }

Mistake slip_in_the_digits(const Numbers& found_numbers, const Numbers& expected_numbers,
                           double tolerance, const Story& story) {
  const Values found = values_of(found_numbers), expected = values_of(expected_numbers);
  if (!found.allFinite()) return story.no_number.empty() ? kNoNumber : story.no_number;
  const double scale = expected.cwiseAbs().maxCoeff(), error = largest_difference(found, expected);
  constexpr double kFloatEps = 0x1p-24;
  if (!(scale > 0) || error > 16 * kFloatEps * scale) return "";
  const bool shows_in_bits = is_float(found) && !is_float(expected);
  const bool shows_in_size =
      !story.iterates && error > kFloatEps / 256 * scale && tolerance < kFloatEps / 4096 * scale;
  if (shows_in_bits) return shown(kFloat);
  if (!shows_in_size) return "";
  std::ostringstream text;
  text << "one way to get such an answer: " << kFloat;
  return text.str();
}

namespace {

// What symbols of a unit there are: "N" of "N (sum of the lower four)", none of "calls of the gap".
std::string symbols_of(const std::string& unit) {
  constexpr int kSymbol = 3;  // letters: kg, rad
  const std::string symbols = unit.substr(0, std::min(unit.find(" ("), unit.size()));
  if (symbols.starts_with('(')) return "";
  int letters = 0;
  for (const char c : symbols) {
    letters = std::isalpha(static_cast<unsigned char>(c)) != 0 ? letters + 1 : 0;
    if (letters > kSymbol) return "";
  }
  return symbols;
}

// "1e-3 m (allowed 1e-9 m)"; empty where nothing can be subtracted.
std::string off_by(double difference, double tolerance, double scale, const std::string& unit) {
  constexpr int kOfADifference = 3;  // digits
  const std::string symbols = symbols_of(unit), with_unit = symbols.empty() ? "" : ' ' + symbols;
  return std::isfinite(difference) ? in_digits(difference, kOfADifference) + with_unit +
                                         allowance(tolerance, scale, with_unit)
                                   : "";
}

bool is_told(const ::testing::TestResult& result, const std::string& told) {
  for (int i = 0; i < result.total_part_count(); ++i) {
    const std::string before = result.GetTestPartResult(i).message();
    // GoogleTest may put its own line before, and "more:" may stand behind
    if (const std::size_t at = before.find(told);
        at != before.npos &&
        (at + told.size() == before.size() || before[at + told.size()] == '\n'))
      return true;
  }
  return false;
}

}  // namespace

void report_failure(const std::string& told) {
  constexpr int kStoriesATest = 3;
  const ::testing::TestInfo* test = ::testing::UnitTest::GetInstance()->current_test_info();
  if (test != nullptr && is_told(*test->result(), told)) return;
  const int told_before = test ? test->result()->total_part_count() : 0;
  const bool is_last = told_before == kStoriesATest - 1;
  if (told_before < kStoriesATest)
    ADD_FAILURE() << told
                  << (is_last ? "\n  more:     what else may differ in this test is left out" : "");
}

void expect_near(double found, double expected, double tolerance, const std::string& unit,
                 const Story& story) {
  const double difference = std::abs(found - expected);
  if (difference <= tolerance) return;
  const Mistake seen = slip_in_the_digits({&found, 1, 1}, {&expected, 1, 1}, tolerance, story);
  const int digits = digits_of(values_of({&found, 1, 1}), values_of({&expected, 1, 1}), tolerance);
  report_failure(tell(with_slip(story, seen), in_digits(expected, digits), in_digits(found, digits),
                      unit, off_by(difference, tolerance, std::abs(expected), unit)));
}

void expect_near(const Numbers& found_numbers, const Numbers& expected_numbers, double tolerance,
                 const std::string& unit, const Story& given) {
  const Values found = values_of(found_numbers), expected = values_of(expected_numbers);
  const bool same_size = found.rows() == expected.rows() && found.cols() == expected.cols();
  const double difference = same_size && found.allFinite()
                                ? largest_difference(found, expected)
                                : std::numeric_limits<double>::quiet_NaN();
  if (difference <= tolerance) return;
  const Story story =
      same_size
          ? with_slip(given, slip_in_the_digits(found_numbers, expected_numbers, tolerance, given))
          : given;
  const std::string off = off_by(difference, tolerance,
                                 expected.size() > 0 ? expected.cwiseAbs().maxCoeff() : 0.0, unit);
  const int digits = digits_of(found, expected, tolerance);
  constexpr Eigen::Index kReadable = 16;  // numbers in a line
  if (same_size && expected.size() > kReadable && found.allFinite()) {
    Eigen::Index row = 0, column = 0;
    (found - expected).cwiseAbs().maxCoeff(&row, &column);
    const std::string where =
        " at [" + std::to_string(row) + "], the worst of " + std::to_string(expected.size());
    report_failure(tell(story, in_digits(expected(row, column), digits) + where,
                        in_digits(found(row, column), digits), unit, off));
  } else {
    report_failure(tell(story, in_digits(expected_numbers, digits),
                        in_digits(found_numbers, digits), unit, off));
  }
}

void expect_kept_nothing(const Numbers& first, const Numbers& expected_first, const Numbers& second,
                         const Numbers& expected_second, double tolerance, const std::string& unit,
                         const Story& story) {
  const auto is_near = [tolerance](const Numbers& x, const Numbers& y) {
    return x.rows * x.columns == y.rows * y.columns &&
           largest_difference(values_of(x), values_of(y)) <= tolerance;
  };
  expect_near(first, expected_first, tolerance, unit, story);
  const bool kept = is_near(first, expected_first) && !is_near(second, expected_second);
  expect_near(second, expected_second, tolerance, unit, with_slip(story, kept ? shown(kKept) : ""));
}

void expect_true(bool holds, const std::string& expected, const std::string& found,
                 const Story& story) {
  if (!holds) report_failure(tell(story, expected, found, ""));
}

}  // namespace tumble::testing
