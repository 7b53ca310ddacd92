// The equations of a2, term by term: for the stories of wrong answers
// (framework/grading/verdicts/xray.h). The stages of a step are what it asked its derivative.
#include "assignments/a2_integration/a2_integration.h"
#include "framework/grading/verdicts/xray.h"

#include <array>
#include <map>
#include <utility>

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

// Of a long state one number is shown: the one that is wrong most.
constexpr Eigen::Index kReadable = 6;  // numbers in a line
Eigen::Index worst_of(const VectorXd& a, const VectorXd& b) {
  Eigen::Index worst = 0;
  if ((a - b).allFinite()) (a - b).cwiseAbs().maxCoeff(&worst);
  return worst;
}

// Where a stage of a step belongs: its part of h, and the slope before it.
constexpr std::array<double, 4> kPart = {0.0, 0.5, 0.5, 1.0};
constexpr std::array<const char*, 4> kTime = {"t", "t + h/2", "t + h/2", "t + h"};

VectorXd place_of(std::size_t i, const VectorXd& y, double h, const std::vector<Stage>& k) {
  return i == 0 ? y : VectorXd(y + kPart[i] * h * k[i - 1].slope);
}

// What a wrong stage was built from, in words: "y + h/2 k1".
std::string built_from(std::size_t i, double t, const VectorXd& y, double h,
                       const std::vector<Stage>& k) {
  std::string time;
  for (const std::size_t j : {i, std::size_t{0}, std::size_t{1}, std::size_t{3}})
    if (time.empty() && grading::is_near(numbers(t + kPart[j] * h), numbers(k[i].time)))
      time = kTime[j];
  std::vector<std::pair<std::string, VectorXd>> places;
  if (i > 0) places.emplace_back("the right y", place_of(i, y, h, k));
  for (std::size_t j = i; j-- > 0;) {
    const std::string slope = "k" + std::to_string(j + 1);
    places.emplace_back("y + h/2 " + slope, y + 0.5 * h * k[j].slope);
    places.emplace_back("y + h " + slope, y + h * k[j].slope);
    places.emplace_back("y + 1/2 " + slope, y + 0.5 * k[j].slope);
    places.emplace_back("y + " + slope, y + k[j].slope);
    places.emplace_back("h/2 " + slope, 0.5 * h * k[j].slope);
  }
  places.emplace_back("y", y);
  for (const auto& [name, place] : places)
    if (grading::is_near(place, k[i].y)) {
      if (time.empty()) return "another time and " + name;
      return time == kTime[i] ? name : time + " and " + name;
    }
  return "";
}

