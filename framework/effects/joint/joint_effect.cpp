#include "framework/effects/joint/joint.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/core/shortest_turn.h"
#include "framework/effects/joint/joint_rows.h"
#include "framework/effects/linked_effect.h"

namespace tumble::effects {

extern const char* const kJointSchema;  // schema.json

namespace {

class JointTerms final : public GroupTerms {
 public:
  JointTerms(const Acting& acting, const std::vector<int>& entries, GroupPlaces& places)
      : calls_(acting.calls),
        all_(acting.world.effects.of<JointLink>()),
        joints_(placed_links(all_, entries, places)) {
    for (const PlacedLink& link : joints_) {
      rows_ += static_cast<std::size_t>(effects::row_count(of(link).kind));
      sizes_.push_back(size_of(of(link), acting.world, places));
    }
  }

  std::size_t row_count() const override { return rows_; }
  void append_rows(const std::vector<Body>& bodies, std::vector<Constraint>& rows) override {
    for (const PlacedLink& link : joints_) {
      ++calls_;
      append_joint_rows(of(link), bodies[link.a.place], link.a.place, bodies[link.b.place],
                        link.b.place, rows);
    }
  }
  void append_joints(std::vector<TreeLink>& joints) const override {
    int row = 0;
    for (const PlacedLink& link : joints_) {
      TreeLink& joint = joints.emplace_back();
      const JointKind kind = of(link).kind;
      joint.kind = kind == JointKind::kBall    ? TreeJoint::kBall
                   : kind == JointKind::kHinge ? TreeJoint::kHinge
                                               : TreeJoint::kWeld;
      joint.a = link.a.place;
      joint.b = link.b.place;
      joint.point_a_body = link.a.point_body;
      joint.point_b_body = link.b.point_body;
      joint.a_from_joint = of(link).a_from_joint;
      joint.b_from_joint = of(link).b_from_joint;
      joint.row = row;
      joint.row_count = effects::row_count(kind);
      row += joint.row_count;
    }
  }
  void note_open(const std::vector<Body>& bodies, const NoteOpen& note) const override {
    for (std::size_t k = 0; k < joints_.size(); ++k) {
      const PlacedLink& link = joints_[k];
      const JointLink& joint = of(link);
      note(joint.name,
           (link.a.point_among(bodies) - link.b.point_among(bodies)).norm() / sizes_[k]);
      const Quaterniond a = bodies[link.a.place].world_from_body * joint.a_from_joint,
                        b = bodies[link.b.place].world_from_body * joint.b_from_joint;
      if (joint.kind == JointKind::kHinge)
        note(joint.name, (a * Vector3d::UnitZ()).cross(b * Vector3d::UnitZ()).norm());
      if (joint.kind == JointKind::kWeld) note(joint.name, 2.0 * (a.conjugate() * b).vec().norm());
    }
  }
  void measure(const std::vector<Body>&, const VectorXd& multipliers,
               std::vector<double>& forces) override {
    Eigen::Index at = 0;
    for (const PlacedLink& link : joints_) {
      forces[static_cast<std::size_t>(link.entry)] = multipliers.segment<3>(at).norm();
      at += effects::row_count(of(link).kind);
    }
  }

 private:
  const JointLink& of(const PlacedLink& link) const {
    return all_[static_cast<std::size_t>(link.entry)];
  }

  // The longer arm of the two bodies; of bodies that are held at their centres, how far their mass
  // lies from there. [m]
  static double size_of(const JointLink& joint, const World& world, const GroupPlaces& places) {
    double size = 0.0;
    for (const Anchor* end : {&joint.a, &joint.b}) {
      if (!places.has(end->body)) continue;
      const Inertia& inertia = world.bodies[static_cast<std::size_t>(end->body)].inertia;
      size = std::max({size, end->point_body.norm(),
                       std::sqrt(0.5 * inertia.inertia_body.trace() * inertia.inverse_mass)});
    }
    return size > 0.0 ? size : 1.0;
  }

