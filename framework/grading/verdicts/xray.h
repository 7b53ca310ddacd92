/// An equation with the numbers of one call in each of its terms, for the story of a wrong answer.
///
///   x-ray:    j = -(1 + e) (n . u) / k   (A1.9)
///             n . u                      -3 m/s
///             1 + e                      1.5   <- your answer comes out with 1 for 1 + e
///             j, expected                9 N s
///             j, found                   6 N s
///
/// An assignment describes its equations where its hidden tests are (solutions_private): the terms
/// are computed from the call's arguments, and the answer must be that of the terms. Wrong variants
/// of a term are tried: each that gives the answer that came is named at its term. Where none does,
/// and no part of the answer shows a wrong term, the line of the answer says so: the function may
/// have its formula in another form, or two wrong terms. Numbers have six digits, and more where
/// the difference begins behind them.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "framework/modules/wire.h"

namespace tumble::grading {

struct XrayTerm {
  std::string name;  // as in the handout: "n . u"
  VectorXd value;
  std::string unit = {};
  // what the submission has here, where the judge sees it (a part of the answer, a stage); empty:
  // inside the function, where nobody sees it
  VectorXd found = {};
  // what it asked a function argument: where that is wrong the call is, also with an answer that is
  // right for what it was told there
  bool is_asked = false;
};

/// The answer that comes out where one term is written otherwise. A variant whose words say more
/// than that (that a ray points away) belongs to a call in which this is so.
struct XrayVariant {
  std::size_t term;  // by its place
  std::string says;  // behind "your answer comes out": "without this term", "with e for 1 + e"
  VectorXd answer;
};

struct Xray {
  std::string equation;  // with its number in the handout
  std::vector<XrayTerm> terms;
  std::string answer, unit;  // name and unit of the answer
  VectorXd expected, found;
  std::vector<XrayVariant> variants;
  // an answer in words, where numbers do not say it ("no hit"); empty: its numbers
  std::function<std::string(const VectorXd&)> words = {};
};

/// How a mark begins that says which wrong variant of a term gives the answer that came.
inline constexpr const char* kComesOut = "your answer comes out ";

/// Whether a call was answered, and asked, as its equation says, to round-off: then another call is
/// the wrong one, and there is nothing to show.
bool is_answered_rightly(const Xray& xray);

/// Lines of a story. Empty where the call was answered rightly.
/// @param is_answered  false: `found` is of no call
std::string xray_in_words(const Xray& xray, bool is_answered = true);

/// Whether both are the same to round-off.
bool is_near(const VectorXd& a, const VectorXd& b);

/// "(0.25, 46.159)", "3 m/s": six digits.
std::string shown(const VectorXd& v, const std::string& unit, int digits = 6);

/// A number or vector as a vector.
VectorXd numbers(double x);
template <class Derived>
VectorXd numbers(const Eigen::MatrixBase<Derived>& x) {
  return x;
}
template <class A, class B>
VectorXd numbers(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<B>& b) {
  VectorXd both(a.size() + b.size());
  both << a, b;
  return both;
}

using XrayOfCall =
    std::function<std::optional<Xray>(modules::Reader& arguments, modules::Reader& answer)>;

/// Registers the equation of a module's function.
/// @return true, so that it can initialise a constant
bool add_xray(const std::string& function, XrayOfCall xray);

/// The same, for a description that takes answer and arguments by their types.
template <class R, class... A>
bool add_xray_of(const std::string& function,
                 std::optional<Xray> (*describe)(const R& found, const A&... arguments)) {
  return add_xray(function, [describe](modules::Reader& arguments, modules::Reader& answer) {
    std::tuple<A...> values;
    std::apply([&](auto&... a) { (arguments.value(a), ...); }, values);
    R found{};
    if (!answer.at_end()) answer.value(found);
    return std::apply([&](const auto&... a) { return describe(found, a...); }, values);
  });
}

/// The last call of this thread to the worker, as it travelled.
struct LastCall {
  std::string function;              // empty: none, or too long to keep
  modules::Bytes arguments, answer;  // arguments without the function's number; no answer: empty
  // what it asked its function arguments: their number, then arguments; and what it was answered
  std::vector<std::pair<modules::Bytes, modules::Bytes>> asked = {};
};
LastCall& last_call();
/// A call begins: the last one is kept among a few.
void begin_call_to_show();

/// The x-ray of the last call; empty where its function has none, or it was answered rightly. Where
/// it was, a test may have asked more of the function to find out what is wrong: then it is that of
/// the first of the few kept calls which was not. A call without an answer shows what its terms
/// are.
/// @param story  of the failure: of several wrong calls it is that of the one whose answer the
///   story names as found; empty: the last one
std::string xray_of_last_call(const std::string& story = "");

}  // namespace tumble::grading
