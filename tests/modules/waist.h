/// A module for tests of the waist itself: every kind of value that may cross it, and functions
/// whose behaviour an argument selects.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/math.h"
#include "framework/core/not_implemented.h"
#include "framework/modules/answer_sizes.h"
#include "framework/modules/module.h"

namespace tumble::waist {

enum class Colour { kRed = 1, kBlue = 7 };

struct Inner {
  bool flag = false;
  Colour colour = Colour::kRed;
  std::optional<double> weight;
  Vector3d point = Vector3d::Zero();
};

struct Everything {
  double number = 0.0;
  int count = 0;
  std::string text;
  Quaterniond turn = Quaterniond::Identity();
  Eigen::MatrixXd matrix;
  std::vector<Inner> inner;
};

double twice(double x);
Everything echo(const Everything& value);
/// The sum of f over 0, ..., calls - 1.
double call_back(const std::function<double(double)>& f, int calls);
/// Performs the attack named `what`, and returns how far it got.
std::string attack(const std::string& what);
/// A step of a method. `what` is "right" to call f with y and return a vector of the same size;
/// "ask 0" calls f with 0 numbers, and "answer 3" returns 3.
VectorXd step(const std::function<VectorXd(double, const VectorXd&)>& f, const VectorXd& y,
              const std::string& what);
/// Not implemented.
double missing(double x);

}  // namespace tumble::waist

TUMBLE_MODULE(waist, twice, echo, call_back, attack, missing, step);

#ifndef TUMBLE_BUILDING_MODULE  // for callers
namespace tumble::waist {

inline void describe(modules::AnswerSizes<Module>& sizes) {
  sizes.add(&Module::step, [](const std::function<VectorXd(double, const VectorXd&)>&,
                              const VectorXd& y, const std::string&) { return y.size(); });
}

}  // namespace tumble::waist
#endif
