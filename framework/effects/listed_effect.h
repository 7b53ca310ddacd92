/// An effect whose entries stand in lists: Spec is what a scene says of one, Held what a world
/// holds of one. Most of what an effect has to answer follows from the two lists; what is left is
/// its own.
#pragma once

#include "framework/effects/effect.h"

namespace tumble::effects {

/// @tparam Spec  has a member `pointer`, the JSON pointer of its entry
template <class Spec, class Held>
class ListedEffect : public Effect {
 public:
  /// An entry, in words: "a: 0.1 N s/m".
  virtual std::string describe(const Spec& spec) const = 0;
  /// The bodies that an entry names; -1 is the world.
  virtual std::vector<int> ends_of(const Held& entry) const = 0;
  /// Names others instead. @param other  by body
  virtual void rename_ends(Held& entry, const std::function<int(int body)>& other) const = 0;

  std::vector<scene::Asker> askers(const scene::Scene& scene) const override {
    std::vector<scene::Asker> askers;
    for (const Spec& spec : specs(scene)) askers.push_back({spec.pointer, describe(spec)});
    return askers;
  }
  bool is_kept_in(const TypedLists& lists) const override { return !lists.of<Spec>().empty(); }
  void clear(scene::Scene& scene) const override { scene.effects.of<Spec>().clear(); }

  int count_in(const World& world) const override { return static_cast<int>(held(world).size()); }
  std::vector<int> bodies_of(const World& world, int entry) const override {
    return ends_of(held(world)[static_cast<std::size_t>(entry)]);
  }
  void copy_entries(const World& whole, const std::vector<int>& entries,
                    const std::function<int(int)>& in_part, World& part) const override {
    for (const int k : entries) {
      Held entry = held(whole)[static_cast<std::size_t>(k)];
      rename_ends(entry, in_part);
      part.effects.of<Held>().push_back(std::move(entry));
    }
  }

 protected:
  static const std::vector<Spec>& specs(const scene::Scene& scene) {
    return scene.effects.of<Spec>();
  }
  static const std::vector<Held>& held(const World& world) { return world.effects.of<Held>(); }
};

}  // namespace tumble::effects
