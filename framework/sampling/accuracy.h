/// How far answers of chains are from the truth, over the CPU time that they took.
#pragma once

#include <vector>

#include "framework/sampling/answers.h"

namespace tumble::sampling {

/// The error of one chain's answers, as several chains of one kind show it.
struct AccuracyPoint {
  int samples = 0;        // of each chain, the first so many
  double cpu_s = kUnset;  // of one chain, the mean over chains
  double error = kUnset;  // [deviations of the truth], root of the mean square over chains, numbers
};

/// Errors of ever longer beginnings of the chains: 1/64, 1/32, ..., 1 of their samples. A beginning
/// in which one of the chains has no world that does what is asked has no answer, and no point.
/// @param truth   the same numbers by other means: its means and deviations are taken as exact
/// @param chains  of equal length, each from a start of its own: the error is that of one of them
std::vector<AccuracyPoint> accuracy_of(const std::vector<Chain>& chains, const Answers& truth);

/// The slope of ln error over ln time, by least squares; NaN for fewer than three points. Of a mean
/// of samples -1/2, however they depend on each other, once a chain is long.
double slope_of(const std::vector<AccuracyPoint>& points);

/// CPU time for an error, from the last point by the law of that slope, error ~ time^(-1/2);
/// infinite without a point.
double price_of(const std::vector<AccuracyPoint>& points, double error);

}  // namespace tumble::sampling
