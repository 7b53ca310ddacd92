#include "tests/a2_integration/a2_fixtures.h"

#include <algorithm>
#include <sstream>

namespace tumble::a2_testing {

OdeFunction noting(Diary& diary, OdeFunction f) {
  return [&diary, f = std::move(f)](double t, const VectorXd& y) {
    diary.times.push_back(t);
    diary.states.push_back(y);
    return f(t, y);
  };
}

OdeFunction scripted(Diary& diary, std::vector<VectorXd> slopes) {
  return noting(diary, [&diary, slopes = std::move(slopes)](double, const VectorXd&) {
    return slopes[std::min(diary.calls(), slopes.size()) - 1];
  });
}

VectorXd integrate(const Step& step, const OdeFunction& f, double t_start, const VectorXd& y,
                   double t_end, int steps) {
  const double h = (t_end - t_start) / steps;
  VectorXd state = y;
  for (int i = 0; i < steps; ++i) state = step(f, t_start + i * h, state, h);
  return state;
}

std::vector<double> observed_orders(const Step& step, const OdeFunction& f, double t_start,
                                    const VectorXd& y, double t_end, const VectorXd& exact,
                                    int first_steps, int halvings) {
  std::vector<double> orders;
  double coarser = kUnset;
  for (int i = 0, steps = first_steps; i <= halvings; ++i, steps *= 2) {
    const double error = distance(integrate(step, f, t_start, y, t_end, steps), exact);
    if (i > 0) orders.push_back(std::log2(coarser / error));
    coarser = error;
  }
  return orders;
}

void expect_orders(const std::vector<double>& found, double order, double tolerance,
                   const Story& story) {
  bool all_near = true;
  std::string all;
  for (const double o : found) {
    all_near = all_near && std::abs(o - order) <= tolerance;
    all += (all.empty() ? "" : ", ") + show(std::round(o * 1000) / 1000);
  }
  expect_true(all_near,
              "order " + show(order) + " +- " + show(tolerance) + " at every halving of the step",
              all, story);
}

namespace {

/// Weights in sixths of h, and the slopes of each stage: `stage(i, k)` is the weight of slope k in
/// stage i, in h.
struct SeenRk4 {
  Eigen::Vector4d sixths = Eigen::Vector4d::Constant(kUnset);
  Eigen::Matrix4d stage = Eigen::Matrix4d::Constant(kUnset);
  std::size_t calls = 0;
};

SeenRk4 look_at_rk4() {
  SeenRk4 seen;
  for (Eigen::Index k = 0; k < 4; ++k) {
    Diary diary;
    std::vector<VectorXd> slopes(4, vector({0}));
    slopes[static_cast<std::size_t>(k)] = vector({1});
    const VectorXd y = a2_module().rk4_step(scripted(diary, slopes), 0.0, vector({0}), 1.0);
    seen.calls = diary.calls();
    if (seen.calls != 4 || y.size() != 1) return seen;
    seen.sixths[k] = 6 * y[0];
    for (Eigen::Index i = 0; i < 4; ++i)
      seen.stage(i, k) = diary.states[static_cast<std::size_t>(i)].size() == 1
                             ? diary.states[static_cast<std::size_t>(i)][0]
                             : kUnset;
  }
  return seen;
}

/// Two steps with only their function in common: the result of the first must not come again, whole
/// or in its slopes.
bool rk4_keeps_something() {
  const auto step = [](double slope, double h) {
    Diary diary;
    const VectorXd y = a2_module().rk4_step(
        scripted(diary, std::vector<VectorXd>(4, vector({slope}))), 0.0, vector({8}), h);
    return y.size() == 1 ? (y[0] - 8) / (slope * h) : kUnset;  // 1, for any slope and step
  };
  const double first = step(2, 0.5), other_slope = step(16, 0.5), other_step = step(2, 4);
  // more than float's rounding, which is no memory of the first step
  constexpr double kNear = 1e-6;
  return std::abs(first - other_slope) > kNear || std::abs(first - other_step) > kNear;
}

bool rk4_rounds_as_float() {
  Diary diary;
  const VectorXd y = a2_module().rk4_step(
      scripted(diary, std::vector<VectorXd>(4, vector({1.0 / 3}))), 0.0, vector({1.0 / 7}), 0.1);
  const double exact = 1.0 / 7 + 0.1 / 3, off = y.size() == 1 ? std::abs(y[0] / exact - 1) : kUnset;
  return off > 0x1p-32 && off < 0x1p-20;
}

}  // namespace

namespace {

/// What the step under test does, read off; empty where weights and stages are right, or not seen.
std::string words_of_rk4() {
  const SeenRk4 seen = look_at_rk4();
  if (seen.calls != 4 || !seen.sixths.allFinite()) return "";
  if (rk4_keeps_something()) return kKept;
  const auto is = [&](double a, double b, double c, double d) {
    return (seen.sixths - Eigen::Vector4d(a, b, c, d)).norm() < 1e-5;
  };
  const std::string right = "; k1 to k4 weigh 1, 2, 2, 1 sixths",
                    weights = show(
                        Eigen::Vector4d((seen.sixths * 1e6).array().round() / 1e6).transpose());
  Eigen::Vector4d sorted = seen.sixths;
  std::sort(sorted.data(), sorted.data() + 4);
  if (!is(1, 2, 2, 1)) {
    if (is(0, 0, 0, 0))
      return "no slope has a weight: 1 / 6 in integers is 0, write 1.0 / 6 or h / 6" + right;
    if (is(1, 0, 0, 1))
      return "k2 and k3 have no weight: 2 / 6 in integers is 0, write 2.0 / 6" + right;
    if (is(1, 1, 1, 1)) return "the weights 1, 2, 2, 1 are forgotten";
    if (is(1.5, 1.5, 1.5, 1.5))
      return "a plain average of the slopes: the weights 1, 2, 2, 1 over 6 are forgotten";
    if (is(1.5, 3, 3, 1.5)) return "h/4 where h/6 belongs: the weights 1 + 2 + 2 + 1 sum to 6";
    if (is(1.2, 2.4, 2.4, 1.2)) return "h/5 where h/6 belongs: the weights 1 + 2 + 2 + 1 sum to 6";
    if (is(6, 12, 12, 6)) return "the division by 6 is forgotten" + right;
    if (is(0.75, 2.25, 2.25, 0.75))
      return "the weights 1, 3, 3, 1 over 8 belong to another method, with other stages" + right;
    if (is(6, 0, 0, 0)) return "this is Euler's method: k1 alone";
    if (is(0, 6, 0, 0)) return "this is the midpoint method: k2 alone";
    if (is(1, 4, 0, 1)) return "k2 used for k3 in the sum" + right;
    if ((sorted - Eigen::Vector4d(1, 1, 2, 2)).norm() < 1e-5)
      return "the right weights in another order: k1 to k4 weigh " + weights + right;
    return "the weights: k1 to k4 weigh " + weights + " sixths" + right;
  }
  Eigen::Matrix4d stage = Eigen::Matrix4d::Zero();
  stage(1, 0) = stage(2, 1) = 0.5;
  stage(3, 2) = 1;
  if (!((seen.stage - stage).norm() < 1e-5)) {
    const auto of = [&](int i) { return seen.stage.row(i); };
    if (!seen.stage.allFinite()) return "";
    if (seen.stage.norm() < 1e-9)
      return "all slopes are taken at the start: 1 / 2 in integers is 0";
    if (std::abs(of(1)[0] - 1) < 1e-5 && std::abs(of(2)[1] - 1) < 1e-5)
      return "whole steps where half steps belong: y + (h/2) k1, y + (h/2) k2";
    if (std::abs(of(2)[0] - 0.5) < 1e-5)
      return "k1 used where k2 belongs: the third slope should be taken at y + (h/2) k2";
    if (std::abs(of(3)[1] - 1) < 1e-5)
      return "k2 used for k3: the fourth slope is taken at y + h k3";
    if (std::abs(of(3)[0] - 1) < 1e-5)
      return "k1 used for k3: the fourth slope is taken at y + h k3";
    if (std::abs(of(3)[2] - 0.5) < 1e-5)
      return "the fourth stage takes half a step: it should be taken at y + h k3";
    for (int i = 1; i < 4; ++i)
      if ((of(i) - stage.row(i)).norm() > 1e-5)
        return "stage " + std::to_string(i + 1) + " is taken at y + h times " + show(of(i)) +
               " of k1 to k4: it belongs at " + show(stage.row(i));
  }
  return rk4_rounds_as_float() ? kFloat : "";
}

}  // namespace

Mistake rk4_slip(const Mistake& otherwise) {
  const std::string read_off = words_of_rk4();
  return read_off.empty() ? otherwise : shown(read_off);
}

VectorXd logistic(double, const VectorXd& y) {
  return (6.0 * y.array() - 0.007 * y.array().square()).matrix();
}

VectorXd free_top(double, const VectorXd& omega_body) {
  const Vector3d w = omega_body, moments(1, 2, 3);
  const Vector3d angular_momentum_body = moments.cwiseProduct(w);
  return angular_momentum_body.cross(w).cwiseQuotient(moments);
}

Inertia block() {
  return {2.0, 0.5, Vector3d(1, 2, 4).asDiagonal(), Vector3d(1, 0.5, 0.25).asDiagonal()};
}

Inertia bracket() {
  Matrix3d inertia, adjugate;
  inertia << 4, -2, -2, -2, 5, -1, -2, -1, 6;
  adjugate << 29, 14, 12, 14, 20, 8, 12, 8, 16;
  return {2.0, 0.5, inertia, adjugate / 64};
}

RigidBodyState resting() {
  return {{5, 3, 1}, Quaterniond::Identity(), Vector3d::Zero(), Vector3d::Zero()};
}

Vector3d random_vector(Random& random, double size) {
  const double x = random.between(-size, size), y = random.between(-size, size),
               z = random.between(-size, size);
  return {x, y, z};
}

Quaterniond random_rotation(Random& random) {
  for (;;) {
    const Vector3d v = random_vector(random, 1);
    const Quaterniond q(random.between(-1, 1), v.x(), v.y(), v.z());
    if (q.norm() > 0.1 && q.norm() < 1) return q.normalized();
  }
}

Approach dropped_ball() {
  return {
      "a point falls from rest, 5 m above the floor: gap = 5 - 4.905 t^2, looked for in [0, 2] s",
      [](double t) { return 5.0 - 4.905 * t * t; },
      [](double t) { return -9.81 * t; },
      0.0,
      2.0,
      std::sqrt(5.0 / 4.905)};
}

Approach thrown_ball() {
  return {
      "a ball of radius 0.5 m is thrown up at 2 m/s from 5 m: gap = 4.5 + 2 t - 4.905 t^2, looked "
      "for in [0, 3] s",
      [](double t) { return 4.5 + (2.0 - 4.905 * t) * t; },
      [](double t) { return 2.0 - 9.81 * t; },
      0.0,
      3.0,
      1.18315682439326991216710727747};
}

Approach spinning_rod() {
  return {
      "a 1.5 m rod spins at 30 rad/s while it falls: gap = 1 + t - 4.905 t^2 - 0.75 |sin(0.1 + 30 "
      "t)|, looked for in [0.3, 0.36] s",
      [](double t) {
        return 1.0 + (1.0 - 4.905 * t) * t - 0.75 * std::abs(std::sin(0.1 + 30 * t));
      },
      [](double t) {
        return 1.0 - 9.81 * t -
               22.5 * std::cos(0.1 + 30 * t) * (std::sin(0.1 + 30 * t) > 0 ? 1 : -1);
      },
      0.3,
      0.36,
      0.356237913635965525678574715385};
}

ScalarFunction noting(Looks& looks, ScalarFunction f) {
  return [&looks, f = std::move(f)](double t) {
    ++looks.calls;
    looks.earliest = std::min(looks.earliest, t);
    looks.latest = std::max(looks.latest, t);
    return f(t);
  };
}

std::string show(RootStatus status) {
  switch (status) {
    case RootStatus::kConverged: return "kConverged";
    case RootStatus::kNoSignChange: return "kNoSignChange";
    case RootStatus::kNotConverged: return "kNotConverged";
  }
  return "no status at all";
}

void expect_impact(const RootResult& found, const Approach& approach, const Looks& looks,
                   double tolerance, double round_off, const std::string& slip,
                   int equation_number) {
  const Story story{.scene = approach.scene + ", tolerance " + show_scale(tolerance) + " s",
                    .slip = slip,
                    .handout = equation(equation_number)};
  const auto because = [&story](const std::string& words) {
    Story other = story;
    other.slip = words;
    return other;
  };
  expect_true(found.status == RootStatus::kConverged, "status kConverged",
              "status " + show(found.status), story);
  if (found.status != RootStatus::kConverged) return;
  const double gap = approach.gap(found.time);
  const bool is_early = found.time >= approach.t_low && gap >= 0;
  Story of_time =
      because(slip + (is_early ? "; or the search ends too early: the bracket must be smaller than "
                                 "the tolerance, or hold no number between its ends, however many "
                                 "steps it takes"
                               : ""));
  of_time.iterates = true;
  expect_near(found.time, approach.time_of_impact, tolerance + round_off, "s", of_time);
  if (!std::isfinite(found.time)) return;  // reported above; without a time there is no gap
  // The gap is the caller's own function of the same number: its sign needs no tolerance.
  expect_true(
      gap >= 0, "gap(time) >= 0", "gap(" + show(found.time) + ") = " + show(gap),
      because(
          "the wrong side of the bracket is returned: the one where the gap has closed already"));
  expect_near(found.residual, gap, 0.0, "m", because("residual is not g at the time returned"));
  expect_near(found.evaluations, looks.calls, 0.0, "calls of the gap",
              because("evaluations does not count every call of g, the two ends included: the test "
                      "counted " +
                      std::to_string(looks.calls)));
}

void expect_no_impact(const RootResult& found, const Looks& looks, const std::string& scene,
                      const std::string& slip) {
  const Story story{.scene = scene, .slip = slip, .handout = equation(10)};
  expect_true(found.status == RootStatus::kNoSignChange, "status kNoSignChange",
              "status " + show(found.status) + ", time " + show(found.time) + " s", story);
  if (found.status != RootStatus::kNoSignChange) return;
  expect_true(std::isnan(found.time) && std::isnan(found.residual), "NaN as time and residual",
              show(found.time) + " and " + show(found.residual),
              {.scene = scene,
               .slip = "a time is returned although no impact was found",
               .handout = equation(10)});
  expect_true(looks.calls <= 2, "2 calls of the gap, at the ends",
              std::to_string(looks.calls) + " calls",
              {.scene = scene,
               .slip = "the search goes on although the ends show no sign change",
               .handout = equation(10)});
}

void expect_nan_noticed(const RootResult& found, const Approach& approach, const Looks& looks,
                        double last_open) {
  const Story story{.scene = approach.scene,
                    .slip =
                        "NaN is not noticed: it compares as neither >= 0 nor < 0, so ask for it "
                        "(std::isnan) at every call of the gap, the two ends included",
                    .handout = equation(10)};
  expect_true(found.status == RootStatus::kNotConverged, "status kNotConverged",
              "status " + show(found.status) + ", time " + show(found.time) + " s", story);
  if (found.status != RootStatus::kNotConverged) return;
  const double gap = approach.gap(found.time);
  const std::string where = std::isnan(last_open)
                                ? "NaN as time and residual: the gap is not known at t_low"
                                : "the last time at which the gap was seen open, at most " +
                                      show(last_open) + " s, and the gap there";
  const bool is_there = std::isnan(last_open)
                            ? std::isnan(found.time) && std::isnan(found.residual)
                            : found.time >= approach.t_low && found.time <= last_open && gap >= 0 &&
                                  found.residual == gap;
  expect_true(is_there, where,
              "time " + show(found.time) + " s, residual " + show(found.residual) + " m",
              {.scene = approach.scene,
               .slip = "time and residual are those of the last a, the open end of the bracket",
               .handout = equation(10)});
  expect_true(found.evaluations == looks.calls, std::to_string(looks.calls) + " evaluations",
              std::to_string(found.evaluations),
              {.scene = approach.scene,
               .slip = "evaluations does not count every call of g",
               .handout = equation(10)});
}

void expect_finder_notices_nan(const Finder& find) {
  const double nan = std::nan("");
  const auto fall = [](double t) { return 5.0 - 4.905 * t * t; };
  const auto rate = [](double t) { return -9.81 * t; };
  const std::string scene = "a falling point, gap = 5 - 4.905 t^2 in [0, 2] s, that is NaN ";
  const std::pair<Approach, double> cases[] = {
      {{scene + "everywhere but at the two ends",
        [=](double t) { return t > 0 && t < 2 ? nan : fall(t); }, rate, 0.0, 2.0, kUnset},
       0.0},
      {{scene + "between 1.005 and 1.015 s, around the impact",
        [=](double t) { return t > 1.005 && t < 1.015 ? nan : fall(t); }, rate, 0.0, 2.0, kUnset},
       1.005},
      {{scene + "at t_high", [=](double t) { return t == 2 ? nan : fall(t); }, rate, 0.0, 2.0,
        kUnset},
       0.0},
      {{scene + "at t_low", [=](double t) { return t == 0 ? nan : fall(t); }, rate, 0.0, 2.0,
        kUnset},
       kUnset}};
  for (const auto& [approach, last_open] : cases) {
    Looks looks;
    expect_nan_noticed(find(approach, 1e-6, looks), approach, looks, last_open);
  }
}

void expect_finder_looks_at_the_bracket(const Finder& find, int most) {
  for (const double unit : {0x1p-40, 0x1p40}) {
    const Approach ball = thrown_ball();
    const Approach approach{
        "a ball of radius 0.5 units is thrown up at 2 units/s from 5 units: gap = 4.5 + 2 t - "
        "4.905 t^2 units, looked for in [0, 3] s; a unit is " +
            show_scale(unit) + " m",
        [=](double t) { return unit * ball.gap(t); },
        [=](double t) { return unit * ball.gap_rate(t); },
        ball.t_low,
        ball.t_high,
        ball.time_of_impact};
    Looks looks;
    expect_impact(find(approach, 1e-9, looks), approach, looks, 1e-9, 1e-15,
                  "what ends the search: the tolerance is a time, and the bracket must be smaller "
                  "than it. One way to such an answer: the size of the gap ends the search",
                  10);
    expect_true(looks.calls <= most, "at most " + std::to_string(most) + " calls of the gap",
                std::to_string(looks.calls) + " calls",
                {.scene = approach.scene + ", tolerance 1e-9 s",
                 .slip = "the size of the gap keeps the search going: the tolerance is a time, and "
                         "the bracket's width ends it",
                 .handout = equation(10)});
  }
}

void expect_finder_refuses_overlap(const Finder& find) {
  Looks inside, leaving;
  const Approach sunk{"gap = -1 - t in [0, 2] s",
                      [](double t) { return -1 - t; },
                      [](double) { return -1.0; },
                      0.0,
                      2.0,
                      kUnset};
  const Approach parting{"gap = t - 1 in [0, 2] s",
                         [](double t) { return t - 1; },
                         [](double) { return 1.0; },
                         0.0,
                         2.0,
                         kUnset};
  const std::string slip =
      "overlap from the start is not an impact: there is no open side, so g(t_low) < 0 is no sign "
      "change of the right sense";
  expect_no_impact(find(sunk, 1e-6, inside), inside, sunk.scene, slip);
  expect_no_impact(find(parting, 1e-6, leaving), leaving, parting.scene, slip);
}

namespace {

constexpr const char* kGivesNothing =
    "the function gives nothing (0, NaN, no impact, its own argument) where there is an answer, or "
    "its status says so";

bool asked_first(bool came, const std::string& scene, const std::string& expected,
                 const std::string& found, int equation_number,
                 const Mistake& slip = kGivesNothing) {
  expect_true(
      came, expected, found,
      {.scene = "before this test a simpler case is asked, which must have an answer: " + scene,
       .slip = slip,
       .handout = equation(equation_number)});
  return came;
}

bool found_something(const RootResult& found, const Looks& looks, const Approach& approach,
                     int equation_number) {
  const bool is_converged = found.status == RootStatus::kConverged, is_later = found.time > 0.0;
  return asked_first(is_converged && is_later && looks.calls > 2, approach.scene,
                     "status kConverged with a time after 0 s, by more than 2 calls of the gap",
                     "status " + show(found.status) + ", time " + show(found.time) + " s, by " +
                         std::to_string(looks.calls) + (looks.calls == 1 ? " call" : " calls"),
                     equation_number,
                     !is_converged ? kGivesNothing
                     : !is_later
                         ? "the time lies outside the interval in which it is looked for"
                         : "the search ends at once, although the ends do not tell the time");
}

}  // namespace

bool bisection_finds_something() {
  Looks looks;
  const Approach ball = dropped_ball();
  const RootResult found =
      a2_module().impact_time_bisection(noting(looks, ball.gap), ball.t_low, ball.t_high, 1e-3);
  return found_something(found, looks, ball, 11);
}

bool newton_finds_something() {
  Looks looks;
  const Approach ball = thrown_ball();
  const RootResult found = a2_module().impact_time_newton(noting(looks, ball.gap), ball.gap_rate,
                                                          ball.t_low, ball.t_high, 1e-3);
  return found_something(found, looks, ball, 12);
}

bool a_body_moves() {
  RigidBodyState state = resting();
  state.momentum_world = {2, 4, 6};
  const VectorXd rate = a2_module().rigid_body_derivative(state, block(), no_wrench());
  const bool came = rate.size() == kStateSize && rate.allFinite() &&
                    rate != VectorXd::Zero(rate.size()) && rate != pack(state);
  return asked_first(came, "a 2 kg block with momentum (2, 4, 6) kg m/s",
                     "a derivative other than 0 and other than the state", show(rate), 4);
}

bool rk4_moves() {
  const VectorXd y = vector({1, 2});
  const VectorXd found =
      a2_module().rk4_step([](double, const VectorXd& at) { return VectorXd(-at); }, 0.0, y, 0.5);
  return asked_first(found.size() == 2 && found.allFinite() && found != y,
                     "y' = -y, y = (1, 2), one step of 0.5 s", "another y than before", show(found),
                     2);
}

}  // namespace tumble::a2_testing
