/// What two mistakes in one expression answer together, from what each answers alone.
///
/// With r the right answer, a and b those of either mistake, and f that of both, number by number:
///   factors of a product                 f / r = (a / r) (b / r)         a sign, and e for 1 + e
///   terms of a sum                       f - r = (a - r) + (b - r)       two terms left out
///   terms of a sum that is divided by    1/f - 1/r = (1/a - 1/r) + (1/b - 1/r)
/// A mistake that decides, such as a comparison, follows none of them.
#pragma once

#include <string>
#include <vector>

namespace tumble::grading {

/// An answer in a story's words, taken apart: "(1; -2) m/s" is "(#; #) m/s" with 1 and -2.
struct Answer {
  std::string words;
  std::vector<double> numbers;
};
Answer answer_of(const std::string& text);

/// A number that begins at `at`, and is no part of a word.
/// @return where it ends; null: there is none
const char* number_at(const char* begin, const char* at, double& value);

/// Whether both agree to a millionth: stories show 12 digits, and round-off differs.
bool is_same_number(double a, double b);

enum class Together { kFactors, kTerms, kTermsBelow };
inline constexpr Together kAllTogether[] = {Together::kFactors, Together::kTerms,
                                            Together::kTermsBelow};

/// Whether `found` is the answer of both, and of neither alone. All four in the same words.
bool is_answer_of_both(Together rule, const Answer& right, const Answer& a, const Answer& b,
                       const Answer& found);

}  // namespace tumble::grading
