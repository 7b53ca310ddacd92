// A right implementation of the test module.
#include "tests/modules/waist.h"

namespace tumble::waist {

double twice(double x) { return 2.0 * x; }
Everything echo(const Everything& value) { return value; }
double call_back(const std::function<double(double)>& f, int calls) {
  double sum = 0.0;
  for (int i = 0; i < calls; ++i) sum += f(i);
  return sum;
}
std::string attack(const std::string& what) { return what; }
VectorXd step(const std::function<VectorXd(double, const VectorXd&)>& f, const VectorXd& y,
              const std::string& what) {
  const VectorXd slope =
      what.starts_with("ask ") ? f(0.0, VectorXd::Zero(std::stol(what.substr(4)))) : f(0.0, y);
  return what.starts_with("answer ") ? VectorXd(VectorXd::Zero(std::stol(what.substr(7))))
                                     : VectorXd(y + slope);
}
double missing(double) { throw NotImplemented("missing", "handouts/none.md"); }

}  // namespace tumble::waist
