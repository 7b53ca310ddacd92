// The reference of a2 but for a Runge-Kutta step that evaluates the derivative five times: the
// judge, which answers and counts these evaluations, must call it wrong.
#include "assignments/a2_integration/a2_integration.h"

#define rk4_step rk4_step_of_the_reference
#include "solutions_private/a2_integration/a2_integration.cpp"
#undef rk4_step

namespace tumble::a2 {

VectorXd rk4_step(const OdeFunction& f, double t, const VectorXd& y, double h) {
  f(t, y);  // the answer is right: only who counts sees it
  return rk4_step_of_the_reference(f, t, y, h);
}

}  // namespace tumble::a2
