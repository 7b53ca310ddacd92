#include "framework/effects/spring/spring.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/dynamics/anchors.h"
#include "framework/effects/linked_effect.h"

namespace tumble::effects {

extern const char* const kSpringSchema;  // schema.json

namespace {

class SpringTerms final : public GroupTerms {
 public:
  SpringTerms(const Acting& acting, const std::vector<int>& entries, GroupPlaces& places)
      : laws_(acting.laws),
        calls_(acting.calls),
        world_(acting.world),
        all_(acting.world.effects.of<SpringLink>()),
        springs_(placed_links(all_, entries, places)) {}

  void add_forces(const std::vector<Body>& bodies, std::vector<Wrench>& wrenches) override {
    for (const PlacedLink& link : springs_) {
      ++calls_;
      const AnchorState a = link.a.state_among(bodies), b = link.b.state_among(bodies);
      const SpringLink& spring = all_[static_cast<std::size_t>(link.entry)];
      const Vector3d force =
          naming_link("spring", spring.name, bodies[link.a.place], bodies[link.b.place],
                      [&] { return laws_.spring_force(spring.spring, a, b); });
      add_force(bodies[link.a.place], force, a.point_world, wrenches[link.a.place]);
      add_force(bodies[link.b.place], -force, b.point_world, wrenches[link.b.place]);
    }
  }
  // At rest; of a spring without a length at rest, where the world starts.
  double reach() const override {
    const auto start_of = [&](const Anchor& anchor) -> Vector3d {
      if (anchor.body < 0) return anchor.point_body;
      const RigidBodyState& start = world_.bodies[static_cast<std::size_t>(anchor.body)].state;
      return start.com_world + start.world_from_body * anchor.point_body;
    };
    double longest = 0.0;
    for (const PlacedLink& link : springs_) {
      const SpringLink& spring = all_[static_cast<std::size_t>(link.entry)];
      longest = std::max(longest, spring.spring.rest_length > 0.0
                                      ? spring.spring.rest_length
                                      : (start_of(spring.a) - start_of(spring.b)).norm());
    }
    return longest;
  }
  void measure(const std::vector<Body>& bodies, const VectorXd&,
               std::vector<double>& forces) override {
    for (const PlacedLink& link : springs_) {
      const AnchorState a = link.a.state_among(bodies), b = link.b.state_among(bodies);
      const Vector3d force = laws_.spring_force(all_[static_cast<std::size_t>(link.entry)].spring,
                                                a, b),
                     way = b.point_world - a.point_world;
      forces[static_cast<std::size_t>(link.entry)] =
          force.dot(way) < 0 ? -force.norm() : force.norm();
    }
  }

 private:
  const Laws& laws_;
  std::uint64_t& calls_;
  const World& world_;
  const std::vector<SpringLink>& all_;
  std::vector<PlacedLink> springs_;
};

class SpringEffect final : public LinkedEffect<SpringSpec, SpringLink> {
 public:
  std::string name() const override { return "spring"; }
  std::string key() const override { return "springs"; }
  std::string stage() const override { return "forces"; }
  std::string counter() const override { return "spring_calls"; }
  std::string schema() const override { return kSpringSchema; }
  Traits traits() const override {
    return {.ties = true, .stores_energy = true, .may_be_stiff = true};
  }

  void read(scene::Entry& entry, scene::Scene& scene) const override {
    SpringSpec spec;
    read_ends(entry, spec);
    entry.read("stiffness_n_m", spec.stiffness_n_m);
    entry.read("damping_n_s_m", spec.damping_n_s_m);
    spec.rest_length_m = distance_at_start(entry, spec);
    entry.read("rest_length_m", spec.rest_length_m);
    scene.effects.of<SpringSpec>().push_back(spec);
  }
  void check(const scene::Scene& scene, const scene::Refuse& refuse) const override {
    const scene::BodiesByName bodies(scene);
    for (const SpringSpec& spring : specs(scene))
      scene::check_ends("spring '" + spring.name + "'", spring.a, spring.b, spring.pointer, bodies,
                        refuse);
  }
  std::string describe(const SpringSpec& spec) const override {
    return fmt::format("{}: {}, {:g} N/m, {:g} N s/m, {:.4g} m at rest", spec.name, between(spec),
                       spec.stiffness_n_m, spec.damping_n_s_m, spec.rest_length_m);
  }
  double length_of(const SpringSpec& spec) const override { return spec.rest_length_m; }

