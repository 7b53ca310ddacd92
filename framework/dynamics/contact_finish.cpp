// Semismooth Newton on Coulomb's law (contact_newton.h).
#include "framework/dynamics/contact_newton.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "framework/dynamics/contact_cone.h"
#include "framework/dynamics/contact_equations.h"

namespace tumble::contacts {
namespace {

// of the problem's speed: a contact this near to opening or sliding is taken as closed, or sticking
constexpr double kTie = 1e-9;

/// delta, the compliance of a step over the inverse effective mass of the contact. A full step
/// takes the error in the stiffest direction down by delta over the smallest eigenvalue of W (N^-4
/// in a stack of N); the rounding of the linear equations grows with 1 / delta. So it is lessened
/// where steps are slow and the equations were solved well, and raised where they were not.
constexpr double kFirstFade = 1e-8, kLeastFade = 1e-11, kMostFade = 1e-4;
/// Of few contacts: the error still falls by a thousand a step. Redundant ones (the four corners of
/// a box that lands flat) share a load in many ways, with friction to different motions, and a step
/// picks one up to rounding / delta: with 1e-11 an impact's result depends on the last digits by
/// millimetres a second, with this by some 1e-10 of its speed.
/// Where that is not done in a few steps, it is lessened as elsewhere.
constexpr std::size_t kFew = 24;
constexpr double kFadeOfFew = 1e-6;
constexpr int kFewSteps = 8;

/// The answer of a contact that sticks, whatever it carries.
Response sticking_response(const ContactBlock& c, const Vector3d& v, double fade) {
  Response response{-v / (fade * c.inverse_effective_mass), Matrix3d::Zero()};
  response.d.diagonal().setConstant(1 / (fade * c.inverse_effective_mass));
  return response;
}

/// Linearised p = P(p - v / r):  (I - (1 - delta) P') dp = F - P' dv / r,   F = P(z) - p.
Response law_response(const ContactBlock& c, const Vector3d& p, const Vector3d& v, double r,
                      double fade, double tie) {
  const Vector3d z = p - v / r;
  Response response{-p, Matrix3d::Zero()};
  if (z[0] < -tie) return response;  // open
  const double length = z.tail<2>().norm(), radius = c.friction * z[0];
  if (!c.is_frictional() || length <= radius + tie) {
    response = sticking_response(c, v, fade);
    if (!c.is_frictional()) response.f.tail<2>().setZero();
    return response;
  }
  const Vector2d t = z.tail<2>() / length;
  Matrix3d slope = Matrix3d::Zero();  // P'
  slope(0, 0) = 1;
  slope.block<2, 1>(1, 0) = c.friction * t;
  slope.block<2, 2>(1, 1) = radius / length * (Eigen::Matrix2d::Identity() - t * t.transpose());
  Vector3d misfit;
  misfit << z[0] - p[0], radius * t - p.tail<2>();
  misfit[0] = -v[0] / r;  // the same, without rounding
  const Matrix3d inverse = (Matrix3d::Identity() - (1 - fade) * slope).inverse();
  response.f = inverse * misfit;
  response.d = inverse * slope / r;
  return response;
}

/// dp = f - D (dv + c dp_n n)  as  dp = f' - D' dv  (Sherman, Morrison).
void yield(double compliance, Response& response) {
  const Vector3d by_normal = response.d.col(0);
  const double share = compliance / (1 + compliance * by_normal[0]);
  response.d -= share * by_normal * response.d.row(0).eval();
  response.f -= share * response.f[0] * by_normal;
}

/// The answers of all contacts by Coulomb's law.
std::vector<Response> law_responses(const System& system, const Impulses& now, double fade) {
  std::vector<Response> responses(system.contacts.size(),
                                  Response{Vector3d::Zero(), Matrix3d::Zero()});
  for (std::size_t i = 0; i < responses.size(); ++i) {
    const ContactBlock& c = system.contacts[i];
    if (!(c.inverse_effective_mass > 0)) continue;
    responses[i] = law_response(
        c, now.contacts[i], yielding_velocity(c, now.contacts[i], now.y), c.inverse_effective_mass,
        fade, c.compliance > 0 ? 0.0 : kTie * system.speed / c.inverse_effective_mass);
    if (c.compliance > 0) yield(c.compliance, responses[i]);
  }
  return responses;
}

/// Those of contacts that stick, where the others are open, whatever Coulomb's law has them do.
std::vector<Response> held_responses(const System& system, const Impulses& now, double fade,
                                     const std::vector<bool>& held) {
  std::vector<Response> responses(system.contacts.size(),
                                  Response{Vector3d::Zero(), Matrix3d::Zero()});
  for (std::size_t i = 0; i < responses.size(); ++i) {
    const ContactBlock& c = system.contacts[i];
    if (held[i] && c.inverse_effective_mass > 0)
      responses[i] = sticking_response(c, contact_velocity(c, now.y), fade);
  }
  return responses;
}

/// impulses + share * change, back into the law's set.
Impulses moved(const System& system, const Impulses& impulses, const Impulses& change,
               double share) {
  Impulses next = impulses;
  for (std::size_t i = 0; i < next.contacts.size(); ++i) {
    next.contacts[i] = coulomb_projection(impulses.contacts[i] + share * change.contacts[i],
                                          system.contacts[i].friction);
  }
  for (std::size_t i = 0; i < next.rows.size(); ++i) next.rows[i] += share * change.rows[i];
  sum_impulses(system, next);
  return next;
}

}  // namespace

namespace {

/// The impulses that hold these contacts, and all rows, in all directions, whatever they have to
/// be. False where the equations cannot be solved.
bool hold(const Goal& goal, const std::vector<bool>& held, BodyMatrix& matrix, Progress& trial) {
  // not as small as later: nothing is known yet of how well these equations can be solved
  constexpr double kFade = 1e-6;
  constexpr int kMostSteps = 6;
  StepEquations equations;
  Impulses change;
  double before = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kMostSteps; ++i) {
    double largest = 0;
    for (std::size_t k = 0; k < held.size(); ++k)
      if (held[k])
        largest =
            std::max(largest, contact_velocity(goal.system.contacts[k], trial.impulses.y).norm());
    for (const RowBlock& row : goal.system.rows)
      if (row.inverse_effective_mass > 0)
        largest = std::max(largest, std::abs(row_velocity(row, trial.impulses.y)));
    if (goal.accepts(trial.impulses, largest)) return true;
    if (!(largest < 0.5 * before) ||
        !equations.prepare(goal.system, kFade, matrix, trial.impulses,
                           held_responses(goal.system, trial.impulses, kFade, held)))
      return false;
    before = largest;
    ++trial.factorisations;
    equations.solve(matrix, largest, change);
    for (std::size_t k = 0; k < held.size(); ++k) trial.impulses.contacts[k] += change.contacts[k];
    for (std::size_t k = 0; k < goal.system.rows.size(); ++k)
      trial.impulses.rows[k] += change.rows[k];
    sum_impulses(goal.system, trial.impulses);
  }
  return false;
}

}  // namespace

