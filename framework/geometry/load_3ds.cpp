// The only file that uses assimp.
#include "framework/geometry/load_3ds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/geometry/chunks_3ds.h"

namespace tumble {
namespace {

// assimp's name for the node of mesh i in a file without nodes
constexpr const char* kNameless = "3DSMesh_";

using Affine = Eigen::Affine3d;

Affine to_eigen(const aiMatrix4x4& m) {
  Affine result;
  result.matrix() << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1,
      m.d2, m.d3, m.d4;
  return result;
}

// Gathers the objects of a scene, each with the vertices of its faces in the file's world frame.
class Gatherer {
 public:
  Gatherer(const aiScene& scene, const Checked3ds& file, double metres_per_unit)
      : scene_(scene), file_(file), metres_per_unit_(metres_per_unit) {}

  std::vector<std::pair<std::string, TriangleMesh>> run() {
    // The root's transform changes z up to y up; without it the file's own axes remain.
    visit(*scene_.mRootNode, Affine::Identity(), true);
    return std::move(objects_);
  }

 private:
  void visit(const aiNode& node, const Affine& world_from_parent, bool is_root) {
    const Affine world_from_node =
        is_root ? world_from_parent : world_from_parent * to_eigen(node.mTransformation);
    if (node.mNumMeshes > 0) gather(node, world_from_node);
    for (unsigned i = 0; i < node.mNumChildren; ++i)
      visit(*node.mChildren[i], world_from_node, false);
  }

  void gather(const aiNode& node, const Affine& world_from_node) {
    TriangleMesh mesh;
    std::map<std::array<float, 3>, int> welded;
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
      const aiMesh& piece = *scene_.mMeshes[node.mMeshes[m]];
      for (unsigned f = 0; f < piece.mNumFaces; ++f) {
        const aiFace& face = piece.mFaces[f];
        if (face.mNumIndices != 3) continue;  // a point or a line
        Face& corners = mesh.faces.emplace_back();
        for (int corner = 0; corner < 3; ++corner) {
          corners[corner] =
              weld(piece.mVertices[face.mIndices[corner]], world_from_node, welded, mesh);
        }
      }
    }
    objects_.emplace_back(name_of(node), std::move(mesh));
  }

  // Corners that have exactly the same float32 coordinates in the mesh's own frame are one vertex.
  int weld(const aiVector3D& p, const Affine& world_from_node,
           std::map<std::array<float, 3>, int>& welded, TriangleMesh& mesh) const {
    const std::array<float, 3> key{p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};  // -0 becomes +0
    // NaN has no place in an ordered map
    if (!std::isfinite(key[0]) || !std::isfinite(key[1]) || !std::isfinite(key[2])) {
      mesh.vertices.push_back(Vector3d(p.x, p.y, p.z));
      return static_cast<int>(mesh.vertices.size()) - 1;
    }
    const auto [place, is_new] = welded.try_emplace(key, static_cast<int>(mesh.vertices.size()));
    if (is_new)
      mesh.vertices.push_back(metres_per_unit_ *
                              (world_from_node * Vector3d(key[0], key[1], key[2])));
    return place->second;
  }

  // In a file without nodes assimp loses the objects' names, but keeps their order.
  std::string name_of(const aiNode& node) const {
    const std::string name = node.mName.C_Str();
    if (!name.starts_with(kNameless) || file_.has_nodes) return name;
    const std::size_t i = std::strtoul(name.c_str() + std::strlen(kNameless), nullptr, 10);
    std::vector<const DeclaredMesh*> with_faces;
    for (const DeclaredMesh& mesh : file_.meshes) {
      if (mesh.faces > 0) with_faces.push_back(&mesh);
    }
    return i < with_faces.size() && !with_faces[i]->name.empty() ? with_faces[i]->name : name;
  }

  const aiScene& scene_;
  const Checked3ds& file_;
  double metres_per_unit_;
  std::vector<std::pair<std::string, TriangleMesh>> objects_;
};

std::string unique_name(const std::string& name, std::map<std::string, int>& used) {
  const int count = ++used[name];
  return count == 1 ? name : fmt::format("{}#{}", name, count);
}

// assimp drops meshes without faces; each is added here as an object that encloses nothing.
void add_faceless(const Checked3ds& file, LoadedFile& loaded) {
  for (const DeclaredMesh& mesh : file.meshes) {
    if (mesh.faces > 0) continue;
    loaded.objects.push_back({mesh.name, check_closed(TriangleMesh{})});
  }
}

std::string read_bytes(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (error || !std::filesystem::exists(status))
    throw UserError(path.string(), "no such file", "Check the path.");
  if (!std::filesystem::is_regular_file(status))
    throw UserError(path.string(), "not a file", "Name a .3ds file.");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw UserError(path.string(), "cannot be opened", "Check its permissions.");
  std::ostringstream bytes;
  bytes << file.rdbuf();
  return std::move(bytes).str();
}

}  // namespace

LoadedFile parse_3ds(std::string_view bytes, const std::string& where,
                     const Load3dsOptions& options) {
  if (!(options.metres_per_unit > 0.0) || !std::isfinite(options.metres_per_unit)) {
    throw UserError(
        where,
        fmt::format("metres per unit is {}, expected a positive number", options.metres_per_unit),
        "");
  }
  const Checked3ds file = check_3ds(bytes, where);
  LoadedFile loaded{where, {}};
  const bool has_faces = std::any_of(file.meshes.begin(), file.meshes.end(),
                                     [](const DeclaredMesh& m) { return m.faces > 0; });
  if (has_faces) {
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFileFromMemory(file.bytes.data(), file.bytes.size(),
                                                       aiProcess_Triangulate, "3ds");
    if (scene == nullptr || scene->mRootNode == nullptr) {
      throw UserError(where, fmt::format("cannot be read: {}", importer.GetErrorString()),
                      "The file is damaged: export it again.");
    }
    std::map<std::string, int> used;
    for (auto& [name, mesh] : Gatherer(*scene, file, options.metres_per_unit).run()) {
      loaded.objects.push_back({unique_name(name, used), check_closed(mesh)});
    }
  }
  add_faceless(file, loaded);
  if (loaded.objects.empty()) {
    throw UserError(where, "holds no mesh (cameras and lights are not bodies)",
                    "Export the objects as triangle meshes.");
  }
  return loaded;
}

LoadedFile load_3ds(const std::filesystem::path& path, const Load3dsOptions& options) {
  return parse_3ds(read_bytes(path), path.string(), options);
}

}  // namespace tumble
