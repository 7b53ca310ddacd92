/// Runs one engine over the cases and its settings, each in a process of its own, and writes a row
/// for each.
///
/// Price: CPU time of that process between the samples, so around the steps only: building the
/// world, loading models and looking at the bodies are not in it. Each setting is run several times
/// and the median counts. A run beyond the cap, and one that crashes, is told as such.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "framework/dynamics/world.h"
#include "framework/trajectory/trajectory.h"
#include "tests/bench/peers/cases.h"

namespace tumble::peers {

/// One way to run an engine: a method and how finely.
struct Setting {
  std::string method;                                      // a curve
  double step = std::numeric_limits<double>::quiet_NaN();  // [s]
  double tolerance = std::numeric_limits<double>::quiet_NaN();
};

/// What a run shows: the bodies at the samples, and the instants of the first body's bounces where
/// the case asks for them.
struct Observed {
  std::vector<std::vector<BodyPose>> samples;  // the first at the start
  std::vector<double> bounces;                 // [s]
  double cpu_s = 0.0;
};

/// An engine's world, for engines that are advanced by steps from outside.
class PeerWorld {
 public:
  virtual ~PeerWorld() = default;
  /// One step. [s]
  virtual void step(double h) = 0;
  /// To an instant, for engines that choose their own steps. @return false for those that do not
  virtual bool advance_to(double) { return false; }
  /// Called before the poses of a sample are asked for; its time does not count.
  virtual void look() {}
  virtual BodyPose pose(int body) = 0;
};

struct Engine {
  std::string name;      // "ODE"
  std::string version;   // "0.16.2, double precision"
  std::string settings;  // what was set, and who recommends it
  /// Ladders of a case, coarse to fine, one a method; empty where the engine cannot do the case.
  std::function<std::vector<std::vector<Setting>>(const BenchCase&)> ladders;
  /// Either this, for engines stepped from outside ...
  std::function<std::unique_ptr<PeerWorld>(const BenchCase&, const World&, const Setting&)> build;
  /// ... or a whole run that measures itself. @param reached  to be set to the time reached, for
  /// what does not finish [s]
  std::function<Observed(const BenchCase&, const Setting&, double& reached)> run;
};

/// CPU time of this process. [s]
double cpu_seconds();

/// The steps of the case as ladders of these methods.
std::vector<std::vector<Setting>> step_ladders(const BenchCase& bench,
                                               const std::vector<std::string>& methods);

/// Command line: --out FILE [--quick] [--cases S1,S3-100] [--runs N] [--cap-s S]
int peer_main(int argc, char** argv, const Engine& engine);

}  // namespace tumble::peers