  std::uint64_t& calls_;
  const std::vector<JointLink>& all_;
  std::vector<PlacedLink> joints_;
  std::vector<double> sizes_;  // by place in joints_ [m]
  std::size_t rows_ = 0;
};

/// How a body has turned since the start, and where a point of it is that was given in the world
/// then; of the world both stay.
struct Carried {
  const BodyPose* pose = nullptr;
  Vector3d com_at_start = Vector3d::Zero();
  Quaterniond turned = Quaterniond::Identity();

  Vector3d point(const Vector3d& point_at_start) const {
    return pose == nullptr ? point_at_start
                           : Vector3d(pose->com_world + turned * (point_at_start - com_at_start));
  }
};

/// Angle between two unit vectors or of a rotation; exact near 0, where acos is not.
double angle_between(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}
double angle_of(const Quaterniond& rotation) {
  return 2.0 * std::atan2(rotation.vec().norm(), std::abs(rotation.w()));
}

class JointEffect final : public ListedEffect<JointSpec, JointLink> {
 public:
  std::string name() const override { return "joint"; }
  std::string key() const override { return "joints"; }
  std::string stage() const override { return "constraints"; }
  std::string counter() const override { return "joint_calls"; }
  std::string schema() const override { return kJointSchema; }
  Traits traits() const override { return {.ties = true, .constrains = true}; }

  void read(scene::Entry& entry, scene::Scene& scene) const override {
    JointSpec spec;
    spec.pointer = entry.pointer();
    spec.name = "joint " + std::to_string(entry.number());
    entry.read("name", spec.name);
    std::string kind;
    entry.read("kind", kind);
    spec.kind = kind == "ball"    ? JointKind::kBall
                : kind == "hinge" ? JointKind::kHinge
                                  : JointKind::kWeld;
    spec.body_a = entry.body("body_a");
    if (entry.has("body_b")) spec.body_b = entry.body("body_b");
    entry.read("point_m", spec.point_m);
    const bool is_hinge = spec.kind == JointKind::kHinge;
    if (is_hinge && !entry.has("axis"))
      entry.refuse("", "a hinge needs the key 'axis': its direction in the world",
                   "Add it, such as \"axis\": [0, 1, 0].");
    if (!is_hinge && entry.has("axis"))
      entry.refuse("axis", "a joint of kind " + kind + " has no axis",
                   "Delete it, or make the joint a hinge.");
    if (is_hinge) {
      entry.read("axis", spec.axis);
      if (spec.axis.isZero(0.0))
        entry.refuse("axis", "found the zero vector, expected a direction");
      spec.axis.stableNormalize();
    }
    scene.effects.of<JointSpec>().push_back(spec);
  }
  void check(const scene::Scene& scene, const scene::Refuse& refuse) const override {
    const scene::BodiesByName bodies(scene);
    for (const JointSpec& joint : specs(scene)) {
      const std::string subject = "joint '" + joint.name + "'";
      if (joint.body_a == joint.body_b)
        refuse(joint.pointer, subject + " joins body '" + joint.body_a + "' to itself",
               "Name another body as body_b.");
      if (!bodies.can_move(joint.body_a) && !bodies.can_move(joint.body_b))
        refuse(joint.pointer,
               subject + " joins " +
                   (joint.body_b.empty() ? "'" + joint.body_a + "' to the world"
                                         : "'" + joint.body_a + "' and '" + joint.body_b + "'") +
                   ": neither can move",
               "Name a movable body.");
    }
  }
  std::string describe(const JointSpec& spec) const override {
    static const char* const kinds[] = {"ball joint", "hinge", "weld"};
    return fmt::format("{}: {}, {} to {}", spec.name, kinds[static_cast<int>(spec.kind)],
                       spec.body_a, spec.body_b.empty() ? "the world" : spec.body_b);
  }
  std::vector<scene::Link> links(const scene::Scene& scene) const override {
    const scene::BodiesByName bodies(scene);
    const auto seen_from = [&](const std::string& name,
                               const Vector3d& point_world) -> scene::AnchorSpec {
      const scene::BodySpec* body = bodies.find(name);
      return {name, body == nullptr ? point_world
                                    : Vector3d(body->world_from_body.conjugate() *
                                               (point_world - body->position_m))};
    };
    std::vector<scene::Link> links;
    for (const JointSpec& spec : specs(scene))
      links.push_back({spec.name, seen_from(spec.body_a, spec.point_m),
                       seen_from(spec.body_b, spec.point_m), kUnset, spec.pointer});
    return links;
  }
  std::vector<std::pair<std::string, std::string>> pairs_apart(
      const scene::Scene& scene) const override {
    std::vector<std::pair<std::string, std::string>> pairs;
    for (const JointSpec& spec : specs(scene))
      if (!spec.body_b.empty()) pairs.emplace_back(spec.body_a, spec.body_b);
    return pairs;
  }
  void visit_places(TypedLists& effects, const scene::VisitPlace& visit) const override {
    for (JointSpec& spec : effects.of<JointSpec>()) visit(spec.point_m, scene::PlaceKind::kHolds);
  }

