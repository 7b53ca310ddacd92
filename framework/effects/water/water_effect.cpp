#include "framework/effects/water/water.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "framework/core/decompositions.h"
#include "framework/core/error.h"
#include "framework/effects/listed_effect.h"

namespace tumble::effects {

extern const char* const kWaterSchema;  // schema.json

namespace {

const Vector3d kSheetColor(0.10, 0.36, 0.52);
// of gravity: across the vertical, which decimals may leave
constexpr double kSinePerTurn = 1e-12;
// of a body's height, in a step through the level: RK4 then leaves up to 1.5e-4 of the depth and
// the height (Water.WhatEntersItFastIsBrakedByWhatIsUnder, 200 by lot; with a half 1.5e-3)
constexpr double kPartPassed = 0.125;

/// What is under the level, in the body's frame, and the level's normal there.
struct Immersion {
  Matrix3d R;  // world from body
  Vector3d up_body;
  double depth;  // of the body's centre [m]
  Submerged under;
};

Immersion immersion_of(const Floating& floating, const Vector3d& com_world,
                       const Quaterniond& world_from_body) {
  Immersion now;
  now.R = world_from_body.normalized().toRotationMatrix();
  now.up_body = now.R.transpose() * Vector3d::UnitZ();
  now.depth = floating.water.surface_m.z() - com_world.z();
  now.under = floating.solid.under(now.up_body, now.depth);
  return now;
}

/// tr(S) w - S w: what a turning solid's points have of angular momentum, for density 1.
Vector3d turning(const Matrix3d& second, const Vector3d& omega) {
  return second.trace() * omega - second * omega;
}

Wrench wrench_on(const Floating& floating, const Body& body, const Immersion& now) {
  const WaterSpec& water = floating.water;
  const auto& [volume, first, second] = now.under;
  const Vector3d up = now.up_body,
                 past = now.R.transpose() * (body.velocity_world - water.stream_m_s),
                 omega = now.R.transpose() * body.omega_world;
  const double g = floating.gravity, k = water.drag_1_s;
  const Vector3d force =
      water.density_kg_m3 * (volume * g * up - k * (volume * past + omega.cross(first)));
  const Vector3d torque = water.density_kg_m3 *
                          (first.cross(g * up) - k * (first.cross(past) + turning(second, omega)));
  return {now.R * force, now.R * torque};
}

double energy_of(const Floating& floating, const RigidBodyState& state) {
  const Immersion now = immersion_of(floating, state.com_world, state.world_from_body);
  return floating.water.density_kg_m3 * floating.gravity *
         (now.under.volume * now.depth - now.up_body.dot(now.under.first));
}

class WaterTerms final : public GroupTerms {
 public:
  WaterTerms(const Acting& acting, const std::vector<int>& entries, GroupPlaces& places)
      : calls_(acting.calls) {
    for (const int entry : entries) {
      const Floating& floating =
          acting.world.effects.of<Floating>()[static_cast<std::size_t>(entry)];
      floating_.push_back({places.place_of(floating.body), &floating});
    }
  }

  void add_forces(const std::vector<Body>& bodies, std::vector<Wrench>& wrenches) override {
    for (const auto& [place, floating] : floating_) {
      const Body& body = bodies[static_cast<std::size_t>(place)];
      const Immersion now = immersion_of(*floating, body.com_world, body.world_from_body);
      if (!(now.under.volume > 0.0)) continue;  // in the air
      ++calls_;
      const Wrench wrench = wrench_on(*floating, body, now);
      wrenches[static_cast<std::size_t>(place)].force_world += wrench.force_world;
      wrenches[static_cast<std::size_t>(place)].torque_world += wrench.torque_world;
    }
  }

