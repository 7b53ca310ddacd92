// Rods and joints hold: bodies brought back onto their rows, and what rows add to a sudden change
// of velocities. Part of LinkedBodies.
#include <algorithm>
#include <cmath>
#include <string>

#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/stepping/linked_bodies.h"

namespace tumble::engines {
namespace {

// Newton's method doubles the digits; a step leaves few missing
constexpr int kMostProjections = 8;

Matrix3d inverse_inertia_world(const Body& body) {
  if (body.inertia.inverse_mass == 0.0) return Matrix3d::Zero();
  const Matrix3d R = body.world_from_body.toRotationMatrix();
  return R * body.inertia.inverse_inertia_body * R.transpose();
}

}  // namespace

// The largest error of these rows: of a place over the group's size, which is its longest rod, its
// farthest coordinate, and where these are near 0 its largest radius of gyration; of a direction
// [rad] as it is, whatever the size.
double LinkedBodies::open_part(const std::vector<Body>& bodies,
                               const std::vector<Constraint>& rows) const {
  double worst = 0.0, turn = 0.0, size = 0.0;
  for (const Constraint& c : rows) {
    double& largest = is_of_directions(c.row) ? turn : worst;
    largest = std::isnan(c.row.value) ? c.row.value : std::max(largest, std::abs(c.row.value));
  }
  for (const Terms& terms : terms_) size = std::max(size, terms.acting->size());
  for (const Body& body : bodies) size = std::max(size, body.com_world.cwiseAbs().maxCoeff());
  if (!(worst <= kNegligible * size))
    for (const int body : bodies_) {
      const Inertia& inertia = world_.bodies[static_cast<std::size_t>(body)].inertia;
      size = std::max(size, std::sqrt(inertia.inertia_body.diagonal().maxCoeff() / inertia.mass));
    }
  const double part = worst == 0.0 ? 0.0 : worst / size;
  return std::isnan(part) || std::isnan(turn) ? kUnset : std::max(part, turn);
}

std::vector<ConstrainedBody> LinkedBodies::constrained(const std::vector<Body>& bodies) {
  std::vector<ConstrainedBody> result;
  result.reserve(bodies.size());
  for (const Body& body : bodies)
    result.push_back({body.inertia.inverse_mass, inverse_inertia_world(body), Vector6d::Zero()});
  return result;
}

VectorXd LinkedBodies::correction(const std::vector<Constraint>& rows,
                                  const std::vector<ConstrainedBody>& bodies,
                                  const VectorXd& error) {
  ++counters_.constraint_corrections;
  VectorXd change = laws_.constraint_correction(rows, bodies, error);
  if (change.size() != 6 * static_cast<Eigen::Index>(bodies.size()))
    throw StoppedRun("rods and joints (constraint_correction of " + laws_.source_of_links() +
                     ") returned " + std::to_string(change.size()) +
                     " numbers instead of 6 a body");
  return change;
}

LinkedBodies::Instant LinkedBodies::at_instant(const std::vector<RigidBodyState>& states,
                                               double t) {
  return naming(subject(), [&]() -> Instant {
    const std::vector<Body> bodies = place_bodies(take(states), t);
    return {rows(bodies), constrained(bodies)};
  });
}

VectorXd LinkedBodies::reaction(const Instant& instant, const VectorXd& change) {
  const StageTimer timer(counters_.constraint_seconds);
  const auto rate = [&](int body, const Vector6d& jacobian) {
    return jacobian.dot(change.segment<6>(6 * static_cast<Eigen::Index>(body)));
  };
  VectorXd error(static_cast<Eigen::Index>(instant.rows.size()));
  for (std::size_t k = 0; k < instant.rows.size(); ++k) {
    const auto& [a, b, row] = instant.rows[k];
    error[static_cast<Eigen::Index>(k)] = rate(a, row.jacobian_a) + rate(b, row.jacobian_b);
  }
  return naming(subject(), [&] { return correction(instant.rows, instant.bodies, error); });
}

void LinkedBodies::project_local(std::vector<RigidBodyState>& local, double t, bool places) {
  naming(subject(), [&] { bring_back(local, t, places); });
}

void LinkedBodies::bring_back(std::vector<RigidBodyState>& local, double t, bool places) {
  if (!laws_.constraint_correction && goes_without_rows()) return settle_on_tree(local, t);
  const StageTimer timer(counters_.constraint_seconds);
  const auto correct = [&](const std::vector<Body>& bodies, const std::vector<Constraint>& all,
                           bool of_places) {
    VectorXd error(static_cast<Eigen::Index>(all.size()));
    for (std::size_t k = 0; k < all.size(); ++k)
      error[static_cast<Eigen::Index>(k)] = of_places ? all[k].row.value : all[k].row.rate;
    return correction(all, constrained(bodies), error);
  };
  std::vector<Body> bodies = place_bodies(local, t);
  std::vector<Constraint> all = rows(bodies);
  for (int round = 0; places && round < kMostProjections; ++round) {
    if (open_part(bodies, all) <= kCoordinateRounding) break;
    const VectorXd change = correct(bodies, all, true);
    for (std::size_t i = 0; i < local.size(); ++i) {
      const Eigen::Index at = 6 * static_cast<Eigen::Index>(i);
      // Momenta follow: the velocities stay, and with them, for a turned body, the angular velocity
      // rather than its momentum.
      const Vector3d omega = bodies[i].omega_world, turn = change.segment<3>(at + 3);
      local[i].com_world += change.segment<3>(at);
      const double angle = turn.norm();
      if (angle > 0)
        local[i].world_from_body =
            (Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) * local[i].world_from_body)
                .normalized();
      local[i].angular_momentum_world =
          angular_momentum_of(omega, local[i].world_from_body, bodies[i].inertia);
    }
    bodies = place_bodies(local, t);
    all = rows(bodies);
  }
  if (const double left = places ? open_part(bodies, all) : 0.0; !(left <= kNegligible))
    counters_.watch.note(RunWatch::Kind::kProjectionOpen, subject(), {left, kNegligible, t, step_});
  const VectorXd change = correct(bodies, all, false);
  for (std::size_t i = 0; i < local.size(); ++i) {
    const Eigen::Index at = 6 * static_cast<Eigen::Index>(i);
    local[i].momentum_world += bodies[i].inertia.mass * change.segment<3>(at);
    local[i].angular_momentum_world +=
        angular_momentum_of(change.segment<3>(at + 3), local[i].world_from_body, bodies[i].inertia);
  }
}

void LinkedBodies::project_velocities(std::vector<RigidBodyState>& states, double t) {
  if (!has_constraints()) return;
  std::vector<RigidBodyState> local = take(states);
  project_local(local, t, false);
  put(local, states);
}

void LinkedBodies::project(std::vector<RigidBodyState>& states, double t) {
  if (!has_constraints()) return;
  std::vector<RigidBodyState> local = take(states);
  project_local(local, t, true);
  put(local, states);
}

}  // namespace tumble::engines
