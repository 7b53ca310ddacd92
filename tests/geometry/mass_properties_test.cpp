// Volume, centre of mass and inertia against exact rationals (tests/truths), and under translation,
// rotation and scaling.
#include <cmath>

#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/geometry/closed.h"
#include "framework/geometry/mass_properties.h"
#include "framework/geometry/shape.h"
#include "models/surfaces.h"
#include "tests/collision/truth_reader.h"

namespace tumble::testing {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
// 4500 roundings: sums over 2304 faces pass, a missing term (1e-2 and more) does not
constexpr double kRelative = 1e-12;

TriangleMesh mesh_of(const nlohmann::json& truth) {
  TriangleMesh mesh;
  for (const auto& v : input(truth, "vertices")) mesh.vertices.push_back(vector(v));
  for (const auto& f : input(truth, "faces")) {
    mesh.faces.push_back({static_cast<int>(number(f[0])), static_cast<int>(number(f[1])),
                          static_cast<int>(number(f[2]))});
  }
  return mesh;
}

Matrix3d matrix(const nlohmann::json& value) {
  Matrix3d m;
  for (int row = 0; row < 3; ++row) m.row(row) = vector(value[row]).transpose();
  return m;
}

/// Largest component of the error over the largest component of the expected value.
template <class A, class B>
double relative_error(const A& found, const B& expected) {
  return (found - expected).cwiseAbs().maxCoeff() / expected.cwiseAbs().maxCoeff();
}

class MassTruth : public ::testing::TestWithParam<const char*> {};

TEST_P(MassTruth, HoldsToTwelveDigits) {
  const auto truth = read_truth(std::string("mass_properties/") + GetParam());
  const TriangleMesh mesh = mesh_of(truth);
  const MassProperties found = compute_mass_properties(mesh, number(input(truth, "density")));
  const double volume = number(output(truth, "volume")), mass = number(output(truth, "mass"));
  EXPECT_NEAR(found.volume, volume, kRelative * volume);
  EXPECT_NEAR(found.mass, mass, kRelative * mass);
  // A centre of mass may be 0: its error is relative to the body's size, or to its distance from
  // the origin where that is larger.
  const Vector3d com = vector(output(truth, "com"));
  const Bounds bounds = bounds_of(mesh);
  EXPECT_LE((found.com_mesh - com).norm(),
            kRelative * std::max(com.norm(), (bounds.high - bounds.low).norm()));
  EXPECT_LE(relative_error(found.inertia_com_mesh, matrix(output(truth, "inertia_about_com"))),
            kRelative);
  EXPECT_LE(relative_error(found.principal_moments, vector(output(truth, "principal_moments_com"))),
            kRelative);
}

INSTANTIATE_TEST_SUITE_P(All, MassTruth,
                         ::testing::Values("L_shape", "box_1e-6", "box_1e6", "box_cavity",
                                           "box_offset_1e6", "box_zero_area_triangles",
                                           "icosahedron", "offset_box", "plate_1e-6", "torus_16x8",
                                           "torus_48x24", "unit_tetrahedron"),
                         [](const auto& info) {
                           std::string name = info.param;
                           for (char& c : name)
                             c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
                           return name;
                         });

TEST(MassProperties, UnitBoxAMillionMetresAwayKeepsNineDigits) {
  // Corners at multiples of 1/2 are exact at 1e6. Sums about the world's origin would lose (1e6)^2
  // * eps = 1e-4 of the inertia.
  const Vector3d far(1e6, -1e6, 1e6);
  const MassProperties found = compute_mass_properties(
      models::box(far - Vector3d::Constant(0.5), far + Vector3d::Constant(0.5)));
  EXPECT_NEAR(found.volume, 1.0, 1e-9);
  EXPECT_LE((found.com_mesh - far).norm(), 1e-9 * far.norm());
  EXPECT_LE(relative_error(found.inertia_com_mesh, Matrix3d(Matrix3d::Identity() / 6.0)), 1e-9);
}

TEST(MassProperties, UnitBoxAMillionMetresAwayOffTheGridKeepsNineDigitsOfItsRoundedCorners) {
  // Corners rounded at 1e6 (spacing 1.2e-10 m) bound a slightly different box, whose sides are
  // known from the corners.
  const Vector3d low = Vector3d::Constant(1e6 + 0.1), high = Vector3d::Constant(1e6 + 1.1);
  const Vector3d side = high - low;
  const MassProperties found = compute_mass_properties(models::box(low, high));
  EXPECT_NEAR(found.volume, side.prod(), 1e-9);
  EXPECT_NEAR(found.inertia_com_mesh(2, 2),
              side.prod() * (side.x() * side.x() + side.y() * side.y()) / 12.0, 1e-9);
}

TEST(MassProperties, RotatedBodyHasRotatedInertiaAndTheSameMoments) {
  const TriangleMesh mesh = models::extrude({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}},
                                            {{0, 1, 2}, {0, 2, 3}, {0, 3, 5}, {3, 4, 5}}, 0, 1);
  const Quaterniond turn = Quaterniond(0.3, -0.5, 0.7, 0.1).normalized();
  const MassProperties before = compute_mass_properties(mesh),
                       after = compute_mass_properties(models::turned(mesh, turn));
  const Matrix3d R = turn.toRotationMatrix();
  constexpr double kRoundOff = 200 * kEps;  // of numbers about 1, over 20 faces
  EXPECT_LE(
      (R * before.inertia_com_mesh * R.transpose() - after.inertia_com_mesh).cwiseAbs().maxCoeff(),
      kRoundOff);
  EXPECT_LE((R * before.com_mesh - after.com_mesh).norm(), kRoundOff);
  EXPECT_LE((before.principal_moments - after.principal_moments).norm(), kRoundOff);
}

