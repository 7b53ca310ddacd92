// Reference values of impulses and rays, compared with the functions of assignment 1.
// Conventions of the files: world frame, normal from B to A, times along a ray in lengths of its
// direction.
#include "assignments/a1_impulse/a1_truths.h"

#include <cmath>

#include "assignments/a1_impulse/a1_impulse.h"
#include "framework/truths/comparison.h"
#include "framework/truths/module_truths.h"

namespace tumble::a1 {
namespace {

using truths::Case;
using truths::Comparison;
using truths::Value;

/// A collision of the files, and the module's results for it.
struct Collision {
  Contact contact;
  Body a, b;
  double restitution;
};

double kinetic_energy(const Body& body, const Velocity& velocity) {
  if (body.inertia.inverse_mass == 0.0) return 0.0;  // the files leave out a wall's energy
  const Vector3d omega_body = body.world_from_body.conjugate() * velocity.angular_world;
  return 0.5 * body.inertia.mass * velocity.linear_world.squaredNorm() +
         0.5 * omega_body.dot(body.inertia.inertia_body * omega_body);
}

/// The module's results for a collision, in all the quantities of the files.
struct Answer {
  double normal_velocity_before, normal_velocity_after, effective_inverse_mass, impulse,
      energy_before, energy_after;
  Velocity a_after, b_after;
};

Answer answer_of(const Module& module, const Collision& collision) {
  const auto& [contact, a, b, restitution] = collision;
  Answer answer;
  answer.normal_velocity_before = module.relative_normal_velocity(contact, a, b);
  answer.impulse = module.collision_impulse(contact, a, b, restitution);
  // (A1.9) solved for k: j k = -(1 + e) u_n. A wrong impulse shows here as well.
  answer.effective_inverse_mass =
      -(1.0 + restitution) * answer.normal_velocity_before / answer.impulse;

  const CollisionOutcome outcome = module.resolve_collision(contact, a, b, restitution);
  answer.a_after = outcome.a;
  answer.b_after = outcome.b;
  Body a_after = a, b_after = b;
  a_after.velocity_world = outcome.a.linear_world, a_after.omega_world = outcome.a.angular_world;
  b_after.velocity_world = outcome.b.linear_world, b_after.omega_world = outcome.b.angular_world;
  answer.normal_velocity_after = module.relative_normal_velocity(contact, a_after, b_after);
  answer.energy_before = kinetic_energy(a, {a.velocity_world, a.omega_world}) +
                         kinetic_energy(b, {b.velocity_world, b.omega_world});
  answer.energy_after = kinetic_energy(a, outcome.a) + kinetic_energy(b, outcome.b);
  return answer;
}

/// Compares the output when the case has it: families have different outputs.
template <class Found>
void compare_if_given(const Case& truth, Comparison& comparison, const std::string& output,
                      const Found& found) {
  if (truth.has_output(output)) comparison.closed_form(truth, output, found);
}

void compare_scalars(const Case& truth, Comparison& comparison, const Answer& answer) {
  compare_if_given(truth, comparison, "relative_normal_velocity_before",
                   answer.normal_velocity_before);
  compare_if_given(truth, comparison, "effective_inverse_mass", answer.effective_inverse_mass);
  compare_if_given(truth, comparison, "j", answer.impulse);
  compare_if_given(truth, comparison, "relative_normal_velocity_after",
                   answer.normal_velocity_after);
  compare_if_given(truth, comparison, "kinetic_energy_before", answer.energy_before);
  compare_if_given(truth, comparison, "kinetic_energy_after", answer.energy_after);
}

Body body_at(const Inertia& inertia, const Vector3d& com_world, const Vector3d& velocity_world,
             const Vector3d& omega_world = Vector3d::Zero()) {
  return {inertia, com_world, Quaterniond::Identity(), velocity_world, omega_world};
}

/// Any solid ball, because the impulse passes through the centre: (2/5) m r^2.
Inertia ball_inertia(double mass, double radius) {
  return finite_inertia(mass, 0.4 * mass * radius * radius * Matrix3d::Identity());
}

// ---- impulse_sphere_sphere ---------------------------------------------------------------------

void compare_sphere_sphere(const Module& module, const Case& truth, Comparison& comparison) {
  Collision collision;
  collision.contact = {truth.input("contact_point").vector3(),
                       truth.input("normal_B_to_A").vector3()};
  collision.a = body_at(ball_inertia(truth.input("mA").number(), truth.input("RA").number()),
                        truth.input("xA").vector3(), truth.input("vA").vector3());
  collision.b = body_at(ball_inertia(truth.input("mB").number(), truth.input("RB").number()),
                        truth.input("xB").vector3(), truth.input("vB").vector3());
  collision.restitution = truth.input("e").number();
  comparison.attempt("collision_impulse, resolve_collision", [&] {
    const Answer answer = answer_of(module, collision);
    compare_scalars(truth, comparison, answer);
    compare_if_given(truth, comparison, "vA_after", VectorXd(answer.a_after.linear_world));
    compare_if_given(truth, comparison, "wA_after", VectorXd(answer.a_after.angular_world));
    compare_if_given(truth, comparison, "vB_after", VectorXd(answer.b_after.linear_world));
    compare_if_given(truth, comparison, "wB_after", VectorXd(answer.b_after.angular_world));
  });
}

// ---- impulse_rod_ball --------------------------------------------------------------------------

// Rod along x at rest, centre at the origin; ball A above it at distance d from the centre.
void compare_rod_ball(const Module& module, const Case& truth, Comparison& comparison) {
  const double mass = truth.input("M_rod").number(), length = truth.input("L_rod").number(),
               d = truth.input("d").number();
  const double transverse = mass * length * length / 12.0;
  // The moment about the rod's own axis has no effect: there is no rotation about x. A thin rod has
  // almost none.
  const Inertia rod =
      finite_inertia(mass, Vector3d(1e-3 * transverse, transverse, transverse).asDiagonal());
  Collision collision;
  collision.contact = {Vector3d(d, 0, 0), truth.input("normal_rod_to_ball").vector3()};
  collision.a = body_at(ball_inertia(truth.input("m_ball").number(), 1.0), Vector3d(d, 0, 1.0),
                        truth.input("v_ball").vector3());
  collision.b = body_at(rod, Vector3d::Zero(), Vector3d::Zero());
  collision.restitution = truth.input("e").number();
  comparison.attempt("collision_impulse, resolve_collision", [&] {
    const Answer answer = answer_of(module, collision);
    const Velocity& after = answer.b_after;
    compare_scalars(truth, comparison, answer);
    compare_if_given(truth, comparison, "ball_vz_after", answer.a_after.linear_world.z());
    compare_if_given(truth, comparison, "rod_vz_after", after.linear_world.z());
    compare_if_given(truth, comparison, "rod_wy_after", after.angular_world.y());
    compare_if_given(truth, comparison, "rod_I_transverse", transverse);
    // The point of the rod that stays at rest: V - w x = 0.
    compare_if_given(truth, comparison, "instant_centre_x",
                     after.linear_world.z() / after.angular_world.y());
  });
}

// ---- impulse_box_corner ------------------------------------------------------------------------

void compare_box_corner(const Module& module, const Case& truth, Comparison& comparison) {
  const double mass = truth.input("m").number();
  const Vector3d squared = truth.input("half_extents").vector3().cwiseAbs2();
  const Vector3d moments =
      mass / 3.0 *
      Vector3d(squared.y() + squared.z(), squared.x() + squared.z(), squared.x() + squared.y());
  const VectorXd q = truth.input("q").vector();
  Collision collision;
  collision.contact = {truth.input("contact_point").vector3(), truth.input("normal").vector3()};
  collision.a = body_at(finite_inertia(mass, moments.asDiagonal()), truth.input("x").vector3(),
                        truth.input("v").vector3(), truth.input("omega_world").vector3());
  collision.a.world_from_body = Quaterniond(q[0], q[1], q[2], q[3]).normalized();
  collision.b =
      body_at(infinite_inertia(), Vector3d::Zero(), truth.input("floor_velocity").vector3());
  collision.restitution = truth.input("e").number();

  const Matrix3d R = collision.a.world_from_body.toRotationMatrix();
  const Matrix3d inertia_world = R * moments.asDiagonal() * R.transpose();
  if (truth.has_output("I_world"))
    comparison.closed_form(
        "I_world", (inertia_world - truth.output("I_world").matrix3()).cwiseAbs().maxCoeff(),
        truth.floor("I_world"));
  comparison.attempt("collision_impulse, resolve_collision", [&] {
    const Answer answer = answer_of(module, collision);
    compare_scalars(truth, comparison, answer);
    compare_if_given(truth, comparison, "v_after", VectorXd(answer.a_after.linear_world));
    compare_if_given(truth, comparison, "w_after", VectorXd(answer.a_after.angular_world));
  });
}

// ---- impulse_random ----------------------------------------------------------------------------

/// Body A or B of a row, its tensor given in the world frame at the instant of impact, when body
/// and world axes coincide.
Body body_of_row(const Value& inputs, const std::string& which) {
  const bool immovable = inputs.at("m" + which).text() == "infinite";
  const Inertia inertia = immovable ? infinite_inertia()
                                    : finite_inertia(inputs.at("m" + which).number(),
                                                     inputs.at("I" + which + "_world").matrix3());
  return body_at(inertia, inputs.at("x" + which).vector3(), inputs.at("v" + which).vector3(),
                 inputs.at("w" + which + "_world").vector3());
}

void compare_random_row(const Module& module, const Value& row, const std::string& name,
                        Comparison& comparison) {
  const Value& inputs = row.at("inputs");
  const Value& outputs = row.at("outputs");
  const Collision collision{
      {inputs.at("contact_point").vector3(), inputs.at("normal_B_to_A").vector3()},
      body_of_row(inputs, "A"),
      body_of_row(inputs, "B"),
      inputs.at("e").number()};
  const Answer answer = answer_of(module, collision);
  const double impulse_floor = row.at("tolerance_floor").at("j").number();
  const double velocity_floor = row.at("tolerance_floor").at("velocities").number();

  comparison.closed_form(name + ".j", std::abs(answer.impulse - outputs.at("j").number()),
                         impulse_floor);
  const auto velocity = [&](const std::string& output, const Vector3d& found) {
    comparison.closed_form(name + "." + output,
                           truths::largest_difference(found, outputs.at(output).vector3()),
                           velocity_floor);
  };
  velocity("vA_after", answer.a_after.linear_world);
  velocity("wA_after", answer.a_after.angular_world);
  velocity("vB_after", answer.b_after.linear_world);
  velocity("wB_after", answer.b_after.angular_world);
  comparison.closed_form(name + ".relative_normal_velocity_before",
                         std::abs(answer.normal_velocity_before -
                                  outputs.at("relative_normal_velocity_before").number()),
                         velocity_floor);
  comparison.closed_form(name + ".relative_normal_velocity_after",
                         std::abs(answer.normal_velocity_after -
                                  outputs.at("relative_normal_velocity_after").number()),
                         velocity_floor);
  // j k = -(1 + e) u_n: a relative error of the impulse is one of k.
  const double k = outputs.at("effective_inverse_mass").number();
  comparison.closed_form(name + ".effective_inverse_mass",
                         std::abs(answer.effective_inverse_mass - k),
                         k * impulse_floor / std::abs(outputs.at("j").number()));
  // The rows have no floor for energies: half m v^2 and half w I w have twice the relative rounding
  // of their velocities.
  const double before = row.at("kinetic_energy_before").number(),
               after = row.at("kinetic_energy_after").number();
  const double relative =
      2.0 * velocity_floor /
      std::max(1.0, answer.a_after.linear_world.norm() + answer.b_after.linear_world.norm());
  comparison.closed_form(name + ".kinetic_energy_before", std::abs(answer.energy_before - before),
                         before * relative);
  comparison.closed_form(name + ".kinetic_energy_after", std::abs(answer.energy_after - after),
                         before * relative);
}

void compare_random(const Module& module, const Case& truth, Comparison& comparison) {
  const auto& rows = truth.output("rows").list();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string name = "rows[" + std::to_string(i) + "]";
    comparison.attempt(name, [&] { compare_random_row(module, rows[i], name, comparison); });
  }
}

// ---- ray_triangle ------------------------------------------------------------------------------

/// Compares the file's values for one ray and one triangle with the module's.
/// @param is_alone  whether no other triangle of the file can have a point on this one's edge
void compare_hit(const Value& expected, bool exact_inputs, bool is_alone,
                 const std::optional<RayHit>& hit, const Ray& ray, const Triangle& triangle,
                 const std::string& name, Comparison& comparison) {
  if (expected.at("hit").is_null()) {
    comparison.not_compared(name, expected.at("class").text() +
                                      ": the ray lies in the triangle's plane, any answer will do");
    return;
  }
  const bool should_hit = expected.at("hit").boolean();
  const std::string& kind = expected.at("class").text();
  if (hit.has_value() != should_hit) {
    // Inputs that are not binary fractions are rounded, and with them a point exactly on the edge.
    const bool undecidable = !exact_inputs && kind.rfind("on_", 0) == 0;
    const bool is_shared = !is_alone && should_hit && kind.rfind("on_", 0) == 0;
    if (is_shared)
      comparison.not_compared(
          name,
          kind +
              " of triangles that share it: rounding may decide which of them is hit, see any_hit");
    else if (undecidable)
      comparison.not_compared(
          name, kind + ", and the inputs are not binary fractions: either answer will do");
    else
      comparison.agree(name, false, kind + ": should be a " + (should_hit ? "hit" : "miss"));
    return;
  }
  comparison.agree(name, true, kind);
  if (!should_hit) return;

  // The file's floor of t is 4 u max|coordinate| |N| / |N.d|, of a length along the ray. The point
  // moves along the ray by that times |d|, the weights by that over the smallest height of the
  // triangle.
  const double floor = expected.at("t_tolerance_floor").number();
  comparison.closed_form(name + ".t", std::abs(hit->t - expected.at("t").number()), floor);
  const double moved = floor * ray.direction_world.norm();
  const Vector3d ab = triangle.b_world - triangle.a_world, ac = triangle.c_world - triangle.a_world,
                 bc = triangle.c_world - triangle.b_world;
  const double height = ab.cross(ac).norm() / std::max({ab.norm(), ac.norm(), bc.norm()});
  // Coordinates near the hit are rounded too, by u of the largest.
  const double size = std::max({triangle.a_world.norm(), triangle.b_world.norm(),
                                triangle.c_world.norm(), ray.origin_world.norm(), 0.0});
  const double rounding = 0x1p-53 * std::max(size, hit->t * ray.direction_world.norm());
  comparison.closed_form(
      name + ".bary", truths::largest_difference(hit->barycentric, expected.at("bary").vector3()),
      0x1p-53 + (moved + rounding) / height);
  const Vector3d point_world = triangle.a_world * hit->barycentric[0] +
                               triangle.b_world * hit->barycentric[1] +
                               triangle.c_world * hit->barycentric[2];
  comparison.closed_form(name + ".point",
                         truths::largest_difference(point_world, expected.at("point").vector3()),
                         moved + rounding);
}

void compare_rays(const Module& module, const Case& truth, Comparison& comparison) {
  std::vector<Triangle> triangles;
  for (const Value& corners : truth.input("triangles").list()) {
    const Matrix3d rows = corners.matrix3();
    triangles.push_back({rows.row(0), rows.row(1), rows.row(2)});
  }
  for (const Value& row : truth.output("rays").list()) {
    const Ray ray{row.at("origin").vector3(), row.at("direction").vector3()};
    const bool exact_inputs = row.at("inputs_exact_in_binary64").boolean();
    comparison.attempt(row.at("name").text(), [&] {
      bool any_hit = false, unanswerable = false;
      for (const Value& expected : row.at("per_triangle").list()) {
        const auto index = static_cast<std::size_t>(expected.at("triangle").integer());
        const std::optional<RayHit> hit = module.intersect_ray_triangle(ray, triangles.at(index));
        any_hit = any_hit || hit.has_value();
        unanswerable = unanswerable || expected.at("hit").is_null();
        const std::string name =
            row.at("name").text() + (triangles.size() > 1 ? "[" + std::to_string(index) + "]" : "");
        compare_hit(expected, exact_inputs, triangles.size() == 1, hit, ray, triangles[index], name,
                    comparison);
      }
      // Of triangles with a common edge or corner at least one is hit: no ray passes between them.
      if (!unanswerable && triangles.size() > 1)
        comparison.agree(row.at("name").text() + ".any_hit", any_hit == row.at("any_hit").boolean(),
                         "at least one of the triangles around a shared edge or corner");
    });
  }
}

}  // namespace

void register_truths(modules::Registry& registry) {
  registry.set_note(
      Module::kId,
      truths::ModuleTruths{{{"impulse_sphere_sphere", truths::for_module(&compare_sphere_sphere)},
                            {"impulse_rod_ball", truths::for_module(&compare_rod_ball)},
                            {"impulse_box_corner", truths::for_module(&compare_box_corner)},
                            {"impulse_random", truths::for_module(&compare_random)},
                            {"ray_triangle", truths::for_module(&compare_rays)}}});
}

}  // namespace tumble::a1
