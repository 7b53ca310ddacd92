/// Writes .3ds files: the few chunks that a shape needs, so that the same surface gives the same
/// bytes on every machine. Assimp's exporter is not used: its bytes depend on its version, it names
/// objects after materials and it splits large meshes. The loader reads through assimp, so writer
/// and reader check each other.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "framework/geometry/triangle_mesh.h"

namespace tumble::models {

/// One object of a file. Its name has at most 10 characters where old programs are to read it.
struct Object {
  std::string name;
  TriangleMesh mesh;  // the file's frame and unit; at most 65535 vertices and faces
};

/// The bytes of a .3ds file with these objects, coordinates rounded to float32, without materials,
/// nodes or smoothing groups.
/// @throws PreconditionError when a mesh is too large for the format
std::string write_3ds(const std::vector<Object>& objects);

/// Little-endian bytes, and a chunk (id u16, length u32, data) of them: for files that write_3ds
/// does not make.
std::string u16(std::uint16_t value);
std::string u32(std::uint32_t value);
std::string f32(double value);
std::string chunk(std::uint16_t id, const std::string& data);

/// The chunks of write_3ds from which other files can be put together.
std::string vertex_list(const std::vector<Vector3d>& vertices);
std::string face_list(const std::vector<Face>& faces);
/// @param mesh_data  vertex and face list, and what else is to stand in the mesh
std::string object_chunk(const std::string& name, const std::string& mesh_data);
/// @param editor_data  object chunks;  @param more  e.g. a keyframer chunk
std::string file_3ds(const std::string& editor_data, const std::string& more = "");

}  // namespace tumble::models
