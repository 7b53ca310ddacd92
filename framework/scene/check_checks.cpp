#include "framework/scene/check_checks.h"

#include <cctype>
#include <map>

#include "framework/scene/words.h"

namespace tumble::scene {
namespace {

/// Whether a check may have a key.
enum class Use { kNot, kMay, kMust };
using enum Use;

/// The keys of a kind of check besides kind, tolerance, unit and why.
struct CheckKeys {
  Use body = kNot, other = kNot, bodies = kNot, axis = kNot, link = kNot, expected = kNot,
      at_s = kNot;
  int values = 0;  // expected; kAny: at least one
};
constexpr int kAny = -1;

const std::map<std::string, CheckKeys>& check_keys() {
  static const std::map<std::string, CheckKeys> keys = {
      {"energy", {.at_s = kMay}},
      {"energy_not_rising", {.at_s = kMay}},
      {"momentum", {.expected = kMay, .at_s = kMay, .values = 3}},
      {"angular_momentum", {.expected = kMay, .at_s = kMay, .values = 3}},
      {"gap", {}},
      {"final_position", {.body = kMust, .expected = kMust, .at_s = kMay, .values = 3}},
      {"final_velocity", {.body = kMust, .expected = kMust, .at_s = kMay, .values = 3}},
      {"centre_of_mass",
       {.body = kMay, .bodies = kMay, .expected = kMust, .at_s = kMay, .values = 3}},
      {"impact_times", {.body = kMust, .other = kMust, .expected = kMust, .values = kAny}},
      {"event_count", {.body = kMay, .other = kMay, .expected = kMust, .values = 1}},
      {"restitution_law", {.body = kMay, .other = kMay}},
      {"side_of_wall", {.body = kMust, .other = kMust, .axis = kMust}},
      {"flips", {.body = kMust, .axis = kMust, .expected = kMust, .values = 1}},
      {"link_force", {.link = kMust, .expected = kMust, .at_s = kMay, .values = 1}},
      {"reaction",
       {.body = kMust, .other = kMay, .axis = kMust, .expected = kMust, .at_s = kMay, .values = 1}},
      {"drift", {.body = kMay, .bodies = kMay, .at_s = kMay}},
      {"tilt", {.body = kMay, .bodies = kMay, .at_s = kMay}},
      {"at_rest", {.body = kMay, .bodies = kMay, .at_s = kMay}},
      {"distance_travelled",
       {.body = kMust, .axis = kMay, .expected = kMust, .at_s = kMay, .values = 1}},
      {"angle_at", {.body = kMust, .axis = kMust, .expected = kMust, .at_s = kMay, .values = 1}},
      {"stands", {.body = kMay, .bodies = kMay, .axis = kMust, .at_s = kMay}},
      {"falls", {.body = kMay, .bodies = kMay, .axis = kMust, .at_s = kMay}},
      {"order_of_falls", {.bodies = kMust, .axis = kMust, .expected = kMust, .values = 1}},
  };
  return keys;
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

void check_expected(const CheckSpec& check, const std::string& pointer, int values,
                    const Refuse& refuse) {
  const auto found = "found a list of " + std::to_string(check.expected.size());
  if (check.expected.empty()) return;  // refused before, where it is required
  if (values == 3 && check.expected.size() != 3)
    refuse(pointer + "/expected", found + ", expected [x, y, z]", "");
  if (values == 1 && check.expected.size() != 1)
    refuse(pointer + "/expected", found + ", expected a list of one number", "");
}

/// A key that a kind does not use would be believed to matter.
void check_use(const CheckSpec& check, const std::string& pointer, const CheckKeys& keys,
               const Refuse& refuse) {
  const auto expect = [&](Use use, bool given, const std::string& key) {
    if (use == kMust && !given)
      refuse(pointer, "a check of kind " + check.kind + " needs the key '" + key + "'", "Add it.");
    if (use == kNot && given)
      refuse(pointer + "/" + key, "a check of kind " + check.kind + " has no key '" + key + "'",
             "Delete it.");
  };
  expect(keys.body, !check.body.empty(), "body");
  expect(keys.other, !check.other.empty(), "other");
  expect(keys.axis, check.axis.has_value(), "axis");
  expect(keys.link, !check.link.empty(), "link");
  expect(keys.bodies, !check.bodies.empty(), "bodies");
  expect(keys.expected, !check.expected.empty(), "expected");
  expect(keys.at_s, check.at_s != 0.0, "at_s");
  if (!check.body.empty() && !check.bodies.empty())
    refuse(pointer + "/body", "a check has either 'body' or 'bodies'", "Delete one of them.");
}

void check_check(const CheckSpec& check, const std::string& pointer, const Names& bodies,
                 const Scene& scene, const Refuse& refuse) {
  const auto found = check_keys().find(check.kind);
  if (found == check_keys().end() && words_of_check(check.kind) == nullptr)
    refuse(pointer + "/kind", "unknown kind of check '" + check.kind + "'", "");
  // a check of links is about one or all of them
  const CheckKeys keys = found == check_keys().end() ? CheckKeys{.link = kMay} : found->second;
  check_use(check, pointer, keys, refuse);
  if (!check.body.empty()) bodies.expect(check.body, pointer + "/body", refuse);
  if (!check.other.empty()) bodies.expect(check.other, pointer + "/other", refuse);
  for (std::size_t i = 0; i < check.bodies.size(); ++i)
    bodies.expect(check.bodies[i], pointer + "/bodies/" + std::to_string(i), refuse);
  if (check.axis && check.axis->norm() == 0.0)
    refuse(pointer + "/axis", "found the zero vector, expected a direction", "");
  if (check.at_s > scene.duration_s)
    refuse(pointer + "/at_s", "the run has ended by then",
           "Give an instant within duration_s, or leave it out.");
  check_link(check, pointer, scene, refuse);
  check_expected(check, pointer, keys.values, refuse);
}

}  // namespace

void check_checks(const Scene& scene, const Refuse& refuse) {
  const Names bodies = names_of_bodies(scene);
  for (std::size_t i = 0; i < scene.checks.size(); ++i)
    check_check(scene.checks[i], "/checks/" + std::to_string(i), bodies, scene, refuse);
}

}  // namespace tumble::scene
