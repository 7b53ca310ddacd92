#include "framework/dynamics/build_links.h"

#include <algorithm>
#include <map>

#include <Eigen/Geometry>

#include "framework/core/error.h"
#include "framework/core/shortest_turn.h"

namespace tumble {
namespace {

class LinkBuilder {
 public:
  LinkBuilder(const scene::Scene& scene, World& world) : scene_(scene), world_(world) {
    for (std::size_t i = 0; i < world.bodies.size(); ++i) index_.emplace(world.bodies[i].name, static_cast<int>(i));
  }

  void build() {
    for (const scene::RodSpec& spec : scene_.rods) {
      const std::string who = "rod '" + spec.name + "'";
      world_.rods.push_back({spec.name, anchor(spec.a, who), anchor(spec.b, who), spec.length_m});
      refuse_immovable(world_.rods.back().a, world_.rods.back().b, who);
    }
    for (const scene::JointSpec& spec : scene_.joints) world_.joints.push_back(joint(spec));
    for (const scene::MotorSpec& spec : scene_.motors) world_.motors.push_back({joint_index(spec.joint), spec});
    world_.contact = scene_.contact;
    if (!world_.rods.empty() || !world_.joints.empty()) world_.stabilisation = scene_.stabilisation.value_or(scene::StabilisationSpec{});
    keep_apart();
  }

 private:
  int body(const std::string& name, const std::string& who) const {
    const auto found = index_.find(name);
    if (found == index_.end()) throw UserError(who, "no body is named '" + name + "'", "name one of the scene's bodies");
    return found->second;
  }

  Anchor anchor(const scene::AnchorSpec& spec, const std::string& who) const {
    return {spec.body.empty() ? -1 : body(spec.body, who), spec.point_m};
  }

  bool can_move(int body) const { return body >= 0 && !world_.bodies[static_cast<std::size_t>(body)].immovable(); }
  void refuse_immovable(const Anchor& a, const Anchor& b, const std::string& who) const {
    if (!can_move(a.body) && !can_move(b.body)) throw UserError(who, "neither of its ends can move", "tie a movable body");
  }

  /// The joint's own frame stands at the shared point; its z is the axis; x and y are any two across it, the same in both bodies.
  JointLink joint(const scene::JointSpec& spec) const {
    const std::string who = "joint '" + spec.name + "'";
    const Quaterniond world_from_joint = spec.kind == scene::JointKind::kHinge ? shortest_turn(Vector3d::UnitZ(), spec.axis) : Quaterniond::Identity();
    const auto seen_from = [&](int body, Anchor& anchor, Quaterniond& body_from_joint) {
      anchor = {body, spec.point_m};
      body_from_joint = world_from_joint;
      if (body < 0) return;
      const RigidBodyState& state = world_.bodies[static_cast<std::size_t>(body)].state;
      const Quaterniond body_from_world = state.world_from_body.conjugate();
      anchor.point_body = body_from_world * (spec.point_m - state.com_world);
      body_from_joint = (body_from_world * world_from_joint).normalized();
    };
    JointLink link;
    link.name = spec.name;
    link.kind = spec.kind;
    seen_from(body(spec.body_a, who), link.a, link.a_from_joint);
    seen_from(spec.body_b.empty() ? -1 : body(spec.body_b, who), link.b, link.b_from_joint);
    refuse_immovable(link.a, link.b, who);
    return link;
  }

  int joint_index(const std::string& name) const {
    for (std::size_t i = 0; i < world_.joints.size(); ++i)
      if (world_.joints[i].name == name && world_.joints[i].kind == scene::JointKind::kHinge) return static_cast<int>(i);
    throw UserError("motor in '" + name + "'", "no hinge has that name", "name one of the scene's hinges");
  }

  void keep_apart() {
    for (const auto& [a, b] : scene_.apart) world_.apart.push_back(std::minmax({body(a, "apart"), body(b, "apart")}));
    for (const JointLink& link : world_.joints)
      if (link.b.body >= 0) world_.apart.push_back(std::minmax({link.a.body, link.b.body}));
    std::sort(world_.apart.begin(), world_.apart.end());
    world_.apart.erase(std::unique(world_.apart.begin(), world_.apart.end()), world_.apart.end());
  }

  const scene::Scene& scene_;
  World& world_;
  std::map<std::string, int> index_;
};

}  // namespace

void build_links(const scene::Scene& scene, World& world) { LinkBuilder(scene, world).build(); }

}  // namespace tumble
