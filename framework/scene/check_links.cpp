#include "framework/scene/check_links.h"

#include <cmath>
#include <map>
#include <sstream>

#include "framework/scene/document.h"
#include "framework/scene/words.h"

namespace tumble::scene {
namespace {

// A rod's length is either measured at the start (equal to rounding) or typed: 1e-9 of it forgives the rounding of typed decimals
// and of the frames between, and is far below what any check of a rod asks for.
constexpr double kRodFit = 1e-9;

std::string digits(double value) {
  std::ostringstream text;
  text.precision(12);
  text << value;
  return text.str();
}

std::string ending(const AnchorSpec& anchor) { return anchor.body.empty() ? "the world" : "'" + anchor.body + "'"; }

class LinkChecker {
 public:
  LinkChecker(const Scene& scene, const Refuse& refuse) : scene_(scene), refuse_(refuse), bodies_(scene) {}

  void check() {
    for (const Words* words : all_words())
      for (const Link& link : words->links(scene_)) take_name(link.name, link.pointer);
    for (const RodSpec& rod : scene_.rods) {
      take_name(rod.name, rod.pointer);
      check_ends("rod '" + rod.name + "'", rod.a, rod.b, rod.pointer, bodies_, refuse_);
      check_length(rod);
    }
    for (const JointSpec& joint : scene_.joints) check_joint(joint);
    for (const MotorSpec& motor : scene_.motors) check_motor(motor);
    check_friction();
  }

 private:
  const BodySpec* body(const std::string& name) const { return bodies_.find(name); }
  bool can_move(const std::string& name) const { return bodies_.can_move(name); }
  Vector3d place(const AnchorSpec& anchor) const {
    const BodySpec* of = body(anchor.body);
    return of == nullptr ? anchor.point_m : Vector3d(of->position_m + of->world_from_body * anchor.point_m);
  }

  void take_name(const std::string& name, const std::string& pointer) {
    const auto [at, is_new] = names_.emplace(name, pointer);
    if (!is_new) refuse_(pointer, "the name '" + name + "' is taken by " + at->second, "Give every spring, rod and joint a name of its own.");
  }

  void check_length(const RodSpec& rod) const {
    const double found = (place(rod.b) - place(rod.a)).norm();
    if (rod.length_m == 0.0 || found == 0.0)
      refuse_(rod.pointer, "rod '" + rod.name + "' has no length: " + ending(rod.a) + " and " + ending(rod.b) + " are anchored at the same place", "Move one of them; for two bodies that share a point use a joint of kind \"ball\".");
    const double off = found - rod.length_m;
    if (std::abs(off) > kRodFit * rod.length_m)
      refuse_(rod.pointer + "/length_m", "rod '" + rod.name + "' is " + digits(rod.length_m) + " m long, but its ends are " + digits(found) + " m apart at the start: " +
              digits(std::abs(off)) + " m too " + (off > 0 ? "far" : "near"), "Leave length_m out (it is then measured), or move a body.");
  }

  void check_joint(const JointSpec& joint) {
    take_name(joint.name, joint.pointer);
    const std::string who = "joint '" + joint.name + "'";
    if (joint.body_a == joint.body_b) refuse_(joint.pointer, who + " joins body '" + joint.body_a + "' to itself", "Name another body as body_b.");
    if (!can_move(joint.body_a) && !can_move(joint.body_b))
      refuse_(joint.pointer, who + " joins " + (joint.body_b.empty() ? "'" + joint.body_a + "' to the world" : "'" + joint.body_a + "' and '" + joint.body_b + "'") + ": neither can move", "Name a movable body.");
  }

  void check_motor(const MotorSpec& motor) const {
    std::vector<std::string> hinges;
    const JointSpec* found = nullptr;
    for (const JointSpec& joint : scene_.joints) {
      if (joint.name == motor.joint) found = &joint;
      if (joint.kind == JointKind::kHinge) hinges.push_back(joint.name);
    }
    std::string there;
    for (const auto& hinge : hinges) there += (there.empty() ? "Hinges: " : ", ") + hinge;
    there = there.empty() ? "The scene has no hinge: add one to \"joints\"." : there + ".";
    if (found == nullptr) refuse_(motor.pointer + "/joint", "no joint is named '" + motor.joint + "'." + did_you_mean(motor.joint, hinges), there);
    else if (found->kind != JointKind::kHinge) refuse_(motor.pointer + "/joint", "joint '" + motor.joint + "' is no hinge, and a motor turns hinges only", there);
    if (motor.stiffness_n_m_rad == 0.0 && motor.damping_n_m_s_rad == 0.0) refuse_(motor.pointer, "the motor has neither stiffness_n_m_rad nor damping_n_m_s_rad: it would do nothing", "Give one of the two.");
  }

  void check_friction() const {
    for (const BodySpec& body : scene_.bodies)
      if (body.friction > 0.0 && !scene_.contact)
        refuse_(body.pointer + "/friction", "body '" + body.name + "' has friction, which acts in lasting contact only, and the scene has none", "Add \"contact\": {} to the scene, or delete friction.");
  }

  const Scene& scene_;
  const Refuse& refuse_;
  BodiesByName bodies_;
  std::map<std::string, std::string> names_;
};

}  // namespace

void check_ends(const std::string& who, const AnchorSpec& a, const AnchorSpec& b, const std::string& pointer, const BodiesByName& bodies, const Refuse& refuse) {
  if (a.body == b.body && !a.body.empty()) {
    const bool is_one_point = (a.point_m - b.point_m).isZero(0.0);
    refuse(pointer, who + " goes from body '" + a.body + "' to " + (is_one_point ? "the same point of it" : "itself, which moves nothing"), "Name another body at one end, or a point of the world.");
  }
  if (!bodies.can_move(a.body) && !bodies.can_move(b.body)) refuse(pointer, who + " ties " + ending(a) + " to " + ending(b) + ": neither can move", "Name a movable body at one end.");
}

void check_links(const Scene& scene, const Refuse& refuse) { LinkChecker(scene, refuse).check(); }

}  // namespace tumble::scene
