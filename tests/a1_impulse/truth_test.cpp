// The functions of a1 against reference values computed in exact rational arithmetic:
// tests/truths/ray_triangle__*.json and impulse_*.json. Numbers there are decimal strings;
// `tolerance_floor` is the error that rounding the inputs alone forces.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>

#include "framework/core/program_trees.h"
#include "tests/a1_impulse/a1_fixtures.h"

namespace tumble::testing {
namespace {

using Json = nlohmann::json;

// A closed form of some tens of operations stays well within 100 floors; the known mistakes are
// wrong by 1e13 floors.
constexpr double kFloors = 100;

double number(const Json& text) { return std::strtod(text.get<std::string>().c_str(), nullptr); }
Vector3d vector(const Json& v) { return {number(v[0]), number(v[1]), number(v[2])}; }
Matrix3d matrix(const Json& m) {
  Matrix3d rows;
  rows << vector(m[0]).transpose(), vector(m[1]).transpose(), vector(m[2]).transpose();
  return rows;
}

std::vector<Json> truths_of_family(const std::string& family) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry :
       std::filesystem::directory_iterator(find_trees().root / "tests/truths")) {
    if (entry.path().filename().string().starts_with(family + "__")) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  EXPECT_FALSE(files.empty()) << "no truths of family " << family;
  std::vector<Json> truths;
  for (const auto& file : files) truths.push_back(Json::parse(std::ifstream(file)));
  return truths;
}

// ---- Rays --------------------------------------------------------------------------------------

// A ray aimed exactly at a seam passes within rounding of it, on either side: there each triangle
// alone may be hit or missed, and the law is that one of them is hit (Woop's own order of
// evaluation shears the corners first, and chooses one of the two).
bool at_least_one_is_hit(const Json& ray, const Json& triangles) {
  return std::any_of(
      ray["per_triangle"].begin(), ray["per_triangle"].end(), [&](const Json& expected) {
        const Json& corners = triangles[expected["triangle"].get<std::size_t>()];
        return student()
            .intersect_ray_triangle({vector(ray["origin"]), vector(ray["direction"])},
                                    {vector(corners[0]), vector(corners[1]), vector(corners[2])})
            .has_value();
      });
}

/// Two triangles or more, and the ray passes through a point that they share.
bool meets_a_seam(const Json& ray) {
  const Json& all = ray["per_triangle"];
  return all.size() > 1 && std::all_of(all.begin(), all.end(), [](const Json& one) {
           return one["class"].get<std::string>().starts_with("on_");
         });
}

TEST(RayTriangle, AgreesWithTheTruths) {
  for (const Json& truth : truths_of_family("ray_triangle")) {
    for (const Json& ray : truth["outputs"]["rays"]["value"]) {
      for (const Json& expected : ray["per_triangle"]) {
        // inside the plane and across the triangle: no single answer
        if (expected["hit"].is_null()) continue;
        const Json& corners =
            truth["inputs"]["triangles"]["value"][expected["triangle"].get<std::size_t>()];
        const auto found = student().intersect_ray_triangle(
            {vector(ray["origin"]), vector(ray["direction"])},
            {vector(corners[0]), vector(corners[1]), vector(corners[2])});
        const Story story{.scene = truth["id"].get<std::string>() + ", ray " +
                                   ray["name"].get<std::string>() + ": " +
                                   expected["class"].get<std::string>() + " of triangle " +
                                   expected["triangle"].dump(),
                          .slip = found.has_value() == expected["hit"].get<bool>()
                                      ? "digits lost on the way: divide last, and only once"
                                      : "an epsilon somewhere: compare with 0 exactly",
                          .handout = "handouts/a1_impulse.md#hint-ray"};
        const bool hit = expected["hit"].get<bool>();
        if (meets_a_seam(ray) && !found) {
          expect_true(at_least_one_is_hit(ray, truth["inputs"]["triangles"]["value"]),
                      "a hit of one of the triangles that share the seam", "a miss of all", story);
          continue;
        }
        expect_true(found.has_value() == hit, hit ? "a hit" : "a miss", found ? "a hit" : "a miss",
                    story);
        if (found && hit)
          expect_near(found->t, number(expected["t"]),
                      kFloors * number(expected["t_tolerance_floor"]), "lengths of d", story);
        if (::testing::Test::HasFailure()) return;  // one story is enough
      }
    }
  }
}

// ---- Impacts -----------------------------------------------------------------------------------

struct Impact {
  std::string id;
  Encounter encounter;
  double restitution, impulse, impulse_floor;
  a1::CollisionOutcome after;
  double after_floor = 0.0;
};

Body body_at(const Inertia& inertia, const Vector3d& com_world, const Vector3d& velocity_world,
             const Vector3d& omega_world) {
  return {inertia, com_world, Quaterniond::Identity(), velocity_world, omega_world};
}

/// A ball whose size has no effect.
Body ball_at(double mass, const Vector3d& com_world, const Vector3d& velocity_world) {
  return body_at(finite_inertia(mass, Matrix3d::Identity() * mass), com_world, velocity_world,
                 Vector3d::Zero());
}

Impact sphere_sphere(const Json& truth) {
  const auto in = [&](const char* name) { return truth["inputs"][name]["value"]; };
  const auto out = [&](const char* name) { return vector(truth["outputs"][name]["value"]); };
  const auto floor = [&](const char* name) {
    return number(truth["outputs"][name]["tolerance_floor"]);
  };
  return {.id = truth["id"],
          .encounter = {{vector(in("contact_point")), vector(in("normal_B_to_A"))},
                        ball_at(number(in("mA")), vector(in("xA")), vector(in("vA"))),
                        ball_at(number(in("mB")), vector(in("xB")), vector(in("vB")))},
          .restitution = number(in("e")),
          .impulse = number(truth["outputs"]["j"]["value"]),
          .impulse_floor = floor("j"),
          .after = a1::CollisionOutcome{{out("vA_after"), out("wA_after")},
                                        {out("vB_after"), out("wB_after")}},
          .after_floor = std::max(floor("vA_after"), floor("vB_after"))};
}

Impact box_corner(const Json& truth) {
  const auto in = [&](const char* name) { return truth["inputs"][name]["value"]; };
  const auto out = [&](const char* name) { return truth["outputs"][name]; };
  const Vector3d squares = vector(in("half_extents")).cwiseAbs2();
  const double m = number(in("m"));
  const Vector3d moments(squares.y() + squares.z(), squares.x() + squares.z(),
                         squares.x() + squares.y());
  Body box = body_at(finite_inertia(m, Matrix3d((m / 3.0 * moments).asDiagonal())), vector(in("x")),
                     vector(in("v")), vector(in("omega_world")));
  box.world_from_body =
      Quaterniond(number(in("q")[0]), number(in("q")[1]), number(in("q")[2]), number(in("q")[3]))
          .normalized();
  return {.id = truth["id"],
          .encounter = {{vector(in("contact_point")), vector(in("normal"))}, box, wall({0, 0, 0})},
          .restitution = number(in("e")),
          .impulse = number(out("j")["value"]),
          .impulse_floor = number(out("j")["tolerance_floor"]),
          .after = a1::CollisionOutcome{{vector(out("v_after")["value"]),
                                         vector(out("w_after")["value"])},
                                        {Vector3d::Zero(), Vector3d::Zero()}},
          .after_floor = number(out("w_after")["tolerance_floor"])};
}

Impact rod_ball(const Json& truth) {
  const auto in = [&](const char* name) { return truth["inputs"][name]["value"]; };
  const auto out = [&](const char* name) { return truth["outputs"][name]; };
  const double M = number(in("M_rod")), L = number(in("L_rod"));
  const Vector3d at(number(in("d")), 0, 0), up = vector(in("normal_rod_to_ball"));
  // The moment about the rod's own axis has no effect: there is no rotation about it.
  const Body rod = body_at(finite_inertia(M, Matrix3d::Identity() * (M * L * L / 12.0)), {0, 0, 0},
                           {0, 0, 0}, {0, 0, 0});
  const Vector3d v = up * number(out("ball_vz_after")["value"]),
                 V = up * number(out("rod_vz_after")["value"]);
  const Vector3d W(0, number(out("rod_wy_after")["value"]), 0);
  return {
      .id = truth["id"],
      .encounter = {{at, up}, ball_at(number(in("m_ball")), at + up, vector(in("v_ball"))), rod},
      .restitution = number(in("e")),
      .impulse = number(out("j")["value"]),
      .impulse_floor = number(out("j")["tolerance_floor"]),
      .after = a1::CollisionOutcome{{v, {0, 0, 0}}, {V, W}},
      .after_floor = number(out("ball_vz_after")["tolerance_floor"])};
}

Body random_truth_body(const Json& in, const std::string& name) {
  const Vector3d x = vector(in["x" + name]), v = vector(in["v" + name]),
                 w = vector(in["w" + name + "_world"]);
  if (in["m" + name] == "infinite") {
    Body body = wall(x);
    body.velocity_world = v;
    body.omega_world = w;
    return body;
  }
  return body_at(finite_inertia(number(in["m" + name]), matrix(in["I" + name + "_world"])), x, v,
                 w);
}

std::vector<Impact> random_impacts(const Json& truth) {
  std::vector<Impact> impacts;
  for (const Json& row : truth["outputs"]["rows"]["value"]) {
    const Json &in = row["inputs"], &out = row["outputs"];
    impacts.push_back(
        {.id = truth["id"].get<std::string>() + " row " + std::to_string(impacts.size()),
         .encounter = {{vector(in["contact_point"]), vector(in["normal_B_to_A"])},
                       random_truth_body(in, "A"),
                       random_truth_body(in, "B")},
         .restitution = number(in["e"]),
         .impulse = number(out["j"]),
         .impulse_floor = number(row["tolerance_floor"]["j"]),
         .after = a1::CollisionOutcome{{vector(out["vA_after"]), vector(out["wA_after"])},
                                       {vector(out["vB_after"]), vector(out["wB_after"])}},
         .after_floor = number(row["tolerance_floor"]["velocities"])});
  }
  return impacts;
}

std::vector<Impact> all_impacts() {
  std::vector<Impact> impacts;
  for (const Json& truth : truths_of_family("impulse_sphere_sphere"))
    impacts.push_back(sphere_sphere(truth));
  for (const Json& truth : truths_of_family("impulse_rod_ball")) impacts.push_back(rod_ball(truth));
  for (const Json& truth : truths_of_family("impulse_box_corner"))
    impacts.push_back(box_corner(truth));
  for (const Json& truth : truths_of_family("impulse_random")) {
    for (Impact& impact : random_impacts(truth)) impacts.push_back(std::move(impact));
  }
  return impacts;
}

const std::string kElsewhere =
    "what simpler tests do not reach: both arms, full tensors, walls that move, digits lost on the "
    "way. No mistake that is known here gives this number";

/// A body's velocity with a wrong impulse.
Slips<Vector3d> slips_of_velocity(const Impact& impact, const Body& body, const Velocity& after,
                                  const std::string& gets, const std::string& name) {
  const Vector3d before = body.velocity_world, change = after.linear_world - before;
  if (change.norm() <= kSameAnswer * before.norm()) return {};  // a wall
  Slips<Vector3d> slips = {{before - change, "the sign is wrong: " + name + " gets " + gets},
                           {before, "no impulse reached " + name}};
  for (const auto& [wrong, words] : slips_of_impulse(impact.encounter, impact.restitution))
    slips.push_back({before + wrong / impact.impulse * change, words + " (in j)"});
  return slips;
}

TEST(CollisionImpulse, AgreesWithTheTruths) {
  for (const Impact& impact : all_impacts()) {
    const auto& [contact, a, b] = impact.encounter;
    const double found = student().collision_impulse(contact, a, b, impact.restitution);
    expect_near(
        found, impact.impulse, kFloors * impact.impulse_floor, "N s",
        {.scene = "case " + impact.id +
                  " of tests/truths, computed in exact arithmetic, e = " + show(impact.restitution),
         .slip = likely(found, slips_of_impulse(impact.encounter, impact.restitution), kElsewhere),
         .handout = equation("9")});
    if (::testing::Test::HasFailure()) return;  // one story is enough
  }
}

TEST(ResolveCollision, AgreesWithTheTruths) {
  for (const Impact& impact : all_impacts()) {
    const auto& [contact, a, b] = impact.encounter;
    const a1::CollisionOutcome found =
        student().resolve_collision(contact, a, b, impact.restitution);
    const double tolerance = kFloors * impact.after_floor;
    const Vector3d J = impact.impulse * contact.normal_b_to_a_world;
    const auto expect_body = [&](const Body& body, const Velocity& after, const Velocity& right,
                                 const Vector3d& impulse, const std::string& gets,
                                 const std::string& name) {
      Story story{.scene = "case " + impact.id +
                           " of tests/truths, computed in exact arithmetic, e = " +
                           show(impact.restitution),
                  .slip = likely<3>(after.linear_world,
                                    slips_of_velocity(impact, body, right, gets, name), kElsewhere),
                  .handout = equation("11")};
      expect_near(after.linear_world, right.linear_world, tolerance,
                  "m/s (velocity of " + name + ")", story);
      Slips<Vector3d> turning = slips_of_apply(body, impulse, contact.point_world);
      // Where the impulse has the wrong sign, so has the turn: then no cross product is to blame.
      const Vector3d opposite = 2 * body.velocity_world - right.linear_world;
      if ((after.linear_world - opposite).norm() <= kSameAnswer * opposite.norm())
        turning.insert(turning.begin(), {Vector3d(2 * body.omega_world - right.angular_world),
                                         "the sign is wrong: " + name + " gets " + gets});
      story.slip = likely<3>(after.angular_world, turning, kElsewhere);
      expect_near(after.angular_world, right.angular_world, tolerance,
                  "rad/s (angular velocity of " + name + ")", story);
    };
    expect_body(a, found.a, impact.after.a, J, "+j n", "A");
    expect_body(b, found.b, impact.after.b, -J, "-j n", "B");
    if (::testing::Test::HasFailure()) return;  // one story is enough
  }
}

}  // namespace
}  // namespace tumble::testing
