#include "framework/engines/stability.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/dynamics/anchors.h"

namespace tumble::engines {
namespace {

// What rounding leaves of an amplification of exactly 1.
constexpr double kNotAtAll = 1e-9;
constexpr double kRuin = 1e3;            // factor over a run by which a method may lengthen a swing: more is refused
constexpr double kSeen = 1.1;            // more is told
constexpr double kRunaway = 10.0;        // times all the energy there was to begin with: more has run away
constexpr double kRoundingOfRest = 1e-6; // of the energy a world at rest has by its height: what steps may leave of it
// More springs than this are judged by the largest row sum (Gershgorin), an upper bound at most some times too large.
constexpr Eigen::Index kMostSprings = 400;

double largest_stable_step(const Laws& laws, double frequency, double damping, double step) {
  double stable = 0.0, unstable = step;
  // Down to a thousandth of a radian a step: a method that still lengthens the swing there always does.
  for (double h = step; h * frequency > 1e-3 && stable == 0.0; h *= 0.5) {
    if (amplification(laws, frequency, damping, h) <= 1.0 + kNotAtAll) stable = h;
    else unstable = h;
  }
  if (stable == 0.0) return 0.0;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (stable + unstable);
    (amplification(laws, frequency, damping, middle) <= 1.0 + kNotAtAll ? stable : unstable) = middle;
  }
  return stable;
}

/// Largest size of the two eigenvalues; they are real where `discriminant` is not negative, else a conjugate pair.
double spectral_radius(const Eigen::Matrix2d& m) {
  const double middle = 0.5 * (m(0, 0) + m(1, 1));
  const double half_difference = 0.5 * (m(0, 0) - m(1, 1));
  const double discriminant = half_difference * half_difference + m(0, 1) * m(1, 0);
  return discriminant < 0.0 ? std::sqrt(m.determinant()) : std::abs(middle) + std::sqrt(discriminant);
}

}  // namespace

double amplification(const Laws& laws, double frequency, double damping, double step) {
  const OdeFunction swing = [&](double, const VectorXd& y) {
    VectorXd dy(2);
    dy << y[1], -frequency * frequency * y[0] - damping * y[1];
    return dy;
  };
  Eigen::Matrix2d matrix;
  for (int column = 0; column < 2; ++column) {
    VectorXd y = VectorXd::Zero(2);
    y[column] = column == 0 ? 1.0 : frequency;   // in the units of the swing
    const VectorXd after = laws.integrate_step(swing, 0.0, y, step);
    matrix(0, column) = after[0];
    matrix(1, column) = after[1] / frequency;
  }
  return spectral_radius(matrix);
}

std::optional<SpringStability> judge_springs(const World& world, const Laws& laws, double step) {
  const Eigen::Index n = static_cast<Eigen::Index>(world.springs.size());
  if (n == 0) return std::nullopt;
  // J M^-1/2 of each spring as one row over all bodies: what two springs share is what they have in common of it.
  struct Row {
    int body;
    Vector6d scaled;
  };
  std::vector<std::vector<Row>> rows(world.springs.size());
  std::vector<RigidBodyState> states;
  for (const WorldBody& body : world.bodies) states.push_back(body.state);
  for (std::size_t k = 0; k < world.springs.size(); ++k) {
    const SpringLink& link = world.springs[k];
    const Vector3d a = anchor_point(link.a, states), b = anchor_point(link.b, states);
    const double length = (a - b).norm();
    const Vector3d along = length > 0 ? Vector3d((a - b) / length) : Vector3d(Vector3d::UnitZ());
    for (const auto& [anchor, point, sign] : {std::tuple{&link.a, a, 1.0}, std::tuple{&link.b, b, -1.0}}) {
      if (anchor->body < 0 || world.bodies[anchor->body].immovable()) continue;
      const WorldBody& body = world.bodies[anchor->body];
      const Matrix3d R = body.state.world_from_body.toRotationMatrix();
      const Matrix3d root = Eigen::SelfAdjointEigenSolver<Matrix3d>(body.inertia.inverse_inertia_body).operatorSqrt();
      Vector6d scaled;
      scaled << sign * std::sqrt(body.inertia.inverse_mass) * along, sign * (root * (R.transpose() * (point - body.state.com_world).cross(along)));
      rows[k].push_back({anchor->body, std::sqrt(link.spring.stiffness) * scaled});
    }
  }
  MatrixXd shared = MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j <= i; ++j)
      for (const Row& p : rows[i])
        for (const Row& q : rows[j])
          if (p.body == q.body) shared(i, j) = shared(j, i) = shared(i, j) + p.scaled.dot(q.scaled);
  Eigen::Index most = 0;
  double squared = 0.0;
  if (n <= kMostSprings) {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(shared);
    squared = solver.eigenvalues()[n - 1];
    solver.eigenvectors().col(n - 1).cwiseAbs().maxCoeff(&most);
  } else {
    squared = shared.cwiseAbs().rowwise().sum().maxCoeff(&most);
  }
  if (!(squared > 0)) return std::nullopt;
  const Spring& spring = world.springs[most].spring;
  const double frequency = std::sqrt(squared), damping = spring.stiffness > 0 ? squared * spring.damping / spring.stiffness : 0.0;
  return SpringStability{world.springs[most].name, frequency, amplification(laws, frequency, damping, step), largest_stable_step(laws, frequency, damping, step)};
}

