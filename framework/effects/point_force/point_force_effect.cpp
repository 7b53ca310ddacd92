#include "framework/effects/point_force/point_force.h"

#include <algorithm>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/effects/listed_effect.h"
#include "framework/effects/point_force/acting_point_forces.h"

namespace tumble::effects {

extern const char* const kPointForceSchema;  // schema.json

namespace {

class PointForceEffect final : public ListedEffect<PointForceSpec, PointForce> {
 public:
  std::string name() const override { return "point force"; }
  std::string key() const override { return "point_forces"; }
  std::string stage() const override { return "integration"; }
  std::string counter() const override { return "point_force_calls"; }
  std::string schema() const override { return kPointForceSchema; }
  Traits traits() const override { return {}; }

  void read(scene::Entry& entry, scene::Scene& scene) const override {
    PointForceSpec spec;
    spec.pointer = entry.pointer();
    spec.body = entry.body("body");
    entry.read("force_n", spec.force_n);
    entry.read("point_m", spec.point_m);
    entry.read("start_s", spec.start_s);
    entry.read("duration_s", spec.duration_s);
    scene.effects.of<PointForceSpec>().push_back(spec);
  }
  void check(const scene::Scene& scene, const scene::Refuse& refuse) const override {
    const scene::BodiesByName bodies(scene);
    for (const PointForceSpec& force : specs(scene))
      if (!bodies.can_move(force.body))
        refuse(force.pointer + "/body", "body '" + force.body + "' is immovable: no force moves it",
               "Name a movable body.");
    for (const PointForceSpec& force : specs(scene))
      if (force.start_s >= scene.duration_s)
        refuse(force.pointer + "/start_s",
               fmt::format("is {:g}, and the scene ends at {:g} s: the force would never act",
                           force.start_s, scene.duration_s),
               "Begin it earlier, or give the scene a longer duration_s.");
  }
  std::string describe(const PointForceSpec& spec) const override {
    return fmt::format("{}: {:.4g} N from {:g} s for {:g} s", spec.body, spec.force_n.norm(),
                       spec.start_s, spec.duration_s);
  }
  void visit_places(TypedLists& effects, const scene::VisitPlace& visit) const override {
    for (PointForceSpec& force : effects.of<PointForceSpec>())
      visit(force.point_m, scene::PlaceKind::kOther);
  }

  void build(const scene::Scene& scene, const BodyIndex& index, World& world) const override {
    for (const PointForceSpec& spec : specs(scene)) {
      const std::string subject = "point force on '" + spec.body + "'";
      const int body = index.of(spec.body, subject);
      if (world.bodies[static_cast<std::size_t>(body)].immovable())
        throw UserError(subject, "the body is immovable", "push a movable body");
      world.effects.of<PointForce>().push_back(
          {body, spec.force_n, spec.point_m, spec.start_s, spec.start_s + spec.duration_s});
    }
  }
  std::vector<int> ends_of(const PointForce& force) const override { return {force.body}; }
  void rename_ends(PointForce& force, const std::function<int(int)>& other) const override {
    force.body = other(force.body);
  }

  std::unique_ptr<SteadyForces> steady_forces(const Acting& acting) const override {
    return count_in(acting.world) > 0 ? std::make_unique<ActingPointForces>(acting) : nullptr;
  }
  std::vector<NeededLaw> needed_laws(const scene::Scene&, const Laws& laws) const override {
    return {{static_cast<bool>(laws.wrench_of_point_force), "the force and torque of a point force",
             "a1"}};
  }
  std::vector<Switch> switches(const World& world) const override {
    std::vector<Switch> switches;
    for (std::size_t k = 0; k < held(world).size(); ++k) {
      const PointForce& force = held(world)[k];
      if (!(force.start < force.end)) continue;
      switches.push_back(switch_of(force, static_cast<int>(k), true, force.start));
      switches.push_back(switch_of(force, static_cast<int>(k), false, force.end));
    }
    return switches;
  }
  bool pushes(const World& world, int body, double from) const override {
    return std::any_of(held(world).begin(), held(world).end(), [&](const PointForce& force) {
      return force.body == body && from < force.end;
    });
  }
  std::unique_ptr<WorkMeter> work_meter(const World& world) const override {
    return count_in(world) > 0 ? std::make_unique<PointForceMeter>(world) : nullptr;
  }
  Takes takes(const World&, int) const override { return Takes::kNothing; }

  void draw(const scene::Scene& scene, Drawables& drawables) const override {
    for (const PointForceSpec& spec : specs(scene))
      drawables.arrows.push_back(
          {spec.body, spec.force_n, spec.point_m, spec.start_s, spec.duration_s});
  }
};

}  // namespace

const Effect& point_force_effect() {
  static const PointForceEffect effect;
  return effect;
}

}  // namespace tumble::effects
