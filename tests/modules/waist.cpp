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
double missing(double) { throw NotImplemented("missing", "handouts/none.md"); }

}  // namespace tumble::waist
