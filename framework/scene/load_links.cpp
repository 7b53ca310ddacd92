#include "framework/scene/load_links.h"

#include "framework/scene/read_json.h"
#include "framework/scene/words.h"

namespace tumble::scene {
namespace {

using nlohmann::json;

void read_contact(const json& root, Scene& scene) {
  if (!root.contains("contact")) return;
  const json& value = root.at("contact");
  ContactSpec spec;
  if (value.value("impact_law", "sequential") == "simultaneous")
    spec.impact_law = ImpactLaw::kSimultaneous;
  const std::string plastic = value.value("plastic_impacts", "automatic");
  spec.plastic_impacts = plastic == "in_step"   ? PlasticImpacts::kInStep
                         : plastic == "located" ? PlasticImpacts::kLocated
                                                : PlasticImpacts::kAutomatic;
  read(value, "sleep", spec.sleep);
  scene.contact = spec;
}

void read_stabilisation(const json& root, const Document& document, Scene& scene) {
  const bool is_needed = is_constrained(scene);
  if (is_needed) scene.stabilisation.emplace();
  if (!root.contains("stabilisation")) return;
  if (!is_needed)
    document.refuse("/stabilisation", "the scene has neither rods nor joints", "Delete it.");
  const json& value = root.at("stabilisation");
  const std::string kind = value.at("kind");
  scene.stabilisation->kind = kind == "none"        ? StabilisationKind::kNone
                              : kind == "baumgarte" ? StabilisationKind::kBaumgarte
                                                    : StabilisationKind::kProjection;
  if (kind != "baumgarte" && value.contains("time_constant_s"))
    document.refuse("/stabilisation/time_constant_s",
                    "stabilisation of kind " + kind + " has no time constant",
                    "Delete it, or choose \"baumgarte\".");
  read(value, "time_constant_s", scene.stabilisation->time_constant_s);
}

void read_coordinates(const json& root, const Document& document, Scene& scene) {
  if (!root.contains("coordinates")) return;
  if (!is_constrained(scene))
    document.refuse("/coordinates", "the scene has neither rods nor joints", "Delete it.");
  scene.coordinates = coordinates_named(root.at("coordinates"), "\"coordinates\"");
}

void read_apart(const json& root, const Document& document, Anchors& anchors, Scene& scene) {
  if (!root.contains("apart")) return;
  const json& pairs = root.at("apart");
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::string at = "/apart/" + std::to_string(i);
    const std::string a = anchors.expect_body(pairs.at(i).at(0), at + "/0").name,
                      b = anchors.expect_body(pairs.at(i).at(1), at + "/1").name;
    if (a == b) document.refuse(at + "/1", "found '" + b + "' twice, expected two bodies");
    scene.apart.emplace_back(a, b);
  }
}

}  // namespace

void read_links(const Document& document, Anchors& anchors, Scene& scene) {
  const json& root = document.json;
  read_apart(root, document, anchors, scene);
  read_contact(root, scene);
  read_stabilisation(root, document, scene);
  read_coordinates(root, document, scene);
}

}  // namespace tumble::scene
