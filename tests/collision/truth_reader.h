/// Reads a reference value of tests/truths; numbers are decimal strings.
#pragma once

#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/support/places.h"
#include "framework/core/math.h"

namespace tumble::testing {

inline nlohmann::json read_truth(const std::string& id) {
  std::string name = id;
  name.replace(name.find('/'), 1, "__");
  std::ifstream file(test::source_dir() + "/tests/truths/" + name + ".json");
  if (!file) throw std::runtime_error("no reference value " + id);
  return nlohmann::json::parse(file);
}

inline double number(const nlohmann::json& value) {
  return value.is_string() ? std::strtod(value.get<std::string>().c_str(), nullptr)
                           : value.get<double>();
}
inline Vector3d vector(const nlohmann::json& value) {
  return {number(value[0]), number(value[1]), number(value[2])};
}
inline std::vector<double> numbers(const nlohmann::json& value) {
  std::vector<double> all;
  for (const auto& v : value) all.push_back(number(v));
  return all;
}
inline nlohmann::json input(const nlohmann::json& truth, const std::string& name) {
  return truth.at("inputs").at(name).at("value");
}
inline nlohmann::json output(const nlohmann::json& truth, const std::string& name) {
  return truth.at("outputs").at(name).at("value");
}
/// Tolerance: 100 times the error floor of double precision.
inline double pass_mark(const nlohmann::json& truth, const std::string& name) {
  return 100 * number(truth.at("outputs").at(name).at("tolerance_floor"));
}

}  // namespace tumble::testing
