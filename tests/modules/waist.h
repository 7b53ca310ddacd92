/// A module for tests of the waist itself: every kind of value that may cross it, and a function that does what it is told.
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
/// f called `calls` times, the answers added.
double call_back(const std::function<double(double)>& f, int calls);
/// Does something evil, named by `what`, and says how far it came.
std::string attack(const std::string& what);
/// A step of a method, as `what` says: "right" asks f with y and answers with as many numbers, "ask 0" and "answer 3" do not.
VectorXd step(const std::function<VectorXd(double, const VectorXd&)>& f, const VectorXd& y, const std::string& what);
/// Never written.
double missing(double x);

}  // namespace tumble::waist

TUMBLE_MODULE(waist, twice, echo, call_back, attack, missing, step);

namespace tumble::waist {

inline void describe(modules::AnswerSizes<Module>& sizes) {
  sizes.add(&Module::step, [](const std::function<VectorXd(double, const VectorXd&)>&, const VectorXd& y, const std::string&) { return y.size(); });
}

}  // namespace tumble::waist