 private:
  std::uint64_t& calls_;
  std::vector<std::pair<int, const Floating*>> floating_;  // by place in the group
};

/// A stream does at most  rho k V |u|^2 / 4  of work a second: the force -k (v - u) gives most
/// where v = u / 2.
class StreamMeter final : public WorkMeter {
 public:
  explicit StreamMeter(const World& world) {
    for (const Floating& floating : world.effects.of<Floating>())
      most_.emplace_back(floating.body, 0.25 * floating.water.density_kg_m3 *
                                            floating.water.drag_1_s *
                                            floating.solid.whole().volume *
                                            floating.water.stream_m_s.squaredNorm());
  }
  void add_work(double time, const std::vector<RigidBodyState>&,
                std::vector<Work>& brought) override {
    const double passed = time - std::exchange(last_look_, time);
    for (const auto& [body, power] : most_)
      brought[static_cast<std::size_t>(body)].most += power * passed;
  }

 private:
  std::vector<std::pair<int, double>> most_;  // bodies, and at most for each [W]
  double last_look_ = 0.0;                    // [s]
};

class WaterEffect final : public ListedEffect<WaterSpec, Floating> {
 public:
  std::string name() const override { return "water"; }
  std::string key() const override { return "water"; }
  std::string stage() const override { return "forces"; }
  std::string counter() const override { return "water_calls"; }
  std::string schema() const override { return kWaterSchema; }
  Traits traits() const override { return {.ties = true}; }

  void read(scene::Entry& entry, scene::Scene& scene) const override {
    WaterSpec spec;
    spec.pointer = entry.pointer();
    entry.read("level_m", spec.surface_m.z());
    entry.read("density_kg_m3", spec.density_kg_m3);
    entry.read("drag_1_s", spec.drag_1_s);
    entry.read("stream_m_s", spec.stream_m_s);
    scene.effects.of<WaterSpec>() = {spec};
  }
  void check(const scene::Scene& scene, const scene::Refuse& refuse) const override {
    for (const WaterSpec& water : specs(scene)) {
      if (!water.stream_m_s.isZero(0.0) && water.drag_1_s == 0.0)
        refuse(water.pointer + "/stream_m_s",
               "the water streams, but has no drag to carry anything by", "Add drag_1_s.");
      if (water.stream_m_s.z() != 0.0)
        refuse(water.pointer + "/stream_m_s", "the water streams through its own level",
               "Give a stream along it: z must be 0.");
    }
  }
  std::string describe(const WaterSpec& spec) const override {
    std::string text = fmt::format("up to z = {:g} m, {:g} kg/m^3, drag {:g} 1/s",
                                   spec.surface_m.z(), spec.density_kg_m3, spec.drag_1_s);
    if (!spec.stream_m_s.isZero(0.0))
      text += fmt::format(", streams at ({:g}, {:g}, {:g}) m/s", spec.stream_m_s.x(),
                          spec.stream_m_s.y(), spec.stream_m_s.z());
    return text;
  }
  void visit_places(TypedLists& effects, const scene::VisitPlace& visit) const override {
    for (WaterSpec& water : effects.of<WaterSpec>())
      visit(water.surface_m, scene::PlaceKind::kOther);
  }

  void build(const scene::Scene& scene, const BodyIndex&, World& world) const override {
    for (const WaterSpec& spec : specs(scene)) {
      // stands above water in the list of effects
      const Vector3d gravity = world.gravity_world.value_or(Vector3d::Zero());
      if (!(gravity.z() < 0.0) || gravity.head<2>().norm() > kSinePerTurn * gravity.norm())
        throw UserError(
            scene::place_of(scene, spec.pointer),
            "water lies level across gravity, and gravity is not straight down",
            "give gravity along -z, such as \"gravity_m_s2\": [0, 0, -9.81], or leave water out");
      for (std::size_t i = 0; i < world.bodies.size(); ++i)
        if (!world.bodies[i].immovable())
          world.effects.of<Floating>().push_back(
              {static_cast<int>(i), spec, gravity.norm(), Floatable(world.bodies[i].shape)});
    }
  }
  std::vector<int> ends_of(const Floating& floating) const override { return {floating.body}; }
  void rename_ends(Floating& floating, const std::function<int(int)>& other) const override {
    floating.body = other(floating.body);
  }

  std::unique_ptr<GroupTerms> group_terms(const Acting& acting, const std::vector<int>& entries,
                                          GroupPlaces& places) const override {
    return std::make_unique<WaterTerms>(acting, entries, places);
  }

