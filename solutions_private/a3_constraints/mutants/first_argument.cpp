// mutant: first_argument - every function returns what it was given
// caught-by: gives nothing
#include "assignments/a3_constraints/a3_constraints.h"

#include <cmath>

namespace tumble::a3 {

// Nothing here is computed: what the tests still give for it is what they give for nothing.
Vector3d anchor_position(const Body&, const Vector3d& point) { return point; }
Vector3d anchor_velocity(const Body&, const Vector3d& point) { return point; }
Vector3d spring_force(const Spring&, const AnchorState& a, const AnchorState&) {
  return a.point_world;
}
ConstraintRow rod_row(const Body&, const Vector3d&, const Body&, const Vector3d&, double) {
  ConstraintRow row;
  row.jacobian_a.setZero();
  row.jacobian_b.setZero();
  row.value = row.rate = row.velocity_product = 0;
  return row;
}
double baumgarte_acceleration(double value, double, double) { return value; }
VectorXd constraint_multipliers(const std::vector<Constraint>&, const std::vector<ConstrainedBody>&,
                                const VectorXd& wanted) {
  return wanted;
}
VectorXd constraint_correction(const std::vector<Constraint>&, const std::vector<ConstrainedBody>&,
                               const VectorXd& error) {
  return error;
}
VectorXd contact_forces(const MatrixXd&, const VectorXd& b) { return b; }
bool ends_in_contact(double, double, double) { return true; }

}  // namespace tumble::a3
