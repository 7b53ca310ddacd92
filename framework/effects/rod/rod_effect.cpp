#include "framework/effects/rod/rod.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "framework/core/numbers.h"
#include "framework/dynamics/anchors.h"
#include "framework/effects/linked_effect.h"

namespace tumble::effects {

extern const char* const kRodSchema;  // schema.json

namespace {

// A rod's length is either measured at the start (equal to rounding) or typed: 1e-9 of it forgives
// the rounding of typed decimals and of the frames between, and is far below what any check of a
// rod asks for.
constexpr double kRodFit = 1e-9;

std::string digits(double value) {
  std::ostringstream text;
  text.precision(12);
  text << value;
  return text.str();
}

class RodTerms final : public GroupTerms {
 public:
  RodTerms(const Acting& acting, const std::vector<int>& entries, GroupPlaces& places)
      : row_(acting.laws.of<RodRow>()),
        calls_(acting.calls),
        all_(acting.world.effects.of<RodLink>()),
        rods_(placed_links(all_, entries, places)) {}

  std::size_t row_count() const override { return rods_.size(); }
  void append_rows(const std::vector<Body>& bodies, std::vector<Constraint>& rows) override {
    for (const PlacedLink& link : rods_) {
      ++calls_;
      const RodLink& rod = of(link);
      rows.push_back({link.a.place, link.b.place,
                      naming_link("rod", rod.name, bodies[link.a.place], bodies[link.b.place], [&] {
                        return row_(bodies[link.a.place], link.a.point_body, bodies[link.b.place],
                                    link.b.point_body, rod.length);
                      })});
    }
  }
  void append_joints(std::vector<TreeLink>& joints) const override {
    for (std::size_t k = 0; k < rods_.size(); ++k) {
      TreeLink& joint = joints.emplace_back();
      joint.kind = TreeJoint::kRod;
      joint.a = rods_[k].a.place;
      joint.b = rods_[k].b.place;
      joint.point_a_body = rods_[k].a.point_body;
      joint.point_b_body = rods_[k].b.point_body;
      joint.length = of(rods_[k]).length;
      joint.row = static_cast<int>(k);
      joint.row_count = 1;
    }
  }
  double size() const override {
    double longest = 0.0;
    for (const PlacedLink& link : rods_) longest = std::max(longest, of(link).length);
    return longest;
  }
  void note_open(const std::vector<Body>& bodies, const NoteOpen& note) const override {
    for (const PlacedLink& link : rods_)
      note(of(link).name,
           std::abs((link.a.point_among(bodies) - link.b.point_among(bodies)).norm() -
                    of(link).length) /
               of(link).length);
  }
  // A rod's multiplier pushes A along the growing length: away from B.
  void measure(const std::vector<Body>&, const VectorXd& multipliers,
               std::vector<double>& forces) override {
    Eigen::Index at = 0;
    for (const PlacedLink& link : rods_)
      forces[static_cast<std::size_t>(link.entry)] = -multipliers[at++];
  }

 private:
  const RodLink& of(const PlacedLink& link) const {
    return all_[static_cast<std::size_t>(link.entry)];
  }

  const LawFunction<RodRow>& row_;
  std::uint64_t& calls_;
  const std::vector<RodLink>& all_;
  std::vector<PlacedLink> rods_;
};

class RodEffect final : public LinkedEffect<RodSpec, RodLink> {
 public:
  std::string name() const override { return "rod"; }
  std::string key() const override { return "rods"; }
  std::string stage() const override { return "constraints"; }
  std::string counter() const override { return "rod_calls"; }
  std::string schema() const override { return kRodSchema; }
  Traits traits() const override { return {.ties = true, .constrains = true}; }

  void read(scene::Entry& entry, scene::Scene& scene) const override {
    RodSpec spec;
    read_ends(entry, spec);
    spec.length_m = distance_at_start(entry, spec);
    entry.read("length_m", spec.length_m);
    scene.effects.of<RodSpec>().push_back(spec);
  }
  void check(const scene::Scene& scene, const scene::Refuse& refuse) const override {
    const scene::BodiesByName bodies(scene);
    for (const RodSpec& rod : specs(scene)) {
      scene::check_ends("rod '" + rod.name + "'", rod.a, rod.b, rod.pointer, bodies, refuse);
      check_length(rod, bodies, refuse);
    }
  }
  std::string describe(const RodSpec& spec) const override {
    return fmt::format("{}: {}, {:.4g} m", spec.name, between(spec), spec.length_m);
  }
  double length_of(const RodSpec& spec) const override { return spec.length_m; }

  void build(const scene::Scene& scene, const BodyIndex& index, World& world) const override {
    for (const RodSpec& spec : specs(scene)) {
      const auto [a, b] = anchors_of(spec, index, world);
      world.effects.of<RodLink>().push_back({spec.name, a, b, spec.length_m});
    }
  }

