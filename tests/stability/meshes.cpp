// Rows 8 and 22: degenerate surfaces; a scene and its masses a thousand kilometres from the origin.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/effects/gravity/gravity.h"
#include "framework/effects/rod/rod.h"
#include "framework/geometry/closed.h"
#include "framework/geometry/mass_properties.h"
#include "framework/geometry/shape.h"
#include "tests/stability/cases.h"
#include "tests/stability/support.h"

namespace tumble::battery {
namespace {

const Vector3d kHalf(0.5, 1.0, 1.5);  // of a box of 6 m^3

/// Largest relative error of volume and moments of a box whose axes are those of the mesh.
double box_error(const MassProperties& found) {
  const Vector3d s = (2 * kHalf).cwiseAbs2();
  const Vector3d moments = found.mass / 12 * Vector3d(s.y() + s.z(), s.x() + s.z(), s.x() + s.y());
  const Matrix3d exact = moments.asDiagonal();
  return std::max(std::abs(found.volume / 6.0 - 1),
                  (found.inertia_com_mesh - exact).cwiseAbs().maxCoeff() / moments.maxCoeff());
}

// ---- Row 8 --------------------------------------------------------------------------------------

void degenerate_meshes(const Given& given, Findings& findings) {
  const TriangleMesh good = surface_of(Box{kHalf});
  compare_with_truth(given, findings, "mass_properties/box_zero_area_triangles");
  compare_with_truth(given, findings, "mass_properties/box_cavity");

  TriangleMesh slivers = good;  // faces without area, and a vertex that stands twice at one place
  slivers.vertices.push_back(good.vertices[0]);
  const int twin = static_cast<int>(slivers.vertices.size()) - 1;
  slivers.faces.push_back({0, 1, 1});
  slivers.faces.push_back({0, 1, twin});
  slivers.faces.push_back({twin, 0, 0});
  findings.at_most("faces of zero area: volume and inertia, against without",
                   box_error(compute_mass_properties(slivers)), 1e-14, "",
                   "they add exactly nothing: the same roundings as without");
  const ClosedReport repaired = check_closed(slivers);
  findings.is_true("faces of zero area: repaired, or refused in words",
                   repaired.is_closed() ? box_error(compute_mass_properties(repaired.mesh)) <= 1e-14
                                        : !repaired.defects.empty(),
                   "repaired it weighs what it weighed, to 1e-14; never NaN");

  TriangleMesh inverted = good;
  for (Face& face : inverted.faces) std::swap(face[0], face[1]);
  const ClosedReport turned = check_closed(inverted);
  findings.at_most("inside out: signed volume against -6 m^3",
                   std::abs(signed_volume(inverted) / 6.0 + 1), 1e-14, "",
                   "a negative volume is how it shows");
  findings.at_most("inside out: turned with a notice, volume and inertia",
                   turned.is_closed() && !turned.notices.empty()
                       ? box_error(compute_mass_properties(turned.mesh))
                       : 1.0,
                   1e-14, "", "the same solid");

  TriangleMesh open = good;
  open.faces.pop_back();
  const ClosedReport hole = check_closed(open);
  findings.is_true("a face missing: refused, with the place",
                   !hole.is_closed() && hole.defects.front().kind == DefectKind::kMissingFace,
                   "every edge of a closed surface is in two faces, once in each direction");
  findings.must_fail("the textbook integral of the open surface: volume",
                     std::abs(signed_volume(open) / 6.0 - 1), 1e-14, "",
                     "it assumes a closed surface and does not look: a hole is a wrong weight");

  TriangleMesh nan = good;
  nan.vertices[3].y() = kUnset;
  const ClosedReport not_finite = check_closed(nan);
  findings.is_true(
      "a coordinate that is no number: refused",
      !not_finite.is_closed() && not_finite.defects.front().kind == DefectKind::kNotFinite,
      "never NaN in a mass");

  report::Plot plot{"A box one side of which is thinner and thinner",
                    {"thickness over length", "", report::Scale::kLog},
                    {"relative error of volume and moments", "", report::Scale::kLog},
                    {},
                    {{1e-12, "12 digits"}},
                    "What a plate weighs is known as well as what a cube weighs, down to a "
                    "millionth of its length."};
  report::Curve curve{"this project", {}, {}, true};
  for (double thin = 1.0; thin > 1e-8; thin *= 0.1) {
    const Vector3d half(0.5, 0.5, 0.5 * thin), s = (2 * half).cwiseAbs2();
    const MassProperties found = compute_mass_properties(surface_of(Box{half}));
    const Vector3d moments = thin / 12 * Vector3d(s.y() + s.z(), s.x() + s.z(), s.x() + s.y());
    curve.x.push_back(thin);
    curve.y.push_back(std::max({1e-17, std::abs(found.volume / thin - 1),
                                (found.inertia_com_mesh.diagonal() - moments)
                                    .cwiseQuotient(moments)
                                    .cwiseAbs()
                                    .maxCoeff()}));
  }
  plot.curves = {curve};
  findings.plot(std::move(plot));
}

// ---- Row 22 -------------------------------------------------------------------------------------

/// Moments about the centre of mass by the textbook: sums over tetrahedra from the world's origin,
/// then Steiner back.
Matrix3d textbook_inertia(const TriangleMesh& mesh) {
  double volume = 0.0;
  Vector3d first = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
  for (const Face& face : mesh.faces) {
    const Vector3d &a = mesh.vertices[face[0]], &b = mesh.vertices[face[1]],
                   &c = mesh.vertices[face[2]], s = a + b + c;
    const double d = a.dot(b.cross(c));
    volume += d / 6;
    first += d / 24 * s;
    second +=
        d / 120 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose());
  }
  const Vector3d com = first / volume;
  const Matrix3d about_com = second - volume * com * com.transpose();
  return about_com.trace() * Matrix3d::Identity() - about_com;
}

struct Placed {
  TriangleMesh mesh;
  Matrix3d exact;  // inertia about the centre of mass, density 1
};

Placed box_at(const Vector3d& place, const Quaterniond& turn) {
  Placed placed{surface_of(Box{kHalf}), {}};
  for (Vector3d& v : placed.mesh.vertices) v = turn * v + place;
  const Vector3d s = (2 * kHalf).cwiseAbs2(),
                 moments = 0.5 * Vector3d(s.y() + s.z(), s.x() + s.z(), s.x() + s.y());
  placed.exact =
      turn.toRotationMatrix() * moments.asDiagonal() * turn.toRotationMatrix().transpose();
  return placed;
}

void masses_far_off(const Given& given, Findings& findings) {
  compare_with_truth(given, findings, "mass_properties/box_offset_1e6");
  report::Plot plot{"Inertia of a rotated box, far from the origin",
                    {"distance", "m", report::Scale::kLog},
                    {"relative error", "", report::Scale::kLog},
                    {},
                    {{1e-8, "threshold"}},
                    "The sum about the world's origin cancels to nothing; about a point of the "
                    "solid nothing is lost but the rounding of its corners."};
  report::Curve ours{"summed about a point of the solid", {}, {}, true},
      book{"summed about the world's origin", {}, {}, true};
  for (const double far : {1.0, 1e2, 1e4, 1e6}) {
    for (const bool rotated : {false, true}) {
      const Placed placed =
          box_at(far * Vector3d(1, -0.6, 0.8),
                 rotated ? Quaterniond(0.8, 0.1, -0.5, 0.3).normalized() : Quaterniond::Identity());
      const double scale = placed.exact.cwiseAbs().maxCoeff();
      const double error = (compute_mass_properties(placed.mesh).inertia_com_mesh - placed.exact)
                               .cwiseAbs()
                               .maxCoeff() /
                           scale;
      const double naive =
          (textbook_inertia(placed.mesh) - placed.exact).cwiseAbs().maxCoeff() / scale;
      if (rotated) {
        ours.x.push_back(far), ours.y.push_back(std::max(error, 1e-17));
        book.x.push_back(far), book.y.push_back(std::max(naive, 1e-17));
      }
      if (far < 1e6) continue;
      const std::string name = rotated ? "rotated box, 10^6 m off" : "box, 10^6 m off";
      findings.at_most(name + ": inertia", error, 1e-8, "",
                       "corners are rounded by ulp(10^6) = 1.2e-10 m");
      findings.must_fail(name + ", textbook sum about the world's origin: inertia", naive, 1e-8, "",
                         "terms of 10^12 cancel to 1, after sums of 10^24");
    }
  }
  plot.curves = {ours, book};
  findings.plot(std::move(plot));
}

/// Balls and a box that fly, hit a floor and bounce.
scene::Scene bouncing(const Vector3d& origin) {
  scene::Scene scene = truths::empty_scene("far", 10.0, 1e-6);
  effects::set_gravity(scene, kDown);
  scene.bodies = {truths::ball("ball", 1.0, 0.25, Vector3d(0, 0, 2), Vector3d(0.5, 0, 0), 0.9),
                  truths::wall("floor", Vector3d::Zero(), Vector3d::UnitZ(), 0.9),
                  truths::wall("left", Vector3d(-1, 0, 0), Vector3d::UnitX(), 1.0),
                  truths::wall("right", Vector3d(1, 0, 0), -Vector3d::UnitX(), 1.0)};
  for (scene::BodySpec& body : scene.bodies) body.position_m += origin;
  return scene;
}

// Sizes and places below are multiples of 1/64 m, which are numbers 10^6 m off, too: what touches
// here neither overlaps nor floats there.
scene::Scene sliding_box() {
  scene::Scene scene =
      with_contact("slides to rest",
                   {rough(box("box", Vector3d(0.25, 0.25, 0.125), 1.0, Vector3d(0, 0, 0.125)), 0.3),
                    floor_of(0.3)});
  scene.bodies[0].velocity_m_s = Vector3d(1.5, 0.4, 0);
  return scene;
}

scene::Scene stack_of_three() {
  std::vector<scene::BodySpec> bodies;
  for (int i = 0; i < 3; ++i)
    bodies.push_back(rough(box("box" + std::to_string(i), Vector3d(0.25, 0.25, 0.125), 1.0,
                               Vector3d(i / 64.0, 0, 0.125 + 0.25 * i)),
                           0.3));
  bodies.push_back(floor_of(0.3));
  return with_contact("stack", std::move(bodies));
}

void scenes_far_off(const Given& given, Findings& findings) {
  const Vector3d origin(1e6, -1e6, 1e6);
  const double duration = given.is_long ? 10.0 : 4.0;
  const auto compare = [&](const std::string& name, const scene::Scene& near,
                           const std::string& why) {
    scene::Scene far = near;
    for (scene::BodySpec& body : far.bodies) body.position_m += origin;
    for (effects::RodSpec& rod : far.effects.of<effects::RodSpec>())
      if (rod.a.body.empty()) rod.a.point_m += origin;
    const Trajectory here = run_by_steps(near, given.laws, duration, 1.0 / 60, 600),
                     there = run_by_steps(far, given.laws, duration, 1.0 / 60, 600);
    double worst = here.frames.size() == there.frames.size() ? 0.0 : INFINITY;
    for (std::size_t i = 0; i < std::min(here.frames.size(), there.frames.size()); ++i)
      for (std::size_t body = 0; body < near.bodies.size(); ++body)
        worst = std::max(worst, (there.frames[i].poses[body].com_world - origin -
                                 here.frames[i].poses[body].com_world)
                                    .norm());
    findings.at_most(
        fmt::format("{}, 10^6 m off, {:g} s: places against those at the origin", name, duration),
        worst, 1e-8, "m", why);
    if (near.contact)
      findings.at_least(name + ", 10^6 m off: smallest gap", smallest_gap(there), 0.0, "m",
                        "nothing interpenetrates, wherever it lies");
  };
  compare("bouncing ball", bouncing(Vector3d::Zero()),
          "100 ulp(10^6); the engine itself works near the scene");
  compare("pendulum on a rod", chain({1.0}, 1.0, Vector3d(0.6, 0, -0.8)),
          "100 ulp(10^6), of 1.2e-10 m each");
  compare("box that slides to rest", sliding_box(),
          "100 ulp(10^6): where it stops goes with the square of its speed, which is not shifted");
  compare("stack of 3", stack_of_three(), "100 ulp(10^6): it stands");
}

void far_from_origin(const Given& given, Findings& findings) {
  findings.part("masses", [&] { masses_far_off(given, findings); });
  if (!given.laws.collision_impulse || !given.laws.constraint_multipliers)
    return findings.not_run("scenes", "needs the laws of a1 and a3, which nobody provides here");
  findings.part("scenes", [&] { scenes_far_off(given, findings); });
}

}  // namespace

void add_meshes(std::vector<Case>& cases) {
  cases.push_back(
      {8, "degenerate mesh",
       "Surfaces with faces of no area, vertices twice, turned inside out, with a hole, with a "
       "cavity. The integrals for mass and inertia assume a closed surface and do not look: "
       "they give some number. Each must give the right mass or a refusal that says where.",
       "", degenerate_meshes});
  cases.push_back(
      {22, "far from the origin",
       "The same scene a thousand kilometres off. Doubles stand 10^-10 m apart there; float "
       "engines fail after a few kilometres. Sums about the world's origin lose the "
       "inertia altogether: a textbook gives a box a moment that is wrong by factors up to 10^11.",
       "", far_from_origin});
}

}  // namespace tumble::battery
