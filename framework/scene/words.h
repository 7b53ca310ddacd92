/// The part of an effect in scene files: its key, the schema of its entries, reading and checking
/// them, and their description for `tumble explain`.
///
/// The folders under framework/effects implement this (framework/effects/effect.h); the code that
/// reads scenes calls all of them and names none.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "framework/scene/entry.h"
#include "framework/scene/names.h"
#include "framework/scene/scene.h"

namespace tumble::scene {

/// An entry that calls for an effect.
struct Asker {
  std::string pointer;  // JSON pointer of the entry; empty for a scene made in memory
  std::string what;     // in words, such as "rod 1: ball_1 to the world, 0.5 m"
  int line = 0;         // line of the entry in the scene's file; 0 for a scene made in memory
};

/// Whether bodies are attached at a position: such positions move with the local origin of a scene
/// (local_origin.h).
enum class PlaceKind { kHolds, kOther };
/// Called with a position in world coordinates; may change it. [m]
using VisitPlace = std::function<void(Vector3d& place_world, PlaceKind kind)>;

/// Properties of an effect.
struct Traits {
  bool leaves_flight = false;  // with it alone bodies have closed forms: a parabola, free rotation
  bool ties = false;           // the bodies of an entry move together, as one system of equations
  // constrains bodies by equations, from which they drift: the scene defines the correction
  // (StabilisationSpec)
  bool constrains = false;
  // sampled control: decides at intervals and holds its output between them
  bool looks = false;
  bool stores_energy = false;  // stores energy and returns it, without a fall of any body
  bool may_be_stiff = false;   // a method for stiff equations may be faster
};

/// A kind of check on the links of an effect.
struct LinkCheck {
  std::string kind;  // "rod_length"
  std::string unit;  // "m"
};

/// A connection of two points with a name: a spring, a rod, a joint.
struct Link {
  std::string name;
  AnchorSpec a, b;
  double length_m;      // its constant length or rest length; NaN without one
  std::string pointer;  // of its entry
};

class Words {
 public:
  virtual ~Words() = default;

  virtual std::string name() const = 0;  // "spring", "point force"
  // of a scene file: "springs", "point_forces"
  virtual std::string key() const = 0;
  // the part of a run with its code: "integration", "forces", "constraints", "control"
  virtual std::string stage() const = 0;
  // the counter of its calls in a run: "spring_calls"
  virtual std::string counter() const = 0;
  virtual Traits traits() const = 0;
  /// A JSON object: {"properties": {KEY: schema of its value}, "definitions": {...}}, in the
  /// language of scene.schema.json and with its definitions.
  virtual std::string schema() const = 0;

  /// Adds an entry to the scene: each entry of a list, or the single value of the key. Bodies and
  /// chains exist already.
  /// @throws UserError for an impossible entry
  virtual void read(Entry& entry, Scene& scene) const = 0;
  /// Refuses entries that a schema cannot refuse: impossible ones, or ones without an effect.
  virtual void check(const Scene&, const Refuse&) const {}

  /// The entries that call for the effect, in the file's order; none: the effect is off.
  virtual std::vector<Asker> askers(const Scene& scene) const = 0;
  virtual bool is_asked(const Scene& scene) const = 0;
  /// A note on the entries, or "".
  virtual std::string note(const Scene&) const { return ""; }
  /// Removes its entries from the scene.
  virtual void clear(Scene& scene) const = 0;

  /// Its entries, where they are links. No two links of a scene have the same name.
  virtual std::vector<Link> links(const Scene&) const { return {}; }
  /// Kinds of checks on them.
  virtual std::vector<LinkCheck> link_checks() const { return {}; }
  /// Bodies that never collide because of it, by name.
  virtual std::vector<std::pair<std::string, std::string>> pairs_apart(const Scene&) const {
    return {};
  }
  /// Every position in world coordinates of its entries.
  virtual void visit_places(TypedLists&, const VisitPlace&) const {}
};

/// Of all effects in the program, in the order of listings. Defined in
/// framework/effects/registry.h, which lists them.
const std::vector<const Words*>& all_words();

/// Whether the scene calls for an effect with a property. @param holds  is called with Traits
template <class Holds>
bool asks_for(const Scene& scene, const Holds& holds) {
  for (const Words* words : all_words())
    if (holds(words->traits()) && words->is_asked(scene)) return true;
  return false;
}
/// Whether the scene has rods, joints, or other effects that constrain bodies by equations.
inline bool is_constrained(const Scene& scene) {
  return asks_for(scene, [](const Traits& traits) { return traits.constrains; });
}

/// The effect of a key of a scene file; nullptr where the program has none with that key.
const Words* words_of(const std::string& key);

}  // namespace tumble::scene
