/// Root finders to compare with, by name: each can stand in the place of Laws::find_impact_time
/// with a tolerance of its own.
#pragma once

#include <string>
#include <vector>

#include "framework/dynamics/laws.h"

namespace tumble {

using ImpactFinder =
    std::function<RootResult(const ScalarFunction& gap, const ScalarFunction& gap_rate,
                             double t_low, double t_high, double tolerance)>;

struct RootMethod {
  std::string word;  // on the command line: "bisection"
  std::string name;  // for people
  ImpactFinder find;
};

/// bisection, newton (with the derivative, kept in the bracket by bisection), toms748 (inverse
/// cubic interpolation in a bracket).
/// Source: Boost.Math (tools/roots.hpp, tools/toms748_solve.hpp).
const std::vector<RootMethod>& root_methods();

/// @throws UserError naming the known words
const RootMethod& root_method_named(const std::string& word);

}  // namespace tumble
