// mutant: all_nan - every function returns NaN
// caught-by: gives nothing
#include "assignments/a3_constraints/a3_constraints.h"

#include <cmath>

namespace tumble::a3 {

// Nothing here is computed: what the tests still give for it is what they give for nothing.
Vector3d anchor_position(const Body&, const Vector3d&) { return unset_vector(); }
Vector3d anchor_velocity(const Body&, const Vector3d&) { return unset_vector(); }
Vector3d spring_force(const Spring&, const AnchorState&, const AnchorState&) {
  return unset_vector();
}
ConstraintRow rod_row(const Body&, const Vector3d&, const Body&, const Vector3d&, double) {
  return {};
}
double baumgarte_acceleration(double, double, double) { return kUnset; }
VectorXd constraint_multipliers(const std::vector<Constraint>&, const std::vector<ConstrainedBody>&,
                                const VectorXd& wanted) {
  return VectorXd::Constant(wanted.size(), kUnset);
}
VectorXd constraint_correction(const std::vector<Constraint>&,
                               const std::vector<ConstrainedBody>& bodies, const VectorXd&) {
  return VectorXd::Constant(6 * static_cast<Eigen::Index>(bodies.size()), kUnset);
}
VectorXd contact_forces(const MatrixXd&, const VectorXd& b) {
  return VectorXd::Constant(b.size(), kUnset);
}
bool ends_in_contact(double, double, double) { return true; }

}  // namespace tumble::a3
