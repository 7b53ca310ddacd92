// Open edges classified: cracks, a single polygon, a lampshade, a terrain, a missing face.
#include "framework/geometry/open_surface.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include <fmt/format.h>

namespace tumble {
namespace {

// of an open edge's length: nearer to another open edge than this is a crack
constexpr double kCrackWidth = 0.05;
// open edges compared pairwise: 9 million distances take about 0.1 s
constexpr std::size_t kMostCompared = 3000;
// of the part's size: above the scatter of a flat polygon's float32 coordinates
constexpr double kFlat = 1e-6;
// a tree of a thousand leaves needs no thousand messages
constexpr std::size_t kMostPartsNamed = 5;

struct OpenEdge {
  int from, to;  // in the order of its face
  int face;
  bool in_crack = false;
  double width = 0;  // to the nearest other open edge, where in_crack [m]
};

double distance_to_segment(const Vector3d& point, const Vector3d& a, const Vector3d& b) {
  const Vector3d along = b - a;
  const double length_squared = along.squaredNorm();
  const double t =
      length_squared > 0.0 ? std::clamp((point - a).dot(along) / length_squared, 0.0, 1.0) : 0.0;
  return (point - a - t * along).norm();
}

std::vector<OpenEdge> find_open_edges(const TriangleMesh& mesh, const std::vector<EdgeUse>& uses) {
  std::vector<OpenEdge> open;
  for_each_edge(uses, [&](const EdgeUse* first, const EdgeUse* last) {
    if (last - first != 1) return;
    const Face& face = mesh.faces[first->face];
    open.push_back({face[first->corner], face[(first->corner + 1) % 3], first->face});
  });
  return open;
}

// An open edge is part of a crack where its midpoint is close to another open edge: corners that
// should coincide differ, or an edge of one face ends in the middle of another's.
void mark_cracks(const TriangleMesh& mesh, std::vector<OpenEdge>& open) {
  const std::size_t n = std::min(open.size(), kMostCompared);
  for (std::size_t i = 0; i < n; ++i) {
    const Vector3d& a = mesh.vertices[open[i].from];
    const Vector3d& b = mesh.vertices[open[i].to];
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < n; ++j) {
      if (j == i) continue;
      nearest = std::min(nearest, distance_to_segment(0.5 * (a + b), mesh.vertices[open[j].from],
                                                      mesh.vertices[open[j].to]));
    }
    open[i].in_crack = nearest <= kCrackWidth * (b - a).norm();
    open[i].width = nearest;
  }
}

// One connected part and its open edges.
struct OpenPart {
  std::vector<int> faces;
  std::vector<OpenEdge> edges;
};

std::map<int, OpenPart> group_by_part(const TriangleMesh& mesh, const std::vector<OpenEdge>& open,
                                      const std::vector<int>& part_of_face) {
  std::map<int, OpenPart> parts;
  for (const OpenEdge& edge : open) parts[part_of_face[edge.face]].edges.push_back(edge);
  for (int f = 0; f < static_cast<int>(mesh.faces.size()); ++f) {
    if (const auto found = parts.find(part_of_face[f]); found != parts.end())
      found->second.faces.push_back(f);
  }
  return parts;
}

Vector3d area_vector(const TriangleMesh& mesh, int face) {
  const auto& [a, b, c] = mesh.faces[face];
  return 0.5 * (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
}

bool is_flat(const TriangleMesh& mesh, const std::vector<int>& faces) {
  Vector3d normal = Vector3d::Zero();
  for (int f : faces) {
    const Vector3d area = area_vector(mesh, f);
    normal += normal.dot(area) < 0.0 ? Vector3d(-area) : area;
  }
  normal.normalize();
  const Vector3d& origin = mesh.vertices[mesh.faces[faces.front()][0]];
  double size = 0.0, height = 0.0;
  for (int f : faces) {
    for (int v : mesh.faces[f]) {
      size = std::max(size, (mesh.vertices[v] - origin).norm());
      height = std::max(height, std::abs(normal.dot(mesh.vertices[v] - origin)));
    }
  }
  return height <= kFlat * size;
}

bool all_normals_point_up(const TriangleMesh& mesh, const std::vector<int>& faces) {
  const bool up = area_vector(mesh, faces.front()).z() > 0.0;
  return std::all_of(faces.begin(), faces.end(), [&](int f) {
    const Vector3d area = area_vector(mesh, f);
    return (up ? area.z() : -area.z()) > kFlat * area.norm();
  });
}

int count_rims(const std::vector<OpenEdge>& edges) {
  std::map<int, int> number;
  for (const OpenEdge& edge : edges) {
    number.try_emplace(edge.from, static_cast<int>(number.size()));
    number.try_emplace(edge.to, static_cast<int>(number.size()));
  }
  DisjointSets sets(static_cast<int>(number.size()));
  for (const OpenEdge& edge : edges) sets.unite(number[edge.from], number[edge.to]);
  std::set<int> rims;
  for (const auto& [vertex, i] : number) rims.insert(sets.find(i));
  return static_cast<int>(rims.size());
}

// Vertices - edges + faces: 0 for a tube open at both ends, 1 for a sheet or a box without its lid.
int euler_characteristic(const TriangleMesh& mesh, const OpenPart& part) {
  std::set<int> vertices;
  for (int f : part.faces) vertices.insert(mesh.faces[f].begin(), mesh.faces[f].end());
  const int faces = static_cast<int>(part.faces.size());
  const int edges = (3 * faces + static_cast<int>(part.edges.size())) / 2;
  return static_cast<int>(vertices.size()) - edges + faces;
}

Defect describe_part(const TriangleMesh& mesh, const OpenPart& part) {
  const OpenEdge& first = part.edges.front();
  const std::string place =
      fmt::format("{} open edge{}, the first at {}", part.edges.size(),
                  part.edges.size() == 1 ? "" : "s", show_edge(mesh, first.from, first.to));
  const int rims = count_rims(part.edges);
  if (is_flat(mesh, part.faces)) {
    return {DefectKind::kSinglePolygon,
            fmt::format("a single polygon ({} triangle{} in one plane) bounds no volume: {}",
                        part.faces.size(), part.faces.size() == 1 ? "" : "s", place),
            "Extrude it, so that it gets thickness and a back."};
  }
  if (rims == 2 && euler_characteristic(mesh, part) == 0) {
    return {DefectKind::kLampshade,
            "a lampshade, one polygon thick and open at both ends: " + place,
            "Cap both ends to make it solid, or give the wall a thickness."};
  }
  // All faces of a pyramid without its base point up too: four open edges or fewer are a missing
  // face rather than the rim of a terrain.
  if (rims == 1 && part.edges.size() > 4 && all_normals_point_up(mesh, part.faces)) {
    return {DefectKind::kTerrain,
            "a terrain: every face points to the same side of the horizon and the rim is open: " +
                place,
            "Add walls and a bottom, or use a plane or a box as the ground."};
  }
  return {DefectKind::kMissingFace,
          fmt::format("{} (a face is missing): {}",
                      rims == 1 ? "a hole" : fmt::format("{} holes", rims), place),
          "Cap the hole: a rigid body needs a closed surface."};
}

Defect describe_cracks(const TriangleMesh& mesh, const std::vector<OpenEdge>& open) {
  std::size_t count = 0;
  double widest = 0.0;
  const OpenEdge* first = nullptr;
  for (const OpenEdge& edge : open) {
    if (!edge.in_crack) continue;
    if (first == nullptr) first = &edge;
    widest = std::max(widest, edge.width);
    ++count;
  }
  return {DefectKind::kCrack,
          fmt::format("cracks: {} open edges run beside other open edges (at most {:.3g} m apart), "
                      "the first at {}",
                      count, widest, show_edge(mesh, first->from, first->to)),
          "Merge the corners that should be one, and let edges meet at corners only."};
}

}  // namespace

std::vector<Defect> describe_open_edges(const TriangleMesh& mesh, const std::vector<EdgeUse>& uses,
                                        const std::vector<int>& part_of_face) {
  std::vector<OpenEdge> open = find_open_edges(mesh, uses);
  if (open.empty()) return {};
  mark_cracks(mesh, open);

  // Parts that are mostly cracked share one description; every other part gets its own.
  std::vector<Defect> defects;
  bool has_cracks = false;
  std::size_t unnamed = 0;
  for (const auto& [name, part] : group_by_part(mesh, open, part_of_face)) {
    const auto cracked = std::count_if(part.edges.begin(), part.edges.end(),
                                       [](const OpenEdge& e) { return e.in_crack; });
    if (2 * static_cast<std::size_t>(cracked) >= part.edges.size())
      has_cracks = true;
    else if (defects.size() < kMostPartsNamed)
      defects.push_back(describe_part(mesh, part));
    else
      ++unnamed;
  }
  if (unnamed > 0)
    defects.back().problem += fmt::format("; and {} more open parts like it", unnamed);
  if (has_cracks) defects.push_back(describe_cracks(mesh, open));
  return defects;
}

}  // namespace tumble
