#include "framework/scene/load_sampling.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <set>
#include <sstream>
#include <utility>

#include "framework/scene/document.h"
#include "framework/scene/names.h"
#include "framework/scene/read_json.h"

namespace tumble::scene {
namespace {

using nlohmann::json;

constexpr double kDegree = std::numbers::pi / 180.0;
// Between a normal prior's mean and its range: further out the logarithm of its density, half the
// square of this, is no longer known to a small part of 1.
constexpr double kMostDeviations = 1e6;

double number_or(const json& object, const char* key, double otherwise) {
  return object.contains(key) ? object.at(key).get<double>() : otherwise;
}

/// A vector in which null is no bound.
Vector3d bounds(const json& object, const char* key, double otherwise) {
  Vector3d bound = Vector3d::Constant(otherwise);
  if (!object.contains(key)) return bound;
  for (int i = 0; i < 3; ++i) {
    const json& value = object.at(key).at(static_cast<std::size_t>(i));
    if (!value.is_null()) bound[i] = value.get<double>();
  }
  return bound;
}

PerturbationSpec perturbation(const json& value, const std::string& pointer,
                              const Document& document, const BodiesByName& bodies) {
  PerturbationSpec spec;
  spec.pointer = pointer;
  spec.body = value.at("body");
  spec.what = value.at("what");
  spec.is_normal = value.contains("normal");
  if (spec.is_normal == value.contains("uniform"))
    document.refuse(pointer, "it has neither \"normal\" nor \"uniform\", or both",
                    "Give one of them: what is believed of the number.");
  const json& prior = value.at(spec.is_normal ? "normal" : "uniform");
  spec.mean = number_or(prior, "mean", kUnset);
  spec.deviation = number_or(prior, "deviation", kUnset);
  const bool is_share = spec.what == "restitution", has_floor = is_share || spec.what == "friction";
  spec.low = number_or(prior, "low", has_floor ? 0.0 : -kNoBound);
  spec.high = number_or(prior, "high", is_share ? 1.0 : kNoBound);
  if (!(spec.low < spec.high))
    document.refuse(pointer, "its lower bound is not below its upper one", "Exchange the two.");
  if ((has_floor && spec.low < 0.0) || (is_share && spec.high > 1.0))
    document.refuse(
        pointer, "a " + spec.what + " cannot be outside its range",
        is_share ? "Keep the bounds within 0 and 1." : "Keep the bounds at 0 or above.");
  if (spec.is_normal && !(std::abs(std::clamp(spec.mean, spec.low, spec.high) - spec.mean) <=
                          kMostDeviations * spec.deviation))
    document.refuse(pointer + "/normal",
                    "its bounds are more than a million deviations from its mean, where it has no "
                    "probability",
                    "Move the bounds or the mean.");
  spec.multiplies = value.value("proposal", "add") == "multiply";
  if (spec.multiplies && !(spec.low >= 0.0))
    document.refuse(pointer + "/proposal", "a number that is multiplied must be positive",
                    "Give a lower bound of at least 0, or \"add\".");
  const double width = spec.is_normal ? spec.deviation : spec.high - spec.low;
  spec.step = number_or(value, "step", spec.multiplies ? 0.3 : 0.5 * width);
  const BodySpec* body = bodies.find(spec.body);
  if (body->immovable && spec.what.find("velocity") != std::string::npos)
    document.refuse(pointer + "/what", "'" + spec.body + "' is immovable and has no velocity",
                    "Perturb a movable body's.");
  return spec;
}

AskedSpec asked(const json& value, const std::string& pointer, const Document& document) {
  AskedSpec spec;
  spec.pointer = pointer;
  spec.body = value.at("body");
  spec.is_place = value.contains("place");
  if (spec.is_place == value.contains("lean"))
    document.refuse(pointer, "it has neither \"place\" nor \"lean\", or both",
                    "Give one of them: what is asked of the body.");
  if (spec.is_place) {
    const json& place = value.at("place");
    read(place, "point_body_m", spec.point_body);
    spec.low_m = bounds(place, "low_m", -kNoBound);
    spec.high_m = bounds(place, "high_m", kNoBound);
    if (!((spec.low_m.array() < spec.high_m.array()).all()))
      document.refuse(pointer + "/place", "a lower bound is not below its upper one",
                      "Exchange the two.");
    if (spec.low_m.array().isInf().all() && spec.high_m.array().isInf().all())
      document.refuse(pointer + "/place", "it has no bound: every place is as asked",
                      "Give a number in low_m or high_m.");
    spec.softness = place.at("softness_m");
    return spec;
  }
  const json& lean = value.at("lean");
  read(lean, "axis_body", spec.axis_body);
  read(lean, "direction", spec.direction_world);
  for (auto [key, vector] :
       {std::pair{"axis_body", &spec.axis_body}, std::pair{"direction", &spec.direction_world}}) {
    if (vector->norm() == 0.0)
      document.refuse(pointer + "/lean/" + key, "the vector (0, 0, 0) has no direction",
                      "Give another.");
    vector->normalize();
  }
  spec.least_rad = kDegree * number_or(lean, "least_deg", 0.0);
  spec.most_rad = kDegree * number_or(lean, "most_deg", 180.0);
  if (!(spec.least_rad < spec.most_rad))
    document.refuse(pointer + "/lean", "least_deg is not below most_deg", "Exchange the two.");
  if (spec.least_rad <= 0.0 && spec.most_rad >= std::numbers::pi)
    document.refuse(pointer + "/lean", "every direction is as asked",
                    "Give least_deg or most_deg.");
  spec.softness = kDegree * lean.at("softness_deg").get<double>();
  return spec;
}

}  // namespace

std::optional<SamplingSpec> read_sampling(const Document& document, const Scene& scene) {
  if (!document.json.contains("sampling")) return std::nullopt;
  const json& value = document.json.at("sampling");
  const Names names = names_of_bodies(scene);
  const BodiesByName bodies(scene);
  const auto expect_body = [&](const json& entry, const std::string& pointer) {
    names.expect(entry.at("body"), pointer + "/body",
                 [&](const std::string& place, const std::string& problem,
                     const std::string& remedy) { document.refuse(place, problem, remedy); });
  };
  SamplingSpec spec;
  std::set<std::pair<std::string, std::string>> taken;  // body, number
  const json& perturbed = value.at("perturbed");
  for (std::size_t i = 0; i < perturbed.size(); ++i) {
    const std::string pointer = "/sampling/perturbed/" + std::to_string(i);
    expect_body(perturbed.at(i), pointer);
    spec.perturbed.push_back(perturbation(perturbed.at(i), pointer, document, bodies));
    const PerturbationSpec& added = spec.perturbed.back();
    if (!taken.emplace(added.body, added.what).second)
      document.refuse(pointer, "'" + added.body + "' has its " + added.what + " perturbed already",
                      "Delete one of the two.");
    if (added.what == "friction" && !scene.contact)
      document.refuse(pointer + "/what",
                      "body '" + added.body +
                          "' has friction, which acts in persistent contact only, and the scene "
                          "has none",
                      "Add \"contact\": {} to the scene, or perturb another number.");
  }
  const json& conditions = value.at("asked");
  for (std::size_t i = 0; i < conditions.size(); ++i) {
    const std::string pointer = "/sampling/asked/" + std::to_string(i);
    expect_body(conditions.at(i), pointer);
    spec.asked.push_back(asked(conditions.at(i), pointer, document));
  }
  read(value, "wide_share", spec.wide_share);
  read(value, "wide_factor", spec.wide_factor);
  return spec;
}

std::optional<SamplingSpec> parse_sampling(const std::string& text, const Scene& scene) {
  return read_sampling(parse_document(text, scene.file), scene);
}

std::optional<SamplingSpec> load_sampling(const Scene& scene) {
  std::ifstream stream(scene.file, std::ios::binary);
  if (!stream) return std::nullopt;  // made in memory
  std::ostringstream text;
  text << stream.rdbuf();
  return parse_sampling(text.str(), scene);
}

}  // namespace tumble::scene