// (A2.2)
Shown runge_kutta(const VectorXd& found, const Function&, const double& t, const VectorXd& whole_y,
                  const double& h) {
  std::vector<Stage> k = stages();
  if (k.size() != 4 || found.size() != whole_y.size()) return std::nullopt;
  for (const Stage& stage : k)
    if (stage.y.size() != whole_y.size() || stage.slope.size() != whole_y.size())
      return std::nullopt;
  const auto sum = [&](const VectorXd& y, double a, double b, double c, double d) {
    return VectorXd(y + h * (a * k[0].slope + b * k[1].slope + c * k[2].slope + d * k[3].slope));
  };
  const auto right_sum = [&](const VectorXd& y) {
    return sum(y, 1.0 / 6, 2.0 / 6, 2.0 / 6, 1.0 / 6);
  };
  // Each stage is judged by the slopes that the step had: the first wrong one is where it began.
  const auto right_stage = [&](std::size_t i, const VectorXd& y) {
    return VectorXd(numbers(numbers(t + kPart[i] * h), place_of(i, y, h, k)));
  };
  std::size_t wrong = 0;
  while (wrong < 4 &&
         grading::is_near(right_stage(wrong, whole_y), numbers(numbers(k[wrong].time), k[wrong].y)))
    ++wrong;
  const std::string from = wrong < 4 ? built_from(wrong, t, whole_y, h, k) : "";
  Xray x{"y + h/6 (k1 + 2 k2 + 2 k3 + k4)   (A2.2)", {}, "y(t + h)", "", {}, {}, {}};
  VectorXd y = whole_y;
  x.found = found;
  if (y.size() > kReadable) {
    const Eigen::Index one =
        wrong < 4 ? worst_of(place_of(wrong, y, h, k), k[wrong].y) : worst_of(right_sum(y), found);
    x.equation += ", number " + std::to_string(one) + " of y, which has " +
                  std::to_string(y.size()) + ": it is wrong most";
    for (Stage& stage : k) {
      stage.y = numbers(stage.y[one]);
      stage.slope = numbers(stage.slope[one]);
    }
    y = numbers(whole_y[one]);
    x.found = numbers(found[one]);
  }
  constexpr std::array<const char*, 4> kName = {"k1: t; y", "k2: t + h/2; y + h/2 k1",
                                                "k3: t + h/2; y + h/2 k2", "k4: t + h; y + h k3"};
  for (std::size_t i = 0; i < 4; ++i) {
    x.terms.push_back({kName[i], right_stage(i, y), "", numbers(numbers(k[i].time), k[i].y), true});
    // what f has answered: it is seen
    x.terms.push_back(
        {'k' + std::to_string(i + 1) + (i < wrong ? " = f there" : " = f at your place"),
         k[i].slope, "", k[i].slope});
  }
  x.expected = right_sum(y);
  constexpr std::size_t kSlope1 = 1, kSlope2 = 3;  // among the terms
  x.variants = {
      {kSlope1, "with the weights 1/4, 1/4, 1/4, 1/4", sum(y, 0.25, 0.25, 0.25, 0.25)},
      {kSlope1, "with the weights 1/6, 1/6, 1/6, 1/6", sum(y, 1.0 / 6, 1.0 / 6, 1.0 / 6, 1.0 / 6)},
      {kSlope1, "with k1 alone: Euler's step", sum(y, 1, 0, 0, 0)},
      {kSlope2, "with k2 alone: the step of the midpoint method", sum(y, 0, 1, 0, 0)},
      {kSlope1, "with h/4 for h/6", sum(y, 0.25, 0.5, 0.5, 0.25)}};
  if (wrong < 4) {  // the answer is what this stage has made of it
    const std::string place = grading::shown(numbers(numbers(k[wrong].time), k[wrong].y), "");
    x.variants.insert(
        x.variants.begin(),
        {2 * wrong, "with " + (from.empty() ? place : place + ", which is " + from + ", here"),
         found});
    if (y.size() != whole_y.size()) x.variants.front().answer = x.found;
  }
  return x;
}

