#include "framework/scene/check_checks.h"

#include <map>

#include "framework/scene/words.h"

namespace tumble::scene {
namespace {

/// What a kind of check cannot do without.
struct CheckNeeds {
  bool body = false, other = false, axis = false, link = false, bodies = false;
  int expected = 0;   // how many numbers; kAny: at least one
};
constexpr int kAny = -1;

const std::map<std::string, CheckNeeds>& check_needs() {
  static const std::map<std::string, CheckNeeds> needs = {
      {"energy", {}},
      {"energy_not_rising", {}},
      {"momentum", {}},
      {"angular_momentum", {}},
      {"gap", {}},
      {"final_position", {.body = true, .expected = 3}},
      {"final_velocity", {.body = true, .expected = 3}},
      {"centre_of_mass", {.expected = 3}},
      {"impact_times", {.body = true, .other = true, .expected = kAny}},
      {"event_count", {.expected = 1}},
      {"restitution_law", {}},
      {"side_of_wall", {.body = true, .other = true, .axis = true}},
      {"flips", {.body = true, .axis = true, .expected = 1}},
      {"rod_length", {}},
      {"joint_gap", {}},
      {"joint_angle", {}},
      {"link_force", {.link = true, .expected = 1}},
      {"reaction", {.body = true, .axis = true, .expected = 1}},
      {"drift", {}},
      {"tilt", {}},
      {"at_rest", {}},
      {"distance_travelled", {.body = true, .expected = 1}},
      {"angle_at", {.body = true, .axis = true, .expected = 1}},
      {"stands", {.axis = true}},
      {"falls", {.axis = true}},
      {"order_of_falls", {.axis = true, .bodies = true, .expected = 1}},
  };
  return needs;
}

/// The links that a kind may name.
struct LinkNames {
  std::vector<std::string> said, rods, joints;   // of effects; of those that stand here

  explicit LinkNames(const Scene& scene) {
    for (const Words* words : all_words())
      for (const Link& link : words->links(scene)) said.push_back(link.name);
    for (const auto& rod : scene.rods) rods.push_back(rod.name);
    for (const auto& joint : scene.joints) joints.push_back(joint.name);
  }
  std::vector<std::string> all() const {
    std::vector<std::string> names = said;
    names.insert(names.end(), rods.begin(), rods.end());
    names.insert(names.end(), joints.begin(), joints.end());
    return names;
  }
};

void check_link(const CheckSpec& check, const std::string& pointer, const LinkNames& links, const Refuse& refuse) {
  const bool of_rods = check.kind == "rod_length", of_joints = check.kind.starts_with("joint_");
  if (of_rods && links.rods.empty()) refuse(pointer + "/kind", "a check of kind " + check.kind + " is about rods, and the scene has none", "Delete it, or add a rod.");
  if (of_joints && links.joints.empty()) refuse(pointer + "/kind", "a check of kind " + check.kind + " is about joints, and the scene has none", "Delete it, or add a joint.");
  if (check.link.empty()) return;
  if (of_rods) Names("rod", "Rods", links.rods).expect(check.link, pointer + "/link", refuse);
  else if (of_joints) Names("joint", "Joints", links.joints).expect(check.link, pointer + "/link", refuse);
  else Names("spring, rod or joint", "Links", links.all()).expect(check.link, pointer + "/link", refuse);
}

void check_expected(const CheckSpec& check, const std::string& pointer, int needed, const Refuse& refuse) {
  const bool is_vector = needed == 3 || check.kind.ends_with("momentum");
  const auto found = "found a list of " + std::to_string(check.expected.size());
  if (check.expected.empty()) return;   // refused before where it is needed
  if (is_vector && check.expected.size() != 3) refuse(pointer + "/expected", found + ", expected [x, y, z]", "");
  if (needed == 1 && check.expected.size() != 1) refuse(pointer + "/expected", found + ", expected a list of one number", "");
}

void check_check(const CheckSpec& check, const std::string& pointer, const Names& bodies, const LinkNames& links, const Refuse& refuse) {
  const auto found = check_needs().find(check.kind);
  if (found == check_needs().end()) refuse(pointer + "/kind", "unknown kind of check '" + check.kind + "'", "");
  const CheckNeeds& needs = found->second;
  const auto need = [&](bool needed, bool given, const char* key) {
    if (needed && !given) refuse(pointer, "a check of kind " + check.kind + " needs the key '" + key + "'", "Add it.");
  };
  need(needs.body, !check.body.empty(), "body");
  need(needs.other, !check.other.empty(), "other");
  need(needs.axis, check.axis.has_value(), "axis");
  need(needs.link, !check.link.empty(), "link");
  need(needs.bodies, !check.bodies.empty(), "bodies");
  need(needs.expected != 0, !check.expected.empty(), "expected");
  if (!check.body.empty()) bodies.expect(check.body, pointer + "/body", refuse);
  if (!check.other.empty()) bodies.expect(check.other, pointer + "/other", refuse);
  for (std::size_t i = 0; i < check.bodies.size(); ++i) bodies.expect(check.bodies[i], pointer + "/bodies/" + std::to_string(i), refuse);
  if (check.axis && check.axis->norm() == 0.0) refuse(pointer + "/axis", "found the zero vector, expected a direction", "");
  check_link(check, pointer, links, refuse);
  check_expected(check, pointer, needs.expected, refuse);
}

}  // namespace

void check_checks(const Scene& scene, const Refuse& refuse) {
  const Names bodies = names_of_bodies(scene);
  const LinkNames links(scene);
  for (std::size_t i = 0; i < scene.checks.size(); ++i) check_check(scene.checks[i], "/checks/" + std::to_string(i), bodies, links, refuse);
}

}  // namespace tumble::scene
