/// Where an assignment shows what accuracy costs.
#pragma once

#include <string>

namespace tumble::engines {

/// Of a module, noted in its registration (Registry::set_note): a scene for so long that an order shows, and so short that a method of the first does too.
struct CostShowcase {
  std::string scene;                       // a bare name; empty: nobody said
  double duration_s = 0.0;
  bool is_graded = false;                  // a part of each graded report: where the module decides how errors shrink with the step, whether they do, or what is paid
  std::string sized_scene = {};            // of a scheduler: the scene that is run at growing size; empty: none
};

}  // namespace tumble::engines
