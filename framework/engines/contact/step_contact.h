/// A contact point of the step that is being solved, and what is asked of all of them.
#pragma once

#include <utility>
#include <vector>

#include "framework/core/math.h"
#include "framework/collision/manifold_points.h"
#include "framework/dynamics/contact_problem.h"
#include "framework/engines/contact/contact_island.h"

namespace tumble::engines {

struct StepContact {
  std::pair<int, int> pair;  // bodies, first < second
  collision::ManifoldPoint point;
  double target;                                  // least normal velocity afterwards [m/s]
  bool activates;                                 // apart at the start of the step
  Vector3d slip_target_world = Vector3d::Zero();  // [m/s], see PushingContact
  double start_gap = 0.0;        // at the start of the step, wherever `point` is looked at [m]
  bool leaves_its_face = false;  // within the step, over a corner to the next
};
/// Sorted by pair.
using StepContacts = std::vector<StepContact>;

/// Of A against B at a contact, with these velocities of the problem's bodies. [m/s]
Vector3d relative_velocity(const ContactProblem& problem, std::size_t contact,
                           const std::vector<Velocity>& velocities);
/// How fast the two come together there. [m/s], > 0 approaching
double approach_speed(const ContactProblem& problem, std::size_t contact,
                      const std::vector<Velocity>& velocities);
/// How fast they slide there, against what is asked of them. [m/s]
double slip_speed(const ContactProblem& problem, std::size_t contact,
                  const std::vector<Velocity>& velocities);

/// Whether a contact becomes active in this step that did not touch before.
bool activates(const StepContacts& contacts, const ContactSolution& solution);
/// Whether a contact that presses leaves its face within the step.
bool presses_over_a_corner(const StepContacts& contacts, const ContactSolution& solution);
/// What touches at the start of the step neither parts nor comes nearer by its end.
void keep_together(StepContacts& contacts, ContactProblem& problem);
/// By how much the targets of the same points differ. [m/s]
double largest_change_of_targets(const StepContacts& before, const StepContacts& after);
/// Bodies of the island and all that its contacts touch; some more than once.
std::vector<int> touched_bodies(const ContactIsland& island, const StepContacts& contacts);

}  // namespace tumble::engines