  void build(const scene::Scene& scene, const BodyIndex& index, World& world) const override {
    for (const SpringSpec& spec : specs(scene)) {
      const auto [a, b] = anchors_of(spec, index, world);
      world.effects.of<SpringLink>().push_back(
          {spec.name, a, b, {spec.stiffness_n_m, spec.damping_n_s_m, spec.rest_length_m}});
    }
  }

  std::unique_ptr<GroupTerms> group_terms(const Acting& acting, const std::vector<int>& entries,
                                          GroupPlaces& places) const override {
    return std::make_unique<SpringTerms>(acting, entries, places);
  }
  std::vector<NeededLaw> needed_laws(const scene::Scene&, const Laws& laws) const override {
    return {{static_cast<bool>(laws.spring_force), "the force of a spring", "a3"}};
  }

  // E = k/2 (L - L0)^2
  void add_potential_energy(const World& world, const std::vector<RigidBodyState>& states,
                            EnergySum& sum) const override {
    for (const SpringLink& link : held(world)) {
      const double stretch = (anchor_point(link.b, states) - anchor_point(link.a, states)).norm() -
                             link.spring.rest_length;
      const bool is_of_a =
          link.a.body >= 0 && !world.bodies[static_cast<std::size_t>(link.a.body)].immovable();
      sum.add(is_of_a ? link.a.body : link.b.body, 0.5 * link.spring.stiffness * stretch * stretch);
    }
  }
  Takes takes(const World& world, int entry) const override {
    return held(world)[static_cast<std::size_t>(entry)].spring.damping == 0.0 ? Takes::kNothing
                                                                              : Takes::kPower;
  }
  // P = c L'^2
  double power_taken(const World& world, const std::vector<RigidBodyState>& states,
                     int entry) const override {
    const SpringLink& link = held(world)[static_cast<std::size_t>(entry)];
    const AnchorState a = anchor_state(link.a, world, states, 0.0),
                      b = anchor_state(link.b, world, states, 0.0);
    // a driven end is where its state says; at which speed is right at any time if it moves evenly
    const auto point = [&](const Anchor& anchor, const AnchorState& at) {
      const bool is_driven =
          anchor.body >= 0 && world.bodies[static_cast<std::size_t>(anchor.body)].immovable();
      return is_driven ? anchor_point(anchor, states) : at.point_world;
    };
    const Vector3d way = point(link.b, b) - point(link.a, a),
                   rate = b.velocity_world - a.velocity_world;
    const double along = way.isZero(0.0) ? rate.norm() : rate.dot(way.normalized());
    return link.spring.damping * along * along;
  }
  // Its length is rounded as places are, so that its stretch is off by that.
  void add_energy_terms(const World& world, const std::vector<RigidBodyState>& states,
                        double& sum) const override {
    for (const SpringLink& link : held(world)) {
      const Vector3d a = anchor_point(link.a, states), b = anchor_point(link.b, states);
      const double stretch = std::abs((a - b).norm() - link.spring.rest_length);
      sum += link.spring.stiffness * stretch * (stretch + a.norm() + b.norm());
    }
  }
  void append_stiff_rows(const World& world, const std::vector<RigidBodyState>& start,
                         std::vector<StiffRow>& rows) const override {
    for (const SpringLink& link : held(world)) {
      const auto [of_a, of_b] = distance_jacobians(link.a, link.b, start);
      rows.push_back({link.a.body, link.b.body, of_a, of_b, link.spring.stiffness,
                      link.spring.damping, "spring '" + link.name + "'",
                      "a softer spring or more damping", "damp the spring"});
    }
  }

  std::vector<double> Frame::*measured_as() const override { return &Frame::spring_forces; }
  void append_pulls(const World& world, const std::vector<RigidBodyState>&,
                    const std::vector<double>& measured, const Laws& laws,
                    std::vector<Pull>& pulls) const override {
    for (std::size_t k = 0; k < measured.size(); ++k) {
      const SpringLink& link = held(world)[k];
      pulls.push_back(
          {link.a.body, link.b.body, std::abs(measured[k]),
           fmt::format("spring '{}' (spring_force of {})", link.name, laws.constraint_source)});
    }
  }
  void draw(const scene::Scene& scene, Drawables& drawables) const override {
    for (const SpringSpec& spec : specs(scene))
      drawables.coils.push_back({spec.name,
                                 {spec.a.body, spec.a.point_m},
                                 {spec.b.body, spec.b.point_m},
                                 spec.rest_length_m});
  }
};

}  // namespace

const Effect& spring_effect() {
  static const SpringEffect effect;
  return effect;
}

}  // namespace tumble::effects
