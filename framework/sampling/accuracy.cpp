#include "framework/sampling/accuracy.h"

#include <cmath>
#include <limits>

namespace tumble::sampling {
namespace {

/// The mean of a number among the first samples that do what is asked; NaN where none does.
double mean_of(const Chain& chain, int samples, Eigen::Index number) {
  double sum = 0.0, done = 0.0;
  for (Eigen::Index i = 0; i < samples; ++i)
    if (chain.violation[i] == 0.0) sum += chain.x(i, number), done += 1.0;
  return done > 0.0 ? sum / done : kUnset;
}

}  // namespace

std::vector<AccuracyPoint> accuracy_of(const std::vector<Chain>& chains, const Answers& truth) {
  std::vector<AccuracyPoint> points;
  const int all = static_cast<int>(chains.front().x.rows());
  for (int part = 64; part >= 1; part /= 2) {
    AccuracyPoint point{all / part, 0.0, 0.0};
    if (point.samples == 0) continue;
    for (const Chain& chain : chains) {
      point.cpu_s += chain.cpu_s[point.samples - 1] / static_cast<double>(chains.size());
      for (std::size_t number = 0; number < truth.estimates.size(); ++number) {
        const Answer& right = truth.estimates[number].answer;
        const double off =
            (mean_of(chain, point.samples, static_cast<Eigen::Index>(number)) - right.mean) /
            right.deviation;
        point.error += off * off / static_cast<double>(chains.size() * truth.estimates.size());
      }
    }
    point.error = std::sqrt(point.error);
    if (std::isfinite(point.error) && point.error > 0.0) points.push_back(point);
  }
  return points;
}

double slope_of(const std::vector<AccuracyPoint>& points) {
  if (points.size() < 3) return kUnset;
  const double n = static_cast<double>(points.size());
  double mean_x = 0.0, mean_y = 0.0, xx = 0.0, xy = 0.0;
  for (const AccuracyPoint& point : points) {
    mean_x += std::log(point.cpu_s) / n;
    mean_y += std::log(point.error) / n;
  }
  for (const AccuracyPoint& point : points) {
    const double x = std::log(point.cpu_s) - mean_x;
    xx += x * x;
    xy += x * (std::log(point.error) - mean_y);
  }
  return xy / xx;
}

double price_of(const std::vector<AccuracyPoint>& points, double error) {
  if (points.empty()) return std::numeric_limits<double>::infinity();
  const double ratio = points.back().error / error;
  return points.back().cpu_s * ratio * ratio;
}

}  // namespace tumble::sampling
