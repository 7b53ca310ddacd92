// The equations of a3, term by term: for the stories of wrong answers
// (framework/grading/verdicts/xray.h).
#include "assignments/a3_constraints/a3_constraints.h"
#include "framework/grading/verdicts/xray.h"

namespace tumble::a3 {
namespace {

using grading::numbers;
using grading::Xray;
using Shown = std::optional<Xray>;

// (A3.1)
Shown position(const Vector3d& found, const Body& body, const Vector3d& point) {
  const Vector3d r = body.world_from_body * point, &x_com = body.com_world;
  Xray x{"p = x + R p_body   (A3.1)", {}, "p", "m", {}, {}, {}};
  x.terms = {{"x", numbers(x_com), "m"}, {"R p_body", numbers(r), "m"}};
  x.expected = numbers(Vector3d(x_com + r));
  x.found = numbers(found);
  x.variants = {{1, "with p_body for R p_body", numbers(Vector3d(x_com + point))},
                {1, "with R^T p_body for R p_body",
                 numbers(Vector3d(x_com + body.world_from_body.conjugate() * point))},
                {0, "without x", numbers(r)}};
  return x;
}

// (A3.2)
Shown velocity(const Vector3d& found, const Body& body, const Vector3d& point) {
  const Vector3d r = body.world_from_body * point, &v = body.velocity_world, &w = body.omega_world;
  Xray x{"v_p = v + omega x r,  r = R p_body   (A3.2)", {}, "v_p", "m/s", {}, {}, {}};
  x.terms = {{"v", numbers(v), "m/s"},
             {"r = R p_body", numbers(r), "m"},
             {"omega x r", numbers(Vector3d(w.cross(r))), "m/s"}};
  x.expected = numbers(Vector3d(v + w.cross(r)));
  x.found = numbers(found);
  x.variants = {{1, "with p_body for R p_body", numbers(Vector3d(v + w.cross(point)))},
                {1, "with r = p, the arm from the world's origin",
                 numbers(Vector3d(v + w.cross(body.com_world + r)))},
                {2, "with r x omega for omega x r", numbers(Vector3d(v - w.cross(r)))},
                {2, "without omega x r", numbers(v)}};
  return x;
}

// (A3.3)
Shown spring(const Vector3d& found, const Spring& s, const AnchorState& a, const AnchorState& b) {
  const Vector3d d = b.point_world - a.point_world, relative = b.velocity_world - a.velocity_world;
  const double length = d.stableNorm();  // of very long and very short springs, too
  if (!(length > 0.0)) return std::nullopt;
  const Vector3d n = d / length;
  const double pull = s.stiffness * (length - s.rest_length), drag = s.damping * n.dot(relative);
  Xray x{"F = (k (|d| - L0) + c n . (v_b - v_a)) n,  d = p_b - p_a   (A3.3)",
         {},
         "F on A",
         "N",
         {},
         {},
         {}};
  x.terms = {{"d", numbers(d), "m"},
             {"|d| - L0", numbers(length - s.rest_length), "m"},
             {"n = d / |d|", numbers(n), ""},
             {"k (|d| - L0)", numbers(pull), "N"},
             {"c n . (v_b - v_a)", numbers(drag), "N"}};
  x.expected = numbers(Vector3d((pull + drag) * n));
  x.found = numbers(found);
  x.variants = {{0, "with d = p_a - p_b: the force on B", numbers(Vector3d(-(pull + drag) * n))},
                {1, "with |d|, without L0", numbers(Vector3d((s.stiffness * length + drag) * n))},
                {3, "without k (|d| - L0)", numbers(Vector3d(drag * n))},
                {4, "without the damper", numbers(Vector3d(pull * n))},
                {4, "with the other sign of this line", numbers(Vector3d((pull - drag) * n))},
                {4, "with c n . (-v_a), the velocity of one end alone",
                 numbers(Vector3d((pull - s.damping * n.dot(a.velocity_world)) * n))},
                {4, "with c (v_b - v_a), in every direction",
                 numbers(Vector3d(pull * n + s.damping * relative))}};
  return x;
}

// (A3.4) and (A3.5)
Shown rod(const ConstraintRow& found, const Body& a, const Vector3d& point_a, const Body& b,
          const Vector3d& point_b, const double& length) {
  const Vector3d r_a = a.world_from_body * point_a, r_b = b.world_from_body * point_b,
                 d = (a.com_world - b.com_world) + (r_a - r_b);
  const double distance = d.stableNorm();
  if (!(distance > 0.0)) return std::nullopt;
  const Vector3d n = d / distance,
                 rate = a.velocity_world + a.omega_world.cross(r_a) - b.velocity_world -
                        b.omega_world.cross(r_b),
                 across = rate - n.dot(rate) * n;
  const double centripetal = n.dot(a.omega_world.cross(a.omega_world.cross(r_a)) -
                                   b.omega_world.cross(b.omega_world.cross(r_b))),
               turning = across.squaredNorm() / distance;
  Vector6d j_a, j_b;
  j_a << n, r_a.cross(n);
  j_b << -n, -r_b.cross(n);
  Xray x{
      "C = |d| - length,  C' = n . d',  J_a = (n, r_a x n),  J_b = (-n, -(r_b x n))   (A3.4), "
      "(A3.5)",
      {},
      "C; C'; J_a; J_b; J' u",
      "",
      {},
      {},
      {}};
  x.terms = {{"n = d / |d|", numbers(n)},
             {"r_a", numbers(r_a), "m"},
             {"r_b", numbers(r_b), "m"},
             {"C", numbers(distance - length), "m", numbers(found.value)},
             {"C' = n . d'", numbers(n.dot(rate)), "m/s", numbers(found.rate)},
             {"J_a", numbers(j_a), "", numbers(found.jacobian_a)},
             {"J_b", numbers(j_b), "", numbers(found.jacobian_b)},
             {"n . (centripetal)", numbers(centripetal), "m/s^2"},
             {"(|d'|^2 - (n . d')^2) / |d|", numbers(turning), "m/s^2"},
             {"J' u, the sum of both", numbers(centripetal + turning), "m/s^2",
              numbers(found.velocity_product)}};
  const auto all = [](double value, double c_rate, const Vector6d& of_a, const Vector6d& of_b,
                      double product) {
    VectorXd v(15);
    v << value, c_rate, of_a, of_b, product;
    return v;
  };
  const auto with = [&](double product) {
    return all(distance - length, n.dot(rate), j_a, j_b, product);
  };
  x.expected = with(centripetal + turning);
  x.found =
      all(found.value, found.rate, found.jacobian_a, found.jacobian_b, found.velocity_product);
  x.variants = {{7, "without this line", with(turning)},
                {8, "without this line", with(centripetal)},
                {9, "with 0 for both", with(0.0)},
                {9, "with the other sign of this line", with(-centripetal - turning)},
                {3, "with the other sign of this line",
                 all(length - distance, n.dot(rate), j_a, j_b, centripetal + turning)}};
  return x;
}

// (A3.6)
Shown baumgarte(const double& found, const double& value, const double& rate, const double& time) {
  Xray x{"-2/T C' - C/T^2   (A3.6)", {}, "C''", "m/s^2", {}, {}, {}};
  const double damping = -2.0 / time * rate, stiffness = -value / (time * time);
  x.terms = {{"C", numbers(value), "m"},
             {"C'", numbers(rate), "m/s"},
             {"-2/T C'", numbers(damping), "m/s^2"},
             {"-C/T^2", numbers(stiffness), "m/s^2"}};
  x.expected = numbers(damping + stiffness);
  x.found = numbers(found);
  x.variants = {{2, "with -C'/T: the 2 is missing", numbers(0.5 * damping + stiffness)},
                {3, "with -C/T: T is not squared", numbers(damping - value / time)},
                {3, "with the other sign of both lines", numbers(-damping - stiffness)}};
  return x;
}

[[maybe_unused]] const bool kAdded[] = {grading::add_xray_of("anchor_position", position),
                                        grading::add_xray_of("anchor_velocity", velocity),
                                        grading::add_xray_of("spring_force", spring),
                                        grading::add_xray_of("rod_row", rod),
                                        grading::add_xray_of("baumgarte_acceleration", baumgarte)};

}  // namespace
}  // namespace tumble::a3
