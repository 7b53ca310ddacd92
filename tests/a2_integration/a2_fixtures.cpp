#include "tests/a2_integration/a2_fixtures.h"

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

VectorXd integrate(const Step& step, const OdeFunction& f, double t_start, const VectorXd& y, double t_end, int steps) {
  const double h = (t_end - t_start) / steps;
  VectorXd state = y;
  for (int i = 0; i < steps; ++i) state = step(f, t_start + i * h, state, h);
  return state;
}

std::vector<double> observed_orders(const Step& step, const OdeFunction& f, double t_start, const VectorXd& y, double t_end,
                                    const VectorXd& exact, int first_steps, int halvings) {
  std::vector<double> orders;
  double coarser = kUnset;
  for (int i = 0, steps = first_steps; i <= halvings; ++i, steps *= 2) {
    const double error = distance(integrate(step, f, t_start, y, t_end, steps), exact);
    if (i > 0) orders.push_back(std::log2(coarser / error));
    coarser = error;
  }
  return orders;
}

void expect_orders(const std::vector<double>& found, double order, double tolerance, const Story& story) {
  bool all_near = true;
  std::string all;
  for (const double o : found) {
    all_near = all_near && std::abs(o - order) <= tolerance;
    all += (all.empty() ? "" : ", ") + show(std::round(o * 1000) / 1000);
  }
  expect_true(all_near, "order " + show(order) + " +- " + show(tolerance) + " at every halving of the step", all, story);
}

VectorXd logistic(double, const VectorXd& y) { return (6.0 * y.array() - 0.007 * y.array().square()).matrix(); }

VectorXd free_top(double, const VectorXd& omega_body) {
  const Vector3d w = omega_body, moments(1, 2, 3);
  const Vector3d angular_momentum_body = moments.cwiseProduct(w);
  return angular_momentum_body.cross(w).cwiseQuotient(moments);
}

Inertia block() { return {2.0, 0.5, Vector3d(1, 2, 4).asDiagonal(), Vector3d(1, 0.5, 0.25).asDiagonal()}; }

RigidBodyState resting() { return {{5, 3, 1}, Quaterniond::Identity(), Vector3d::Zero(), Vector3d::Zero()}; }

Vector3d random_vector(Random& random, double size) {
  const double x = random.between(-size, size), y = random.between(-size, size), z = random.between(-size, size);
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
  return {"a point falls from rest, 5 m above the floor: gap = 5 - 4.905 t^2, looked for in [0, 2] s",
          [](double t) { return 5.0 - 4.905 * t * t; }, [](double t) { return -9.81 * t; }, 0.0, 2.0, std::sqrt(5.0 / 4.905)};
}

Approach thrown_ball() {
  return {"a ball of radius 0.5 m is thrown up at 2 m/s from 5 m: gap = 4.5 + 2 t - 4.905 t^2, looked for in [0, 3] s",
          [](double t) { return 4.5 + (2.0 - 4.905 * t) * t; }, [](double t) { return 2.0 - 9.81 * t; }, 0.0, 3.0,
          1.18315682439326991216710727747};
}