// (A2.1)
Shown euler(const VectorXd& found, const Function&, const double&, const VectorXd& y,
            const double& h) {
  const std::vector<Stage> k = stages();
  if (k.empty() || y.size() > kReadable) return std::nullopt;
  Xray x{"y + h f(t, y)   (A2.1)", {}, "y(t + h)", "", {}, {}, {}};
  x.terms = {{"where f is taken", y, "", k[0].y, true}, {"f(t, y)", k[0].slope}};
  x.expected = y + h * k[0].slope;
  x.found = found;
  x.variants = {{0, "without y", VectorXd(h * k[0].slope)},
                {1, "with f for h f", VectorXd(y + k[0].slope)}};
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
  x.variants = {{0, "with omega = I^-1 L: I^-1 of the body frame, and L of the world frame",
                 with(spin(body))},
                {0, "with omega in the body frame", with(spin(in_body))},
                {2, "without the factor 1/2",
                 with(Quaterniond(2 * rate.w(), 2 * rate.x(), 2 * rate.y(), 2 * rate.z()))},
                {2, "with q on the left: q (0, omega)",
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
  x.variants = {{0, "with R^T for R: R^T I R", all(r.transpose() * inertia * r)},
                {0, "as I itself, without R", all(inertia)},
                {0, "as R I: R on one side alone", all(r * inertia)}};
  return x;
}

// (A2.12), of the first step that left the bracket.
Shown newton(const RootResult&, const Function& gap, const Function&, const double& t_low,
             const double& t_high, const double&) {
  double a = t_low, b = t_high;          // the bracket, by what the search was told
  std::map<double, double> gaps, rates;  // so far, by their times
  std::optional<double> from;            // the last time whose gap and rate are known
  for (const auto& [question, answer] : grading::last_call().asked) {
    std::uint32_t which = 0;
    double time = 0.0, value = 0.0;
    modules::Reader asked(question), answered(answer);
    asked.value(which);
    asked.value(time);
    answered.value(value);
    const bool is_gap = which == gap;
    if (is_gap && from && !(time >= a && time <= b)) {
      const double next = *from - gaps[*from] / rates[*from], middle = a + (b - a) / 2;
      const bool is_inside = next > a && next < b;
      Xray x{"t - g(t) / g'(t) where that lies inside the bracket, else its middle   (A2.12)",
             {},
             "the next time",
             "s",
             numbers(is_inside ? next : middle),
             numbers(time),
             {}};
      x.terms = {{"t, the last time", numbers(*from), "s"},
                 {"g(t)", numbers(gaps[*from]), "m"},
                 {"g'(t)", numbers(rates[*from]), "m/s"},
                 {"t - g / g'", numbers(next), "s"},
                 {"the bracket", numbers(numbers(a), numbers(b)), "s"},
                 {"its middle", numbers(middle), "s"}};
      x.variants = {{3, "with t + g / g'", numbers(*from + gaps[*from] / rates[*from])}};
      if (!is_inside)
        x.variants.push_back({4, "without the bracket: the step may leave it", numbers(next)});
      return x;
    }
    (is_gap ? gaps : rates)[time] = value;
    if (gaps.contains(time) && rates.contains(time)) from = time;
    if (is_gap && time > a && time < b) (value >= 0.0 ? a : b) = time;
  }
  return std::nullopt;
}

// (A2.7)
Shown gram_schmidt(const Matrix3d& found, const Matrix3d& drifted) {
  const auto all = [](const Matrix3d& m) {
    return VectorXd(Eigen::Map<const VectorXd>(m.data(), 9));
  };
  const Vector3d a = drifted.col(0), b = drifted.col(1), c = drifted.col(2);
  // factors of the shares that are taken off: 1, or 0 where one is left
  const auto columns = [&](double xb, double xc, double yc, bool is_unit = true) {
    Matrix3d m;
    const Vector3d x = a.normalized(), off = b - xb * x.dot(b) * x, y = off.normalized(),
                   rest = c - xc * x.dot(c) * x - yc * y.dot(c) * y;
    m << x, (is_unit ? y : off), (is_unit ? rest.normalized() : rest);
    return m;
  };
  const Matrix3d right = columns(1, 1, 1);
  const Vector3d x_axis = right.col(0), y_axis = right.col(1);
  Xray x{"x = a/|a|,  y = b - (x . b) x,  z = c - (x . c) x - (y . c) y, each made unit   (A2.7)",
         {},
         "x, y, z by columns",
         "",
         all(right),
         all(found),
         {}};
  x.terms = {{"x", numbers(x_axis), "", VectorXd(found.col(0))},
             {"x . b", numbers(x_axis.dot(b))},
             {"y", numbers(y_axis), "", VectorXd(found.col(1))},
             {"x . c", numbers(x_axis.dot(c))},
             {"y . c", numbers(y_axis.dot(c))},
             {"z", numbers(Vector3d(right.col(2))), "", VectorXd(found.col(2))}};
  x.variants = {{1, "without (x . b) x", all(columns(0, 1, 1))},
                {3, "without (x . c) x", all(columns(1, 0, 1))},
                {4, "without (y . c) y", all(columns(1, 1, 0))},
                {3, "without (x . c) x and (y . c) y", all(columns(1, 0, 0))},
                {2, "with a y that is not made unit", all(columns(1, 1, 1, false))}};
  return x;
}

[[maybe_unused]] const bool kAdded[] = {grading::add_xray_of("rk4_step", runge_kutta),
                                        grading::add_xray_of("euler_step", euler),
                                        grading::add_xray_of("rigid_body_derivative", derivative),
                                        grading::add_xray_of("inertia_in_world", world_tensor),
                                        grading::add_xray_of("orthonormalize", gram_schmidt),
                                        grading::add_xray_of("impact_time_newton", newton)};

}  // namespace
}  // namespace tumble::a2
