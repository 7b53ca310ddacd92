#include "framework/engines/base/guarded_laws.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "framework/dynamics/law_guard.h"
#include "framework/dynamics/world.h"

namespace tumble::engines {
namespace {

/// Puts a law under its guard, where there is one.
template <class Law, class Check>
void guard(Law& law, const char* effect, const std::string& name, const std::string& source,
           Check check) {
  if (law) law = guarded_function(LawGuard(effect, name, source), std::move(law), check);
}

// Of any law: its answer is made of numbers.
constexpr auto kNumber = [](const LawGuard& by, const auto& answer, const auto&...) {
  by.need_number(answer);
};

// Faster is no body of a scene: only an impulse leads there that drives two bodies together again
// and again, each time faster, until an answer overflows. Which of the two functions has the wrong
// sign cannot be seen from there.
constexpr double kFlung = 1e100;  // m/s, rad/s

bool is_flung(const Body& body) {
  const double fastest = std::max(body.velocity_world.lpNorm<Eigen::Infinity>(),
                                  body.omega_world.lpNorm<Eigen::Infinity>());
  return std::isfinite(fastest) && fastest > kFlung;
}

template <class Answer>
void need_number_unless_flung(const LawGuard& by, const std::string& source, const Answer& answer,
                              std::initializer_list<const Body*> bodies) {
  if (!is_number(answer) &&
      std::any_of(bodies.begin(), bodies.end(), [](const Body* body) { return is_flung(*body); }))
    throw StoppedRun("collision (collision_impulse, apply_impulse of " + source +
                     ") drives them together, faster each time it is applied: an impulse has the "
                     "wrong sign");
  by.need_number(answer);
}

void guard_impulses(Laws& laws) {
  const std::string source = laws.impulse_source;
  const auto of_two = [source](const LawGuard& by, double answer, const Contact&, const Body& a,
                               const Body& b, auto...) {
    need_number_unless_flung(by, source, answer, {&a, &b});
  };
  guard(laws.relative_normal_velocity, "collision", "relative_normal_velocity", source, of_two);
  guard(laws.collision_impulse, "collision", "collision_impulse", source, of_two);
  guard(laws.apply_impulse, "collision", "apply_impulse", source,
        [source](const LawGuard& by, const Velocity& answer, const Body& body, const Vector3d&,
                 const Vector3d&) { need_number_unless_flung(by, source, answer, {&body}); });
  guard(laws.wrench_of_point_force, "point force", "wrench_of_point_force", source, kNumber);
}

void guard_motion(Laws& laws) {
  const std::string& source = laws.integrator_source;
  guard(laws.integrate_step, "integration", laws.step_function, source,
        [](const LawGuard& by, const VectorXd& end, const OdeFunction&, double, const VectorXd& y,
           double) {
          by.need_size(end.size(), y.size());
          by.need_number(end);
        });
  guard(laws.state_derivative, "integration", laws.derivative_function, source,
        [](const LawGuard& by, const VectorXd& rate, const RigidBodyState& state, const Inertia&,
           const Wrench&) {
          by.need_size(rate.size(), kStateSize);
          // Out of a state that is no number nothing better can come: that is the method's doing.
          if (!is_number(rate) && is_finite(state)) by.need_number(rate);
        });
  guard(laws.renormalize, "integration", "renormalize", source, kNumber);
  guard(laws.find_impact_time, "time of impact", laws.impact_time_function, source,
        [](const auto&...) {});
}

bool are_directions(const std::vector<Constraint>& rows) {
  return std::all_of(rows.begin(), rows.end(), [](const Constraint& one) {
    return is_number(one.row.jacobian_a) && is_number(one.row.jacobian_b);
  });
}

bool are_accelerations(const std::vector<Constraint>& rows,
                       const std::vector<ConstrainedBody>& bodies) {
  return std::all_of(rows.begin(), rows.end(),
                     [](const Constraint& one) { return is_number(one.row.velocity_product); }) &&
         std::all_of(bodies.begin(), bodies.end(),
                     [](const ConstrainedBody& body) { return is_number(body.free_acceleration); });
}

/// Out of what is no number no law makes one: then it is not blamed.
template <class Answer, class AreNumbers>
void need_number_of(const LawGuard& by, const char* effect, const Answer& answer,
                    AreNumbers&& are_given_numbers) {
  if (!is_number(answer) && !are_given_numbers())
    throw StoppedRun(std::string(effect) +
                     ": what acts on these bodies, or how they move, is not a number any more: the "
                     "steps have run away, and no law could answer for it");
  by.need_number(answer);
}

void guard_constraints(Laws& laws) {
  guard(laws.spring_force, "springs", "spring_force", laws.constraint_source, kNumber);
  guard(laws.baumgarte_acceleration, "rods and joints", "baumgarte_acceleration",
        laws.constraint_source, kNumber);
  guard(laws.constraint_multipliers, "rods and joints", "constraint_multipliers",
        laws.source_of_links(),
        [](const LawGuard& by, const VectorXd& answer, const std::vector<Constraint>& rows,
           const std::vector<ConstrainedBody>& bodies, const VectorXd& wanted) {
          need_number_of(by, "rods and joints", answer, [&] {
            return is_number(wanted) && are_directions(rows) && are_accelerations(rows, bodies);
          });
        });
  guard(laws.constraint_correction, "rods and joints", "constraint_correction",
        laws.source_of_links(),
        [](const LawGuard& by, const VectorXd& answer, const std::vector<Constraint>& rows,
           const std::vector<ConstrainedBody>&, const VectorXd& error) {
          need_number_of(by, "rods and joints", answer,
                         [&] { return is_number(error) && are_directions(rows); });
        });
  guard(laws.contact_forces, "persistent contact", "contact_forces", laws.source_of_contacts(),
        [](const LawGuard& by, const VectorXd& answer, const MatrixXd& A, const VectorXd& b) {
          need_number_of(by, "persistent contact", answer,
                         [&] { return is_number(A) && is_number(b); });
        });
}

}  // namespace

Laws guarded(const Laws& laws) {
  Laws safe = laws;
  guard_impulses(safe);
  guard_motion(safe);
  guard_constraints(safe);
  safe.guard_listed();
  return safe;
}

}  // namespace tumble::engines