void refuse_unstable_springs(const World& world, const Laws& laws, const StepsOfARun& steps, const std::string& where, std::vector<std::string>& notices) {
  const auto springs = judge_springs(world, laws, steps.step);
  if (!springs || !(springs->amplification > 1.0)) return;
  const double over_the_run = std::log(springs->amplification) * steps.duration / steps.step;
  const std::string what = fmt::format("a step of {:.3g} s of {} lengthens the swing of spring '{}' ({:.4g} rad/s where the run starts) by a factor {:.6g} each time",
                                       steps.step, laws.integrator_source, springs->spring, springs->angular_frequency, springs->amplification);
  if (over_the_run > std::log(kRuin))
    throw UserError(where, what + fmt::format(", 10^{:.0f} times over the run", over_the_run / std::log(10.0)),
                    springs->largest_step > 0 ? fmt::format("take a step of at most {:.4g} s (\"step_s\"), a softer spring or more damping", springs->largest_step)
                                              : "this method lengthens it at every step size: take another method (a2's rk4_step), or damp the spring");
  if (over_the_run > std::log(kSeen))
    notices.push_back(what + (springs->largest_step > 0 ? fmt::format("; steps of at most {:.4g} s do not", springs->largest_step) : "; this method does at every step size"));
}

std::optional<std::string> EnergyWatch::look(const World& world, const std::vector<RigidBodyState>& states) {
  const auto driven = [](const WorldBody& b) { return b.immovable() && !(b.motion.velocity_m_s.isZero(0.0) && b.motion.amplitude_m.isZero(0.0)); };
  if (!world.point_forces.empty() || !world.motors.empty() || std::any_of(world.bodies.begin(), world.bodies.end(), driven)) return std::nullopt;
  const Invariants sums = invariants_of(world, states);
  const double energy = sums.kinetic_energy + sums.potential_energy;
  if (std::isnan(first_energy_)) {
    first_energy_ = energy;
    lowest_potential_ = first_potential_ = sums.potential_energy;
    scale_ = sums.kinetic_energy;
    for (const SpringLink& link : world.springs) {
      const double stretch = (anchor_point(link.a, states) - anchor_point(link.b, states)).norm() - link.spring.rest_length;
      scale_ += 0.5 * link.spring.stiffness * stretch * stretch;
    }
  }
  lowest_potential_ = std::min(lowest_potential_, sums.potential_energy);
  const double available = scale_ + (first_potential_ - lowest_potential_);
  if (energy - first_energy_ <= kRunaway * available + kRoundingOfRest * std::abs(first_energy_)) return std::nullopt;
  if (available == 0.0 && first_energy_ == 0.0 && !(sums.kinetic_energy > 0)) return std::nullopt;
  std::size_t fastest = 0;
  double most = -1.0;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    if (world.bodies[i].immovable()) continue;
    const double kinetic = kinetic_energy(states[i], world.bodies[i].inertia);
    if (kinetic > most) {
      most = kinetic;
      fastest = i;
    }
  }
  return fmt::format("body '{}': runaway energy: the world has {:.4g} J, it began with {:.4g} J and nothing brings energy in", world.bodies[fastest].name, energy, first_energy_);
}

std::string told_runaway(double time, const std::string& runaway, const Laws& laws) {
  return fmt::format("at t = {:.6f} s, {} (integrator: {}; impulses: {}; springs, rods, contacts: {}); a shorter step or another method is needed, or one of these is wrong", time, runaway,
                     laws.integrator_source, laws.impulse_source, laws.constraint_source);
}

}  // namespace tumble::engines