  void build(const scene::Scene& scene, const BodyIndex& index, World& world) const override {
    for (const JointSpec& spec : specs(scene))
      world.effects.of<JointLink>().push_back(link_of(spec, index, world));
  }
  std::vector<int> ends_of(const JointLink& joint) const override {
    return {joint.a.body, joint.b.body};
  }
  void rename_ends(JointLink& joint, const std::function<int(int)>& other) const override {
    for (Anchor* anchor : {&joint.a, &joint.b})
      if (anchor->body >= 0) anchor->body = other(anchor->body);
  }

  std::unique_ptr<GroupTerms> group_terms(const Acting& acting, const std::vector<int>& entries,
                                          GroupPlaces& places) const override {
    return std::make_unique<JointTerms>(acting, entries, places);
  }
  Takes takes(const World&, int) const override { return Takes::kNothing; }
  std::vector<NeededLaw> needed_laws(const scene::Scene& scene, const Laws& laws) const override {
    std::vector<NeededLaw> needed;
    append_laws_of_rows(scene, laws, needed);
    return needed;
  }

  void append_held_rows(const World& world, const std::vector<RigidBodyState>& start,
                        std::vector<Constraint>& rows) const override {
    const auto at_rest = [&](int index) {
      Body body{infinite_inertia(), Vector3d::Zero(), Quaterniond::Identity(), Vector3d::Zero(),
                Vector3d::Zero()};
      if (index < 0) return body;
      body.com_world = start[static_cast<std::size_t>(index)].com_world;
      body.world_from_body = start[static_cast<std::size_t>(index)].world_from_body;
      return body;
    };
    for (const JointLink& joint : held(world))
      append_joint_rows(joint, at_rest(joint.a.body), joint.a.body, at_rest(joint.b.body),
                        joint.b.body, rows);
  }
  void append_carriers(const World& world, std::vector<Carrier>& carriers) const override {
    for (std::size_t k = 0; k < held(world).size(); ++k) {
      const JointLink& joint = held(world)[k];
      const auto arm = [&](const Anchor& anchor, const Quaterniond& body_from_joint) {
        if (anchor.body < 0) return 0.0;
        if (joint.kind != JointKind::kHinge) return anchor.point_body.norm();
        return anchor.point_body.cross(body_from_joint * Vector3d::UnitZ()).norm();
      };
      carriers.push_back({joint.a, joint.b, 0.0, joint.kind != JointKind::kWeld,
                          static_cast<int>(k), arm(joint.a, joint.a_from_joint),
                          arm(joint.b, joint.b_from_joint)});
    }
  }