bool hold_rows(const Goal& goal, BodyMatrix& matrix, Progress& progress) {
  if (goal.system.rows.empty() || progress.accepted) return false;
  Progress trial = progress;
  hold(goal, std::vector<bool>(goal.system.contacts.size(), false), matrix, trial);
  progress.factorisations = trial.factorisations;
  goal.measure(trial);
  if (!(trial.violation.squares < progress.violation.squares)) return false;
  progress = std::move(trial);
  return true;
}

bool stick(const Goal& goal, BodyMatrix& matrix, Progress& progress) {
  constexpr int kMostRounds = 8;
  const System& system = goal.system;
  const auto is_smooth = [](const ContactBlock& c) {
    return !c.is_frictional() && c.inverse_effective_mass > 0;
  };
  if (std::any_of(system.contacts.begin(), system.contacts.end(), is_smooth)) return false;
  std::vector<bool> held(system.contacts.size());
  for (std::size_t i = 0; i < held.size(); ++i)
    held[i] = system.contacts[i].inverse_effective_mass > 0 &&
              system.contacts[i].base[0] <= goal.violation;
  for (int round = 0; round < kMostRounds; ++round) {
    Progress trial;
    trial.impulses.contacts.assign(system.contacts.size(), Vector3d::Zero());
    trial.impulses.rows.assign(system.rows.size(), 0.0);
    sum_impulses(system, trial.impulses);
    const bool holds = hold(goal, held, matrix, trial);
    progress.factorisations += trial.factorisations;
    if (!holds) return false;
    bool changed = false;
    for (std::size_t i = 0; i < held.size(); ++i) {
      const double v = contact_velocity(system.contacts[i], trial.impulses.y)[0];
      const bool next = held[i]
                            ? trial.impulses.contacts[i][0] >= 0
                            : system.contacts[i].inverse_effective_mass > 0 && v < -goal.violation;
      changed = changed || next != held[i];
      held[i] = next;
    }
    if (changed) continue;
    trial.impulses = moved(system, trial.impulses,
                           Impulses{std::vector<Vector3d>(held.size(), Vector3d::Zero()),
                                    std::vector<double>(system.rows.size(), 0.0),
                                    {}},
                           0.0);
    goal.measure(trial);
    if (!trial.accepted) return false;  // one leaves its cone
    trial.sweeps = progress.sweeps;
    trial.factorisations = progress.factorisations;
    progress = std::move(trial);
    return true;
  }
  return false;
}

