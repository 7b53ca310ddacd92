// The closed check: one test for each refusal, with the words that a user reads, and for each
// repair.
#include <limits>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/shortest_turn.h"
#include "framework/geometry/closed.h"
#include "framework/geometry/mass_properties.h"
#include "framework/geometry/shape.h"
#include "framework/geometry/solid.h"
#include "models/catalogue.h"
#include "models/surfaces.h"

namespace tumble::testing {
namespace {

TriangleMesh unit_box() { return models::box({0, 0, 0}, {1, 1, 1}); }

TriangleMesh broken(const std::string& name) {
  for (const models::Model& model : models::broken_catalogue()) {
    if (model.file == "broken/" + name + ".3ds") return model.objects.front().mesh;
  }
  ADD_FAILURE() << "no model broken/" << name;
  return {};
}

TriangleMesh joined(TriangleMesh a, const TriangleMesh& b) {
  const int first = static_cast<int>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const Face& f : b.faces) a.faces.push_back({first + f[0], first + f[1], first + f[2]});
  return a;
}

TriangleMesh turned_inside_out(TriangleMesh mesh) {
  for (Face& face : mesh.faces) std::swap(face[1], face[2]);
  return mesh;
}

/// The first defect has this kind, contains these words, and has a remedy.
void expect_refused(const TriangleMesh& mesh, DefectKind kind, const std::string& words,
                    const std::string& place) {
  const ClosedReport report = check_closed(mesh);
  ASSERT_FALSE(report.is_closed()) << "accepted, but should say: " << words;
  const Defect& defect = report.defects.front();
  EXPECT_EQ(defect.kind, kind) << defect.problem;
  EXPECT_NE(defect.problem.find(words), std::string::npos)
      << "says: " << defect.problem << "\nexpected the words: " << words;
  EXPECT_NE(defect.problem.find(place), std::string::npos)
      << "says: " << defect.problem << "\nexpected the place: " << place;
  EXPECT_FALSE(defect.remedy.empty());
}

TEST(Closed, SinglePolygonIsRefused) {
  expect_refused(broken("single_polygon"), DefectKind::kSinglePolygon, "a single polygon",
                 "(0, 0, 0)-(1, 0, 0)");
}
TEST(Closed, TerrainIsRefused) {
  expect_refused(broken("terrain"), DefectKind::kTerrain, "a terrain",
                 "(0, 0, 0)-(0.25, 0, 0.133681)");
}
TEST(Closed, MissingFaceIsRefused) {
  expect_refused(broken("missing_face"), DefectKind::kMissingFace, "a face is missing",
                 "(0.5, -0.5, 0.5)-(-0.5, -0.5, 0.5)");
}
TEST(Closed, CracksAreRefused) {
  expect_refused(broken("cracked"), DefectKind::kCrack, "at most 0.001 m apart",
                 "(0.5, -0.5, 0.5)-(-0.5, -0.5, 0.5)");
}
TEST(Closed, LampshadeIsRefused) {
  expect_refused(broken("lampshade"), DefectKind::kLampshade, "one polygon thick", "(0.5, 0, 0)");
}
TEST(Closed, EdgeOfThreeFacesIsRefused) {
  expect_refused(broken("edge_of_three_faces"), DefectKind::kEdgeOfManyFaces, "belongs to 3 faces",
                 "(0.5, -0.5, 0.5)-(0.5, 0.5, 0.5)");
}
TEST(Closed, DisagreeingOrientationIsRefused) {
  expect_refused(broken("mixed_winding"), DefectKind::kOrientation,
                 "disagree on which side is outside along 4 edges", "faces 2 and 5");
}
TEST(Closed, ZeroVolumeIsRefused) {
  expect_refused(broken("zero_volume"), DefectKind::kZeroVolume, "encloses no volume", "flat");
}
TEST(Closed, NoFacesIsRefused) {
  expect_refused(broken("no_faces"), DefectKind::kNoFaces, "no faces", "");
}

TEST(Closed, OneTriangleMissingOfASphereIsAHole) {
  TriangleMesh mesh = subdivided_sphere(2);
  mesh.faces.pop_back();
  expect_refused(mesh, DefectKind::kMissingFace, "a hole (a face is missing): 3 open edges",
                 "first at (");
}

TEST(Closed, CoincidentLayersAreALampshade) {
  // Both sides modelled as faces on the same corners: every edge is in two faces, but there is no
  // thickness.
  TriangleMesh mesh = broken("lampshade");
  const std::vector<Face> outside = mesh.faces;
  for (const Face& f : outside) mesh.faces.push_back({f[0], f[2], f[1]});
  expect_refused(mesh, DefectKind::kLampshade, "a wall one polygon thick, like a lampshade",
                 "faces 0 and 32");
}

TEST(Closed, NotANumberIsRefusedAtItsVertex) {
  TriangleMesh mesh = unit_box();
  mesh.vertices[5].y() = std::numeric_limits<double>::quiet_NaN();
  expect_refused(mesh, DefectKind::kNotFinite, "vertex 5 is not finite", "nan");
}

TEST(Closed, InfinityIsRefusedAtItsVertex) {
  TriangleMesh mesh = unit_box();
  mesh.vertices[3].x() = std::numeric_limits<double>::infinity();
  expect_refused(mesh, DefectKind::kNotFinite, "vertex 3 is not finite", "inf");
}

TEST(Closed, IndexWithoutVertexIsRefused) {
  TriangleMesh mesh = unit_box();
  mesh.faces[7][1] = 8;
  expect_refused(mesh, DefectKind::kBadIndex,
                 "face 7 refers to vertex 8, but the vertices are 0 to 7", "");
}

TEST(Closed, MoebiusStripClosedByADiscHasOneSide) {
  // The projective plane on six vertices: every edge is in two faces, and no orientation exists.
  TriangleMesh mesh{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {0, 1, 1}, {1, 0, 1}},
                    {{0, 1, 2},
                     {0, 2, 3},
                     {0, 3, 4},
                     {0, 4, 5},
                     {0, 5, 1},
                     {1, 2, 4},
                     {2, 3, 5},
                     {3, 4, 1},
                     {4, 5, 2},
                     {5, 1, 3}}};
  expect_refused(mesh, DefectKind::kOneSided, "one-sided", "faces");
}

