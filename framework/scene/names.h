/// Names that resolve, and the refusal of one that does not.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "framework/scene/scene.h"

namespace tumble::scene {

/// Called with a position (a key of the body, or a JSON pointer of the scene), the problem, and the
/// remedy. Must throw.
using Refuse = std::function<void(const std::string& place, const std::string& problem,
                                  const std::string& remedy)>;

/// The known names of one kind of entry.
class Names {
 public:
  /// @param what, plural  for errors: "body", "Bodies"
  Names(std::string what, std::string plural, std::vector<std::string> names)
      : what_(std::move(what)), plural_(std::move(plural)), names_(std::move(names)) {}

  /// Refuses an unknown name, with the nearest known one.
  void expect(const std::string& name, const std::string& pointer, const Refuse& refuse) const;

 private:
  std::string what_, plural_;
  std::vector<std::string> names_;
};
Names names_of_bodies(const Scene& scene);

/// The bodies of a scene, which must outlive it.
class BodiesByName {
 public:
  explicit BodiesByName(const Scene& scene) {
    for (const BodySpec& body : scene.bodies) bodies_.emplace(body.name, &body);
  }
  /// nullptr where no body has that name, and for the world, whose name is empty.
  const BodySpec* find(const std::string& name) const {
    const auto found = bodies_.find(name);
    return found == bodies_.end() ? nullptr : found->second;
  }
  bool can_move(const std::string& name) const {
    const BodySpec* body = find(name);
    return body != nullptr && !body->immovable;
  }

 private:
  std::map<std::string, const BodySpec*> bodies_;
};

}  // namespace tumble::scene