TEST(MassProperties, PrincipalAxesAreARotationThatDiagonalisesTheInertia) {
  const MassProperties found =
      compute_mass_properties(models::extrude({{0, 0}, {3, 0}, {0, 1}}, {{0, 1, 2}}, 0, 0.5));
  const Matrix3d& axes = found.mesh_from_principal;
  EXPECT_NEAR(axes.determinant(), 1.0, 20 * kEps);
  const Matrix3d diagonal = axes.transpose() * found.inertia_com_mesh * axes;
  EXPECT_LE((diagonal - Matrix3d(found.principal_moments.asDiagonal())).cwiseAbs().maxCoeff(),
            50 * kEps);
  EXPECT_LT(found.principal_moments[0], found.principal_moments[1]);
  EXPECT_LT(found.principal_moments[1], found.principal_moments[2]);
}

TEST(MassProperties, MassAndInertiaScaleWithPowersThreeAndFive) {
  const TriangleMesh mesh =
      models::star_shaped([](const Vector3d& d) { return 1.0 + 0.3 * d.x(); }, 2);
  TriangleMesh large = mesh;
  for (Vector3d& v : large.vertices) v *= 4.0;  // a power of 2: exact
  const MassProperties small = compute_mass_properties(mesh), big = compute_mass_properties(large);
  EXPECT_EQ(big.volume, 64.0 * small.volume);
  EXPECT_EQ(big.inertia_com_mesh, 1024.0 * small.inertia_com_mesh);
}

TEST(MassProperties, InsideOutSurfaceHasNegativeVolume) {
  TriangleMesh mesh = models::box({0, 0, 0}, {1, 2, 3});
  for (Face& face : mesh.faces) std::swap(face[0], face[1]);
  EXPECT_NEAR(signed_volume(mesh), -6.0, 20 * kEps * 6.0);
}

TEST(MassProperties, TriangulatedSphereConvergesToTheBallFromBelow) {
  // The volume error of an inscribed surface is proportional to its edge length squared: a factor 4
  // per subdivision.
  const double ball = 4.0 / 3.0 * 3.14159265358979323846;
  const double coarse = ball - signed_volume(subdivided_sphere(3)),
               fine = ball - signed_volume(subdivided_sphere(4));
  EXPECT_GT(fine, 0.0);
  EXPECT_NEAR(coarse / fine, 4.0, 0.05);
}

}  // namespace
}  // namespace tumble::testing
