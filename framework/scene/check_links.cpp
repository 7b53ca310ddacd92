#include "framework/scene/check_links.h"

#include <map>

#include "framework/scene/words.h"

namespace tumble::scene {
std::string ending(const AnchorSpec& anchor) {
  return anchor.body.empty() ? "the world" : "'" + anchor.body + "'";
}

void check_ends(const std::string& who, const AnchorSpec& a, const AnchorSpec& b,
                const std::string& pointer, const BodiesByName& bodies, const Refuse& refuse) {
  if (a.body == b.body && !a.body.empty()) {
    const bool is_one_point = (a.point_m - b.point_m).isZero(0.0);
    refuse(pointer,
           who + " goes from body '" + a.body + "' to " +
               (is_one_point ? "the same point of it" : "itself, which moves nothing"),
           "Name another body at one end, or a point of the world.");
  }
  if (!bodies.can_move(a.body) && !bodies.can_move(b.body))
    refuse(pointer, who + " ties " + ending(a) + " to " + ending(b) + ": neither can move",
           "Name a movable body at one end.");
}

void check_links(const Scene& scene, const Refuse& refuse) {
  std::map<std::string, std::string> names;
  for (const Words* words : all_words())
    for (const Link& link : words->links(scene)) {
      const auto [at, is_new] = names.emplace(link.name, link.pointer);
      if (!is_new)
        refuse(link.pointer, "the name '" + link.name + "' is taken by " + at->second,
               "Give every spring, rod and joint a name of its own.");
    }
}

}  // namespace tumble::scene
