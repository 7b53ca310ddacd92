#include "framework/truths/families.h"

namespace tumble::truths {

const std::map<std::string, FrameworkFamily>& framework_families() {
  static const std::map<std::string, FrameworkFamily> families{
      {"ball_moving_floor", compare_moving_floor},
      {"ball_shaken_floor", compare_shaken_floor},
      {"bouncing_ball", compare_bouncing_ball},
      {"chain", compare_chain},
      {"compound_pendulum", compare_compound_pendulum},
      {"double_pendulum", compare_chain},
      {"elastic_pendulum", compare_elastic_pendulum},
      {"free_top_asymmetric", compare_free_top},
      {"free_top_needle", compare_free_top},
      {"free_top_symmetric", compare_free_top},
      {"friction_incline", compare_friction_incline},
      {"hard_spheres", compare_hard_spheres},
      {"heavy_top", compare_heavy_top},
      {"mass_properties", compare_mass_properties},
      {"newtons_cradle", compare_cradle},
      {"roll_incline", compare_roll_incline},
      {"slip_to_roll", compare_slip_to_roll},
      {"spring_mass", compare_spring_mass},
      {"toi_boxes", compare_times_of_impact},
      {"toi_grazing", compare_times_of_impact},
      {"toi_rod_plane", compare_times_of_impact},
      {"toi_sphere_plane", compare_times_of_impact},
      {"toi_tunnel", compare_times_of_impact},
      {"two_body_spring", compare_two_body_spring},
  };
  return families;
}

}  // namespace tumble::truths
