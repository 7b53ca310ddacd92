/// Defects of a surface that should bound a solid.
#pragma once

#include <string>

namespace tumble {

enum class DefectKind {
  kNoFaces,
  kBadIndex,       // a face refers to a vertex that does not exist
  kNotFinite,      // NaN or infinite coordinate
  kSinglePolygon,  // open and flat
  kTerrain,        // open, and every normal points up
  kMissingFace,    // one or more holes in an otherwise closed surface
  // one polygon thick: a tube open at both ends, or two layers of faces back to back
  kLampshade,
  kRepeatedFace,  // the same face twice, with the same orientation
  // corners that single precision has merged: faces without area, and others back to back
  kMergedCorners,
  kCrack,            // open edges close beside each other
  kEdgeOfManyFaces,  // three or more faces at an edge
  kOrientation,      // neighbours disagree on which side is outside
  kOneSided,         // like a Moebius strip: no choice of sides exists
  // a part inside another that is not a cavity of it: its volume would count twice
  kNestedOutward,
  kZeroVolume,
  // so long and thin that its moment about its length is lost in double precision
  kNeedle,
  kSelfCrossing,  // shells pass through each other, or one through itself
};

/// One defect of a surface.
struct Defect {
  DefectKind kind;
  std::string problem;  // what and where: "2 open edges, the first at (0, 0, 1)-(1, 0, 1)"
  std::string remedy;
};

}  // namespace tumble
