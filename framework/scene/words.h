/// What a scene file may say of an effect: its key, the schema of what stands there, reading and checking it, and what `tumble explain` tells of it.
///
/// The folders under framework/effects implement this (framework/effects/effect.h); whoever reads a scene asks them all, and knows none.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "framework/scene/entry.h"
#include "framework/scene/names.h"
#include "framework/scene/scene.h"

namespace tumble::scene {

/// Who asked for an effect.
struct Asker {
  std::string pointer;        // JSON pointer of the entry; empty where the scene was made in memory
  std::string what;           // in words, such as "rod 1: ball_1 to the world, 0.5 m"
  int line = 0;               // of the scene's file, where the entry begins; 0 where the scene was made in memory
};

/// Whether a place is one that bodies are held at: such places are part of where a scene stands (local_origin.h).
enum class PlaceKind { kHolds, kOther };
/// Called with a place in the world's coordinates; may change it. [m]
using VisitPlace = std::function<void(Vector3d& place_world, PlaceKind kind)>;

/// What kind of thing an effect is.
struct Traits {
  bool leaves_flight = false;  // where it alone acts, bodies go in closed form: a parabola, free rotation
  bool ties = false;           // the bodies that an entry names move together, as one system of equations
  bool constrains = false;     // holds bodies by equations, from which they drift: the scene says how they are brought back (StabilisationSpec)
  bool looks = false;          // decides once in a while, and holds that until it looks again
  bool stores_energy = false;  // gives back what it has taken, without anything falling
  bool may_be_stiff = false;   // a method for stiff equations may pay
};

/// A kind of check about the links of an effect.
struct LinkCheck {
  std::string kind;            // "rod_length"
  std::string unit;            // "m"
};

/// Something between two points that has a name of its own: a spring, a rod, a joint.
struct Link {
  std::string name;
  AnchorSpec a, b;
  double length_m;            // that it keeps, or has at rest; NaN where it has none
  std::string pointer;        // of its entry
};

class Words {
 public:
  virtual ~Words() = default;

  virtual std::string name() const = 0;                  // "spring", "point force"
  virtual std::string key() const = 0;                   // of a scene file: "springs", "point_forces"
  virtual std::string stage() const = 0;                 // the part of a run that its code stands in: "integration", "forces", "constraints", "control"
  virtual std::string counter() const = 0;               // the count of a run that tells how often it was asked: "spring_calls"
  virtual Traits traits() const = 0;
  /// A JSON object: {"properties": {KEY: what stands there}, "definitions": {...}}, in the language of scene.schema.json and with its definitions.
  virtual std::string schema() const = 0;

  /// Adds an entry to the scene: each of a list, or the one thing that stands under the key. Bodies and chains are there.
  /// @throws UserError at what cannot be
  virtual void read(Entry& entry, Scene& scene) const = 0;
  /// Refuses what a schema cannot: what is impossible, or would do nothing.
  virtual void check(const Scene&, const Refuse&) const {}

  /// The entries that ask for the effect, in the file's order; none: the effect is off.
  virtual std::vector<Asker> askers(const Scene& scene) const = 0;
  virtual bool is_asked(const Scene& scene) const = 0;
  /// Something to tell of what the file says, or "".
  virtual std::string note(const Scene&) const { return ""; }
  /// Takes its entries out of the scene.
  virtual void clear(Scene& scene) const = 0;

  /// Its entries, where they are links. No two links of a scene have the same name.
  virtual std::vector<Link> links(const Scene&) const { return {}; }
  /// Checks of a scene that are about them.
  virtual std::vector<LinkCheck> link_checks() const { return {}; }
  /// Bodies that never collide because of it, by name.
  virtual std::vector<std::pair<std::string, std::string>> pairs_apart(const Scene&) const { return {}; }
  /// Every place in the world that its entries name.
  virtual void visit_places(TypedLists&, const VisitPlace&) const {}
};

/// Of all effects that the program is built with, in the order in which they are listed. Said by framework/effects/registry.h, which knows them.
const std::vector<const Words*>& all_words();

/// Whether the scene asks for an effect of which this holds. @param holds  is asked with Traits
template <class Holds>
bool asks_for(const Scene& scene, const Holds& holds) {
  for (const Words* words : all_words())
    if (holds(words->traits()) && words->is_asked(scene)) return true;
  return false;
}
/// Whether the scene has rods, joints, or what else holds bodies by equations.
inline bool is_constrained(const Scene& scene) {
  return asks_for(scene, [](const Traits& traits) { return traits.constrains; });
}

/// The effect that a key of a scene file belongs to; nullptr where the program is built with none of that key.
const Words* words_of(const std::string& key);

}  // namespace tumble::scene
