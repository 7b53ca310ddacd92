// mutant: all_zeros - every function returns 0
// caught-by: gives nothing
#include "assignments/a3_constraints/a3_constraints.h"

#include <cmath>

namespace tumble::a3 {

// Nothing here is computed: what the tests still give for it is what they give for nothing.
Vector3d anchor_position(const Body&, const Vector3d& point) { return 0 * point; }
Vector3d anchor_velocity(const Body&, const Vector3d& point) { return 0 * point; }
Vector3d spring_force(const Spring&, const AnchorState& a, const AnchorState&) {
  return 0 * a.point_world;
}
ConstraintRow rod_row(const Body&, const Vector3d&, const Body&, const Vector3d&, double) {
  ConstraintRow row;
  row.jacobian_a.setZero();
  row.jacobian_b.setZero();
  row.value = row.rate = row.velocity_product = 0;
  return row;
}
double baumgarte_acceleration(double, double, double) { return 0.0; }
VectorXd constraint_multipliers(const std::vector<Constraint>&, const std::vector<ConstrainedBody>&,
                                const VectorXd& wanted) {
  return VectorXd::Zero(wanted.size());
}
VectorXd constraint_correction(const std::vector<Constraint>&,
                               const std::vector<ConstrainedBody>& bodies, const VectorXd&) {
  return VectorXd::Zero(6 * static_cast<Eigen::Index>(bodies.size()));
}
VectorXd contact_forces(const MatrixXd&, const VectorXd& b) { return VectorXd::Zero(b.size()); }
bool ends_in_contact(double, double, double) { return false; }

}  // namespace tumble::a3