void finish(const Goal& goal, int most_steps, BodyMatrix& matrix, Progress& progress) {
  constexpr double kHelps = 0.5;  // a step that leaves more of the sum of squares is shortened
  constexpr double kShortest = 0.03;
  // of the sum of squares: a full step that leaves more may owe it to the fade
  constexpr double kSlow = 1e-4;
  constexpr int kMostPoorSteps = 3;  // in a row
  const bool few = goal.system.contacts.size() + goal.system.rows.size() <= kFew;
  double fade = few ? kFadeOfFew : kFirstFade;
  StepEquations equations;
  Impulses change;
  for (int i = 0, poor = 0; i < most_steps && poor < kMostPoorSteps; ++i) {
    const bool was_accepted = progress.accepted;
    const Violation before = progress.violation;
    if (!equations.prepare(goal.system, fade, matrix, progress.impulses,
                           law_responses(goal.system, progress.impulses, fade)))
      return;
    const bool solved = equations.solve(matrix, before.largest, change);
    ++progress.factorisations;
    double share = 1, best_share = 1;
    Impulses next = moved(goal.system, progress.impulses, change, share);
    Violation after = measure_violation(goal.system, next);
    while (after.squares > kHelps * before.squares && share > kShortest && !was_accepted) {
      share *= 0.5;
      Impulses shorter = moved(goal.system, progress.impulses, change, share);
      const Violation there = measure_violation(goal.system, shorter);
      if (!(there.squares < after.squares)) continue;
      after = there;
      next = std::move(shorter);
      best_share = share;
    }
    if (!(after.squares < before.squares)) return;
    if (!solved) {
      fade = std::min(kMostFade, 10 * fade);
    } else if (best_share == 1 && after.squares > kSlow * before.squares) {
      fade = std::max(few && i < kFewSteps ? kFadeOfFew : kLeastFade, 0.1 * fade);
    }
    poor = after.squares > 0.8 * before.squares ? poor + 1 : 0;
    progress.impulses = std::move(next);
    progress.violation = after;
    progress.accepted = goal.accepts(progress.impulses, after.largest);
    // One step past the goal: the velocities of a high stack are sums of many contacts' violations.
    if (was_accepted || after.largest <= rounding_floor(goal.system, progress.impulses)) return;
  }
}

bool finish_yielding(const Goal& goal, int most_steps, BodyMatrix& matrix, Progress& progress) {
  constexpr double kFade = 1e-7;
  StepEquations equations;
  Impulses change;
  for (int i = 0; i < most_steps && !progress.accepted; ++i) {
    if (!equations.prepare(goal.system, kFade, matrix, progress.impulses,
                           law_responses(goal.system, progress.impulses, kFade)))
      return false;
    ++progress.factorisations;
    equations.solve(matrix, progress.violation.largest, change);
    progress.impulses = moved(goal.system, progress.impulses, change, 1.0);
    goal.measure(progress);
  }
  return progress.accepted;
}

}  // namespace tumble::contacts