  std::unique_ptr<GroupTerms> group_terms(const Acting& acting, const std::vector<int>& entries,
                                          GroupPlaces& places) const override {
    return std::make_unique<RodTerms>(acting, entries, places);
  }
  Takes takes(const World&, int) const override { return Takes::kNothing; }
  std::vector<NeededLaw> needed_laws(const scene::Scene& scene, const Laws& laws) const override {
    std::vector<NeededLaw> needed{needed_law<RodRow>(laws)};
    append_laws_of_rows(scene, laws, needed);
    return needed;
  }

  void append_held_rows(const World& world, const std::vector<RigidBodyState>& start,
                        std::vector<Constraint>& rows) const override {
    for (const RodLink& rod : held(world)) {
      const auto [of_a, of_b] = distance_jacobians(rod.a, rod.b, start);
      rows.push_back({rod.a.body, rod.b.body, {of_a, of_b, kUnset, kUnset, kUnset}});
    }
  }
  void append_carriers(const World& world, std::vector<Carrier>& carriers) const override {
    for (std::size_t k = 0; k < held(world).size(); ++k)
      carriers.push_back(
          {held(world)[k].a, held(world)[k].b, held(world)[k].length, false, static_cast<int>(k)});
  }

  std::vector<double> Frame::*measured_as() const override { return &Frame::rod_tensions; }
  void append_pulls(const World& world, const std::vector<RigidBodyState>&,
                    const std::vector<double>& measured, const Laws& laws,
                    std::vector<Pull>& pulls) const override {
    for (std::size_t k = 0; k < measured.size(); ++k) {
      const RodLink& rod = held(world)[k];
      const std::string rows =
          fmt::format("rod_row{}, constraint_multipliers, constraint_correction of {}",
                      laws.link_solver.empty() ? "" : " of " + laws.source_of<RodRow>(),
                      laws.source_of_links());
      pulls.push_back({rod.a.body, rod.b.body, std::abs(measured[k]),
                       fmt::format("rod '{}' ({})", rod.name, rows_in_words(world, rows))});
    }
  }
  std::vector<scene::LinkCheck> link_checks() const override { return {{"rod_length", "m"}}; }
  std::pair<double, std::string> error_of(const std::string&, const scene::Scene& scene,
                                          std::size_t entry, const PoseOf& pose_of) const override {
    const RodSpec& rod = specs(scene)[entry];
    const auto place = [&](const scene::AnchorSpec& anchor) -> Vector3d {
      const BodyPose* pose = pose_of(anchor.body);
      return pose == nullptr ? anchor.point_m
                             : Vector3d(pose->com_world + pose->world_from_body * anchor.point_m);
    };
    const double length = (place(rod.b) - place(rod.a)).norm();
    return {std::abs(length - rod.length_m), fmt::format("{} is {:.9g} m long", rod.name, length)};
  }
  void draw(const scene::Scene& scene, Drawables& drawables) const override {
    for (const RodSpec& spec : specs(scene))
      drawables.bars.push_back(
          {spec.name, {spec.a.body, spec.a.point_m}, {spec.b.body, spec.b.point_m}});
  }

 private:
  static void check_length(const RodSpec& rod, const scene::BodiesByName& bodies,
                           const scene::Refuse& refuse) {
    const auto place = [&](const scene::AnchorSpec& anchor) -> Vector3d {
      const scene::BodySpec* of = bodies.find(anchor.body);
      return of == nullptr ? anchor.point_m
                           : Vector3d(of->position_m + of->world_from_body * anchor.point_m);
    };
    const double found = (place(rod.b) - place(rod.a)).norm();
    if (rod.length_m == 0.0 || found == 0.0)
      refuse(rod.pointer,
             "rod '" + rod.name + "' has no length: " + scene::ending(rod.a) + " and " +
                 scene::ending(rod.b) + " are anchored at the same place",
             "Move one of them; for two bodies that share a point use a joint of kind \"ball\".");
    const double off = found - rod.length_m;
    // far from the origin coordinates have no more digits
    const double rounding =
        4 * kEpsilon *
        std::max(place(rod.a).cwiseAbs().maxCoeff(), place(rod.b).cwiseAbs().maxCoeff());
    if (std::abs(off) > kRodFit * rod.length_m + rounding)
      refuse(rod.pointer + "/length_m",
             "rod '" + rod.name + "' is " + digits(rod.length_m) + " m long, but its ends are " +
                 digits(found) + " m apart at the start: " + digits(std::abs(off)) + " m too " +
                 (off > 0 ? "far" : "near"),
             "Leave length_m out (it is then measured), or move a body.");
  }
};

}  // namespace

const Effect& rod_effect() {
  static const RodEffect effect;
  return effect;
}

}  // namespace tumble::effects
