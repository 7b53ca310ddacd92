/// A small drawing of a blow, as inline SVG: the point where it acts, the arms from the centres of
/// mass to it, and its directions.
///
///   page.plot(Arms{.arms = {{"r_a", r_a, "A"}, {"r_b", r_b, "B"}}, .directions = {{"n", n}}});
///
/// It shows the plane that holds the first direction and as much of the arms as one plane can: the
/// direction points up, lengths along it and across it are true. What stands out of the plane is
/// said in the caption.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace tumble::report {

struct Arms {
  struct Arm {
    std::string name;           // "r_a"
    Eigen::Vector3d arm_world;  // from the centre of mass to the point [m]
    std::string body;           // name of the centre; empty: "x"
  };
  struct Direction {
    std::string name;             // "n"
    Eigen::Vector3d along_world;  // of any length: all are drawn equally long
  };
  std::vector<Arm> arms;
  std::vector<Direction> directions;
  std::string caption = {};
};

/// Whether there is something to see: finite numbers, an arm, and a direction that is not zero.
bool can_be_drawn(const Arms& arms);

/// The arms' parts out of the plane of the drawing, in words; empty where there are none.
std::string out_of_plane_words(const Arms& arms);

/// An <svg> element, 240 units wide.
/// @pre can_be_drawn(arms)
std::string svg_of(const Arms& arms);

}  // namespace tumble::report
