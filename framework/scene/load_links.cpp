#include "framework/scene/load_links.h"

#include "framework/scene/read_json.h"

namespace tumble::scene {
namespace {

using nlohmann::json;

RodSpec rod(const json& value, Anchors& anchors, const std::string& pointer, const std::string& name) {
  RodSpec spec;
  spec.pointer = pointer;
  spec.name = value.value("name", name);
  spec.a = anchors.read_anchor(value.at("a"), pointer + "/a");
  spec.b = anchors.read_anchor(value.at("b"), pointer + "/b");
  spec.length_m = (anchors.place_at_start(spec.b) - anchors.place_at_start(spec.a)).norm();
  read(value, "length_m", spec.length_m);
  return spec;
}

JointSpec joint(const json& value, const Document& document, Anchors& anchors, const std::string& pointer, const std::string& name) {
  JointSpec spec;
  spec.pointer = pointer;
  spec.name = value.value("name", name);
  const std::string kind = value.at("kind");
  spec.kind = kind == "ball" ? JointKind::kBall : kind == "hinge" ? JointKind::kHinge : JointKind::kWeld;
  spec.body_a = anchors.expect_body(value.at("body_a"), pointer + "/body_a").name;
  if (value.contains("body_b")) spec.body_b = anchors.expect_body(value.at("body_b"), pointer + "/body_b").name;
  spec.point_m = read_vector(value.at("point_m"));
  const bool is_hinge = spec.kind == JointKind::kHinge;
  if (is_hinge && !value.contains("axis")) document.refuse(pointer, "a hinge needs the key 'axis': its direction in the world", "Add it, such as \"axis\": [0, 1, 0].");
  if (!is_hinge && value.contains("axis")) document.refuse(pointer + "/axis", "a joint of kind " + kind + " has no axis", "Delete it, or make the joint a hinge.");
  if (!is_hinge) return spec;
  spec.axis = read_vector(value.at("axis"));
  if (spec.axis.isZero(0.0)) document.refuse(pointer + "/axis", "found the zero vector, expected a direction");
  spec.axis.normalize();
  return spec;
}

MotorSpec motor(const json& value, const std::string& pointer) {
  MotorSpec spec;
  spec.pointer = pointer;
  spec.joint = value.at("joint");
  read(value, "offset_rad", spec.offset_rad);
  read(value, "amplitude_rad", spec.amplitude_rad);
  read(value, "frequency_hz", spec.frequency_hz);
  read(value, "phase_rad", spec.phase_rad);
  read(value, "stiffness_n_m_rad", spec.stiffness_n_m_rad);
  read(value, "damping_n_m_s_rad", spec.damping_n_m_s_rad);
  read(value, "largest_torque_n_m", spec.largest_torque_n_m);
  read(value, "period_s", spec.period_s);
  return spec;
}

void read_contact(const json& root, Scene& scene) {
  if (!root.contains("contact")) return;
  const json& value = root.at("contact");
  ContactSpec spec;
  if (value.value("impact_law", "sequential") == "simultaneous") spec.impact_law = ImpactLaw::kSimultaneous;
  const std::string plastic = value.value("plastic_impacts", "automatic");
  spec.plastic_impacts = plastic == "in_step" ? PlasticImpacts::kInStep : plastic == "located" ? PlasticImpacts::kLocated : PlasticImpacts::kAutomatic;
  read(value, "sleep", spec.sleep);
  scene.contact = spec;
}

void read_stabilisation(const json& root, const Document& document, Scene& scene) {
  const bool is_needed = !scene.rods.empty() || !scene.joints.empty();
  if (is_needed) scene.stabilisation.emplace();
  if (!root.contains("stabilisation")) return;
  if (!is_needed) document.refuse("/stabilisation", "there are neither rods nor joints to keep together", "Delete it.");
  const json& value = root.at("stabilisation");
  const std::string kind = value.at("kind");
  scene.stabilisation->kind = kind == "none" ? StabilisationKind::kNone : kind == "baumgarte" ? StabilisationKind::kBaumgarte : StabilisationKind::kProjection;
  if (kind != "baumgarte" && value.contains("time_constant_s"))
    document.refuse("/stabilisation/time_constant_s", "stabilisation of kind " + kind + " has no time constant", "Delete it, or choose \"baumgarte\".");
  read(value, "time_constant_s", scene.stabilisation->time_constant_s);
}

/// Calls `read_one` with each entry of a list, its JSON pointer and its number from 1.
template <class ReadOne>
void each(const json& root, const std::string& key, const ReadOne& read_one) {
  if (!root.contains(key)) return;
  for (std::size_t i = 0; i < root.at(key).size(); ++i) read_one(root.at(key).at(i), "/" + key + "/" + std::to_string(i), std::to_string(i + 1));
}

}  // namespace

void read_links(const Document& document, Anchors& anchors, Scene& scene) {
  const json& root = document.json;
  using Text = const std::string&;
  each(root, "rods", [&](const json& value, Text at, Text n) { scene.rods.push_back(rod(value, anchors, at, "rod " + n)); });
  each(root, "joints", [&](const json& value, Text at, Text n) { scene.joints.push_back(joint(value, document, anchors, at, "joint " + n)); });
  each(root, "motors", [&](const json& value, Text at, Text) { scene.motors.push_back(motor(value, at)); });
  each(root, "apart", [&](const json& value, Text at, Text) {
    const std::string a = anchors.expect_body(value.at(0), at + "/0").name, b = anchors.expect_body(value.at(1), at + "/1").name;
    if (a == b) document.refuse(at + "/1", "found '" + b + "' twice, expected two bodies");
    scene.apart.emplace_back(a, b);
  });
  read_contact(root, scene);
  read_stabilisation(root, document, scene);
}

}  // namespace tumble::scene