  void add_potential_energy(const World& world, const std::vector<RigidBodyState>& states,
                            EnergySum& sum) const override {
    for (const Floating& floating : held(world))
      sum.add(floating.body, energy_of(floating, states[static_cast<std::size_t>(floating.body)]));
  }
  void add_energy_terms(const World& world, const std::vector<RigidBodyState>& states,
                        double& sum) const override {
    for (const Floating& floating : held(world)) {
      const double z = states[static_cast<std::size_t>(floating.body)].com_world.z(),
                   reach = std::abs(floating.water.surface_m.z()) + std::abs(z) +
                           floating.solid.radius();
      sum +=
          floating.water.density_kg_m3 * floating.gravity * floating.solid.whole().volume * reach;
    }
  }
  std::unique_ptr<WorkMeter> work_meter(const World& world) const override {
    const bool streams = std::any_of(
        held(world).begin(), held(world).end(),
        [](const Floating& floating) { return !floating.water.stream_m_s.isZero(0.0); });
    return streams ? std::make_unique<StreamMeter>(world) : nullptr;
  }
  Takes takes(const World& world, int entry) const override {
    return held(world)[static_cast<std::size_t>(entry)].water.drag_1_s == 0.0 ? Takes::kNothing
                                                                              : Takes::kPower;
  }
  // P = rho k integral over what is under of (v_p - u) . v_p; a stream may bring more in.
  double power_taken(const World& world, const std::vector<RigidBodyState>& states,
                     int entry) const override {
    const Floating& floating = held(world)[static_cast<std::size_t>(entry)];
    const Inertia& inertia = world.bodies[static_cast<std::size_t>(floating.body)].inertia;
    const RigidBodyState& state = states[static_cast<std::size_t>(floating.body)];
    const Immersion now = immersion_of(floating, state.com_world, state.world_from_body);
    const auto& [volume, first, second] = now.under;
    const Vector3d velocity_world = inertia.inverse_mass * state.momentum_world,
                   velocity = now.R.transpose() * velocity_world,
                   past = now.R.transpose() * (velocity_world - floating.water.stream_m_s),
                   omega = now.R.transpose() * omega_of(state, inertia);
    const double per_drag = velocity.dot(volume * past + omega.cross(first)) +
                            omega.dot(first.cross(past) + turning(second, omega));
    return std::max(0.0, floating.water.density_kg_m3 * floating.water.drag_1_s * per_drag);
  }

  void append_drains(const World& world, std::vector<Drain>& drains) const override {
    for (const Floating& floating : held(world)) {
      const double k = floating.water.density_kg_m3 * floating.water.drag_1_s;
      if (k == 0.0) continue;
      const Submerged& whole = floating.solid.whole();
      const double least =
          symmetric_eigen(Matrix3d(whole.second.trace() * Matrix3d::Identity() - whole.second))
              .values[0];
      drains.push_back({floating.body, k * whole.volume, k * least,
                        fmt::format("the water's drag on body '{}'",
                                    world.bodies[static_cast<std::size_t>(floating.body)].name),
                        "less drag_1_s"});
    }
  }
  // Up and down: k = rho g A, A the area that the level cuts where the run starts; of a body that
  // starts clear of it, its mean over the body's shortest way through. Damped by the drag on what
  // is under the level then; of a body that starts clear, on half of it.
  void append_stiff_rows(const World& world, const std::vector<RigidBodyState>& start,
                         std::vector<StiffRow>& rows) const override {
    for (const Floating& floating : held(world)) {
      const RigidBodyState& state = start[static_cast<std::size_t>(floating.body)];
      Vector6d up = Vector6d::Zero();
      up[2] = 1.0;
      const double stiffness =
          floating.water.density_kg_m3 * floating.gravity * area_at_level(floating, state);
      const double under =
          immersion_of(floating, state.com_world, state.world_from_body).under.volume;
      const double damping = floating.water.density_kg_m3 * floating.water.drag_1_s *
                             (under > 0.0 ? under : 0.5 * floating.solid.whole().volume);
      rows.push_back(
          {floating.body, -1, up, Vector6d::Zero(), stiffness, damping,
           fmt::format("body '{}' in the water",
                       world.bodies[static_cast<std::size_t>(floating.body)].name),
           "a larger body",
           damping > 0.0 ? "give the water a larger drag_1_s" : "give the water drag_1_s"});
    }
  }
  // A body that passes the level within a step is felt at a stage or two of the method, or at none.
  // So the step ends where the body reaches the level, and while the level cuts it none passes more
  // than a part of its height.
  double longest_step(const World& world, const std::vector<RigidBodyState>& states,
                      double asked) const override {
    double longest = std::numeric_limits<double>::infinity();
    for (const Floating& floating : held(world)) {
      const auto body = static_cast<std::size_t>(floating.body);
      longest = std::min(longest, longest_step_of(floating, world.bodies[body].inertia.inverse_mass,
                                                  states[body], asked));
    }
    return longest;
  }
  void append_pulls(const World& world, const std::vector<RigidBodyState>& states,
                    const std::vector<double>&, const Laws&,
                    std::vector<Pull>& pulls) const override {
    for (const Floating& floating : held(world)) {
      const RigidBodyState& state = states[static_cast<std::size_t>(floating.body)];
      const Inertia& inertia = world.bodies[static_cast<std::size_t>(floating.body)].inertia;
      const Body body{inertia, state.com_world, state.world_from_body,
                      inertia.inverse_mass * state.momentum_world, omega_of(state, inertia)};
      pulls.push_back(
          {floating.body, -1,
           wrench_on(floating, body, immersion_of(floating, state.com_world, state.world_from_body))
               .force_world.norm(),
           "water (the framework's own)"});
    }
  }

