/// A recorded run: frames, events, counters. Engines write to a sink; pictures, plots and judges
/// read a Trajectory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/math.h"
#include "framework/trajectory/virtual_times.h"

namespace tumble {

/// Pose and velocity of a body at one instant. World frame.
struct BodyPose {
  Vector3d com_world;           // [m]
  Quaterniond world_from_body;  // unit
  Vector3d velocity_world;      // [m/s]
  Vector3d omega_world;         // [rad/s]
};

/// A persistent contact point between two bodies, with its force.
struct ContactPoint {
  int body_a, body_b;
  Vector3d point_world;          // [m]
  Vector3d normal_b_to_a_world;  // unit
  Vector3d force_on_a_world;     // [N], friction included
  // whether the laws' contact_forces found it; files do not keep that
  bool by_contact_forces = false;
};

/// All bodies at a frame time.
struct Frame {
  double time;                      // [s]
  std::vector<BodyPose> poses;      // by body index
  double kinetic_energy;            // [J], movable bodies
  double potential_energy;          // [J]
  Vector3d momentum_world;          // [kg m/s], movable bodies
  Vector3d angular_momentum_world;  // [kg m^2/s], movable bodies, about the world's origin
  // [m], over all pairs that may collide; +infinity where there is none
  double smallest_gap;
  std::vector<double> spring_forces{};   // by spring of the scene; > 0: tension [N]
  std::vector<double> rod_tensions{};    // by rod of the scene; > 0: tension [N]
  std::vector<double> joint_forces{};    // by joint of the scene: magnitude of its force [N]
  std::vector<ContactPoint> contacts{};  // persistent contacts
};

enum class EventKind : std::uint8_t {
  kCollision = 1,
  kRest,
  kForceOn,
  kForceOff,
  kContact,
  kBreak,
  kStick,
  kSlide,
  kSleep,
  kWake,
  kControl
};

/// A committed discontinuity.
struct Event {
  double time;  // [s]
  EventKind kind;
  int body_a, body_b;             // body_b is -1 where only one body takes part
  Vector3d point_world;           // [m]
  Vector3d normal_b_to_a_world;   // unit
  double impulse;                 // [N s], along the normal
  double normal_velocity_before;  // [m/s], negative when approaching
  // [m/s], of the same point after the impulse; measured by the framework
  double normal_velocity_after = kUnset;
  // Measured at an impact; not kept in files. NaN where it was not measured, or where bodies with
  // different prescribed motions took part.
  // of the kinetic energy of all bodies that the impulse changed, in the frame of the driven body
  // [J]
  double energy_change = kUnset;
  // its difference from the value by restitution and friction, relative to the kinetic energy
  // before [-]
  double energy_excess = kUnset;
};

/// A reason not to trust a run, found by the framework during the run (engines/base/run_watch.h). A
/// run with a fault is judged wrong.
struct RunFault {
  // a name like that of a check: "link_open", "projection_open", "contact_unsolved",
  // "energy_rises", "energy_lost", "turn_unresolved", "turns_wrong", "overlap_left"
  std::string kind;
  std::string subject;  // names of the bodies or links in the worst case
  double worst = 0.0, allowed = 0.0;
  std::string unit;                           // of `worst` and `allowed`
  double first_s = kUnset, worst_s = kUnset;  // times of the first and of the worst occurrence [s]
  std::uint64_t count = 0;                    // number of occurrences
  std::string meaning, remedy;                // in words
};

/// The cost of a run, as counts (deterministic) and times (not).
struct Counters {
  // "integrations", "undone_integrations", "gap_evaluations", "rollbacks", ...
  std::map<std::string, std::uint64_t> counts;
  // "integration", "collision", "forces", ...; kept out of anything compared byte by byte
  std::map<std::string, double> stage_seconds;
  // for the user, e.g. that steps were shortened and why
  std::vector<std::string> notices;
  std::vector<RunFault> faults{};  // each counts as a failed check
};

struct TrajectoryBody {
  std::string name;
  bool immovable;
};

struct TrajectoryInfo {
  std::string command, version, scene_name, scene_digest, engine, impulse_source, integrator_source;
  double step_s = 0.0;
  double frame_rate_hz = 0.0;
  std::vector<std::uint64_t> seeds;  // of random numbers
  // module that provides springs, rods and contact forces, what solves for links and contacts in
  // its place, and whose the listed laws of other effects are; "none" where the scene needs none
  std::string constraint_source{};
  std::string scheduling_source{};  // module that schedules a timewarp; not kept in files
};

struct Trajectory {
  TrajectoryInfo info;
  std::vector<TrajectoryBody> bodies;
  std::vector<Frame> frames;  // in order of time, the first at 0
  std::vector<Event> events;  // in order of time
  Counters counters;
  VirtualTimes virtual_times;  // of a timewarp that reports them; not kept in files
  // empty: ran to the end; else what stopped it (body, time, effect); earlier frames are kept
  std::string stopped_by;
};

/// Receives the output of an engine.
class TrajectorySink {
 public:
  virtual ~TrajectorySink() = default;
  virtual void begin(const TrajectoryInfo& info, const std::vector<TrajectoryBody>& bodies) = 0;
  virtual void frame(const Frame& frame) = 0;
  virtual void event(const Event& event) = 0;
  virtual void end(const Counters& counters, const std::string& stopped_by) = 0;
  /// An engine that has work to do before its first frame has come to this time of it, and no frame
  /// is due yet: teaching timewarp, whose ordered reference runs first. A sink may throw to end the
  /// run.
  virtual void beat(double /*time_s*/) {}
  /// The moves of a timewarp scheduler, called before end(); most engines have none.
  virtual void virtual_times(const VirtualTimes&) {}
};

/// Keeps everything in memory.
class TrajectoryRecorder final : public TrajectorySink {
 public:
  void begin(const TrajectoryInfo& info, const std::vector<TrajectoryBody>& bodies) override;
  void frame(const Frame& frame) override { trajectory_.frames.push_back(frame); }
  void event(const Event& event) override { trajectory_.events.push_back(event); }
  void end(const Counters& counters, const std::string& stopped_by) override;
  void virtual_times(const VirtualTimes& times) override { trajectory_.virtual_times = times; }
  const Trajectory& trajectory() const { return trajectory_; }
  /// Hands it over.
  Trajectory take() { return std::move(trajectory_); }

 private:
  Trajectory trajectory_;
};

/// Writes the file format of a run (binary, little-endian, versioned), whole or not at all. Times
/// of stages are left out, so that the same run gives the same bytes.
/// @throws UserError when the file cannot be written
void write_trajectory(const std::filesystem::path& file, const Trajectory& trajectory);
/// @throws UserError with the byte at which the file is not a trajectory
Trajectory read_trajectory(const std::filesystem::path& file);

}  // namespace tumble
