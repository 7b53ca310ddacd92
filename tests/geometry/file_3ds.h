/// Chunks that models/write_3ds.h does not write: frames of objects, nodes, pivots.
#pragma once

#include <initializer_list>
#include <string>

#include "models/write_3ds.h"

namespace tumble::testing {

using models::chunk, models::f32, models::u16, models::u32;

inline std::string numbers(std::initializer_list<double> values) {
  std::string data;
  for (double value : values) data += f32(value);
  return data;
}

/// Axes (rows) and origin of an object's frame in the file's world.
inline std::string matrix_chunk(const Eigen::Affine3d& world_from_mesh) {
  std::string data;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row) data += f32(world_from_mesh.matrix()(row, column));
  }
  return chunk(0x4160, data);
}

/// A track of one key at frame 0.
inline std::string track(std::uint16_t id, const std::string& value) {
  return chunk(id, u16(0) + u32(0) + u32(0) + u32(1) + u32(0) + u16(0) + value);
}

struct Node {
  std::string name;
  Vector3d pivot = Vector3d::Zero(), position = Vector3d::Zero();
  double angle = 0.0;
  Vector3d axis = Vector3d::UnitZ();
  std::uint16_t number = 0, parent = 0xFFFF;
};

inline std::string node_chunk(const Node& n) {
  const auto three = [](const Vector3d& v) { return numbers({v.x(), v.y(), v.z()}); };
  return chunk(0xB002, chunk(0xB030, u16(n.number)) +
                           chunk(0xB010, n.name + '\0' + u16(0x4000) + u16(0) + u16(n.parent)) +
                           chunk(0xB013, three(n.pivot)) + track(0xB020, three(n.position)) +
                           track(0xB021, f32(n.angle) + three(n.axis)) +
                           track(0xB022, numbers({1, 1, 1})));
}

inline std::string keyframer(const std::string& nodes) { return chunk(0xB000, nodes); }

}  // namespace tumble::testing
