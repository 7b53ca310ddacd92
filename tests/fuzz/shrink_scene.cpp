#include "tests/fuzz/shrink_scene.h"

#include <cmath>
#include <string>
#include <vector>

namespace tumble::fuzz {
namespace {

bool names(const Json& value, const std::string& body) {
  if (value.is_string()) return value == body;
  for (const auto& part : value)
    if ((part.is_string() || part.is_structured()) && names(part, body)) return true;
  return false;
}

/// The scene without an entry, and without all entries that name it.
Json without_body(Json scene, std::size_t index) {
  const std::string name = scene["bodies"][index]["name"];
  scene["bodies"].erase(index);
  std::vector<std::string> gone{name};
  for (const char* list :
       {"springs", "rods", "joints", "drag", "point_forces", "apart", "motors"}) {
    if (!scene.contains(list)) continue;
    for (std::size_t i = scene[list].size(); i-- > 0;) {
      bool is_about = false;
      for (const std::string& one : gone) is_about = is_about || names(scene[list][i], one);
      if (!is_about) continue;
      // with a joint its motor is removed
      if (scene[list][i].contains("name")) gone.push_back(scene[list][i]["name"]);
      scene[list].erase(i);
    }
    if (scene[list].empty()) scene.erase(list);
  }
  return scene;
}

/// Numbers with this many digits.
void round_numbers(Json& value, int digits) {
  if (value.is_number_float()) {
    const double number = value;
    if (number == 0.0) return;
    const double unit = std::pow(10.0, digits - 1 - std::floor(std::log10(std::abs(number))));
    value = std::round(number * unit) / unit;
  } else if (value.is_structured()) {
    for (auto& part : value) round_numbers(part, digits);
  }
}

/// All scenes that are one step smaller, the largest steps first.
std::vector<Json> smaller(const Json& scene) {
  std::vector<Json> found;
  for (std::size_t i = scene["bodies"].size(); i-- > 0;) found.push_back(without_body(scene, i));
  for (const char* key : {"chains", "repeat", "gravity_m_s2", "contact", "stabilisation"})
    if (scene.contains(key)) {
      found.push_back(scene);
      found.back().erase(key);
      if (std::string(key) == "contact")  // friction is removed with it
        for (auto& body : found.back()["bodies"]) body.erase("friction");
    }
  for (const char* list : {"motors", "springs", "rods", "joints", "drag", "point_forces"})
    for (std::size_t i = scene.contains(list) ? scene[list].size() : 0; i-- > 0;) {
      found.push_back(scene);
      found.back()[list].erase(i);
      if (found.back()[list].empty()) found.back().erase(list);
    }
  if (scene.contains("contact"))
    for (const char* key : {"plastic_impacts", "impact_law", "sleep"})
      if (scene["contact"].contains(key)) {
        found.push_back(scene);
        found.back()["contact"].erase(key);
      }
  for (std::size_t i = 0; i < scene["bodies"].size(); ++i)
    for (const char* key : {"velocity_m_s", "angular_velocity_rad_s", "orientation", "friction",
                            "restitution", "motion"})
      if (scene["bodies"][i].contains(key)) {
        found.push_back(scene);
        found.back()["bodies"][i].erase(key);
      }
  for (const double part : {0.25, 0.5, 0.8}) {
    found.push_back(scene);
    found.back()["duration_s"] =
        std::max(1.0, std::floor(part * 60.0 * scene["duration_s"].get<double>())) / 60.0;
    if (found.back() == scene) found.pop_back();
  }
  for (const int digits : {2, 4})
    for (std::size_t i = 0; i < scene["bodies"].size(); ++i) {
      found.push_back(scene);
      round_numbers(found.back()["bodies"][i], digits);
      if (found.back() == scene) found.pop_back();
    }
  return found;
}

}  // namespace

Json shrink_scene(Json scene, const std::function<bool(const Json&)>& still_fails,
                  int most_trials) {
  for (bool is_smaller = true; is_smaller && most_trials > 0;) {
    is_smaller = false;
    for (Json& candidate : smaller(scene)) {
      if (candidate["bodies"].empty()) continue;
      if (--most_trials < 0) break;
      if (!still_fails(candidate)) continue;
      scene = std::move(candidate);
      is_smaller = true;
      break;
    }
  }
  return scene;
}

}  // namespace tumble::fuzz
