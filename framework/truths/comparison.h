/// Comparison with reference values: error, error floor, tolerance and verdict of each output of a
/// case.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "framework/truths/truth_case.h"

namespace tumble::truths {

inline constexpr double kNoFrames = 1e-3;  // Hz, of a run of which only events are used

/// A closed form passes within this multiple of the error that double precision forces: a few dozen
/// roundings.
inline constexpr double kClosedFormFactor = 100.0;

/// The classical Runge-Kutta method's, where its error goes as h^4; how far a right one may be off
/// it; and, half of that, how near to each other two successive orders are that have settled.
inline constexpr double kOrder = 4.0, kOrderTolerance = 0.1, kSettled = 0.05;

enum class Verdict {
  kRight,
  kWrong,
  kNotAttempted,  // the module's function is a stub
  kNotCompared,   // with the reason in the note: another law's result, beyond double precision, ...
};

/// One output of one case.
struct Line {
  std::string output;           // "j", "rows[3].toi"
  double error = kUnset;        // |found - expected|, largest component, in the output's unit
  double error_floor = kUnset;  // forced by double precision; NaN where the file has none
  double tolerance = kUnset;
  Verdict verdict = Verdict::kNotCompared;
  // the origin of a tolerance that is not the closed form's; the reason for no comparison; the
  // error that stopped it
  std::string note;
};

/// Collects the lines of one case.
class Comparison {
 public:
  const std::vector<Line>& lines() const { return lines_; }

  /// One error against a tolerance. NaN and infinity never pass.
  void check(const std::string& output, double error, double floor, double tolerance,
             const std::string& note = "");
  /// With the closed form's tolerance: 100 times the floor.
  void closed_form(const std::string& output, double error, double floor) {
    check(output, error, floor, kClosedFormFactor * floor);
  }
  /// Scalar or vector output of a case, by name, with its floor from the file. A list shorter than
  /// Right or wrong without a number: a yes or no, a count, a name.
  void closed_form(const Case& truth, const std::string& output, double found);
  void closed_form(const Case& truth, const std::string& output, const VectorXd& found);
  /// Right or wrong without a number: a verdict, a count, a name.
  void agree(const std::string& output, bool agrees, const std::string& note);
  void not_compared(const std::string& output, const std::string& why);

  /// Runs comparisons of a module's functions: a stub gives one line "not attempted", an exception
  /// one line "wrong".
  void attempt(const std::string& outputs, const std::function<void()>& group);

 private:
  std::vector<Line> lines_;
};

/// Largest |found_i - expected_i|; NaN for different sizes or anything that is not finite.
double largest_difference(const VectorXd& found, const VectorXd& expected);
/// The same for unit quaternions, of which q and -q are one orientation. @param expected  (4), w
/// first
double quaternion_difference(const Quaterniond& found, const VectorXd& expected);

/// The worst line of a case: a failure, else one not attempted, else the one with the largest error
/// relative to its tolerance. Null when empty.
const Line* worst_line(const std::vector<Line>& lines);
/// Wrong if any line is wrong, else not attempted if any is, else right if any is, else not
/// compared.
Verdict verdict_of(const std::vector<Line>& lines);
std::string word_of(Verdict verdict);

}  // namespace tumble::truths