  void draw(const scene::Scene& scene, Drawables& drawables) const override {
    for (const WaterSpec& water : specs(scene))
      drawables.sheets.push_back({water.surface_m.z(), kSheetColor});
  }

 private:
  static double longest_step_of(const Floating& floating, double inverse_mass,
                                const RigidBodyState& state, double asked) {
    constexpr double kAny = std::numeric_limits<double>::infinity();
    const double down = -inverse_mass * state.momentum_world.z(), speed = std::abs(down),
                 fallen = 0.5 * floating.gravity * asked * asked,
                 depth = floating.water.surface_m.z() - state.com_world.z();
    if (std::abs(depth) > floating.solid.radius() + speed * asked + fallen) return kAny;
    const auto [lowest, highest] = floating.solid.reach(
        state.world_from_body.normalized().conjugate() * Vector3d(Vector3d::UnitZ()));
    const double part = kPartPassed * (highest - lowest);
    if (speed * asked <= part) return kAny;
    const double over = lowest - depth, under = depth - highest;  // between it and the level
    const double way = std::max({over, under, 0.0});
    const bool parts = (over > 0.0 && down < 0.0) || (under > 0.0 && down > 0.0);
    if (parts || way > speed * asked + fallen) return kAny;
    return std::max(way, part) / (speed + 0.5 * floating.gravity * asked);
  }
  /// Of the box that has the solid's least second moment: exact for boxes, 1.55 R of a ball's 2 R.
  /// [m]
  static double least_width(const Submerged& whole) {
    const Matrix3d central = whole.second - whole.first * whole.first.transpose() / whole.volume;
    return std::sqrt(12.0 * symmetric_eigen(central).values[0] / whole.volume);
  }
  static double area_at_level(const Floating& floating, const RigidBodyState& state) {
    constexpr double kPart = 1e-4;  // of the radius: a difference quotient over this way
    const double way = kPart * floating.solid.radius();
    if (!(way > 0.0)) return 0.0;
    const Vector3d lower = state.com_world - way * Vector3d::UnitZ(),
                   upper = state.com_world + way * Vector3d::UnitZ();
    const double area = (immersion_of(floating, lower, state.world_from_body).under.volume -
                         immersion_of(floating, upper, state.world_from_body).under.volume) /
                        (2.0 * way);
    return area > 0.0 ? area : floating.solid.whole().volume / least_width(floating.solid.whole());
  }
};

}  // namespace

const Effect& water_effect() {
  static const WaterEffect effect;
  return effect;
}

}  // namespace tumble::effects
