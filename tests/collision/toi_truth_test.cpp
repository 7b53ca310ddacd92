// Times of impact against independent reference values, with a tolerance of 100 times the error
// floor of double precision.
#include <cmath>

#include <gtest/gtest.h>

#include "framework/collision/first_impact.h"
#include "framework/core/shortest_turn.h"
#include "framework/dynamics/laws.h"
#include "tests/collision/flights.h"
#include "tests/collision/truth_reader.h"

namespace tumble::testing {
namespace {

using collision::CollisionShape;
using collision::Impact;
using collision::Motion;

Motion still(const Vector3d& x, const Quaterniond& q = Quaterniond::Identity()) {
  return flight(x, Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero(), q);
}

std::optional<Impact> impact(const CollisionShape& a, const Motion& ma, const CollisionShape& b,
                             const Motion& mb, double until, bool library_root_finder) {
  collision::ImpactOptions options;
  if (library_root_finder) options.root_finder = library_laws().find_impact_time;
  collision::ImpactCost cost;
  const auto found = collision::first_impact(a, ma, b, mb, 0.0, until, options, &cost);
  EXPECT_TRUE(!found || found->gap.distance >= 0.0);
  EXPECT_LT(cost.gap_evaluations, 500u);
  return found;
}

class TimeOfImpact : public ::testing::TestWithParam<bool> {};

TEST_P(TimeOfImpact, SpherePlane) {
  for (const std::string name : {"cancellation", "horizontal_drop", "tilted"}) {
    const auto truth = read_truth("toi_sphere_plane/" + name);
    const Vector3d n = vector(input(truth, "n"));
    const CollisionShape ball{Sphere{number(input(truth, "R"))}}, plane{HalfSpace{}};
    const Motion fall = flight(vector(input(truth, "x0")), vector(input(truth, "v0")),
                               {0, 0, -number(input(truth, "g"))}, Vector3d::Zero());
    const Motion floor =
        still(n * (number(input(truth, "d")) / n.norm()), shortest_turn(Vector3d::UnitZ(), n));
    const auto found = impact(ball, fall, plane, floor, 10.0, GetParam());
    ASSERT_TRUE(found) << name;
    EXPECT_NEAR(found->time, number(output(truth, "toi")), pass_mark(truth, "toi")) << name;
    EXPECT_NEAR(found->rate, number(output(truth, "normal_velocity_at_toi")),
                pass_mark(truth, "normal_velocity_at_toi"))
        << name;
    EXPECT_LE(
        (found->gap.point_a_world - vector(output(truth, "contact_point"))).cwiseAbs().maxCoeff(),
        std::max(pass_mark(truth, "contact_point"), 1e-16))
        << name;
  }
}

TEST_P(TimeOfImpact, RodPlane) {
  for (const std::string name : {"fast_spin", "no_gravity_sweep", "slow_spin"}) {
    const auto truth = read_truth("toi_rod_plane/" + name);
    const double half = 0.5 * number(input(truth, "L"));
    TriangleMesh mesh;  // the rod's two ends
    mesh.vertices = {{half, 0, 0}, {-half, 0, 0}};
    const CollisionShape rod{MeshSolid{mesh, true}}, plane{HalfSpace{}};
    // The angle phi rotates x towards z: about -y.
    const double phi = number(input(truth, "phi0")), omega = number(input(truth, "omega"));
    const Motion motion =
        flight({0, 0, number(input(truth, "h"))}, {0, 0, number(input(truth, "v_up"))},
               {0, 0, -number(input(truth, "g"))}, {0, -omega, 0},
               Quaterniond(Eigen::AngleAxisd(phi, -Vector3d::UnitY())));
    const auto found = impact(rod, motion, plane, still(Vector3d::Zero()), 10.0, GetParam());
    ASSERT_TRUE(found) << name;
    EXPECT_NEAR(found->time, number(output(truth, "toi")), pass_mark(truth, "toi")) << name;
    EXPECT_NEAR(found->rate, number(output(truth, "tip_normal_velocity")),
                pass_mark(truth, "tip_normal_velocity"))
        << name;
  }
}

TEST_P(TimeOfImpact, Boxes) {
  for (const std::string name :
       {"boxes_edge_edge_principal_spin", "cubes_edge_edge", "cubes_vertex_face"}) {
    const auto truth = read_truth("toi_boxes/" + name);
    const auto solid = [&](const char* half) {
      return CollisionShape{Box{vector(input(truth, half))}};
    };
    const auto motion = [&](const char* x, const char* v, const char* w) {
      return flight(vector(input(truth, x)), vector(input(truth, v)), Vector3d::Zero(),
                    vector(input(truth, w)));
    };
    const auto found = impact(solid("half_A"), motion("xA", "vA", "omegaA_world"), solid("half_B"),
                              motion("xB", "vB", "omegaB_world"), 3.0, GetParam());
    ASSERT_TRUE(found) << name;
    EXPECT_NEAR(found->time, number(output(truth, "toi")), pass_mark(truth, "toi")) << name;
    const Vector3d normal = found->gap.normal_b_to_a_world + vector(output(truth, "normal_A_to_B"));
    EXPECT_LE(normal.cwiseAbs().maxCoeff(), pass_mark(truth, "normal_A_to_B")) << name;
    EXPECT_LE(
        (found->gap.point_a_world - vector(output(truth, "contact_point"))).cwiseAbs().maxCoeff(),
        pass_mark(truth, "contact_point"))
        << name;
    EXPECT_NEAR(found->rate, number(output(truth, "relative_normal_velocity")),
                pass_mark(truth, "relative_normal_velocity"))
        << name;
  }
}

TEST_P(TimeOfImpact, Tunnel) {
  const auto truth = read_truth("toi_tunnel/bullet_1000");
  const double half = 0.5 * number(input(truth, "wall_thickness"));
  const CollisionShape bullet{Sphere{number(input(truth, "R"))}}, wall{Box{{half, 1.0, 1.0}}};
  const Motion shot = flight(Vector3d::Zero(), {number(input(truth, "v")), 0, 0}, Vector3d::Zero(),
                             Vector3d::Zero());
  const auto found =
      impact(bullet, shot, wall, still({number(input(truth, "wall_front_face_x")) + half, 0, 0}),
             1.0, GetParam());
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->time, number(output(truth, "toi")), pass_mark(truth, "toi"));
}

TEST_P(TimeOfImpact, Grazing) {
  for (const std::string name : {"ceiling", "spheres"}) {
    const auto truth = read_truth("toi_grazing/" + name);
    for (const auto& row : output(truth, "rows")) {
      std::optional<Impact> found;
      if (name == "ceiling") {
        const CollisionShape ball{Sphere{number(input(truth, "R"))}}, plane{HalfSpace{}};
        const Motion thrown =
            flight({0, 0, number(input(truth, "h"))}, {0, 0, number(input(truth, "v"))},
                   {0, 0, -number(input(truth, "g"))}, Vector3d::Zero());
        const Motion ceiling =
            still({0, 0, number(row.at("ceiling_height"))}, Quaterniond(0, 1, 0, 0));
        found = impact(ball, thrown, plane, ceiling, 1.0, GetParam());
      } else {
        const CollisionShape one{Sphere{number(input(truth, "R1"))}},
            two{Sphere{number(input(truth, "R2"))}};
        const Motion passing =
            flight({-number(input(truth, "D")), number(row.at("impact_parameter")), 0},
                   {number(input(truth, "v")), 0, 0}, Vector3d::Zero(), Vector3d::Zero());
        found = impact(one, passing, two, still(Vector3d::Zero()), 4.0, GetParam());
      }
      EXPECT_FALSE(found && row.at("verdict") == "miss") << name << " gap " << row.at("gap");
      if (row.at("verdict") == "hit") {
        ASSERT_TRUE(found) << name << " gap " << row.at("gap");
        EXPECT_NEAR(found->time, number(row.at("toi")), 100 * number(row.at("toi_tolerance_floor")))
            << name << " gap " << row.at("gap");
      }
      EXPECT_TRUE(!found || std::isfinite(found->time));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(RootFinders, TimeOfImpact, ::testing::Values(false, true),
                         [](const auto& info) { return info.param ? "Library" : "Bisection"; });

}  // namespace
}  // namespace tumble::testing
