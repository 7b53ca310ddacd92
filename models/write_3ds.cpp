// Chunks as in the public 3D Studio file notes (J. van Velsen, R. Kalms, 1996).
#include "models/write_3ds.h"

#include <cstring>

#include "framework/core/error.h"

namespace tumble::models {
namespace {

constexpr std::size_t kMostCounted = 65535;  // counts and indices are u16

template <class T>
std::string little_endian(T value) {
  std::string bytes;
  for (std::size_t i = 0; i < sizeof value; ++i)
    bytes += static_cast<char>((value >> (8 * i)) & 0xFF);
  return bytes;
}

}  // namespace

std::string u16(std::uint16_t value) { return little_endian(value); }
std::string u32(std::uint32_t value) { return little_endian(value); }

std::string f32(double value) {
  const float rounded = static_cast<float>(value) + 0.0f;  // -0 becomes +0
  std::uint32_t bits;
  std::memcpy(&bits, &rounded, sizeof bits);
  return u32(bits);
}

std::string chunk(std::uint16_t id, const std::string& data) {
  return u16(id) + u32(static_cast<std::uint32_t>(6 + data.size())) + data;
}

std::string vertex_list(const std::vector<Vector3d>& vertices) {
  require(vertices.size() <= kMostCounted, "vertex_list: a .3ds mesh has at most 65535 vertices");
  std::string data = u16(static_cast<std::uint16_t>(vertices.size()));
  for (const Vector3d& vertex : vertices)
    data += f32(vertex.x()) + f32(vertex.y()) + f32(vertex.z());
  return chunk(0x4110, data);
}

std::string face_list(const std::vector<Face>& faces) {
  require(faces.size() <= kMostCounted, "face_list: a .3ds mesh has at most 65535 faces");
  constexpr std::uint16_t kAllEdgesVisible = 7;
  std::string data = u16(static_cast<std::uint16_t>(faces.size()));
  for (const Face& face : faces) {
    for (int corner : face) data += u16(static_cast<std::uint16_t>(corner));
    data += u16(kAllEdgesVisible);
  }
  return chunk(0x4120, data);
}

std::string object_chunk(const std::string& name, const std::string& mesh_data) {
  return chunk(0x4000, name + '\0' + chunk(0x4100, mesh_data));
}

std::string file_3ds(const std::string& editor_data, const std::string& more) {
  constexpr std::uint32_t kVersion = 3;
  const std::string editor = chunk(0x3D3D, chunk(0x3D3E, u32(kVersion)) + editor_data);
  return chunk(0x4D4D, chunk(0x0002, u32(kVersion)) + editor + more);
}

std::string write_3ds(const std::vector<Object>& objects) {
  std::string data;
  for (const Object& object : objects)
    data +=
        object_chunk(object.name, vertex_list(object.mesh.vertices) + face_list(object.mesh.faces));
  return file_3ds(data);
}

}  // namespace tumble::models
