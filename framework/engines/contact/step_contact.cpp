#include "framework/engines/contact/step_contact.h"

#include <algorithm>
#include <cmath>

namespace tumble::engines {

Vector3d relative_velocity(const ContactProblem& problem, std::size_t contact,
                           const std::vector<Velocity>& velocities) {
  const PushingContact& c = problem.contacts[contact];
  const auto velocity = [&](int body) -> Vector3d {
    return velocities[body].linear_world +
           velocities[body].angular_world.cross(c.point_world - problem.bodies[body].com_world);
  };
  return velocity(c.body_a) - velocity(c.body_b);
}

double approach_speed(const ContactProblem& problem, std::size_t contact,
                      const std::vector<Velocity>& velocities) {
  return -problem.contacts[contact].normal_b_to_a_world.dot(
      relative_velocity(problem, contact, velocities));
}

double slip_speed(const ContactProblem& problem, std::size_t contact,
                  const std::vector<Velocity>& velocities) {
  const PushingContact& c = problem.contacts[contact];
  const Vector3d relative = relative_velocity(problem, contact, velocities) - c.slip_target_world;
  return (relative - relative.dot(c.normal_b_to_a_world) * c.normal_b_to_a_world).norm();
}

bool presses_over_a_corner(const StepContacts& contacts, const ContactSolution& solution) {
  for (std::size_t i = 0; i < contacts.size(); ++i)
    if (contacts[i].leaves_its_face && !solution.impulses_world[i].isZero(0.0)) return true;
  return false;
}

bool activates(const StepContacts& contacts, const ContactSolution& solution) {
  for (std::size_t i = 0; i < contacts.size(); ++i)
    if (contacts[i].activates && solution.impulses_world[i].squaredNorm() > 0.0) return true;
  return false;
}

void keep_together(StepContacts& contacts, ContactProblem& problem) {
  for (std::size_t i = 0; i < contacts.size(); ++i)
    if (!contacts[i].activates) contacts[i].target = problem.contacts[i].target = 0.0;
}

double largest_change_of_targets(const StepContacts& before, const StepContacts& after) {
  double largest = 0.0;
  for (std::size_t i = 0; i < after.size(); ++i)
    largest = std::max(largest, std::abs(after[i].target - before[i].target));
  return largest;
}

std::vector<int> touched_bodies(const ContactIsland& island, const StepContacts& contacts) {
  std::vector<int> bodies = island.bodies;
  for (const StepContact& step_contact : contacts) {
    bodies.push_back(step_contact.pair.first);
    bodies.push_back(step_contact.pair.second);
  }
  return bodies;
}

}  // namespace tumble::engines
