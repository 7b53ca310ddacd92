/// Bodies of a world by the names that its scene gives them.
#pragma once

#include <map>
#include <string>

#include "framework/dynamics/world.h"

namespace tumble::effects {

class BodyIndex {
 public:
  explicit BodyIndex(const World& world);

  /// @param subject  for the error: "spring 'a'"
  /// @throws UserError where no body has that name
  int of(const std::string& name, const std::string& subject) const;
  /// An anchor of the scene; with an empty name a point of the world.
  Anchor anchor(const scene::AnchorSpec& spec, const std::string& subject) const;

 private:
  std::map<std::string, int> index_;
};

/// @throws UserError where neither of two bodies can move (-1: the world)
void refuse_immovable(int a, int b, const World& world, const std::string& subject);

}  // namespace tumble::effects