  std::vector<double> Frame::*measured_as() const override { return &Frame::joint_forces; }
  void append_pulls(const World& world, const std::vector<RigidBodyState>&,
                    const std::vector<double>& measured, const Laws& laws,
                    std::vector<Pull>& pulls) const override {
    for (std::size_t k = 0; k < measured.size(); ++k) {
      const JointLink& joint = held(world)[k];
      const std::string rows = fmt::format("constraint_multipliers, constraint_correction of {}",
                                           laws.source_of_links());
      pulls.push_back({joint.a.body, joint.b.body, std::abs(measured[k]),
                       fmt::format("joint '{}' ({})", joint.name, rows_in_words(world, rows))});
    }
  }
  std::vector<scene::LinkCheck> link_checks() const override {
    return {{"joint_gap", "m"}, {"joint_angle", "rad"}};
  }
  std::pair<double, std::string> error_of(const std::string& check, const scene::Scene& scene,
                                          std::size_t entry, const PoseOf& pose_of) const override {
    const JointSpec& joint = specs(scene)[entry];
    const Carried a = carried_by(joint.body_a, scene, pose_of),
                  b = carried_by(joint.body_b, scene, pose_of);
    if (check == "joint_gap")
      return {(a.point(joint.point_m) - b.point(joint.point_m)).norm(), joint.name};
    if (joint.kind == JointKind::kBall) return {0.0, joint.name};  // free to turn
    return {joint.kind == JointKind::kHinge
                ? angle_between(a.turned * joint.axis, b.turned * joint.axis)
                : angle_of(a.turned * b.turned.conjugate()),
            joint.name};
  }
  void draw(const scene::Scene& scene, Drawables& drawables) const override {
    using Kind = DrawnPivot::Kind;
    for (const JointSpec& spec : specs(scene))
      drawables.pivots.push_back({spec.name,
                                  spec.kind == JointKind::kHinge  ? Kind::kPin
                                  : spec.kind == JointKind::kBall ? Kind::kBall
                                                                  : Kind::kWeld,
                                  spec.body_a, spec.body_b, spec.point_m, spec.axis});
  }

 private:
  /// The joint's own frame stands at the shared point; its z is the axis; x and y are any two
  /// across it, the same in both bodies.
  static JointLink link_of(const JointSpec& spec, const BodyIndex& index, const World& world) {
    const std::string subject = "joint '" + spec.name + "'";
    const Quaterniond world_from_joint = spec.kind == JointKind::kHinge
                                             ? shortest_turn(Vector3d::UnitZ(), spec.axis)
                                             : Quaterniond::Identity();
    const auto seen_from = [&](int body, Anchor& anchor, Quaterniond& body_from_joint) {
      anchor = {body, spec.point_m};
      body_from_joint = world_from_joint;
      if (body < 0) return;
      const RigidBodyState& state = world.bodies[static_cast<std::size_t>(body)].state;
      const Quaterniond body_from_world = state.world_from_body.conjugate();
      anchor.point_body = body_from_world * (spec.point_m - state.com_world);
      body_from_joint = (body_from_world * world_from_joint).normalized();
    };
    JointLink link;
    link.name = spec.name;
    link.kind = spec.kind;
    seen_from(index.of(spec.body_a, subject), link.a, link.a_from_joint);
    seen_from(spec.body_b.empty() ? -1 : index.of(spec.body_b, subject), link.b, link.b_from_joint);
    refuse_immovable(link.a.body, link.b.body, world, subject);
    return link;
  }

  static Carried carried_by(const std::string& name, const scene::Scene& scene,
                            const PoseOf& pose_of) {
    const BodyPose* pose = pose_of(name);
    if (pose == nullptr) return {};
    const auto body = std::find_if(scene.bodies.begin(), scene.bodies.end(),
                                   [&](const scene::BodySpec& spec) { return spec.name == name; });
    return {pose, body->position_m, pose->world_from_body * body->world_from_body.conjugate()};
  }
};

}  // namespace

const Effect& joint_effect() {
  static const JointEffect effect;
  return effect;
}

}  // namespace tumble::effects
