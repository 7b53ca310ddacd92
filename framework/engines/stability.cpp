#include "framework/engines/stability.h"

#include <cmath>

#include <Eigen/Eigenvalues>

#include "framework/dynamics/anchors.h"

namespace tumble::engines {
namespace {

// What rounding leaves of an amplification of exactly 1.
constexpr double kNotAtAll = 1e-9;
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
  return Eigen::EigenSolver<Eigen::Matrix2d>(matrix, false).eigenvalues().cwiseAbs().maxCoeff();
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

}  // namespace tumble::engines