TEST(Closed, PartInsideAnotherThatIsNotACavityIsRefused) {
  const TriangleMesh mesh =
      joined(models::box({0, 0, 0}, {4, 4, 4}), models::box({1, 1, 1}, {2, 2, 2}));
  expect_refused(mesh, DefectKind::kNestedOutward, "its volume would count twice",
                 "(1.5, 1.5, 1.5)");
}

TEST(Closed, SolidIsAcceptedWithoutNotice) {
  const ClosedReport report = check_closed(unit_box());
  EXPECT_TRUE(report.is_closed());
  EXPECT_TRUE(report.notices.empty());
  EXPECT_EQ(report.parts, 1);
}

TEST(Closed, InvertedSurfaceIsFlippedWithANotice) {
  const ClosedReport report = check_closed(turned_inside_out(unit_box()));
  ASSERT_TRUE(report.is_closed());
  EXPECT_DOUBLE_EQ(signed_volume(report.mesh), 1.0);
  ASSERT_EQ(report.notices.size(), 1u);
  EXPECT_EQ(report.notices[0], "the surface was inside out: all its faces were flipped");
}

TEST(Closed, OneInvertedPartOfTwoIsFlippedWithItsPlace) {
  const ClosedReport report =
      check_closed(joined(unit_box(), turned_inside_out(models::box({2, 0, 0}, {3, 1, 1}))));
  ASSERT_TRUE(report.is_closed());
  EXPECT_DOUBLE_EQ(signed_volume(report.mesh), 2.0);
  ASSERT_EQ(report.notices.size(), 1u);
  EXPECT_NE(report.notices[0].find("about (2.5, 0.5, 0.5) was inside out"), std::string::npos)
      << report.notices[0];
}

TEST(Closed, CavityIsKept) {
  const ClosedReport report = check_closed(joined(
      models::box({0, 0, 0}, {4, 4, 4}), turned_inside_out(models::box({1, 1, 1}, {2, 2, 2}))));
  ASSERT_TRUE(report.is_closed());
  EXPECT_DOUBLE_EQ(signed_volume(report.mesh), 63.0);
  EXPECT_EQ(report.parts, 2);
}

TEST(Closed, TwoConesTouchingAtTheirTipsAreSeparatedThere) {
  const TriangleMesh mesh{
      {{0, 0, 0}, {1, 0, 1}, {0, 1, 1}, {-1, -1, 1}, {1, 0, -1}, {0, 1, -1}, {-1, -1, -1}},
      {{0, 2, 1}, {0, 3, 2}, {0, 1, 3}, {1, 2, 3}, {0, 4, 5}, {0, 5, 6}, {0, 6, 4}, {4, 6, 5}}};
  const ClosedReport report = check_closed(mesh);
  ASSERT_TRUE(report.is_closed()) << report.defects.front().problem;
  EXPECT_EQ(report.mesh.vertices.size(), 8u);
  ASSERT_FALSE(report.notices.empty());
  EXPECT_NE(report.notices[0].find("touches itself at 1 corner, the first at (0, 0, 0)"),
            std::string::npos)
      << report.notices[0];
}

