/// What the cases of the stability battery share: small scenes, measures of runs, comparisons with
/// truth files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/cli/battery.h"
#include "framework/truths/memory_scene.h"
#include "framework/geometry/triangle_mesh.h"

namespace tumble::battery {

inline constexpr double kG = 9.81;            // m/s^2
inline constexpr double kRounding = 0x1p-53;  // u: half a unit in the last place of 1
inline const Vector3d kDown(0, 0, -kG);

// ---- Scenes -------------------------------------------------------------------------------------

scene::BodySpec box(const std::string& name, const Vector3d& half_extents, double mass,
                    const Vector3d& position);
scene::BodySpec rough(scene::BodySpec body, double friction, double restitution = 0.0);
/// A level floor through the origin.
scene::BodySpec floor_of(double friction);
scene::BodySpec turned(scene::BodySpec body, double angle, const Vector3d& axis);
/// Bodies that may lie on each other, under gravity.
scene::Scene with_contact(const std::string& name, std::vector<scene::BodySpec> bodies);
/// A chain of rods from the origin, a bob at each rod's end. @param direction  unit, along the
/// chain
scene::Scene chain(const std::vector<double>& masses, double length, const Vector3d& direction);
/// Writes a solid to a .3ds file, its faces counter-clockwise seen from outside.
void write_model(const TriangleMesh& mesh, const std::filesystem::path& file);
/// Writes a four-cornered prism. @param corners  (x, z), the inside to the left of each side, seen
/// against y
void write_prism(const std::vector<Vector2d>& corners, double half_depth,
                 const std::filesystem::path& file);
/// The run of a scene by steps of about h, frames at ends of steps. @param frames  about how many
Trajectory run_by_steps(const scene::Scene& scene, const Laws& laws, double duration, double h,
                        long frames);

// ---- Measures -----------------------------------------------------------------------------------

double energy_of(const Frame& frame);
/// Largest |E - E0| / scale over the frames.
double energy_drift(const Trajectory& run, double scale);
/// Largest rise of the energy above an earlier value, over the energy at the start.
double energy_rise(const Trajectory& run);
/// Largest way of a body from where it began. [m]
double drift_of(const Trajectory& run, std::size_t body);
/// Largest turn of a body against how it began. [rad]
double tilt_of(const Trajectory& run, std::size_t body);
/// Smallest gap of any frame. [m]
double smallest_gap(const Trajectory& run);
/// Vertical force of persistent contacts on a body by another, of a frame. [N]
double push_up(const Frame& frame, int on, int by);
/// Angle of the turn between two orientations. [rad]
double angle_between(const Quaterniond& a, const Quaterniond& b);

/// Values of the frames over time, for plots.
report::Curve curve_of(const std::string& name, const Trajectory& run,
                       const std::function<double(const Frame&)>& value);

// ---- Truth files --------------------------------------------------------------------------------

/// What this project computes for a truth file: the output closest to its mark. Marks are 100 times
/// the floor of double precision, or for an integrator the error its order predicts.
/// @param exact_only  leaves out what is integrated on finer and finer steps, which takes seconds
void compare_with_truth(const Given& given, Findings& findings, const std::string& id,
                        bool exact_only = false);

}  // namespace tumble::battery
