/// Reads values of a JSON object into plain data. For the .cpp files of this folder only; the
/// schema has been checked before.
#pragma once

#include <optional>

#include "framework/core/math.h"
#include "framework/scene/document.h"

namespace tumble::scene {

inline Vector3d read_vector(const nlohmann::json& value) {
  return Vector3d(value.at(0).get<double>(), value.at(1).get<double>(), value.at(2).get<double>());
}

/// Leaves the target unchanged where the key is absent.
inline void read(const nlohmann::json& object, const char* key, Vector3d& target) {
  if (object.contains(key)) target = read_vector(object.at(key));
}
template <class T>
void read(const nlohmann::json& object, const char* key, T& target) {
  if (object.contains(key)) target = object.at(key).get<T>();
}
template <class T>
void read(const nlohmann::json& object, const char* key, std::optional<T>& target) {
  if (!object.contains(key)) return;
  T value;
  read(object, key, value);
  target = value;
}

}  // namespace tumble::scene
