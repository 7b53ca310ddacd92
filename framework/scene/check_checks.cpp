#include "framework/scene/check_checks.h"

#include <cctype>
#include <map>

#include "framework/scene/words.h"

namespace tumble::scene {
namespace {

/// The values that a kind of check requires.
struct CheckNeeds {
  bool body = false, other = false, axis = false, link = false, bodies = false;
  int expected = 0;  // number of values; kAny: at least one
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

std::vector<std::string> names_of(const std::vector<Link>& links) {
  std::vector<std::string> names;
  for (const Link& link : links) names.push_back(link.name);
  return names;
}

/// The effect to which a kind of check belongs; nullptr: none.
const Words* words_of_check(const std::string& kind) {
  for (const Words* words : all_words())
    for (const LinkCheck& check : words->link_checks())
      if (check.kind == kind) return words;
  return nullptr;
}

void check_link(const CheckSpec& check, const std::string& pointer, const Scene& scene,
                const Refuse& refuse) {
  if (const Words* words = words_of_check(check.kind)) {
    const std::vector<std::string> names = names_of(words->links(scene));
    if (names.empty())
      refuse(pointer + "/kind",
             "a check of kind " + check.kind + " is about " + words->key() +
                 ", and the scene has none",
             "Delete it, or add a " + words->name() + ".");
    std::string plural = words->key();
    plural[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(plural[0])));
    if (!check.link.empty())
      Names(words->name(), plural, names).expect(check.link, pointer + "/link", refuse);
    return;
  }
  if (check.link.empty()) return;
  std::vector<std::string> all;
  for (const Words* words : all_words())
    for (const Link& link : words->links(scene)) all.push_back(link.name);
  Names("spring, rod or joint", "Links", all).expect(check.link, pointer + "/link", refuse);
}

void check_expected(const CheckSpec& check, const std::string& pointer, int needed,
                    const Refuse& refuse) {
  const bool is_vector = needed == 3 || check.kind.ends_with("momentum");
  const auto found = "found a list of " + std::to_string(check.expected.size());
  if (check.expected.empty()) return;  // refused before, where it is required
  if (is_vector && check.expected.size() != 3)
    refuse(pointer + "/expected", found + ", expected [x, y, z]", "");
  if (needed == 1 && check.expected.size() != 1)
    refuse(pointer + "/expected", found + ", expected a list of one number", "");
}

void check_check(const CheckSpec& check, const std::string& pointer, const Names& bodies,
                 const Scene& scene, const Refuse& refuse) {
  const auto found = check_needs().find(check.kind);
  if (found == check_needs().end() && words_of_check(check.kind) == nullptr)
    refuse(pointer + "/kind", "unknown kind of check '" + check.kind + "'", "");
  // checks of links require nothing
  const CheckNeeds needs = found == check_needs().end() ? CheckNeeds{} : found->second;
  const auto need = [&](bool needed, bool given, const char* key) {
    if (needed && !given)
      refuse(pointer, "a check of kind " + check.kind + " needs the key '" + key + "'", "Add it.");
  };
  need(needs.body, !check.body.empty(), "body");
  need(needs.other, !check.other.empty(), "other");
  need(needs.axis, check.axis.has_value(), "axis");
  need(needs.link, !check.link.empty(), "link");
  need(needs.bodies, !check.bodies.empty(), "bodies");
  need(needs.expected != 0, !check.expected.empty(), "expected");
  if (!check.body.empty()) bodies.expect(check.body, pointer + "/body", refuse);
  if (!check.other.empty()) bodies.expect(check.other, pointer + "/other", refuse);
  for (std::size_t i = 0; i < check.bodies.size(); ++i)
    bodies.expect(check.bodies[i], pointer + "/bodies/" + std::to_string(i), refuse);
  if (check.axis && check.axis->norm() == 0.0)
    refuse(pointer + "/axis", "found the zero vector, expected a direction", "");
  check_link(check, pointer, scene, refuse);
  check_expected(check, pointer, needs.expected, refuse);
}

}  // namespace

void check_checks(const Scene& scene, const Refuse& refuse) {
  const Names bodies = names_of_bodies(scene);
  for (std::size_t i = 0; i < scene.checks.size(); ++i)
    check_check(scene.checks[i], "/checks/" + std::to_string(i), bodies, scene, refuse);
}

}  // namespace tumble::scene
