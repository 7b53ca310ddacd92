#include "framework/geometry/parts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include <fmt/format.h>

#include "framework/geometry/mass_properties.h"

namespace tumble {
namespace {

// A part is flat where its volume is below this times area^1.5: a plate of relative thickness 1e-10
// is 500 times thinner than float32 resolves.
constexpr double kFlatPart = 1e-10;
// about 5 s; with thousands of parts inside each other not all are tested
constexpr double kMostSolidAngles = 5e7;

struct Part {
  TriangleMesh mesh;
  std::vector<int> faces;  // in the whole mesh
  Bounds bounds;
  double volume = 0.0;
  int depth = 0;  // how many other parts it lies in
};

double area_of(const TriangleMesh& mesh) {
  double doubled = 0.0;
  for (const auto& [a, b, c] : mesh.faces) {
    doubled +=
        (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).norm();
  }
  return 0.5 * doubled;
}

// Bound on the rounding error of the volume: each of n terms d = a . ((b - a) x (c - a)) / 6 is off
// by a few eps of the product of its lengths, and their sum by n eps more. The volume of a stone of
// 1 m with a spike of length 1e31 is nothing but rounding.
double rounding_of_volume(const Part& part) {
  const Vector3d middle = 0.5 * (part.bounds.low + part.bounds.high);
  double lengths = 0.0;
  for (const auto& [i, j, k] : part.mesh.faces) {
    const Vector3d &a = part.mesh.vertices[i], &b = part.mesh.vertices[j],
                   &c = part.mesh.vertices[k];
    lengths += (a - middle).norm() * (b - a).norm() * (c - a).norm() / 6.0;
  }
  constexpr double kTerm = 16.0;  // eps: three differences, three products, five sums
  return (kTerm + static_cast<double>(part.mesh.faces.size())) *
         std::numeric_limits<double>::epsilon() * lengths;
}

std::vector<Part> split(const TriangleMesh& mesh, const std::vector<int>& part_of_face) {
  std::map<int, int> number;
  std::vector<Part> parts;
  for (int f = 0; f < static_cast<int>(mesh.faces.size()); ++f) {
    const auto [place, is_new] =
        number.try_emplace(part_of_face[f], static_cast<int>(parts.size()));
    if (is_new) parts.emplace_back();
    parts[place->second].faces.push_back(f);
  }
  for (Part& part : parts) {
    std::map<int, int> vertex;
    for (int f : part.faces) {
      Face& face = part.mesh.faces.emplace_back();
      for (int corner = 0; corner < 3; ++corner) {
        const int v = mesh.faces[f][corner];
        const auto [place, is_new] =
            vertex.try_emplace(v, static_cast<int>(part.mesh.vertices.size()));
        if (is_new) part.mesh.vertices.push_back(mesh.vertices[v]);
        face[corner] = place->second;
      }
    }
    part.bounds = bounds_of(part.mesh);
    part.volume = signed_volume(part.mesh);
  }
  return parts;
}

bool holds(const Bounds& outer, const Bounds& inner) {
  return (outer.low.array() <= inner.low.array()).all() &&
         (outer.high.array() >= inner.high.array()).all();
}

void find_depths(std::vector<Part>& parts, std::vector<std::string>& notices) {
  double work = 0.0;
  for (Part& inner : parts) {
    for (const Part& outer : parts) {
      if (&outer == &inner || !holds(outer.bounds, inner.bounds)) continue;
      work += static_cast<double>(outer.mesh.faces.size());
      if (work > kMostSolidAngles) {
        notices.push_back(
            "too many parts inside each other: a part counts as a cavity where its faces point "
            "inward");
        for (Part& part : parts) part.depth = part.volume < 0.0 ? 1 : 0;
        return;
      }
      if (std::abs(winding_number(outer.mesh, inner.mesh.vertices.front())) > 0.5) ++inner.depth;
    }
  }
}

void flip(const Part& part, TriangleMesh& mesh) {
  for (int f : part.faces) std::swap(mesh.faces[f][1], mesh.faces[f][2]);
}

std::string place_of(const Part& part) {
  return fmt::format("the part of {} faces about {}", part.faces.size(),
                     show_point(0.5 * (part.bounds.low + part.bounds.high)));
}

// Flat parts, and spikes whose volume is lost in rounding.
std::vector<Defect> find_without_volume(const std::vector<Part>& parts) {
  std::vector<Defect> defects;
  for (const Part& part : parts) {
    const std::string what = parts.size() == 1 ? "the surface is closed but" : place_of(part);
    if (std::abs(part.volume) <= kFlatPart * std::pow(area_of(part.mesh), 1.5)) {
      defects.push_back({DefectKind::kZeroVolume, what + " encloses no volume: it is flat",
                         "Give it a thickness, or remove it."});
    } else if (std::abs(part.volume) <= rounding_of_volume(part)) {
      defects.push_back(
          {DefectKind::kNeedle,
           fmt::format("{} is a needle from {} to {}: its volume is lost in rounding", what,
                       show_point(part.bounds.low), show_point(part.bounds.high)),
           "Look for a vertex far from the others, or make it thicker."});
    }
  }
  return defects;
}

}  // namespace

double winding_number(const TriangleMesh& mesh, const Vector3d& point) {
  double solid_angle = 0.0;
  for (const auto& [i, j, k] : mesh.faces) {
    const Vector3d a = mesh.vertices[i] - point, b = mesh.vertices[j] - point,
                   c = mesh.vertices[k] - point;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    const double numerator = a.dot(b.cross(c));
    const double denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    solid_angle += 2.0 * std::atan2(numerator, denominator);
  }
  return solid_angle / (4.0 * std::numbers::pi);
}

TriangleMesh double_pinched_vertices(const TriangleMesh& mesh, const std::vector<EdgeUse>& uses,
                                     std::vector<std::string>& notices) {
  // Corners of neighbouring faces at the ends of their common edge are the same corner of the
  // surface.
  const int corners = 3 * static_cast<int>(mesh.faces.size());
  DisjointSets sets(corners);
  for_each_edge(uses, [&](const EdgeUse* begin, const EdgeUse*) {
    for (int vertex : {begin->low, begin->high}) {
      int corner_of[2];
      for (int side = 0; side < 2; ++side) {
        const Face& face = mesh.faces[begin[side].face];
        corner_of[side] =
            3 * begin[side].face +
            static_cast<int>(std::find(face.begin(), face.end(), vertex) - face.begin());
      }
      sets.unite(corner_of[0], corner_of[1]);
    }
  });

  // One new vertex for each fan, in the order of the old vertices.
  std::map<std::pair<int, int>, int> fans;  // (old vertex, smallest corner) -> new vertex
  for (int corner = 0; corner < corners; ++corner)
    fans[{mesh.faces[corner / 3][corner % 3], sets.find(corner)}] = 0;
  TriangleMesh result{{}, mesh.faces};
  std::string first;
  int doubled = 0, previous = -1;
  for (auto& [fan, vertex] : fans) {
    vertex = static_cast<int>(result.vertices.size());
    result.vertices.push_back(mesh.vertices[fan.first]);
    if (fan.first == previous && doubled++ == 0) first = show_point(mesh.vertices[fan.first]);
    previous = fan.first;
  }
  for (int corner = 0; corner < corners; ++corner) {
    result.faces[corner / 3][corner % 3] =
        fans[{mesh.faces[corner / 3][corner % 3], sets.find(corner)}];
  }
  if (doubled > 0)
    notices.push_back(
        fmt::format("the surface touches itself at {} corner{}, the first at {}: doubled there",
                    doubled, doubled == 1 ? "" : "s", first));
  return result;
}

std::vector<Defect> orient_parts(const std::vector<int>& part_of_face, TriangleMesh& mesh,
                                 std::vector<std::string>& notices) {
  std::vector<Part> parts = split(mesh, part_of_face);
  if (std::vector<Defect> nothing = find_without_volume(parts); !nothing.empty()) return nothing;
  find_depths(parts, notices);

  // Solids and cavities alternate from the outside inward: volumes have the signs +, -, +, ...
  const auto is_wrong = [](const Part& part) {
    return (part.volume < 0.0) != (part.depth % 2 == 1);
  };
  const auto wrong = std::count_if(parts.begin(), parts.end(), is_wrong);
  const bool all_wrong = wrong == static_cast<std::ptrdiff_t>(parts.size());
  std::vector<Defect> defects;
  for (const Part& part : parts) {
    if (!is_wrong(part)) continue;
    if (all_wrong || part.depth == 0) {
      flip(part, mesh);
      if (!all_wrong) notices.push_back(place_of(part) + " was inside out: its faces were flipped");
    } else {
      defects.push_back(
          {DefectKind::kNestedOutward,
           place_of(part) +
               " lies inside another part and is not a cavity: its volume would count twice",
           "Remove it, or flip its faces if it is meant as a cavity."});
    }
  }
  if (all_wrong) notices.push_back("the surface was inside out: all its faces were flipped");
  return defects;
}

}  // namespace tumble
