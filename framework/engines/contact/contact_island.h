/// Islands: bodies that touch each other or are linked, directly or through others. Impulses are
/// solved island by island.
#pragma once

#include <utility>
#include <vector>

#include "framework/dynamics/contact_problem.h"
#include "framework/engines/stepping/body_places.h"
#include "framework/engines/stepping/moving_world.h"

namespace tumble::engines {

struct ContactIsland {
  using Pair = std::pair<int, int>;  // bodies, first < second
  std::vector<int> bodies;           // that can move, ascending
  std::vector<Pair> pairs;           // in contact
  // pairs with a body of the island that may meet in the step; those in contact among them
  std::vector<Pair> near;
  std::vector<int> linked;  // places in MovingWorld::linked_groups()
  bool large = false;       // many bodies, solved in steps (large_islands.cpp)
};

/// Puts a body into a contact problem, once.
/// @param velocities  the state that its velocities and inertia are taken from; null: none, as for
/// position correction
/// @param places      of bodies in the problem; the new one is entered
/// @return its place
int place_body(const MovingWorld& moving, int body, double t, BodyPlaces& places,
               const std::vector<RigidBodyState>& states, const RigidBodyState* velocities,
               ContactProblem& problem);

/// Rods and joints of an island as rows of a problem. @pre its bodies are placed
/// @param of_places  true: the errors of places go; false: what the free step has made of
/// velocities stays
void add_island_rows(MovingWorld& moving, const ContactIsland& island,
                     const std::vector<RigidBodyState>& states, double t, const BodyPlaces& places,
                     bool of_places, ContactProblem& problem);

/// Of the fastest point of the island's bodies. [m/s]
double fastest_speed(const MovingWorld& moving, const ContactIsland& island);

}  // namespace tumble::engines
