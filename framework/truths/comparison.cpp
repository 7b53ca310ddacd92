#include "framework/truths/comparison.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/not_implemented.h"

namespace tumble::truths {

void Comparison::check(const std::string& output, double error, double floor, double tolerance,
                       const std::string& note) {
  const Verdict verdict = error <= tolerance ? Verdict::kRight : Verdict::kWrong;  // false for NaN
  lines_.push_back({output, error, floor, tolerance, verdict, note});
}

void Comparison::closed_form(const Case& truth, const std::string& output, double found) {
  closed_form(output, std::abs(found - truth.output(output).number()), truth.floor(output));
}

void Comparison::closed_form(const Case& truth, const std::string& output, const VectorXd& found) {
  closed_form(output, largest_difference(found, truth.output(output).vector()),
              truth.floor(output));
}

void Comparison::agree(const std::string& output, bool agrees, const std::string& note) {
  lines_.push_back({output, agrees ? 0.0 : kUnset, kUnset, 0.0,
                    agrees ? Verdict::kRight : Verdict::kWrong, note});
}

void Comparison::not_compared(const std::string& output, const std::string& why) {
  lines_.push_back({output, kUnset, kUnset, kUnset, Verdict::kNotCompared, why});
}

void Comparison::attempt(const std::string& outputs, const std::function<void()>& group) {
  const auto stopped = [&](Verdict verdict, const std::string& note) {
    lines_.push_back({outputs, kUnset, kUnset, kUnset, verdict, note});
  };
  try {
    group();
  } catch (const NotImplemented& missing) {
    stopped(Verdict::kNotAttempted, missing.what());
  } catch (const UserError&) {
    throw;  // the file or the command is wrong, not the module
  } catch (const std::exception& error) {
    stopped(Verdict::kWrong, std::string("threw an exception: ") + error.what());
  }
}

double largest_difference(const VectorXd& found, const VectorXd& expected) {
  if (found.size() != expected.size() || !found.allFinite()) return kUnset;
  return found.size() == 0 ? 0.0 : (found - expected).cwiseAbs().maxCoeff();
}

double quaternion_difference(const Quaterniond& found, const VectorXd& expected) {
  const Eigen::Vector4d q(found.w(), found.x(), found.y(), found.z());
  const double sign = expected.size() == 4 && q.dot(expected) < 0.0 ? -1.0 : 1.0;
  return largest_difference(sign * q, expected);
}

namespace {

// Rank of a line: failures first, then stubs, then the error relative to its tolerance.
double badness(const Line& line) {
  switch (line.verdict) {
    case Verdict::kWrong: return 1e300;
    case Verdict::kNotAttempted: return 1e200;
    case Verdict::kNotCompared: return -1.0;
    case Verdict::kRight: return line.tolerance > 0.0 ? line.error / line.tolerance : 0.0;
  }
  return 0.0;
}

}  // namespace

const Line* worst_line(const std::vector<Line>& lines) {
  const auto worst = std::max_element(lines.begin(), lines.end(), [](const Line& a, const Line& b) {
    return badness(a) < badness(b);
  });
  return worst == lines.end() ? nullptr : &*worst;
}

Verdict verdict_of(const std::vector<Line>& lines) {
  const auto any = [&](Verdict verdict) {
    return std::any_of(lines.begin(), lines.end(),
                       [=](const Line& line) { return line.verdict == verdict; });
  };
  for (const Verdict verdict : {Verdict::kWrong, Verdict::kNotAttempted, Verdict::kRight}) {
    if (any(verdict)) return verdict;
  }
  return Verdict::kNotCompared;
}

std::string word_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::kRight: return "right";
    case Verdict::kWrong: return "WRONG";
    case Verdict::kNotAttempted: return "not attempted";
    case Verdict::kNotCompared: return "not compared";
  }
  return "";
}

}  // namespace tumble::truths
