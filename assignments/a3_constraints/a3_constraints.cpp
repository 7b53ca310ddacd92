// Your work for assignment 3. Replace each body; the comment above its declaration in
// a3_constraints.h says what it must do.
#include "assignments/a3_constraints/a3_constraints.h"

namespace tumble::a3 {

Vector3d anchor_position(const Body&, const Vector3d&) {
  throw NotImplemented("anchor_position", "handouts/a3_constraints.md#hint-anchors");
}

Vector3d anchor_velocity(const Body&, const Vector3d&) {
  throw NotImplemented("anchor_velocity", "handouts/a3_constraints.md#hint-anchors");
}

Vector3d spring_force(const Spring&, const AnchorState&, const AnchorState&) {
  throw NotImplemented("spring_force", "handouts/a3_constraints.md#hint-spring");
}

ConstraintRow rod_row(const Body&, const Vector3d&, const Body&, const Vector3d&, double) {
  throw NotImplemented("rod_row", "handouts/a3_constraints.md#hint-rod");
}

double baumgarte_acceleration(double, double, double) {
  throw NotImplemented("baumgarte_acceleration", "handouts/a3_constraints.md#hint-baumgarte");
}

VectorXd constraint_multipliers(const std::vector<Constraint>&, const std::vector<ConstrainedBody>&,
                                const VectorXd&) {
  throw NotImplemented("constraint_multipliers", "handouts/a3_constraints.md#hint-multipliers");
}

VectorXd constraint_correction(const std::vector<Constraint>&, const std::vector<ConstrainedBody>&,
                               const VectorXd&) {
  throw NotImplemented("constraint_correction", "handouts/a3_constraints.md#hint-correction");
}

VectorXd contact_forces(const MatrixXd&, const VectorXd&) {
  throw NotImplemented("contact_forces", "handouts/a3_constraints.md#hint-contact");
}

bool ends_in_contact(double, double, double) {
  throw NotImplemented("ends_in_contact", "handouts/a3_constraints.md#hint-rest");
}

}  // namespace tumble::a3
