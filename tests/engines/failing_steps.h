/// A process whose step fails from some time on, unless a ball has turned it back before.
#pragma once

#include <cmath>
#include <optional>
#include <stdexcept>

#include "framework/effects/point_force/point_force.h"
#include "framework/modules/answer_sizes.h"
#include "tests/engines/scenes.h"

namespace tumble::testing {

constexpr double kFailingStep = 1.0 / 64.0;  // s: steps begin at exact multiples of it
constexpr double kCartFails = 0.5;  // s: for a cart at y = 0, while it goes on to the right

/// `laws`, where no step of a body that goes to the right begins at kCartFails or later; for each
/// metre of y an eighth of a second later.
/// @param Failure  what such a step throws
template <class Failure = std::runtime_error>
Laws with_failing_steps(Laws laws) {
  laws.integrate_step = [step = laws.integrate_step](const OdeFunction& f, double t,
                                                     const VectorXd& y, double h) {
    constexpr int kMomentumX = 7;
    if (y.size() == kStateSize && y[kMomentumX] > 0.0 &&
        t > kCartFails + 0.125 * y[1] - 0.25 * kFailingStep)
      throw Failure("no way through");
    return step(f, t, y, h);
  };
  return laws;
}

/// The same, where such a step returns a vector of a wrong size.
inline Laws with_steps_of_a_wrong_size(Laws laws) {
  return with_failing_steps<modules::WrongSize>(std::move(laws));
}

constexpr double kCartSpins = 0.5;     // s: for a cart that goes on to the right
constexpr double kSpunFails = 0.5625;  // s: likewise; four steps later

/// `laws`, where the step at kCartSpins sets a body that goes to the right spinning about x, by
/// more than half a turn a step, and where it has no step from kSpunFails on.
inline Laws with_spinning_steps(Laws laws) {
  laws.integrate_step = [step = laws.integrate_step](const OdeFunction& f, double t,
                                                     const VectorXd& y, double h) -> VectorXd {
    constexpr int kMomentumX = 7, kAngularMomentumX = 10;
    constexpr double kSpin = 1.7;  // kg m^2/s: 255 rad/s, 4 rad a step, of a cube of 0.2 m and 1 kg
    const bool goes_right = y.size() == kStateSize && y[kMomentumX] > 0.0;
    if (goes_right && t > kSpunFails - 0.25 * kFailingStep)
      throw std::runtime_error("no way through");
    VectorXd next = step(f, t, y, h);
    if (goes_right && std::abs(t - kCartSpins) < 0.25 * kFailingStep)
      next[kAngularMomentumX] = kSpin;
    return next;
  };
  return laws;
}

/// Carts at y = 0, 2, ..., each a process since a force pushes it: x = t + t^2 / 20 [m, s]. A ball
/// that flies freely meets the first of them at `met_at` and turns it back for the rest of the run;
/// it goes on to the left itself.
inline scene::Scene pushed_carts(int carts, double met_at, double duration) {
  scene::Scene scene;
  for (int i = 0; i < carts; ++i) {
    const std::string name = "cart" + std::to_string(i);
    scene.bodies.push_back(ball(name, 0.1, 1.0, {0.0, 2.0 * i, 0.0}, {1.0, 0.0, 0.0}));
    scene.effects.of<effects::PointForceSpec>().push_back(
        {name, {0.1, 0.0, 0.0}, {0.0, 2.0 * i, 0.0}, 0.0, 10.0});
  }
  const double x = met_at + met_at * met_at / 20.0 + 0.2 + met_at;
  scene.bodies.push_back(ball("comer", 0.1, 5.0, {x, 0.0, 0.0}, {-1.0, 0.0, 0.0}));
  scene.name = "pushed carts";
  scene.step_s = kFailingStep;
  scene.duration_s = duration;
  return scene;
}

/// The same scene beside a heavy body that flies past: of its energy, 1e6 J, the 200 J of a cart that
/// steps set spinning are no part that is told.
inline scene::Scene beside_much_energy(scene::Scene scene) {
  scene.bodies.push_back(ball("heavy", 0.1, 1e3, {0.0, 0.0, 50.0}, {0.0, 0.0, 50.0}));
  return scene;
}

/// `laws`, where an impact with an immovable body has no response. Contacts never last.
inline Laws with_failing_responses(Laws laws) {
  laws.ends_in_contact = [](double, double, double) { return false; };
  laws.contact_forces = [](const MatrixXd&, const VectorXd& b) -> VectorXd {
    return VectorXd::Zero(b.size());
  };
  laws.collision_impulse = [right = laws.collision_impulse](const Contact& contact, const Body& a,
                                                            const Body& b, double restitution) {
    if (a.inertia.inverse_mass == 0.0 || b.inertia.inverse_mass == 0.0)
      throw std::runtime_error("no way back");
    return right(contact, a, b, restitution);
  };
  return laws;
}

/// A cart as above that meets a post at `post_at`; where a pebble lies in its way, it meets that at
/// `pebble_at` first and is thrown back. In a scene with persistent contacts the impact with the
/// post is a matter of the cart's process alone.
inline scene::Scene cart_and_post(double post_at, std::optional<double> pebble_at) {
  const auto x = [](double t) { return t + t * t / 20.0; };
  scene::Scene scene = pushed_carts(1, 5.0, 0.8);
  scene.bodies.pop_back();
  scene.bodies.push_back(ball("post", 0.1, 1.0, {x(post_at) + 0.2, 0.0, 0.0}, Vector3d::Zero()));
  scene.bodies.back().mass_kg.reset();
  scene.bodies.back().immovable = true;
  if (pebble_at)
    scene.bodies.push_back(
        ball("pebble", 1e-3, 1e3, {x(*pebble_at) + 0.101, 0.0, 0.0}, Vector3d::Zero()));
  scene.contact.emplace();
  scene.name = "cart and post";
  return scene;
}

/// The first of such carts as a cube, whose face the ball meets.
inline scene::Scene pushed_cube(double met_at, double duration) {
  scene::Scene scene = pushed_carts(1, met_at, duration);
  scene.bodies[0].shape = scene::BoxSpec{Vector3d::Constant(0.1)};
  scene.name = "pushed cube";
  return beside_much_energy(scene);
}

}  // namespace tumble::testing
