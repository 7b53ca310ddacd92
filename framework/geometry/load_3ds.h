/// Reads .3ds files: objects as welded triangle meshes in the file's frame (z up), each with a
/// report whether it is closed.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "framework/geometry/closed.h"

namespace tumble {

struct Load3dsOptions {
  // length of the file's unit [m], > 0: the format does not specify it
  double metres_per_unit = 1.0;
};

struct LoadedObject {
  std::string name;  // as in the file; "name#2" for the second of that name
  // report.mesh: mesh frame = the file's world frame, scaled to metres; exactly equal positions
  // welded
  ClosedReport report;
};

struct LoadedFile {
  std::string where;                  // the path, for messages
  std::vector<LoadedObject> objects;  // in the file's order; at least one
};

/// All objects of a .3ds file, with node transforms and pivots applied. Open surfaces are loaded
/// too; their reports list the defects.
/// @throws UserError when the file cannot be read, is not 3DS, is truncated or damaged (with the
///         byte offset), or holds no mesh
LoadedFile load_3ds(const std::filesystem::path& path, const Load3dsOptions& options = {});

/// The same from memory.
/// @param where  names the file in errors
LoadedFile parse_3ds(std::string_view bytes, const std::string& where,
                     const Load3dsOptions& options = {});

}  // namespace tumble
