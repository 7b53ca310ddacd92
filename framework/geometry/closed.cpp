#include "framework/geometry/closed.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "framework/geometry/crossings.h"
#include "framework/geometry/mass_properties.h"
#include "framework/geometry/mesh_edges.h"
#include "framework/geometry/open_surface.h"
#include "framework/geometry/parts.h"

namespace tumble {
namespace {

// Sine of a face's smallest angle, below which its area is round-off: coordinates are rounded to
// 2^-53, and the cross product adds a few such errors.
constexpr double kZeroArea = 1e-15;

// Smallest over largest principal moment. Below this ratio the rounding of the large one (about 10
// eps) exceeds 1/500 of the small one. A round rod reaches it at a length of a million radii.
constexpr double kNeedle = 1e-12;

// Rounding error of an integral whose exact value is zero, relative to the largest moment: sums
// over a million faces of both signs, 1e4 eps. A plate falls below it at a thickness of a millionth
// of its width.
constexpr double kRoundedMoment = 1e-12;

constexpr double kSingleSpacing = 0x1.0p-23;  // of float32 numbers, relative

std::string plural(std::size_t n, const char* one, const char* many) {
  return fmt::format("{} {}", n, n == 1 ? one : many);
}

// Defects that make every later test meaningless: no faces, indices out of range, numbers that are
// not finite.
std::vector<Defect> find_unusable(const TriangleMesh& mesh) {
  if (mesh.faces.empty()) {
    return {{DefectKind::kNoFaces, "no faces",
             "A rigid body needs a closed surface: model one, or leave the object out."}};
  }
  const int n = static_cast<int>(mesh.vertices.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    for (int v : mesh.faces[f]) {
      if (v >= 0 && v < n) continue;
      return {
          {DefectKind::kBadIndex,
           fmt::format("face {} refers to vertex {}, but the vertices are 0 to {}", f, v, n - 1),
           "The file is damaged: export it again."}};
    }
  }
  for (int v = 0; v < n; ++v) {
    if (mesh.vertices[v].allFinite()) continue;
    return {{DefectKind::kNotFinite,
             fmt::format("vertex {} is not finite: {}", v, show_point(mesh.vertices[v])),
             "The file is damaged: export it again."}};
  }
  return {};
}

bool has_area(const TriangleMesh& mesh, const Face& face) {
  const Vector3d u = mesh.vertices[face[1]] - mesh.vertices[face[0]];
  const Vector3d v = mesh.vertices[face[2]] - mesh.vertices[face[0]];
  return u.cross(v).norm() > kZeroArea * u.norm() * v.norm();
}

template <class Keep>
TriangleMesh keep_faces(const TriangleMesh& mesh, Keep keep) {
  TriangleMesh kept{mesh.vertices, {}};
  std::copy_if(mesh.faces.begin(), mesh.faces.end(), std::back_inserter(kept.faces), keep);
  return kept;
}

// Faces on the same three vertices: the same face twice, or two back to back with nothing between
// them.
struct CoincidentFaces {
  std::size_t repeated = 0, back_to_back = 0;  // faces that can be dropped
  std::pair<int, int> first_repeated{-1, -1}, first_back_to_back{-1, -1};
  // by face: without these each place has one face or none
  std::vector<char> droppable;
};

/// Whether the face's corners are an even permutation of ascending order.
bool is_even(const Face& f) { return (f[0] < f[1]) + (f[1] < f[2]) + (f[2] < f[0]) == 2; }

CoincidentFaces find_coincident(const TriangleMesh& mesh) {
  CoincidentFaces found;
  found.droppable.assign(mesh.faces.size(), 0);
  std::map<Face, std::vector<int>> kept;  // by sorted corners: the face that stays, if any
  for (int f = 0; f < static_cast<int>(mesh.faces.size()); ++f) {
    Face sorted = mesh.faces[f];
    std::sort(sorted.begin(), sorted.end());
    std::vector<int>& here = kept[sorted];
    if (here.empty()) {
      here.push_back(f);
      continue;
    }
    const bool is_same = is_even(mesh.faces[here.back()]) == is_even(mesh.faces[f]);
    std::pair<int, int>& first = is_same ? found.first_repeated : found.first_back_to_back;
    if (first.first < 0) first = {here.back(), f};
    found.droppable[f] = 1;
    if (is_same) {
      ++found.repeated;
    } else {
      found.droppable[here.back()] = 1;
      found.back_to_back += 2;
      here.pop_back();
    }
  }
  return found;
}

std::string show_middle(const TriangleMesh& mesh, int face) {
  const auto& [a, b, c] = mesh.faces[face];
  return show_point((mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]) / 3.0);
}

/// @param lines  number of faces that were dropped because two of their corners had merged
std::vector<Defect> describe_coincident(const TriangleMesh& mesh, std::size_t lines) {
  const CoincidentFaces found = find_coincident(mesh);
  const auto& [same_a, same_b] = found.first_repeated;
  const auto& [front, back] = found.first_back_to_back;
  std::vector<Defect> defects;
  if (found.repeated > 0)
    defects.push_back({DefectKind::kRepeatedFace,
                       fmt::format("{}: face {} repeats face {}, at {}",
                                   plural(found.repeated, "duplicate face", "duplicate faces"),
                                   same_b, same_a, show_middle(mesh, same_a)),
                       "Remove the duplicates (\"remove doubles\" in the modelling program)."});
  if (found.back_to_back > 0 && lines > 0) {
    const Bounds bounds = bounds_of(mesh);
    const double far =
        std::max(bounds.low.cwiseAbs().maxCoeff(), bounds.high.cwiseAbs().maxCoeff());
    defects.push_back({DefectKind::kMergedCorners,
                       fmt::format("corners have merged: {} no area left, and faces {} and {} lie "
                                   "on each other at {}; a .3ds file holds single precision, which "
                                   "at coordinates of {:.3g} m cannot resolve less than "
                                   "{:.2g} m",
                                   plural(lines, "face has", "faces have"), front, back,
                                   show_middle(mesh, front), far, kSingleSpacing * far),
                       "Model it near the origin (a scene places it by \"position_m\"), or make "
                       "thin places thicker."});
  } else if (found.back_to_back > 0) {
    defects.push_back({DefectKind::kLampshade,
                       fmt::format("a wall one polygon thick, like a lampshade: {} on another, the "
                                   "first two are faces {} and {} at {}",
                                   plural(found.back_to_back / 2, "face lies", "faces lie"), front,
                                   back, show_middle(mesh, front)),
                       "Give the wall a thickness, or remove one of its two layers."});
  }
  return defects;
}

std::vector<Defect> find_edges_of_many_faces(const TriangleMesh& mesh,
                                             const std::vector<EdgeUse>& uses) {
  std::size_t count = 0;
  std::string first;
  for_each_edge(uses, [&](const EdgeUse* begin, const EdgeUse* end) {
    if (end - begin <= 2 || count++ > 0) return;
    first = fmt::format("{} belongs to {} faces", show_edge(mesh, begin->low, begin->high),
                        end - begin);
  });
  if (count == 0) return {};
  return {{DefectKind::kEdgeOfManyFaces,
           fmt::format("{} of three or more faces, the first: {}", plural(count, "edge", "edges"),
                       first),
           "Remove inner walls, and separate parts that touch along an edge."}};
}

// Propagates an orientation over each part. Where both faces of an edge traverse it in the same
// direction, one of them must be reversed.
std::vector<Defect> find_disagreement(const TriangleMesh& mesh, const std::vector<EdgeUse>& uses) {
  const int n = static_cast<int>(mesh.faces.size());
  std::vector<std::vector<std::pair<int, bool>>> neighbours(n);
  std::size_t count = 0;
  std::string first;
  for_each_edge(uses, [&](const EdgeUse* begin, const EdgeUse* end) {
    if (end - begin != 2) return;
    const bool disagree = begin[0].forward == begin[1].forward;
    neighbours[begin[0].face].push_back({begin[1].face, disagree});
    neighbours[begin[1].face].push_back({begin[0].face, disagree});
    if (disagree && count++ == 0)
      first = fmt::format("faces {} and {} at {}", begin[0].face, begin[1].face,
                          show_edge(mesh, begin->low, begin->high));
  });
  if (count == 0) return {};

  constexpr int kUnvisited = -1;
  std::vector<int> turned(n, kUnvisited);
  for (int start = 0; start < n; ++start) {
    if (turned[start] != kUnvisited) continue;
    turned[start] = 0;
    std::vector<int> to_do{start};
    while (!to_do.empty()) {
      const int f = to_do.back();
      to_do.pop_back();
      for (const auto& [g, disagree] : neighbours[f]) {
        const int wanted = turned[f] ^ (disagree ? 1 : 0);
        if (turned[g] == kUnvisited) {
          turned[g] = wanted;
          to_do.push_back(g);
        } else if (turned[g] != wanted) {
          return {{DefectKind::kOneSided,
                   "a one-sided surface (like a Moebius strip): no choice of inside exists; " +
                       first + " disagree however they are oriented",
                   "A solid has an inside: cut the strip and close it differently."}};
        }
      }
    }
  }
  return {{DefectKind::kOrientation,
           fmt::format("faces disagree on which side is outside along {}, the first: {}",
                       plural(count, "edge", "edges"), first),
           "Unify the normals in the modelling program, all outward."}};
}

std::vector<int> parts_by_edges(const TriangleMesh& mesh, const std::vector<EdgeUse>& uses) {
  DisjointSets sets(static_cast<int>(mesh.faces.size()));
  for_each_edge(uses, [&](const EdgeUse* begin, const EdgeUse* end) {
    for (const EdgeUse* use = begin + 1; use < end; ++use) sets.unite(begin->face, use->face);
  });
  std::vector<int> part(mesh.faces.size());
  for (std::size_t f = 0; f < part.size(); ++f) part[f] = sets.find(static_cast<int>(f));
  return part;
}

void append(std::vector<Defect>& to, std::vector<Defect> more) {
  to.insert(to.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

std::vector<Defect> find_impossible_mass(const TriangleMesh& closed_mesh) {
  const MassProperties mass = compute_mass_properties(closed_mesh);
  const Vector3d& moments = mass.principal_moments;  // ascending
  const double ratio = moments[0] / moments[2];
  const Bounds bounds = bounds_of(closed_mesh);
  const Vector3d& com = mass.com_mesh;
  // The eigenvalues of int x x' are integrals of squares, positive for every solid. In terms of the
  // moments: (I_1 + I_2 - I_3) / 2 etc.
  const double least_square = 0.5 * (moments[0] + moments[1] - moments[2]);
  std::string impossible;
  if ((com.array() < bounds.low.array()).any() || (com.array() > bounds.high.array()).any())
    impossible =
        fmt::format("the centre of mass would be at {}, outside the surface", show_point(com));
  else if (moments[2] <= 0.0 || least_square < -kRoundedMoment * moments[2])
    impossible = fmt::format(
        "the rest would have moments of inertia {:.3g}, {:.3g} and {:.3g} (at density 1), which no "
        "solid has",
        moments[0], moments[1], moments[2]);
  if (!impossible.empty()) {
    return {{DefectKind::kSelfCrossing,
             "faces pass through each other: parts of the inside cancel, and " + impossible,
             "Separate the crossing faces in the modelling program."}};
  }
  if (ratio >= kNeedle) return {};
  return {
      {DefectKind::kNeedle,
       fmt::format(
           "a needle from {} to {}: its moments of inertia are too far apart for double precision",
           show_point(bounds.low), show_point(bounds.high)),
       "Look for a vertex far from the others, or make it thicker."}};
}

// Every check of a mesh that find_unusable accepts.
// @param lines  number of faces that were dropped because they had a vertex twice
ClosedReport examine(const TriangleMesh& mesh, std::size_t lines) {
  ClosedReport report;
  report.mesh = mesh;
  const std::vector<EdgeUse> uses = edge_uses(mesh);
  const std::vector<int> part_of_face = parts_by_edges(mesh, uses);
  report.parts = static_cast<int>(std::set<int>(part_of_face.begin(), part_of_face.end()).size());

  append(report.defects, describe_coincident(mesh, lines));
  if (report.defects.empty()) append(report.defects, find_edges_of_many_faces(mesh, uses));
  append(report.defects, describe_open_edges(mesh, uses, part_of_face));
  append(report.defects, find_disagreement(mesh, uses));
  if (!report.is_closed()) return report;

  report.mesh = double_pinched_vertices(mesh, uses, report.notices);
  append(report.defects, find_crossings(report.mesh, part_of_face, report.notices));
  if (report.is_closed())
    append(report.defects, orient_parts(part_of_face, report.mesh, report.notices));
  if (report.is_closed()) append(report.defects, find_impossible_mass(report.mesh));
  if (!report.is_closed()) report.mesh = mesh;
  return report;
}

}  // namespace

ClosedReport check_closed(const TriangleMesh& mesh) {
  if (std::vector<Defect> unusable = find_unusable(mesh); !unusable.empty())
    return {std::move(unusable), {}, mesh, 0};

  // A face with a repeated vertex is not a triangle.
  std::vector<std::string> notices;
  const TriangleMesh triangles =
      keep_faces(mesh, [](const Face& f) { return f[0] != f[1] && f[1] != f[2] && f[2] != f[0]; });
  const std::size_t lines = mesh.faces.size() - triangles.faces.size();
  if (lines > 0)
    notices.push_back(
        fmt::format("dropped {} with a repeated vertex", plural(lines, "face", "faces")));
  if (triangles.faces.empty()) {
    return {{{DefectKind::kNoFaces, "no face has an area",
              "Model a surface: lines and points bound no volume."}},
            notices,
            mesh,
            0};
  }

  ClosedReport report = examine(triangles, lines);
  // Without duplicate faces, and faces back to back, the rest may be a solid.
  const CoincidentFaces coincident = find_coincident(triangles);
  if (coincident.repeated + coincident.back_to_back > 0) {
    TriangleMesh rest{triangles.vertices, {}};
    for (std::size_t f = 0; f < triangles.faces.size(); ++f)
      if (coincident.droppable[f] == 0) rest.faces.push_back(triangles.faces[f]);
    ClosedReport repaired = rest.faces.empty() ? ClosedReport{report} : examine(rest, lines);
    if (repaired.is_closed()) {
      const auto& [front, back] = coincident.first_back_to_back;
      if (coincident.repeated > 0)
        notices.push_back(
            fmt::format("dropped {}, the first: face {}, which repeats face {} at {}",
                        plural(coincident.repeated, "duplicate face", "duplicate faces"),
                        coincident.first_repeated.second, coincident.first_repeated.first,
                        show_middle(triangles, coincident.first_repeated.first)));
      if (coincident.back_to_back > 0)
        notices.push_back(fmt::format(
            "dropped {} back to back with nothing between them, the first: {} and {} at {}",
            plural(coincident.back_to_back, "face that lay", "faces that lay"), front, back,
            show_middle(triangles, front)));
      repaired.notices.insert(repaired.notices.begin(), notices.begin(), notices.end());
      return repaired;
    }
  }

  // Faces of zero area may close a seam (then they stay) or break the surface (then they are
  // dropped).
  const auto is_about_size = [](const Defect& d) {
    return d.kind == DefectKind::kZeroVolume || d.kind == DefectKind::kNeedle ||
           d.kind == DefectKind::kSelfCrossing;
  };
  if (!report.is_closed() && !is_about_size(report.defects.front())) {
    const TriangleMesh solid_faces =
        keep_faces(triangles, [&](const Face& f) { return has_area(triangles, f); });
    const std::size_t flat = triangles.faces.size() - solid_faces.faces.size();
    if (flat > 0 && !solid_faces.faces.empty()) {
      report = examine(solid_faces, lines + flat);
      notices.push_back(fmt::format("dropped {} of zero area", plural(flat, "face", "faces")));
    }
  }
  report.notices.insert(report.notices.begin(), notices.begin(), notices.end());
  return report;
}

}  // namespace tumble
