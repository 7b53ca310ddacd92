/// Validates the structure of a .3ds file before it is read: nested chunks of (id u16, length u32,
/// data), little-endian.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tumble {

/// A triangle object as the file declares it.
struct DeclaredMesh {
  std::string name;
  int vertices = 0;
  int faces = 0;
};

/// The meshes that the file declares, and its bytes with every chunk hidden that does not affect a
/// shape.
struct Checked3ds {
  std::vector<DeclaredMesh> meshes;  // in the file's order
  bool has_nodes = false;            // a keyframer section places the meshes
  // with materials, smoothing groups and the master scale hidden: no mesh is
  std::string bytes;
  // split by material, and coordinates stay in the file's unit
};

/// Checks every length, count and index.
/// @param where  names the file in errors
/// @throws UserError, each kind with its own message and byte offset: empty, not 3DS, truncated, a
///   chunk longer than its parent, counts that the chunk cannot hold, an index out of range, NaN or
///   infinite numbers, a singular transform, nested too deep, too large
/// Source: format as in the public 3D Studio file notes (J. van Velsen, R. Kalms, 1996).   Cost:
/// O(bytes)
Checked3ds check_3ds(std::string_view bytes, const std::string& where);

}  // namespace tumble
