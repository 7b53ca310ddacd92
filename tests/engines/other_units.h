/// A scene in other units: the same bodies and the same motion, with other numbers.
///
/// A law of mechanics knows nothing of metres, seconds and kilograms. In units that are even powers
/// of two times those of SI every number of a scene, its square root, and what sums, products and
/// quotients make of them, is scaled without rounding, so that a run gives the same bits again. A
/// run that does not compares something that has a unit with a plain number.
#pragma once

#include <array>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "framework/engines/base/rest_speed.h"
#include "framework/scene/load_scene.h"

namespace tumble::testing {

/// Powers of two by which the numbers of a scene are multiplied.
struct OtherUnits {
  int length = 0, time = 0, mass = 0;
  double of(int lengths, int times, int masses) const {
    return std::ldexp(1.0, lengths * length + times * time + masses * mass);
  }
};

/// The factor of a key of a scene by the unit at its end, such as "density_kg_m3".
inline double factor_of_key(const std::string& key, const OtherUnits& units) {
  struct Unit {
    const char* word;
    int lengths, times, masses;
  };
  // a longer word comes before those that it ends in
  static constexpr std::array kUnits{Unit{"stiffness_n_m", 0, -2, 1},
                                     Unit{"_kg_m3", -3, 0, 1},
                                     Unit{"_kg_m2", 2, 0, 1},
                                     Unit{"_n_m_s_rad", 2, -1, 1},
                                     Unit{"_n_m_rad", 2, -2, 1},
                                     Unit{"_n_m_s", 2, -1, 1},
                                     Unit{"_n_s_m", 0, -1, 1},
                                     Unit{"_n_m", 2, -2, 1},
                                     Unit{"_rad_s", 0, -1, 0},
                                     Unit{"_m_s2", 1, -2, 0},
                                     Unit{"_m_s", 1, -1, 0},
                                     Unit{"_1_s", 0, -1, 0},
                                     Unit{"_hz", 0, -1, 0},
                                     Unit{"_kg", 0, 0, 1},
                                     Unit{"_n", 1, -2, 1},
                                     Unit{"_m", 1, 0, 0},
                                     Unit{"_s", 0, 1, 0},
                                     Unit{"metres_per_unit", 1, 0, 0}};
  for (const Unit& unit : kUnits)
    if (key.ends_with(unit.word)) return units.of(unit.lengths, unit.times, unit.masses);
  return 1.0;
}

/// The factor of what a check compares. Of forces it compares parts, and 0 N with newtons.
inline double factor_of_check(const nlohmann::json& check, const OtherUnits& units) {
  const std::string kind = check.at("kind");
  static const std::set<std::string> lengths{"gap",          "final_position", "centre_of_mass",
                                             "side_of_wall", "drift",          "distance_travelled",
                                             "rod_length",   "joint_gap"};
  if (lengths.contains(kind)) return units.of(1, 0, 0);
  if (kind == "momentum") return units.of(1, -1, 1);
  if (kind == "angular_momentum") return units.of(2, -1, 1);
  if (kind == "final_velocity") return units.of(1, -1, 0);
  if (kind == "impact_times") return units.of(0, 1, 0);
  if (kind == "at_rest") return units.of(2, -2, 0);
  if (kind == "link_force" || kind == "reaction") return units.of(1, -2, 1);
  return 1.0;
}

inline void multiply_numbers(nlohmann::json& value, double factor) {
  if (value.is_number()) value = value.get<double>() * factor;
  if (value.is_array())
    for (nlohmann::json& part : value) multiply_numbers(part, factor);
}

inline void change_units(nlohmann::json& value, const OtherUnits& units) {
  if (value.is_object())
    for (auto& [key, part] : value.items()) {
      if (const double factor = factor_of_key(key, units); factor != 1.0)
        multiply_numbers(part, factor);
      else
        change_units(part, units);
    }
  if (value.is_array())
    for (nlohmann::json& part : value) change_units(part, units);
}

/// A model's unit, which a scene need not say, is 1 m.
inline void say_units_of_models(nlohmann::json& value) {
  if (value.is_object() && value.contains("model") && value["model"].is_object() &&
      !value["model"].contains("metres_per_unit"))
    value["model"]["metres_per_unit"] = 1.0;
  if (value.is_structured())
    for (nlohmann::json& part : value) say_units_of_models(part);
}

/// What a scene does not say stands for a number of SI units (a step of 1/60 s), or follows from
/// the scene (the speed of rest); here it says all of them.
inline nlohmann::json with_defaults_said(const std::string& text,
                                         const std::filesystem::path& file) {
  const scene::Scene read = scene::parse_scene(text, file);
  nlohmann::json all = nlohmann::json::parse(text);
  all["step_s"] = read.step_s;
  all["rest_speed_m_s"] = engines::rest_speed_of(read);
  if (auto found = all.find("stabilisation"); found != all.end() &&
                                              found->value("kind", "") == "baumgarte" &&
                                              !found->contains("time_constant_s"))
    (*found)["time_constant_s"] = read.stabilisation->time_constant_s;
  if (auto found = all.find("motors"); found != all.end())
    for (nlohmann::json& motor : *found)
      if (!motor.contains("period_s")) motor["period_s"] = 0.01;
  if (auto found = all.find("water"); found != all.end() && !found->contains("density_kg_m3"))
    (*found)["density_kg_m3"] = 1000.0;
  all.erase("sampling");
  say_units_of_models(all);
  return all;
}

/// @param scene  with all defaults said
inline nlohmann::json in_other_units(nlohmann::json scene, const OtherUnits& units) {
  if (auto found = scene.find("checks"); found != scene.end())
    for (nlohmann::json& check : *found) {
      const double factor = factor_of_check(check, units);
      const std::string kind = check.at("kind");
      const bool is_of_forces = kind == "link_force" || kind == "reaction";
      bool is_zero = true;
      if (check.contains("expected"))
        for (const nlohmann::json& number : check["expected"])
          is_zero = is_zero && number.get<double>() == 0.0;
      if (check.contains("expected")) multiply_numbers(check["expected"], factor);
      if (!is_of_forces || is_zero) multiply_numbers(check["tolerance"], factor);
    }
  change_units(scene, units);
  return scene;
}

}  // namespace tumble::testing
