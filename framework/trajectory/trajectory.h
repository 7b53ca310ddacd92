/// A recorded run: frames, events, counters. Engines push into a sink; pictures, plots and judges read a Trajectory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "framework/core/math.h"
#include "framework/trajectory/virtual_times.h"

namespace tumble {

/// Where a body is, and how it moves, at one instant. World frame.
struct BodyPose {
  Vector3d com_world;              // [m]
  Quaterniond world_from_body;     // unit
  Vector3d velocity_world;         // [m/s]
  Vector3d omega_world;            // [rad/s]
};

/// A point at which two bodies push each other for a while, and how hard.
struct ContactPoint {
  int body_a, body_b;
  Vector3d point_world;            // [m]
  Vector3d normal_b_to_a_world;    // unit
  Vector3d force_on_a_world;       // [N], friction included
};

/// All bodies at a redraw time.
struct Frame {
  double time;                     // [s]
  std::vector<BodyPose> poses;     // by body index
  double kinetic_energy;           // [J], movable bodies
  double potential_energy;         // [J]
  Vector3d momentum_world;         // [kg m/s], movable bodies
  Vector3d angular_momentum_world; // [kg m^2/s], movable bodies, about the world's origin
  double smallest_gap;             // [m], over all pairs that may collide; +infinity where there is none
  std::vector<double> spring_forces{};      // by spring of the scene; > 0 pulls its ends together [N]
  std::vector<double> rod_tensions{};       // by rod of the scene; > 0 pulls its ends together [N]
  std::vector<double> joint_forces{};       // by joint of the scene: size of the force in it [N]
  std::vector<ContactPoint> contacts{};     // lasting ones
};

enum class EventKind : std::uint8_t { kCollision = 1, kRest, kForceOn, kForceOff, kContact, kBreak, kStick, kSlide, kSleep, kWake, kControl };

/// A discontinuity that was committed.
struct Event {
  double time;                     // [s]
  EventKind kind;
  int body_a, body_b;              // body_b is -1 where there is one body only
  Vector3d point_world;            // [m]
  Vector3d normal_b_to_a_world;    // unit
  double impulse;                  // [N s], along the normal
  double normal_velocity_before;   // [m/s], negative when approaching
  double normal_velocity_after = kUnset;   // [m/s], of the same point, when the impulse has been applied; the framework measures it
  // Of an impact, measured; not kept in files. NaN where it was not measured, or where bodies driven in different ways took part.
  double energy_change = kUnset;           // of the kinetic energy of all bodies that the impulse changed, seen from what is driven [J]
  double energy_excess = kUnset;           // how far that is from what restitution and friction say, over the kinetic energy before [-]
};

/// A reason not to trust a run, which the framework found while it went (engines/base/run_watch.h). A run that has one is judged wrong.
struct RunFault {
  std::string kind;                // as a check's: "link_open", "projection_open", "contact_unsolved", "energy_rises", "turn_unresolved"
  std::string subject;             // the bodies or links of the worst, by name
  double worst = 0.0, allowed = 0.0;
  std::string unit;                // of both
  double first_s = kUnset, worst_s = kUnset;   // when it happened first, and when worst [s]
  std::uint64_t count = 0;         // how often
  std::string meaning, remedy;     // in words
};

/// What a run cost, as counts (deterministic) and times (not).
struct Counters {
  std::map<std::string, std::uint64_t> counts;   // "integrations", "undone_integrations", "gap_evaluations", "rollbacks", ...
  std::map<std::string, double> stage_seconds;   // "integration", "collision", "forces", ...; kept out of anything compared byte by byte
  std::vector<std::string> notices;              // for people, e.g. that steps were shortened and why; not kept in files
  std::vector<RunFault> faults{};                // judged as checks that failed; not kept in files
};

struct TrajectoryBody {
  std::string name;
  bool immovable;
};

struct TrajectoryInfo {
  std::string command, version, scene_name, scene_digest, engine, impulse_source, integrator_source;
  double step_s = 0.0;
  double frame_rate_hz = 0.0;
  std::vector<std::uint64_t> seeds;  // of what was drawn by lot
  std::string constraint_source{};   // who provides springs, rods and contact forces; "none" where the scene asks for none
};

struct Trajectory {
  TrajectoryInfo info;
  std::vector<TrajectoryBody> bodies;
  std::vector<Frame> frames;       // in order of time, the first at 0
  std::vector<Event> events;       // in order of time
  Counters counters;
  VirtualTimes virtual_times;      // of a timewarp that tells them; not kept in files
  std::string stopped_by;          // empty: ran to the end; else what stopped it (body, time, effect), frames kept up to there
};

/// What an engine pushes into.
class TrajectorySink {
 public:
  virtual ~TrajectorySink() = default;
  virtual void begin(const TrajectoryInfo& info, const std::vector<TrajectoryBody>& bodies) = 0;
  virtual void frame(const Frame& frame) = 0;
  virtual void event(const Event& event) = 0;
  virtual void end(const Counters& counters, const std::string& stopped_by) = 0;
  /// What a timewarp scheduler did, before the end; most engines have nothing to tell.
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

 private:
  Trajectory trajectory_;
};

/// Writes the one file format of a run (binary, little-endian, versioned), whole or not at all. Times of stages are left out,
/// so that the same run gives the same bytes.
/// @throws UserError when the file cannot be written
void write_trajectory(const std::filesystem::path& file, const Trajectory& trajectory);
/// @throws UserError naming the byte where a file stops being a trajectory
Trajectory read_trajectory(const std::filesystem::path& file);

}  // namespace tumble
