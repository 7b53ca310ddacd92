#include "framework/effects/motor/motor.h"

#include <algorithm>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/core/nearest_word.h"
#include "framework/effects/motor/acting_motors.h"

namespace tumble::effects {

extern const char* const kMotorSchema;  // schema.json

namespace {

class MotorEffect final : public ListedEffect<MotorSpec, Motor> {
 public:
  std::string name() const override { return "motor"; }
  std::string key() const override { return "motors"; }
  std::string stage() const override { return "control"; }
  std::string counter() const override { return "motor_calls"; }
  std::string schema() const override { return kMotorSchema; }
  Traits traits() const override { return {.ties = true, .looks = true}; }

  void read(scene::Entry& entry, scene::Scene& scene) const override {
    MotorSpec spec;
    spec.pointer = entry.pointer();
    entry.read("joint", spec.joint);
    entry.read("offset_rad", spec.offset_rad);
    entry.read("amplitude_rad", spec.amplitude_rad);
    entry.read("frequency_hz", spec.frequency_hz);
    entry.read("phase_rad", spec.phase_rad);
    entry.read("stiffness_n_m_rad", spec.stiffness_n_m_rad);
    entry.read("damping_n_m_s_rad", spec.damping_n_m_s_rad);
    entry.read("largest_torque_n_m", spec.largest_torque_n_m);
    entry.read("period_s", spec.period_s);
    scene.effects.of<MotorSpec>().push_back(spec);
  }
  void check(const scene::Scene& scene, const scene::Refuse& refuse) const override {
    for (const MotorSpec& motor : specs(scene)) check_motor(motor, scene, refuse);
  }
  std::string describe(const MotorSpec& spec) const override {
    return fmt::format("in {}, looks every {:g} s", spec.joint, spec.period_s);
  }

  void build(const scene::Scene& scene, const BodyIndex&, World& world) const override {
    // built before: joints stand above motors in the list of effects
    const std::vector<JointLink>& joints = world.effects.of<JointLink>();
    for (const MotorSpec& spec : specs(scene)) {
      const auto hinge = std::find_if(joints.begin(), joints.end(), [&](const JointLink& joint) {
        return joint.name == spec.joint && joint.kind == JointKind::kHinge;
      });
      if (hinge == joints.end())
        throw UserError("motor in '" + spec.joint + "'", "no hinge has that name",
                        "name one of the scene's hinges");
      world.effects.of<Motor>().push_back({*hinge, spec});
    }
  }
  std::vector<int> ends_of(const Motor& motor) const override {
    return {motor.hinge.a.body, motor.hinge.b.body};
  }
  void rename_ends(Motor& motor, const std::function<int(int)>& other) const override {
    for (Anchor* anchor : {&motor.hinge.a, &motor.hinge.b})
      if (anchor->body >= 0) anchor->body = other(anchor->body);
  }

  std::unique_ptr<GroupTerms> group_terms(const Acting& acting, const std::vector<int>& entries,
                                          GroupPlaces& places) const override {
    return std::make_unique<MotorTerms>(acting, entries, places);
  }
  std::unique_ptr<WorkMeter> work_meter(const World& world) const override {
    return count_in(world) > 0 ? std::make_unique<MotorMeter>(world) : nullptr;
  }
  Takes takes(const World&, int) const override { return Takes::kNothing; }

 private:
  static void check_motor(const MotorSpec& motor, const scene::Scene& scene,
                          const scene::Refuse& refuse) {
    std::vector<std::string> hinges;
    const JointSpec* found = nullptr;
    for (const JointSpec& joint : scene.effects.of<JointSpec>()) {
      if (joint.name == motor.joint) found = &joint;
      if (joint.kind == JointKind::kHinge) hinges.push_back(joint.name);
    }
    std::string there;
    for (const auto& hinge : hinges) there += (there.empty() ? "Hinges: " : ", ") + hinge;
    there = there.empty() ? "The scene has no hinge: add one to \"joints\"." : there + ".";
    if (found == nullptr)
      refuse(motor.pointer + "/joint",
             "no joint is named '" + motor.joint + "'." + did_you_mean(motor.joint, hinges), there);
    else if (found->kind != JointKind::kHinge)
      refuse(motor.pointer + "/joint",
             "joint '" + motor.joint + "' is no hinge, and a motor turns hinges only", there);
    if (motor.stiffness_n_m_rad == 0.0 && motor.damping_n_m_s_rad == 0.0)
      refuse(motor.pointer,
             "the motor has neither stiffness_n_m_rad nor damping_n_m_s_rad: it would do nothing",
             "Give one of the two.");
    // seen at equal times, sin(2 pi f t) is the same for f and for 1 / period - f
    if (motor.amplitude_rad != 0.0 && motor.frequency_hz * motor.period_s > 0.5)
      refuse(motor.pointer + "/frequency_hz",
             fmt::format("is {:g}: a motor that looks every {:g} s sees no target that swings "
                         "faster than {:g} times a second",
                         motor.frequency_hz, motor.period_s, 0.5 / motor.period_s),
             fmt::format("Give period_s, at most {:g}; ten times less follows it well.",
                         0.5 / motor.frequency_hz));
  }
};

}  // namespace

const Effect& motor_effect() {
  static const MotorEffect effect;
  return effect;
}

}  // namespace tumble::effects
