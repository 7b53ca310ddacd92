// The equations of a2, term by term: for the stories of wrong answers
// (framework/grading/verdicts/xray.h). The stages of a step are what it asked its derivative.
#include "assignments/a2_integration/a2_integration.h"
#include "framework/grading/verdicts/xray.h"

#include <array>

namespace tumble::a2 {
namespace {

using grading::numbers;
using grading::Xray;
using Shown = std::optional<Xray>;
using Function = std::uint32_t;  // an argument that is a function travels as a number

struct Stage {
  double time = 0.0;
  VectorXd y, slope;
};

// Where the step asked for slopes, and what it got.
std::vector<Stage> stages() {
  std::vector<Stage> all;
  for (const auto& [question, answer] : grading::last_call().asked) {
    Stage stage;
    modules::Reader asked(question), answered(answer);
    std::uint32_t which = 0;
    asked.value(which);
    asked.value(stage.time);
    asked.value(stage.y);
    answered.value(stage.slope);
    all.push_back(stage);
  }
  return all;
}

// (A2.2)
Shown runge_kutta(const VectorXd& found, const Function&, const double& t, const VectorXd& y,
                  const double& h) {
  constexpr Eigen::Index kReadable = 6;  // numbers in a line
  const std::vector<Stage> k = stages();
  if (k.size() != 4 || y.size() > kReadable) return std::nullopt;
  Xray x{"y + h/6 (k1 + 2 k2 + 2 k3 + k4)   (A2.2)", {}, "y(t + h)", "", {}, {}, {}};
  // each stage is judged by the slopes that the step had: the first wrong one is where it began
  const std::array<double, 4> part = {0.0, 0.5, 0.5, 1.0};
  const std::array<const char*, 4> at = {"t; y, where k1 is taken", "t + h/2; y + h/2 k1, for k2",
                                         "t + h/2; y + h/2 k2, for k3", "t + h; y + h k3, for k4"};
  for (std::size_t i = 0; i < 4; ++i) {
    const VectorXd place = i == 0 ? y : VectorXd(y + part[i] * h * k[i - 1].slope);
    x.terms.push_back(
        {at[i], numbers(numbers(t + part[i] * h), place), "", numbers(numbers(k[i].time), k[i].y)});
  }
  for (std::size_t i = 0; i < 4; ++i) x.terms.push_back({"k" + std::to_string(i + 1), k[i].slope});
  const auto sum = [&](double a, double b, double c, double d) {
    return VectorXd(y + h * (a * k[0].slope + b * k[1].slope + c * k[2].slope + d * k[3].slope));
  };
  x.expected = sum(1.0 / 6, 2.0 / 6, 2.0 / 6, 1.0 / 6);
  x.found = found;
  x.variants = {{4, "the weights 1/4, 1/4, 1/4, 1/4", sum(0.25, 0.25, 0.25, 0.25)},
                {4, "the weights 1/6, 1/6, 1/6, 1/6", sum(1.0 / 6, 1.0 / 6, 1.0 / 6, 1.0 / 6)},
                {4, "k1 alone: Euler's step", sum(1, 0, 0, 0)},
                {5, "k2 alone: the midpoint's step", sum(0, 1, 0, 0)},
                {4, "a division by 4", sum(0.25, 0.5, 0.5, 0.25)}};
  return x;
}

// (A2.1)
Shown euler(const VectorXd& found, const Function&, const double&, const VectorXd& y,
            const double& h) {
  const std::vector<Stage> k = stages();
  if (k.empty() || y.size() > 6) return std::nullopt;
  Xray x{"y + h f(t, y)   (A2.1)", {}, "y(t + h)", "", {}, {}, {}};
  x.terms = {{"where f is taken", y, "", k[0].y}, {"f(t, y)", k[0].slope}};
  x.expected = y + h * k[0].slope;
  x.found = found;
  x.variants = {{0, "nothing: y is left out", VectorXd(h * k[0].slope)},
                {1, "f without h", VectorXd(y + k[0].slope)}};
  return x;
}

// (A2.4) and (A2.5): the parts of the state, as they lie in it.
Shown derivative(const VectorXd& found, const RigidBodyState& s, const Inertia& inertia,
                 const Wrench& wrench) {
  if (found.size() != kStateSize) return std::nullopt;
  const Matrix3d r = s.world_from_body.toRotationMatrix();
  const Vector3d velocity = s.momentum_world * inertia.inverse_mass,
                 omega = r * (inertia.inverse_inertia_body *
                              (r.transpose() * s.angular_momentum_world));
  const Quaterniond q = s.world_from_body,
                    rate = Quaterniond(0, 0.5 * omega.x(), 0.5 * omega.y(), 0.5 * omega.z()) * q;
  const Eigen::Vector4d turning(rate.w(), rate.x(), rate.y(), rate.z());
  Xray x{
      "x' = P/m,  q' = 1/2 (0, omega) q,  P' = F,  L' = tau,  omega = R I^-1 R^T L   (A2.4), "
      "(A2.5)",
      {},
      "y'",
      "",
      {},
      {},
      {}};
  x.terms = {{"omega", numbers(omega), "rad/s"},
             {"x' = P/m", numbers(velocity), "m/s", VectorXd(found.segment<3>(0))},
             {"q' (w, x, y, z)", turning, "1/s", VectorXd(found.segment<4>(3))},
             {"P' = F", numbers(wrench.force_world), "N", VectorXd(found.segment<3>(7))},
             {"L' = tau", numbers(wrench.torque_world), "N m", VectorXd(found.segment<3>(10))}};
  x.expected.resize(kStateSize);
  x.expected << velocity, turning, wrench.force_world, wrench.torque_world;
  x.found = found;
  const auto with = [&](const Quaterniond& other) {
    VectorXd y = x.expected;
    y.segment<4>(3) << other.w(), other.x(), other.y(), other.z();
    return y;
  };
  const auto spin = [&](const Vector3d& w) {
    return Quaterniond(0, 0.5 * w.x(), 0.5 * w.y(), 0.5 * w.z()) * q;
  };
  const Vector3d body = inertia.inverse_inertia_body * s.angular_momentum_world,
                 in_body =
                     inertia.inverse_inertia_body * (r.transpose() * s.angular_momentum_world);
  x.variants = {{0, "I^-1 of the body frame with the world's L", with(spin(body))},
                {0, "omega in the body frame", with(spin(in_body))},
                {2, "no factor 1/2",
                 with(Quaterniond(2 * rate.w(), 2 * rate.x(), 2 * rate.y(), 2 * rate.z()))},
                {2, "q on the left",
                 with(q * Quaterniond(0, 0.5 * omega.x(), 0.5 * omega.y(), 0.5 * omega.z()))}};
  return x;
}

// (A2.3)
Shown world_tensor(const Matrix3d& found, const Matrix3d& inertia, const Quaterniond& q) {
  const Matrix3d r = q.toRotationMatrix();
  const auto all = [](const Matrix3d& m) {
    return VectorXd(Eigen::Map<const VectorXd>(m.data(), 9));
  };
  Xray x{"R I R^T, by columns   (A2.3)", {}, "I in the world", "kg m^2", {}, {}, {}};
  x.terms = {{"R", all(r)}, {"I in the body", all(inertia), "kg m^2"}};
  x.expected = all(r * inertia * r.transpose());
  x.found = all(found);
  x.variants = {{0, "R^T: R^T I R", all(r.transpose() * inertia * r)},
                {0, "nothing: I as it is", all(inertia)},
                {0, "R on one side alone", all(r * inertia)}};
  return x;
}

[[maybe_unused]] const bool kAdded[] = {grading::add_xray_of("rk4_step", runge_kutta),
                                        grading::add_xray_of("euler_step", euler),
                                        grading::add_xray_of("rigid_body_derivative", derivative),
                                        grading::add_xray_of("inertia_in_world", world_tensor)};

}  // namespace
}  // namespace tumble::a2