TEST(Closed, SolidFromABrokenMeshNamesFileProblemAndRemedy) {
  try {
    solid_from_mesh(broken("missing_face"), "box.3ds: object 'lid'");
    FAIL() << "accepted";
  } catch (const UserError& error) {
    const std::string said = error.what();
    for (const char* words : {"box.3ds: object 'lid'", "4 open edges",
                              "(0.5, -0.5, 0.5)-(-0.5, -0.5, 0.5)", "Cap the hole"}) {
      EXPECT_NE(said.find(words), std::string::npos) << said;
    }
  }
}

TEST(Closed, RelativeFlatnessIsRefusedAndAThinPlateIsNot) {
  EXPECT_TRUE(check_closed(models::box({0, 0, 0}, {1, 1, 1e-6})).is_closed());
  EXPECT_FALSE(check_closed(models::box({0, 0, 0}, {1, 1, 0})).is_closed());
}

TEST(Closed, VertexFarFromTheOthersMakesANeedle) {
  TriangleMesh mesh = unit_box();
  mesh.vertices[0].x() = -1e8;
  expect_refused(mesh, DefectKind::kNeedle, "a needle", "(-1e+08, 0, 0)");
  EXPECT_TRUE(check_closed(models::box({0, 0, 0}, {1e5, 1, 1})).is_closed());
}

/// A prism over a curve like three links of a chain: the middle link has positive area, the outer
/// two, up to x = +-reach, are inverted. By symmetry its centre of mass is in the middle.
TriangleMesh three_links(double reach) {
  const double y = reach - 4;
  return models::extrude(
      {{-reach, y}, {-1, -3}, {1, -3}, {reach, y}, {reach, -y}, {1, 3}, {-1, 3}, {-reach, -y}},
      {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 6}, {0, 6, 7}}, 0, 4);
}

TEST(Closed, InertiaThatNoSolidHasIsRefused) {
  // int x^2 over the links is 85 - 2 * 2 (reach^4 / 4 - 4 reach^3 / 3 + 64 / 3) per metre of
  // height: negative at 5.5, where all three moments of inertia are still positive and the centre
  // of mass is inside.
  // At 4.5 it is 70, and no mass property is impossible. Both are refused because their faces
  // cross, before mass properties are computed.
  for (const double reach : {4.5, 5.5})
    expect_refused(three_links(reach), DefectKind::kSelfCrossing, "passes through itself",
                   "faces ");
}

TEST(Closed, ShellsThatPassThroughEachOtherAreRefusedByName) {
  // Two unit boxes with a common volume of 0.28 m^3: their volumes add up to 2 m^3, the solid has
  // 1.72 m^3.
  const TriangleMesh mesh = joined(unit_box(), models::box({0.3, 0.2, 0.5}, {1.3, 1.2, 1.5}));
  expect_refused(mesh, DefectKind::kSelfCrossing,
                 "two shells pass through each other: the part of 12 faces about (0.5, 0.5, 0.5) "
                 "and the part of 12 faces about (0.8, 0.7, 1)",
                 "faces ");
}

TEST(Closed, BoxesPushedIntoEachOtherAlongTheirFacesAreRefusedToo) {
  // Faces lie on each other, and none passes through another: half of the second box is in the
  // first, with sides in common planes.
  expect_refused(joined(unit_box(), models::box({0.5, 0, 0}, {1.5, 1, 1})),
                 DefectKind::kSelfCrossing, "two shells pass through each other", "(0.5, ");
  expect_refused(joined(unit_box(), models::box({0.5, 0.5, 0}, {1.5, 1.5, 1})),
                 DefectKind::kSelfCrossing, "two shells pass through each other", "");
}

TEST(Closed, ABarThroughABallIsRefusedAtAnySizeAndPlace) {
  for (const double size : {1e-3, 1.0, 1e3})
    for (const Vector3d& place : {Vector3d(0, 0, 0), Vector3d(50, -20, 7)}) {
      TriangleMesh mesh =
          joined(subdivided_sphere(3), models::box({-2, -0.1, -0.1}, {2, 0.1, 0.1}));
      for (Vector3d& vertex : mesh.vertices) vertex = size * (vertex + place);
      expect_refused(mesh, DefectKind::kSelfCrossing, "two shells pass through each other",
                     "the part of 1280 faces");
    }
}

