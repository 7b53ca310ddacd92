#include "framework/effects/gravity/gravity.h"

#include <fmt/format.h>

#include "framework/effects/effect.h"

namespace tumble::effects {

extern const char* const kGravitySchema;  // schema.json

namespace {

class ActingGravity final : public SteadyForces {
 public:
  explicit ActingGravity(const Acting& acting) : world_(acting.world), calls_(acting.calls) {}

  void add(int body, const RigidBodyState&, Wrench& sum) override {
    ++calls_;
    sum.force_world +=
        world_.bodies[static_cast<std::size_t>(body)].inertia.mass * *world_.gravity_world;
  }
  void add_acceleration(int, Vector3d& sum_world) const override {
    sum_world += *world_.gravity_world;
  }
  double work(int body, const RigidBodyState& from, const RigidBodyState& to) const override {
    return world_.bodies[static_cast<std::size_t>(body)].inertia.mass *
           world_.gravity_world->dot(to.com_world - from.com_world);
  }

 private:
  const World& world_;
  std::uint64_t& calls_;
};

class GravityEffect final : public Effect {
 public:
  std::string name() const override { return "gravity"; }
  std::string key() const override { return "gravity_m_s2"; }
  std::string stage() const override { return "integration"; }
  std::string counter() const override { return "gravity_calls"; }
  std::string schema() const override { return kGravitySchema; }
  Traits traits() const override { return {.leaves_flight = true}; }

  void read(scene::Entry& entry, scene::Scene& scene) const override {
    scene.effects.of<GravitySpec>() = {{entry.vector(), entry.pointer()}};
  }
  void clear(scene::Scene& scene) const override { scene.effects.of<GravitySpec>().clear(); }
  bool is_kept_in(const TypedLists& lists) const override {
    return !lists.of<GravitySpec>().empty();
  }
  std::vector<scene::Asker> askers(const scene::Scene& scene) const override {
    const auto g = gravity_of(scene);
    if (!g) return {};
    return {{"/gravity_m_s2", fmt::format("({:g}, {:g}, {:g}) m/s^2", g->x(), g->y(), g->z())}};
  }
  std::string note(const scene::Scene& scene) const override {
    const auto g = gravity_of(scene);
    return g && g->isZero(0.0) ? "/gravity_m_s2 is zero, and is applied all the same: delete it"
                               : "";
  }

  void build(const scene::Scene& scene, const BodyIndex&, World& world) const override {
    world.gravity_world = gravity_of(scene);
  }
  int count_in(const World& world) const override { return world.gravity_world ? 1 : 0; }
  std::vector<int> bodies_of(const World&, int) const override { return {}; }  // all of them
  // a part of a world lies in the same field
  void copy_entries(const World&, const std::vector<int>&, const std::function<int(int)>&,
                    World&) const override {}

  std::unique_ptr<SteadyForces> steady_forces(const Acting& acting) const override {
    return acting.world.gravity_world ? std::make_unique<ActingGravity>(acting) : nullptr;
  }

  void add_potential_energy(const World& world, const std::vector<RigidBodyState>& states,
                            EnergySum& sum) const override {
    if (!world.gravity_world) return;
    for (std::size_t i = 0; i < world.bodies.size(); ++i)
      if (!world.bodies[i].immovable())
        sum.add(static_cast<int>(i),
                -(world.bodies[i].inertia.mass * world.gravity_world->dot(states[i].com_world)));
  }
  Takes takes(const World&, int) const override { return Takes::kNothing; }
  void add_energy_terms(const World& world, const std::vector<RigidBodyState>& states,
                        double& sum) const override {
    if (!world.gravity_world) return;
    for (std::size_t i = 0; i < world.bodies.size(); ++i)
      if (!world.bodies[i].immovable())
        sum += world.bodies[i].inertia.mass *
               world.gravity_world->cwiseAbs().dot(states[i].com_world.cwiseAbs());
  }
};

}  // namespace

const Effect& gravity_effect() {
  static const GravityEffect effect;
  return effect;
}

}  // namespace tumble::effects
