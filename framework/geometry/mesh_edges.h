/// Which faces share an edge: the basis of the closed check and of the tests for convexity and open
/// edges.
#pragma once

#include <string>
#include <vector>

#include "framework/core/disjoint_sets.h"
#include "framework/geometry/triangle_mesh.h"

namespace tumble {

/// One use of an edge by a face.
struct EdgeUse {
  int low, high;  // vertices, low < high
  int face;
  int corner;    // the edge goes from faces[face][corner] to the face's next corner
  bool forward;  // from low to high
};

/// Every use of every edge, sorted by (low, high, face), so that uses of the same edge are
/// adjacent. Cost: O(n log n)
std::vector<EdgeUse> edge_uses(const TriangleMesh& mesh);

/// Calls group(first, last) for every run of uses of the same edge, in order.
template <class Group>
void for_each_edge(const std::vector<EdgeUse>& uses, Group group) {
  for (std::size_t first = 0; first < uses.size();) {
    std::size_t last = first + 1;
    while (last < uses.size() && uses[last].low == uses[first].low &&
           uses[last].high == uses[first].high)
      ++last;
    group(uses.data() + first, uses.data() + last);
    first = last;
  }
}

/// "(0, 0.5, 1)": a place in messages.
std::string show_point(const Vector3d& point);
/// "(0, 0, 1)-(1, 0, 1)"
std::string show_edge(const TriangleMesh& mesh, int from, int to);

}  // namespace tumble