TEST(Closed, PartsThatTouchAreNotCrossing) {
  // Face on face, edge on face, corner on face, edge on edge: in contact, but not through each
  // other.
  const TriangleMesh diamond = [] {  // its lowest corner at the origin
    TriangleMesh mesh = subdivided_sphere(0);
    const Quaterniond down = shortest_turn(mesh.vertices[0], -Vector3d::UnitZ());
    for (Vector3d& vertex : mesh.vertices) vertex = down * vertex + Vector3d(0.4, 0.4, 2.0);
    return mesh;
  }();
  for (const TriangleMesh& other :
       {models::box({0.25, 0.25, 1}, {0.75, 0.75, 2}), models::box({0.5, 0.5, 1}, {1.5, 1.5, 2}),
        models::box({1, 1, 0}, {2, 2, 1}), models::box({1, 0.3, 0.3}, {2, 0.8, 0.9}), diamond}) {
    const ClosedReport report = check_closed(joined(unit_box(), other));
    EXPECT_TRUE(report.is_closed()) << report.defects.front().problem;
  }
}

TEST(Closed, DuplicateFaceIsDroppedWithItsPlace) {
  TriangleMesh mesh = unit_box();
  mesh.faces.push_back({mesh.faces[4][1], mesh.faces[4][2], mesh.faces[4][0]});
  const ClosedReport report = check_closed(mesh);
  ASSERT_TRUE(report.is_closed()) << report.defects.front().problem;
  EXPECT_DOUBLE_EQ(signed_volume(report.mesh), 1.0);
  ASSERT_EQ(report.notices.size(), 1u);
  EXPECT_NE(
      report.notices[0].find("dropped 1 duplicate face, the first: face 12, which repeats face 4"),
      std::string::npos)
      << report.notices[0];
}

TEST(Closed, DuplicateFaceOnAnOpenSurfaceIsNamed) {
  TriangleMesh mesh = broken("missing_face");
  mesh.faces.push_back(mesh.faces[2]);
  expect_refused(mesh, DefectKind::kRepeatedFace, "1 duplicate face: face 10 repeats face 2",
                 "at (");
}

TEST(Closed, AFinWithoutThicknessIsDroppedWithItsPlace) {
  // both sides of a triangle between two corners and a point outside
  TriangleMesh mesh = unit_box();
  mesh.vertices.push_back({2, 0.5, 0.5});
  const int tip = static_cast<int>(mesh.vertices.size()) - 1, a = mesh.faces[0][0],
            b = mesh.faces[0][1];
  mesh.faces.push_back({a, b, tip});
  mesh.faces.push_back({b, a, tip});
  const ClosedReport report = check_closed(mesh);
  ASSERT_TRUE(report.is_closed()) << report.defects.front().problem;
  EXPECT_DOUBLE_EQ(signed_volume(report.mesh), 1.0);
  EXPECT_NE(report.notices.at(0).find("back to back"), std::string::npos);
}

TEST(Closed, CornersMergedBySinglePrecisionAreNamed) {
  // A plate 1 cm thick, 200 km from the origin: float32 numbers are 16 mm apart there, so its two
  // sides coincide.
  TriangleMesh mesh = models::box({0, 0, 0}, {1, 1, 0});
  for (Face& face : mesh.faces)  // corners of the upper side are those of the lower
    for (int& corner : face)
      for (int v = 0; v < corner; ++v)
        if (mesh.vertices[v] == mesh.vertices[corner]) corner = v;
  for (Vector3d& vertex : mesh.vertices) vertex.z() += 2e5;
  expect_refused(mesh, DefectKind::kMergedCorners, "corners have merged: 8 faces have no area left",
                 "2e+05 m cannot resolve less than 0.024 m");
}

TEST(Closed, PlateAsThinAsRoundingIsNotACrossing) {
  for (const double thickness : {1e-6, 1e-9, 1e-12}) {
    const ClosedReport report = check_closed(models::box({0, 0, 0}, {1, 1, thickness}));
    for (const Defect& defect : report.defects)
      EXPECT_NE(defect.kind, DefectKind::kSelfCrossing) << thickness << ": " << defect.problem;
  }
}

TEST(Closed, VolumeLostInRoundingIsRefused) {
  // A spike to 1e31 m on a stone of 1 m: its volume is a sum of numbers of 1e62, and the result is
  // only their rounding.
  TriangleMesh mesh = models::rounded(subdivided_sphere(1));
  mesh.vertices[0] = {2.7e31, 0, 0};
  mesh.vertices[3] = {0, 0, -2.9e31};
  EXPECT_FALSE(check_closed(mesh).is_closed());
}

TEST(Convex, BoxAndBallAreConvexAndAnLIsNot) {
  EXPECT_TRUE(is_convex(unit_box()));
  EXPECT_TRUE(is_convex(models::rounded(subdivided_sphere(3))));
  const TriangleMesh l_shape = models::extrude({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}},
                                               {{0, 1, 2}, {0, 2, 3}, {0, 3, 5}, {3, 4, 5}}, 0, 1);
  EXPECT_FALSE(is_convex(l_shape));
}

}  // namespace
}  // namespace tumble::testing
