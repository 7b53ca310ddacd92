#include "framework/effects/water/submerged.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "framework/core/error.h"

namespace tumble::effects {
namespace {

/// Moves moments to those about another origin, which lies at -shift: x becomes x + shift.
Submerged shifted(const Submerged& moments, const Vector3d& shift) {
  const Matrix3d mixed = shift * moments.first.transpose();
  return {moments.volume, moments.first + moments.volume * shift,
          moments.second + mixed + mixed.transpose() + moments.volume * shift * shift.transpose()};
}

// Of the tetrahedron from the origin to a face:  d = a . (b x c),  V = d / 6,  int x = d s / 24,
// int x x' = d (a a' + b b' + c c' + s s') / 120
void add_tetrahedron(const Vector3d& a, const Vector3d& b, const Vector3d& c, Submerged& sum) {
  const double d = a.dot(b.cross(c));
  const Vector3d s = a + b + c;
  sum.volume += d / 6.0;
  sum.first += d / 24.0 * s;
  sum.second +=
      d / 120.0 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose());
}

// The part of a face under the plane through the origin: a triangle or a quadrilateral, in the
// face's own order.
void add_cut_face(const std::array<Vector3d, 3>& corners, const Vector3d& normal, Submerged& sum) {
  std::array<Vector3d, 4> kept;
  std::size_t count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3d &from = corners[i], &to = corners[(i + 1) % 3];
    const double here = normal.dot(from), there = normal.dot(to);
    if (here <= 0.0) kept[count++] = from;
    if ((here < 0.0 && there > 0.0) || (here > 0.0 && there < 0.0))
      kept[count++] = from + here / (here - there) * (to - from);
  }
  for (std::size_t k = 2; k < count; ++k) add_tetrahedron(kept[0], kept[k - 1], kept[k], sum);
}

}  // namespace

Submerged submerged_ball(double radius, const Vector3d& normal, double offset) {
  const double R = radius, d = std::clamp(offset, -R, R);
  const auto between = [&](const auto& antiderivative) {
    return std::numbers::pi * (antiderivative(d) - antiderivative(-R));
  };
  const double along =
      between([&](double z) { return R * R * std::pow(z, 3) / 3.0 - std::pow(z, 5) / 5.0; });
  const double across =
      0.25 * between([&](double z) {
        return std::pow(R, 4) * z - 2.0 * R * R * std::pow(z, 3) / 3.0 + std::pow(z, 5) / 5.0;
      });
  const Matrix3d n = normal * normal.transpose();
  return {between([&](double z) { return R * R * z - z * z * z / 3.0; }),
          between([&](double z) { return R * R * z * z / 2.0 - std::pow(z, 4) / 4.0; }) * normal,
          along * n + across * (Matrix3d::Identity() - n)};
}

Submerged submerged_ellipsoid(const Ellipsoid& ellipsoid, const Vector3d& normal, double offset) {
  // x = c + A y with |y| <= 1:  n . x <= d  is  (A n) . y <= d - n . c
  const Eigen::DiagonalMatrix<double, 3> A(ellipsoid.semi_axes_body);
  const Vector3d direction = A * normal;
  const double length = direction.norm(), stretch = ellipsoid.semi_axes_body.prod();
  const Submerged ball = submerged_ball(1.0, direction / length,
                                        (offset - normal.dot(ellipsoid.center_body)) / length);
  return shifted(
      {stretch * ball.volume, stretch * (A * ball.first), stretch * (A * ball.second * A)},
      ellipsoid.center_body);
}

Submerged submerged_mesh(const TriangleMesh& mesh, const Vector3d& normal, double offset) {
  const Vector3d origin = offset * normal;  // in the plane
  Submerged sum;
  for (const Face& face : mesh.faces) {
    const auto corner = [&](std::size_t k) -> Vector3d {
      return mesh.vertices[static_cast<std::size_t>(face[k])] - origin;
    };
    add_cut_face({corner(0), corner(1), corner(2)}, normal, sum);
  }
  return shifted(sum, origin);
}

Floatable::Floatable(const Shape& shape) : solid_(TriangleMesh{}), radius_(bounding_radius(shape)) {
  require(!std::holds_alternative<HalfSpace>(shape), "a half-space does not float");
  if (const auto* sphere = std::get_if<Sphere>(&shape))
    solid_ = *sphere;
  else if (const auto* ellipsoid = std::get_if<Ellipsoid>(&shape))
    solid_ = *ellipsoid;
  else if (const auto* mesh = std::get_if<MeshSolid>(&shape))
    solid_ = mesh->mesh_body;
  else
    solid_ = surface_of(shape);
  whole_ = under(Vector3d::UnitZ(), radius_);
}

Submerged Floatable::under(const Vector3d& normal_body, double offset) const {
  if (offset <= -radius_) return {};
  if (offset >= radius_ && whole_.volume > 0.0) return whole_;
  if (const auto* sphere = std::get_if<Sphere>(&solid_))
    return submerged_ball(sphere->radius, normal_body, offset);
  if (const auto* ellipsoid = std::get_if<Ellipsoid>(&solid_))
    return submerged_ellipsoid(*ellipsoid, normal_body, offset);
  return submerged_mesh(std::get<TriangleMesh>(solid_), normal_body, offset);
}

std::pair<double, double> Floatable::reach(const Vector3d& direction_body) const {
  if (const auto* sphere = std::get_if<Sphere>(&solid_)) return {-sphere->radius, sphere->radius};
  if (const auto* ellipsoid = std::get_if<Ellipsoid>(&solid_)) {
    const double middle = direction_body.dot(ellipsoid->center_body),
                 half = direction_body.cwiseProduct(ellipsoid->semi_axes_body).norm();
    return {middle - half, middle + half};
  }
  std::pair<double, double> reach{radius_, -radius_};
  for (const Vector3d& vertex : std::get<TriangleMesh>(solid_).vertices) {
    const double along = direction_body.dot(vertex);
    reach = {std::min(reach.first, along), std::max(reach.second, along)};
  }
  return reach;
}

}  // namespace tumble::effects