Approach spinning_rod() {
  return {"a 1.5 m rod spins at 30 rad/s while it falls: gap = 1 + t - 4.905 t^2 - 0.75 |sin(0.1 + 30 t)|, looked for in [0.3, 0.36] s",
          [](double t) { return 1.0 + (1.0 - 4.905 * t) * t - 0.75 * std::abs(std::sin(0.1 + 30 * t)); },
          [](double t) { return 1.0 - 9.81 * t - 22.5 * std::cos(0.1 + 30 * t) * (std::sin(0.1 + 30 * t) > 0 ? 1 : -1); }, 0.3, 0.36,
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

void expect_impact(const RootResult& found, const Approach& approach, const Looks& looks, double tolerance, double round_off,
                   const std::string& slip, int equation_number) {
  const Story story{.scene = approach.scene + ", tolerance " + show(tolerance) + " s", .slip = slip, .handout = equation(equation_number)};
  const auto because = [&story](const std::string& words) {
    Story other = story;
    other.slip = words;
    return other;
  };
  expect_true(found.status == RootStatus::kConverged, "status kConverged", "status " + show(found.status), story);
  if (found.status != RootStatus::kConverged) return;
  const double gap = approach.gap(found.time);
  const bool is_early = found.time >= approach.t_low && gap >= 0;
  expect_near(found.time, approach.time_of_impact, tolerance + round_off, "s",
              because(slip + (is_early ? "; or the search ends too early: the bracket must be smaller than the tolerance, however many steps it takes" : "")));
  if (!std::isfinite(found.time)) return;  // said above; the gap of no time says nothing more
  // The gap is the caller's own function of the same number: its sign is known without any tolerance.
  expect_true(gap >= 0, "gap(time) >= 0", "gap(" + show(found.time) + ") = " + show(gap),
              because("the wrong side of the bracket is returned: the one where the gap has closed already"));
  expect_near(found.residual, gap, 0.0, "m", because("residual is not g at the time returned"));
  expect_near(found.evaluations, looks.calls, 0.0, "calls of the gap", because("evaluations does not count every call of g, the two ends included"));
}

void expect_no_impact(const RootResult& found, const Looks& looks, const std::string& scene, const std::string& slip) {
  const Story story{.scene = scene, .slip = slip, .handout = equation(10)};
  expect_true(found.status == RootStatus::kNoSignChange, "status kNoSignChange",
              "status " + show(found.status) + ", time " + show(found.time) + " s", story);
  if (found.status != RootStatus::kNoSignChange) return;
  expect_true(std::isnan(found.time) && std::isnan(found.residual), "NaN as time and residual", show(found.time) + " and " + show(found.residual),
              {.scene = scene, .slip = "a time is returned although no impact was found", .handout = equation(10)});
  expect_true(looks.calls <= 2, "2 calls of the gap, at the ends", std::to_string(looks.calls) + " calls",
              {.scene = scene, .slip = "the search goes on although the ends show no sign change", .handout = equation(10)});
}

namespace {

bool asked_first(bool came, const std::string& scene, const std::string& expected, int equation_number) {
  expect_true(came, expected, "nothing of the kind",
              {.scene = "asked first, because this test's own answer is \"nothing\": " + scene,
               .slip = "the function gives nothing (0, NaN, no impact, its own argument) whatever it is asked",
               .handout = equation(equation_number)});
  return came;
}

bool found_something(const RootResult& found, const Looks& looks) { return found.status == RootStatus::kConverged && found.time > 0.0 && looks.calls > 2; }

}  // namespace

bool bisection_finds_something() {
  Looks looks;
  const Approach ball = dropped_ball();
  const RootResult found = a2_module().impact_time_bisection(noting(looks, ball.gap), ball.t_low, ball.t_high, 1e-3);
  return asked_first(found_something(found, looks), ball.scene, "status kConverged with a time, and calls of the gap", 11);
}

bool newton_finds_something() {
  Looks looks;
  const Approach ball = thrown_ball();
  const RootResult found = a2_module().impact_time_newton(noting(looks, ball.gap), ball.gap_rate, ball.t_low, ball.t_high, 1e-3);
  return asked_first(found_something(found, looks), ball.scene, "status kConverged with a time, and calls of the gap", 12);
}

bool a_body_moves() {
  RigidBodyState state = resting();
  state.momentum_world = {2, 4, 6};
  const VectorXd rate = a2_module().rigid_body_derivative(state, block(), no_wrench());
  const bool came = rate.size() == kStateSize && rate.allFinite() && rate != VectorXd::Zero(rate.size()) && rate != pack(state);
  return asked_first(came, "a 2 kg block with momentum (2, 4, 6) kg m/s", "a derivative other than 0 and other than the state", 4);
}

bool rk4_moves() {
  const VectorXd y = vector({1, 2});
  const VectorXd found = a2_module().rk4_step([](double, const VectorXd& at) { return VectorXd(-at); }, 0.0, y, 0.5);
  return asked_first(found.size() == 2 && found.allFinite() && found != y, "y' = -y, y = (1, 2), one step of 0.5 s", "another y than before", 2);
}

}  // namespace tumble::a2_testing
