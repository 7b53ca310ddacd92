/// The scene in which an assignment shows error against cost.
#pragma once

#include <string>

namespace tumble::cost {

/// Noted in the registration of a module (Registry::set_note): a scene long enough that the order
/// of a method shows, and short enough that a first-order method shows it too.
struct CostShowcase {
  std::string scene;  // a bare name; empty: none
  double duration_s = 0.0;
  // part of each graded report: where the module determines how errors fall with the step, or the
  // cost
  bool is_graded = false;
  std::string sized_scene = {};  // of a scheduler: the scene of growing size; empty: none
};

}  // namespace tumble::cost
