#include "framework/engines/truths/families.h"

namespace tumble::truths {

const std::map<std::string, FrameworkFamily>& framework_families() {
  static const std::map<std::string, FrameworkFamily> families{
      {"ball_moving_floor", compare_moving_floor},
      {"ball_shaken_floor", compare_shaken_floor},
      {"bouncing_ball", compare_bouncing_ball},
      {"free_top_asymmetric", compare_free_top},
      {"free_top_needle", compare_free_top},
      {"free_top_symmetric", compare_free_top},
      {"hard_spheres", compare_hard_spheres},
      {"mass_properties", compare_mass_properties},
      {"newtons_cradle", compare_cradle},
      {"toi_boxes", compare_times_of_impact},
      {"toi_grazing", compare_times_of_impact},
      {"toi_rod_plane", compare_times_of_impact},
      {"toi_sphere_plane", compare_times_of_impact},
      {"toi_tunnel", compare_times_of_impact},
  };
  return families;
}

}  // namespace tumble::truths
