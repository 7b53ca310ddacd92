/// A failing test tells its story: what was set up, what was expected, what came, the likely slip,
/// where to read.
///
///   const Story story{.scene = "a 2 kg ball at 3 m/s hits a wall, e = 0.5",
///                     .slip = "forgetting the (1 + e)", .handout =
///                     "handouts/a1_impulse.md#eq-a1-8"};
///   expect_near(a1().collision_impulse(...), 9.0, 10 * kEps * 9.0, "N s", story);
#pragma once

#include <string>
#include <utility>

#include <Eigen/Core>

namespace tumble::testing {

inline constexpr double kEps = 2.220446049250313e-16;  // spacing of doubles at 1

/// What a story says of the mistake. Words alone say what holds here or what may be wrong, and are
/// told as "look at:". Only where the answer that came shows the mistake it is told as "likely:".
struct Mistake {
  std::string words;
  bool is_shown = false;

  Mistake(const char* text) : words(text) {}
  Mistake(std::string text) : words(std::move(text)) {}
  bool empty() const { return words.empty(); }
};
/// A mistake that the answer shows: it gives this number, or leaves this trace.
inline Mistake shown(std::string words) {
  Mistake mistake(std::move(words));
  mistake.is_shown = true;
  return mistake;
}

struct Story {
  std::string scene = "";    // what was set up, with numbers and units
  std::string steps = "";    // what was done to it, where more than one call
  Mistake slip = "";         // what to look at; the mistake itself where the answer shows it
  std::string handout = "";  // file and anchor
  // what to look at where NaN or infinity came; empty: nothing special to this scene
  std::string no_number = "";
  // the answer comes from an iteration, whose error may have any size: see slip_in_the_digits
  bool iterates = false;
};

/// The numbers of a vector or a matrix, whatever expression they came from: what is said of them is
/// compiled once, in story.cpp.
struct Numbers {
  const double* data = nullptr;  // column by column; lives as long as what it is of
  Eigen::Index rows = 0, columns = 0;
};
template <class Plain>
Numbers numbers_of(const Eigen::PlainObjectBase<Plain>& m) {
  static_assert(!Plain::IsRowMajor || Plain::RowsAtCompileTime == 1,
                "numbers stand column by column");
  return {m.data(), m.rows(), m.cols()};
}

// ---- Slips that show in the numbers themselves, whatever the function ----
inline constexpr const char* kFloat =
    "float where double belongs: the relative error is that of float's 24 bits, about 6e-8";
inline constexpr const char* kKept =
    "something is kept between calls (a static or global variable, or a reference to one): the "
    "first call is answered rightly, and a later one with what the first one left";

/// The story with another slip; as it is where that is empty, or where the story has one that its
/// answer shows and this is none.
Story with_slip(Story story, const Mistake& slip);
std::string tell(const Story& story, const std::string& expected, const std::string& found,
                 const std::string& unit, const std::string& difference = "");

std::string show(double x);
/// A scale: powers of two as such ("2^-60"), other numbers in three digits.
std::string show_scale(double x);
std::string show(const Numbers& m);
template <class Derived>
std::string show(const Eigen::MatrixBase<Derived>& m) {
  return show(numbers_of(m.eval()));
}

/// Fails the test with this story. The first three say it; more of them would only hide the next
/// test's. A story that has been told is not told again.
void report_failure(const std::string& told);

/// What the digits of a wrong answer alone say: no number, or float. Empty where they say neither.
/// Float is shown where every component is a float exactly and near the expected one, which is not.
/// Where only the error is a few of float's roundings (2^-24), and the test allows none of that
/// size, float is one way to such an answer. The error of an iteration does not say even that.
Mistake slip_in_the_digits(const Numbers& found, const Numbers& expected, double tolerance,
                           const Story& story);

/// Absolute comparison. NaN never passes.
void expect_near(double found, double expected, double tolerance, const std::string& unit,
                 const Story& story);
/// Largest component.
void expect_near(const Numbers& found, const Numbers& expected, double tolerance,
                 const std::string& unit, const Story& story);
template <class A, class B>
void expect_near(const Eigen::MatrixBase<A>& found, const Eigen::MatrixBase<B>& expected,
                 double tolerance, const std::string& unit, const Story& story) {
  expect_near(numbers_of(found.eval()), numbers_of(expected.eval()), tolerance, unit, story);
}

/// Two calls, the second about the same scene with other numbers: a function that answers the first
/// rightly and the second with the answer of the first (or with none) keeps something between
/// calls. Call it for each function in a test of its own process.
void expect_kept_nothing(const Numbers& first, const Numbers& expected_first, const Numbers& second,
                         const Numbers& expected_second, double tolerance, const std::string& unit,
                         const Story& story);
template <class A, class B>
void expect_kept_nothing(const Eigen::MatrixBase<A>& first,
                         const Eigen::MatrixBase<A>& expected_first,
                         const Eigen::MatrixBase<B>& second,
                         const Eigen::MatrixBase<B>& expected_second, double tolerance,
                         const std::string& unit, const Story& story) {
  expect_kept_nothing(numbers_of(first.eval()), numbers_of(expected_first.eval()),
                      numbers_of(second.eval()), numbers_of(expected_second.eval()), tolerance,
                      unit, story);
}

void expect_true(bool holds, const std::string& expected, const std::string& found,
                 const Story& story);

}  // namespace tumble::testing
