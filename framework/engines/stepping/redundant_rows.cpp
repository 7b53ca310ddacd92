// Rows of links that say what others say. Part of LinkedBodies.
//
// Loops have them: all axes of a plane linkage are parallel, those of a universal joint or of a
// spherical linkage meet. That holds where the loop is closed, and only there. At a stage of a step
// the loop is open by what the method leaves, e; the rows differ by e there, and if all had to
// hold, they would push with forces of the order 1 / e, which take a mechanism's energy within a
// few steps. So which rows say something new is asked where the step begins, and its stages obey
// these; the others hold because of them.
#include <algorithm>
#include <cmath>

#include "framework/core/decompositions.h"
#include "framework/core/disjoint_sets.h"
#include "framework/effects/registry.h"
#include "framework/engines/stepping/linked_bodies.h"

namespace tumble::engines {

double redundant_within(double open_part) {
  constexpr double kRounding = 1e-13, kOfOpening = 10;
  return std::max(kRounding, std::pow(kOfOpening * open_part, 2));
}

// Whether links close a loop: the world and all that cannot move is one node.
bool LinkedBodies::closes_loop(const LinkedGroup& group) const {
  // rows that a step looks at, densely: 1 ms
  constexpr std::size_t kMostRows = 120;
  if (row_count_ > kMostRows) return false;
  const int immovable = static_cast<int>(bodies_.size());
  DisjointSets joined(immovable + 1);
  for (const Terms& terms : terms_) {
    if (terms.acting->row_count() == 0) continue;
    for (const int entry : group.entries.at(terms.effect)) {
      std::vector<int> ends;
      for (const int body : effects::all()[terms.effect]->bodies_of(world_, entry)) {
        const auto found = std::lower_bound(bodies_.begin(), bodies_.end(), body);
        if (found != bodies_.end() && *found == body)
          ends.push_back(static_cast<int>(found - bodies_.begin()));
      }
      if (ends.size() < 2) ends.push_back(immovable);
      if (joined.find(ends.front()) == joined.find(ends.back())) return true;
      joined.unite(ends.front(), ends.back());
    }
  }
  return false;
}

// Where the scene begins: what is redundant by proportions is so everywhere.
bool LinkedBodies::has_redundant_rows() {
  if (!has_redundant_rows_) {
    std::vector<RigidBodyState> start;
    for (const int body : bodies_)
      start.push_back(world_.bodies[static_cast<std::size_t>(body)].state);
    has_redundant_rows_ = has_loop_ && !spanning(place_bodies(start, 0.0)).empty();
  }
  return *has_redundant_rows_;
}

void LinkedBodies::choose_rows(const std::vector<RigidBodyState>& local, double t) {
  obeyed_.clear();
  if (has_redundant_rows()) obeyed_ = spanning(place_bodies(local, t));
}

// By row, whether it says something that others do not; empty: all do.
std::vector<char> LinkedBodies::spanning(const std::vector<Body>& bodies) {
  const std::vector<Constraint> all = rows(bodies);
  const auto m = static_cast<Eigen::Index>(all.size());
  // J M^-1/2, each row of length 1
  MatrixXd J = MatrixXd::Zero(m, 6 * static_cast<Eigen::Index>(bodies_.size()));
  for (Eigen::Index k = 0; k < m; ++k) {
    const auto& [a, b, row] = all[static_cast<std::size_t>(k)];
    for (const auto& [place, jacobian] :
         {std::pair{a, &row.jacobian_a}, std::pair{b, &row.jacobian_b}}) {
      if (static_cast<std::size_t>(place) >= bodies_.size()) continue;
      const Body& body = bodies[static_cast<std::size_t>(place)];
      const Vector3d turning_body = body.world_from_body.conjugate() * jacobian->tail<3>();
      J.row(k).segment<3>(6 * place) += std::sqrt(body.inertia.inverse_mass) * jacobian->head<3>();
      J.row(k).segment<3>(6 * place + 3) +=
          symmetric_root(body.inertia.inverse_inertia_body) * turning_body;
    }
    if (const double size = J.row(k).norm(); size > 0) J.row(k) /= size;
  }
  std::vector<char> chosen =
      spanning_rows(J * J.transpose(), redundant_within(open_part(bodies, all)));
  if (std::find(chosen.begin(), chosen.end(), 0) == chosen.end()) chosen.clear();
  return chosen;
}

// @param chosen  by row; empty: all
std::vector<Constraint> LinkedBodies::those_of(const std::vector<char>& chosen,
                                               std::vector<Constraint> all) {
  if (chosen.empty()) return all;
  std::vector<Constraint> some;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (chosen[k] != 0) some.push_back(all[k]);
  return some;
}

std::vector<Constraint> LinkedBodies::constraint_rows(const std::vector<RigidBodyState>& states,
                                                      double t) {
  if (!has_constraints()) return {};
  const std::vector<Body> bodies = place_bodies(take(states), t);
  std::vector<Constraint> all = rows(bodies);
  if (has_redundant_rows()) all = those_of(spanning(bodies), std::move(all));
  for (Constraint& row : all) {  // all fixed ends are one: none of them moves by an impulse
    row.body_a = std::min(row.body_a, fixed_end());
    row.body_b = std::min(row.body_b, fixed_end());
  }
  return all;
}

}  // namespace tumble::engines
