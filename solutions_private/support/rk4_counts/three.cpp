// The reference of a2 but for a Runge-Kutta step that evaluates the derivative three times: the
// judge, which answers and counts these evaluations, must call it wrong.
#include "assignments/a2_integration/a2_integration.h"

#define rk4_step rk4_step_of_the_reference
#include "solutions_private/a2_integration/a2_integration.cpp"
#undef rk4_step

namespace tumble::a2 {

VectorXd rk4_step(const OdeFunction& f, double t, const VectorXd& y, double h) {
  const VectorXd k1 = f(t, y);
  const VectorXd k2 = f(t + h / 2, y + h / 2 * k1);
  const VectorXd k4 = f(t + h, y + h * k2);
  return y + h / 6 * (k1 + 4 * k2 + k4);
}

}  // namespace tumble::a2
