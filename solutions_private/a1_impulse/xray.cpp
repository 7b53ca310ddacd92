// The equations of a1, term by term: for the stories of wrong answers
// (framework/grading/verdicts/xray.h). Each describes one function: its terms from the arguments,
// and the answers of frequent mistakes.
#include "assignments/a1_impulse/a1_impulse.h"
#include "framework/grading/verdicts/xray.h"

namespace tumble::a1 {
namespace {

using grading::numbers;
using grading::Xray;
using Shown = std::optional<Xray>;

Matrix3d rotation_of(const Body& body) { return body.world_from_body.toRotationMatrix(); }

Matrix3d inverse_inertia_world(const Body& body) {
  const Matrix3d r = rotation_of(body);
  return r * body.inertia.inverse_inertia_body * r.transpose();
}

Vector3d velocity_at(const Body& body, const Vector3d& arm) {
  return body.velocity_world + body.omega_world.cross(arm);
}

Vector3d arm_of(const Body& body, const Contact& contact) {
  return contact.point_world - body.com_world;
}

// (A1.2)
Shown point_force(const Wrench& found, const Vector3d& force, const Vector3d& point,
                  const Vector3d& com) {
  const Vector3d r = point - com, torque = r.cross(force);
  Xray x{"tau = r x F,  r = p - x   (A1.2)", {}, "F; tau", "N; N m", {}, {}, {}};
  x.terms = {{"F", numbers(force), "N", numbers(found.force_world)},
             {"r = p - x", numbers(r), "m"},
             {"r x F", numbers(torque), "N m", numbers(found.torque_world)}};
  x.expected = numbers(force, torque);
  x.found = numbers(found.force_world, found.torque_world);
  x.variants = {
      {1, "with r = p, the arm from the world's origin", numbers(force, point.cross(force))},
      {1, "with F x r for r x F", numbers(force, force.cross(r))},
      {1, "with r = x - p", numbers(force, Vector3d(-r).cross(force))}};
  return x;
}

// (A1.3)
Shown acceleration(const Vector3d& found, const Body& body, const Vector3d& force) {
  Xray x{"a = F (1/m)   (A1.3)", {}, "a", "m/s^2", {}, {}, {}};
  x.terms = {{"F", numbers(force), "N"}, {"1/m", numbers(body.inertia.inverse_mass), "1/kg"}};
  x.expected = numbers(Vector3d(force * body.inertia.inverse_mass));
  x.found = numbers(found);
  x.variants = {{1, "with m for 1/m", numbers(Vector3d(force * body.inertia.mass))},
                {1, "without any mass", numbers(force)}};
  return x;
}

// (A1.4), in the body frame.
Shown turning(const Vector3d& found, const Body& body, const Vector3d& torque) {
  if (body.inertia.inverse_mass == 0.0) return std::nullopt;
  const Matrix3d r = rotation_of(body), inertia = body.inertia.inertia_body,
                 inverse = body.inertia.inverse_inertia_body;
  const Vector3d w = r.transpose() * body.omega_world, tau = r.transpose() * torque,
                 gyroscopic = w.cross(inertia * w);
  Xray x{"alpha = R I^-1 (R^T tau - w x (I w)),  w = R^T omega   (A1.4)",
         {},
         "alpha",
         "rad/s^2",
         {},
         {},
         {}};
  x.terms = {
      {"R^T tau", numbers(tau), "N m"},
      {"w = R^T omega", numbers(w), "rad/s"},
      {"w x (I w)", numbers(gyroscopic), "N m"},
      {"I^-1 (R^T tau - w x (I w))", numbers(Vector3d(inverse * (tau - gyroscopic))), "rad/s^2"}};
  x.expected = numbers(Vector3d(r * (inverse * (tau - gyroscopic))));
  x.found = numbers(found);
  x.variants = {{0, "with tau of the world frame for R^T tau",
                 numbers(Vector3d(r * (inverse * (torque - gyroscopic))))},
                {2, "without w x (I w)", numbers(Vector3d(r * (inverse * tau)))},
                {2, "with the other sign of w x (I w)",
                 numbers(Vector3d(r * (inverse * (tau + gyroscopic))))},
                {3, "as I^-1 of the body frame times tau of the world frame, without w x (I w)",
                 numbers(Vector3d(inverse * torque))},
                {3, "with I for I^-1", numbers(Vector3d(r * (inertia * (tau - gyroscopic))))},
                {3, "without R, the rotation back to the world",
                 numbers(Vector3d(inverse * (tau - gyroscopic)))}};
  return x;
}

// (A1.5)
Shown approach(const double& found, const Contact& contact, const Body& a, const Body& b) {
  const Vector3d r_a = arm_of(a, contact), r_b = arm_of(b, contact), u_a = velocity_at(a, r_a),
                 u_b = velocity_at(b, r_b), &n = contact.normal_b_to_a_world,
                 &p = contact.point_world;
  Xray x{"u_n = n . (u_a - u_b),  u = v + omega x r   (A1.5)", {}, "u_n", "m/s", {}, {}, {}};
  x.terms = {{"n", numbers(n), ""},
             {"r_a = p - x_a", numbers(r_a), "m"},
             {"r_b = p - x_b", numbers(r_b), "m"},
             {"u_a", numbers(u_a), "m/s"},
             {"u_b", numbers(u_b), "m/s"}};
  x.expected = numbers(n.dot(u_a - u_b));
  x.found = numbers(found);
  const auto with = [&](const Vector3d& of_a, const Vector3d& of_b) {
    return numbers(n.dot(of_a - of_b));
  };
  x.variants = {{3, "with u_b - u_a for u_a - u_b", with(u_b, u_a)},
                {3, "with v alone, without omega x r", with(a.velocity_world, b.velocity_world)},
                {3, "with r x omega for omega x r",
                 with(a.velocity_world - a.omega_world.cross(r_a),
                      b.velocity_world - b.omega_world.cross(r_b))},
                {1, "with r = p, the arm from the world's origin",
                 with(velocity_at(a, p), velocity_at(b, p))},
                {2, "with r_a, the arm of A, for B", with(u_a, velocity_at(b, r_a))},
                {4, "with v alone for B, without omega x r", with(u_a, b.velocity_world)},
                {4, "without u_b", with(u_a, Vector3d::Zero())}};
  return x;
}

// -(1 + e) u_n / k, with the answers of mistakes in each.
Xray quotient(const std::string& equation, double found, double u, double k, double e) {
  Xray x{equation, {}, "j", "N s", {}, {}, {}};
  x.terms = {{"u_n", numbers(u), "m/s"}, {"1 + e", numbers(1.0 + e), ""}};
  const bool hits = u < 0.0 && k > 0.0;
  x.expected = numbers(hits ? -(1.0 + e) * u / k : 0.0);
  x.found = numbers(found);
  if (k <= 0.0) return x;
  x.variants = {{0, "with -u_n for u_n", numbers((1.0 + e) * u / k)},
                {1, "with e for 1 + e", numbers(-e * u / k)},
                {1, "with 1 for 1 + e", numbers(-u / k)},
                {1, "with 1 + e^2 for 1 + e", numbers(-(1.0 + e * e) * u / k)}};
  if (!hits)
    x.variants = {{0, "by the same equation, though the bodies do not approach (u_n >= 0)",
                   numbers(-(1.0 + e) * u / k)}};
  return x;
}

// (A1.8)
Shown impulse_of_points(const double& found, const Contact& contact, const Body& a, const Body& b,
                        const double& e) {
  const double u = contact.normal_b_to_a_world.dot(a.velocity_world - b.velocity_world),
               m_a = a.inertia.inverse_mass, m_b = b.inertia.inverse_mass, k = m_a + m_b;
  Xray x = quotient("j = -(1 + e) u_n / (1/m_a + 1/m_b)   (A1.8)", found, u, k, e);
  x.terms.push_back({"1/m_a + 1/m_b", numbers(k), "1/kg"});
  const auto with = [&](double other) { return numbers(-(1.0 + e) * u / other); };
  if (u < 0.0 && k > 0.0) {
    x.variants.push_back({2, "with 1/m_a alone", with(m_a)});
    x.variants.push_back({2, "with 1/m_b alone", with(m_b)});
    x.variants.push_back({2, "with 1/(m_a + m_b)", with(1.0 / (a.inertia.mass + b.inertia.mass))});
  }
  return x;
}

// n . [(I^-1 (r x n)) x r]
double yielding(const Matrix3d& inverse_inertia, const Vector3d& r, const Vector3d& n) {
  return r.cross(n).dot(inverse_inertia * r.cross(n));
}

// (A1.9)
Shown impulse_of_bodies(const double& found, const Contact& contact, const Body& a, const Body& b,
                        const double& e) {
  const Vector3d &n = contact.normal_b_to_a_world, r_a = arm_of(a, contact),
                 r_b = arm_of(b, contact);
  const double u = n.dot(velocity_at(a, r_a) - velocity_at(b, r_b)),
               m = a.inertia.inverse_mass + b.inertia.inverse_mass,
               k_a = yielding(inverse_inertia_world(a), r_a, n),
               k_b = yielding(inverse_inertia_world(b), r_b, n);
  Xray x = quotient(
      "j = -(1 + e) u_n / (1/m_a + 1/m_b + k_a + k_b),  k = n . (I^-1 (r x n)) x r   (A1.9)", found,
      u, m + k_a + k_b, e);
  x.terms.push_back({"1/m_a + 1/m_b", numbers(m), "1/kg"});
  x.terms.push_back({"r_a", numbers(r_a), "m"});
  x.terms.push_back({"k_a", numbers(k_a), "1/kg"});
  x.terms.push_back({"r_b", numbers(r_b), "m"});
  x.terms.push_back({"k_b", numbers(k_b), "1/kg"});
  x.terms.push_back({"n", numbers(n), ""});
  if (!(u < 0.0) || m <= 0.0) return x;
  const auto with = [&](double k) { return numbers(-(1.0 + e) * u / k); };
  const double body_a = yielding(a.inertia.inverse_inertia_body, r_a, n),
               body_b = yielding(b.inertia.inverse_inertia_body, r_b, n);
  const double still = n.dot(a.velocity_world - b.velocity_world);
  x.variants.push_back({0, "with n . (v_a - v_b), without omega x r",
                        numbers(-(1.0 + e) * still / (m + k_a + k_b))});
  x.variants.push_back({2, "with the masses alone, without k_a and k_b", with(m)});
  x.variants.push_back(
      {2, "with the share of A alone, without 1/m_b and k_b", with(a.inertia.inverse_mass + k_a)});
  x.variants.push_back({4, "with I^-1 of the body frame for A and B", with(m + body_a + body_b)});
  x.variants.push_back({4, "with I^-1 of the body frame for A", with(m + body_a + k_b)});
  x.variants.push_back({6, "with I^-1 of the body frame for B", with(m + k_a + body_b)});
  x.variants.push_back({6, "without k_b", with(m + k_a)});
  x.variants.push_back({6, "with r_a, the arm of A, for B",
                        with(m + k_a + yielding(inverse_inertia_world(b), r_a, n))});
  return x;
}

// (A1.10)
Shown applied(const Velocity& found, const Body& body, const Vector3d& impulse,
              const Vector3d& point) {
  const Vector3d r = point - body.com_world, spin = r.cross(impulse), &v = body.velocity_world,
                 &w = body.omega_world, linear = v + impulse * body.inertia.inverse_mass;
  const Matrix3d inverse = inverse_inertia_world(body);
  Xray x{"v' = v + J/m,  omega' = omega + I^-1 (r x J)   (A1.10)",
         {},
         "v'; omega'",
         "m/s; rad/s",
         {},
         {},
         {}};
  x.terms = {
      {"J", numbers(impulse), "N s"},
      {"r = p - x", numbers(r), "m"},
      {"v", numbers(v), "m/s"},
      {"J/m", numbers(Vector3d(impulse * body.inertia.inverse_mass)), "m/s"},
      {"omega", numbers(w), "rad/s"},
      {"r x J", numbers(spin), "N m s"},
      {"I^-1 (r x J)", numbers(Vector3d(inverse * spin)), "rad/s"},
      {"v'", numbers(linear), "m/s", numbers(found.linear_world)},
      {"omega'", numbers(Vector3d(w + inverse * spin)), "rad/s", numbers(found.angular_world)}};
  x.expected = numbers(linear, Vector3d(w + inverse * spin));
  x.found = numbers(found.linear_world, found.angular_world);
  const Vector3d body_spin = body.inertia.inverse_inertia_body * spin;
  x.variants = {
      {2, "without v: the impulse replaces it",
       numbers(Vector3d(impulse * body.inertia.inverse_mass), Vector3d(w + inverse * spin))},
      {5, "with J x r for r x J", numbers(linear, Vector3d(w - inverse * spin))},
      {1, "with r = p, the arm from the world's origin",
       numbers(linear, Vector3d(w + inverse * point.cross(impulse)))},
      {6, "with I^-1 of the body frame, and r x J of the world frame",
       numbers(linear, Vector3d(w + body_spin))},
      {6, "without this line: omega stays as it was", numbers(linear, w)}};
  return x;
}

// (A1.7)
Vector2d beside(const Vector2d& from, const Vector2d& to, const Vector2d& a) {
  const Vector2d edge = to - from, right = Vector2d(edge.y(), -edge.x()).normalized();
  return right.dot(a - from) >= 0.0 ? right : Vector2d(-right);
}

Xray normal(const std::string& equation, const Vector2d& found, const Vector2d& n,
            const Vector2d& unscaled) {
  Xray x{equation, {{"before the division by its length", numbers(unscaled), "m"}}, "n", "", {}, {},
         {}};
  x.expected = numbers(n);
  x.found = numbers(found);
  x.variants = {
      {0, "as this line itself: the division by its length is missing", numbers(unscaled)},
      {0, "with the other sign: it points from A to B", numbers(Vector2d(-n))},
      {0, "with the other sign, and without the division by its length",
       numbers(Vector2d(-unscaled))}};
  return x;
}

Shown vertex_edge(const Vector2d& found, const Vector2d& vertex, const Vector2d& from,
                  const Vector2d& to) {
  const Vector2d n = beside(from, to, vertex);
  return normal("n = perpendicular of B's edge, on A's side, of length 1   (A1.7)", found, n,
                Vector2d(n * (to - from).norm()));
}

Shown edge_edge(const Vector2d& found, const Vector2d& from, const Vector2d& to,
                const Vector2d& com_a) {
  return vertex_edge(found, com_a, from, to);
}

Shown vertex_vertex(const Vector2d& found, const Vector2d& com_a, const Vector2d& com_b) {
  const Vector2d line = com_a - com_b;
  return normal("n = (x_a - x_b) / |x_a - x_b|   (A1.7)", found, line.normalized(), line);
}

std::string words_of_hit(const VectorXd& answer) {
  if (!(answer[0] > 0.0)) return "no hit";
  return "hit at t = " + grading::shown(numbers(answer[1]), "") + ", weights " +
         grading::shown(answer.tail(3), "");
}

// (A1.1): for rays that meet the plane. Whether a ray is a hit is not said where rounding alone
// decides it (t or a weight is almost 0): both answers are right then.
Shown ray(const std::optional<RayHit>& found, const Ray& ray, const Triangle& triangle) {
  const Vector3d ab = triangle.b_world - triangle.a_world, ac = triangle.c_world - triangle.a_world,
                 normal = ab.cross(ac), from = ray.origin_world - triangle.a_world,
                 &d = ray.direction_world;
  const double slope = normal.dot(d);
  constexpr double kRoundOff = 1e-9;  // relative
  if (!(std::abs(slope) > kRoundOff * normal.norm() * d.norm())) return std::nullopt;
  const double t = -normal.dot(from) / slope;
  const Vector3d q = d.cross(from);
  const double w_b = ac.dot(q) / slope, w_c = -ab.dot(q) / slope;
  const Vector3d weights(1.0 - w_b - w_c, w_b, w_c);
  Xray x{"o + t d = w_a a + w_b b + w_c c;  a hit has t >= 0 and no weight below 0   (A1.1)",
         {},
         "answer",
         "",
         {},
         {},
         {},
         words_of_hit};
  x.terms = {{"t", numbers(t), ""}, {"w_a, w_b, w_c", numbers(weights), ""}};
  const bool is_behind = t < 0.0, is_inside = weights.minCoeff() >= 0.0;
  const bool is_border = std::abs(t) <= kRoundOff * from.norm() / d.norm() ||
                         weights.cwiseAbs().minCoeff() <= kRoundOff * weights.cwiseAbs().maxCoeff();
  const bool is_hit = is_border ? found.has_value() : !is_behind && is_inside;
  const auto of = [](bool hit, double time, const Vector3d& w) {
    VectorXd all = VectorXd::Zero(5);
    if (hit) all << 1.0, time, w;
    return all;
  };
  x.expected = of(is_hit, t, weights);
  x.found = found ? of(true, found->t, found->barycentric) : of(false, 0.0, weights);
  x.variants = {{0, "with t in metres", of(is_hit, t * d.norm(), weights)},
                {1, "with the weights in another order",
                 of(is_hit, t, Vector3d(weights[1], weights[2], weights[0]))}};
  if (is_border) return x;
  if (is_hit) {
    x.variants.push_back({1, "as no hit, though no weight is below 0", of(false, t, weights)});
  } else if (is_inside) {
    x.variants.push_back(
        {0, "as a hit, though t < 0: it lies behind the origin of the ray", of(true, t, weights)});
  } else {
    x.variants.push_back({1, "as a hit, though a weight is below 0", of(true, t, weights)});
  }
  return x;
}

[[maybe_unused]] const bool kAdded[] = {
    grading::add_xray_of("intersect_ray_triangle", ray),
    grading::add_xray_of("wrench_of_point_force", point_force),
    grading::add_xray_of("linear_acceleration", acceleration),
    grading::add_xray_of("angular_acceleration", turning),
    grading::add_xray_of("relative_normal_velocity", approach),
    grading::add_xray_of("contact_normal_vertex_edge", vertex_edge),
    grading::add_xray_of("contact_normal_edge_edge", edge_edge),
    grading::add_xray_of("contact_normal_vertex_vertex", vertex_vertex),
    grading::add_xray_of("collision_impulse_without_rotation", impulse_of_points),
    grading::add_xray_of("collision_impulse", impulse_of_bodies),
    grading::add_xray_of("apply_impulse", applied)};

}  // namespace
}  // namespace tumble::a1
