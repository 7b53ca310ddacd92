// The cost of a contact problem: stacks with and without warm start, forty contacts at rest, a pile
// of 200 bodies.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/dynamics/contact_scenes.h"

#include "framework/dynamics/solve_contacts.h"

namespace tumble::testing {
namespace {

ContactProblem with_guess(ContactProblem problem, const ContactSolution& solution, double share) {
  for (std::size_t i = 0; i < problem.contacts.size(); ++i)
    problem.contacts[i].warm_start_world = share * solution.impulses_world[i];
  return problem;
}

/// 200 balls in 10 x 10 x 2 layers, each pressed on its four lower neighbours or the floor, and
/// loosely on its neighbours: 800 contacts.
ContactProblem pile() {
  ContactProblem problem;
  problem.bodies.push_back(fixed_body());
  Random random(1);
  for (int layer = 0; layer < 2; ++layer)
    for (int i = 0; i < 100; ++i) {
      const int row = i / 10, column = i % 10, body = static_cast<int>(problem.bodies.size());
      problem.bodies.push_back(
          ball_body(random.between(0.5, 2), 0.5,
                    Vector3d(column + 0.5 * layer, row + 0.5 * layer, 0.5 + 0.7 * layer)));
      if (layer == 0)
        for (int k = 0; k < 4; ++k)
          problem.contacts.push_back(
              contact_at(body, 0, Vector3d(column + 0.1 * (k % 2), row + 0.1 * (k / 2), 0),
                         Vector3d::UnitZ(), 0.5));
      if (layer == 1)
        for (const int lower : {0, 1, 10, 11}) {
          const int other = 1 + std::min(99, i + lower);
          const Vector3d apart = problem.bodies[body].com_world - problem.bodies[other].com_world;
          problem.contacts.push_back(contact_at(
              body, other, problem.bodies[other].com_world + 0.5 * apart, apart.normalized(), 0.5));
        }
    }
  let_fall(problem);
  return problem;
}

void time_it(const std::string& name, const ContactProblem& problem,
             const ContactOptions& options = {}) {
  ContactSolution solution;
  double least = 1e9;
  for (int i = 0; i < 20; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    solution = solve_contacts(problem, options);
    least = std::min(
        least, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  std::printf("%-34s %4zu contacts %10.1f us   residual %.1e  sweeps %4d  factorisations %d%s\n",
              name.c_str(), problem.contacts.size(), 1e6 * least, solution.residual,
              solution.sweeps, solution.factorisations,
              solution.converged ? "" : "  NOT CONVERGED");
}

void run() {
  for (const int n : {1, 10, 50}) {
    const ContactProblem cold = stack_of_boxes(std::vector<double>(n, 1.0));
    const ContactSolution solution = solve_contacts(cold);
    time_it("stack of " + std::to_string(n) + ", cold", cold);
    time_it("stack of " + std::to_string(n) + ", guess 1 % off", with_guess(cold, solution, 0.99));
    time_it("stack of " + std::to_string(n) + ", exact guess", with_guess(cold, solution, 1));
  }
  const ContactProblem heap = pile();
  ContactOptions loose;
  loose.tolerance = 1e-6;
  loose.largest_direct = 2000;
  const ContactSolution solution = solve_contacts(heap);
  time_it("pile of 200, cold, 1e-6", heap, loose);
  time_it("pile of 200, guess 1 % off, 1e-6", with_guess(heap, solution, 0.99), loose);
  loose.tolerance = 1e-4;
  time_it("pile of 200, guess 1 % off, 1e-4", with_guess(heap, solution, 0.99), loose);
}

}  // namespace
}  // namespace tumble::testing

int main() {
  tumble::testing::run();
  return EXIT_SUCCESS;
}
