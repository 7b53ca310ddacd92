#include "framework/effects/drag/drag.h"

#include <fmt/format.h>

#include "framework/effects/listed_effect.h"

namespace tumble::effects {

extern const char* const kDragSchema;  // schema.json

namespace {

class DragTerms final : public GroupTerms {
 public:
  DragTerms(const Acting& acting, const std::vector<int>& entries, GroupPlaces& places)
      : calls_(acting.calls) {
    for (const int entry : entries) {
      const Drag& drag = acting.world.effects.of<Drag>()[static_cast<std::size_t>(entry)];
      drags_.push_back({places.place_of(drag.body), drag.linear, drag.angular});
    }
  }

  void add_forces(const std::vector<Body>& bodies, std::vector<Wrench>& wrenches) override {
    for (const Drag& drag : drags_) {
      ++calls_;
      const auto place = static_cast<std::size_t>(drag.body);
      wrenches[place].force_world -= drag.linear * bodies[place].velocity_world;
      wrenches[place].torque_world -= drag.angular * bodies[place].omega_world;
    }
  }

 private:
  std::uint64_t& calls_;
  std::vector<Drag> drags_;  // of the group; `body` is the place in it
};

class DragEffect final : public ListedEffect<DragSpec, Drag> {
 public:
  std::string name() const override { return "drag"; }
  std::string key() const override { return "drag"; }
  std::string stage() const override { return "forces"; }
  std::string counter() const override { return "drag_calls"; }
  std::string schema() const override { return kDragSchema; }
  Traits traits() const override { return {.ties = true}; }

  void read(scene::Entry& entry, scene::Scene& scene) const override {
    DragSpec spec;
    spec.pointer = entry.pointer();
    spec.body = entry.body("body");
    entry.read("linear_n_s_m", spec.linear_n_s_m);
    entry.read("angular_n_m_s", spec.angular_n_m_s);
    scene.effects.of<DragSpec>().push_back(spec);
  }
  void check(const scene::Scene& scene, const scene::Refuse& refuse) const override {
    const scene::BodiesByName bodies(scene);
    for (const DragSpec& drag : specs(scene)) {
      if (!bodies.can_move(drag.body))
        refuse(drag.pointer + "/body", "body '" + drag.body + "' is immovable: nothing slows it",
               "Name a movable body.");
      if (drag.linear_n_s_m == 0.0 && drag.angular_n_m_s == 0.0)
        refuse(drag.pointer,
               "the drag has neither linear_n_s_m nor angular_n_m_s: it would do nothing",
               "Give one of the two.");
    }
  }
  std::string describe(const DragSpec& spec) const override {
    return fmt::format("{}: {:g} N s/m, {:g} N m s", spec.body, spec.linear_n_s_m,
                       spec.angular_n_m_s);
  }

  void build(const scene::Scene& scene, const BodyIndex& index, World& world) const override {
    for (const DragSpec& spec : specs(scene))
      world.effects.of<Drag>().push_back(
          {index.of(spec.body, "drag"), spec.linear_n_s_m, spec.angular_n_m_s});
  }
  std::vector<int> ends_of(const Drag& drag) const override { return {drag.body}; }
  void rename_ends(Drag& drag, const std::function<int(int)>& other) const override {
    drag.body = other(drag.body);
  }

  std::unique_ptr<GroupTerms> group_terms(const Acting& acting, const std::vector<int>& entries,
                                          GroupPlaces& places) const override {
    return std::make_unique<DragTerms>(acting, entries, places);
  }
  Takes takes(const World&, int) const override { return Takes::kPower; }
  double power_taken(const World& world, const std::vector<RigidBodyState>& states,
                     int entry) const override {
    const Drag& drag = held(world)[static_cast<std::size_t>(entry)];
    const Inertia& inertia = world.bodies[static_cast<std::size_t>(drag.body)].inertia;
    const RigidBodyState& state = states[static_cast<std::size_t>(drag.body)];
    return drag.linear * (inertia.inverse_mass * state.momentum_world).squaredNorm() +
           drag.angular * omega_of(state, inertia).squaredNorm();
  }
  void append_drains(const World& world, std::vector<Drain>& drains) const override {
    for (const Drag& drag : held(world))
      drains.push_back({drag.body, drag.linear, drag.angular,
                        fmt::format("the drag of body '{}'",
                                    world.bodies[static_cast<std::size_t>(drag.body)].name),
                        "less drag"});
  }
};

}  // namespace

const Effect& drag_effect() {
  static const DragEffect effect;
  return effect;
}

}  // namespace tumble::effects
