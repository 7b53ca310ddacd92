// Tumble itself, through the entry that `tumble run` uses: run_scene with the laws of the reference
// modules. The clock starts when the engine hands over its first frame, and stops when it ends:
// frames that it records are part of its price.
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/dynamics/methods.h"
#include "framework/effects/joint/joint.h"
#include "framework/engines/run.h"
#include "framework/truths/memory_scene.h"
#include "tests/bench/peers/harness.h"
#include "tests/engines/reference_laws.h"
#if __has_include( \
    "framework/engines/timewarp/fast_timewarp.h")  // a tree without timewarp is measured as well
#include "framework/engines/timewarp/fast_timewarp.h"
#define TUMBLE_HAS_TIMEWARP
#endif

namespace tumble::peers {
namespace {

// Retroactive detection by a method, or engines that go from event to event, where a flight is a
// closed form and there is no step.
const std::vector<std::pair<std::string, std::string>> kEventEngines = {
    {"ca", "conservative advancement"}, {"tw", "timewarp"}};
const std::string kRungeKutta = "RK4", kDormandPrince = "Dormand-Prince",
                  kFehlberg = "Fehlberg 7(8)", kRungeKuttaInJoints = "RK4, joint coordinates",
                  kFehlbergInJoints = "Fehlberg 7(8), joint coordinates",
                  kGaussInJoints = "Gauss 6, joint coordinates",
                  kSymplecticInJoints = "symplectic Euler, joint coordinates",
                  kLocated = "RK4, plastic impacts located";
// s: within it the method chooses its own, and at its end joints are projected.
// In joint coordinates nothing is projected: a step is as long as the time between samples.
constexpr double kAdaptiveStep = 1.0 / 30, kAdaptiveStepOfTop = 1.0, kAdaptiveStepOfBob = 1.0 / 480;

class Clock final : public TrajectorySink {
 public:
  Clock(Observed& run, double& reached) : run_(run), reached_(reached) {}
  void begin(const TrajectoryInfo&, const std::vector<TrajectoryBody>&) override {}
  void frame(const Frame& frame) override {
    if (run_.samples.empty()) start_ = cpu_seconds();
    run_.samples.push_back(frame.poses);
    reached_ = frame.time;
  }
  void event(const Event& event) override {
    if (event.kind == EventKind::kCollision) run_.bounces.push_back(event.time);
  }
  void end(const Counters&, const std::string& stopped_by) override {
    run_.cpu_s = cpu_seconds() - start_;
    stopped_by_ = stopped_by;
  }
  const std::string& stopped_by() const { return stopped_by_; }

 private:
  Observed& run_;
  double& reached_;
  double start_ = 0.0;
  std::string stopped_by_;
};

engines::RunOptions options_of(const std::string& engine) {
  engines::RunOptions options;
  options.engine = engine;
#ifdef TUMBLE_HAS_TIMEWARP
  if (engine == "tw") options.timewarp = engines::fast_timewarp();
#endif
  return options;
}

Observed run(const BenchCase& bench, const Setting& setting, double& reached) {
  Laws laws = testing::reference_laws();
  laws.impulse_source = laws.integrator_source = laws.constraint_source = "reference";
  if (setting.method == kDormandPrince)
    laws.integrate_step = step_of(method_named("dopri5"), setting.tolerance);
  if (setting.method == kFehlberg || setting.method == kFehlbergInJoints)
    laws.integrate_step = step_of(method_named("fehlberg78"), setting.tolerance);
  if (setting.method == kGaussInJoints)
    laws.integrate_step = step_of(method_named("gauss6"), kUnset);
  if (setting.method == kSymplecticInJoints)
    laws.integrate_step = step_of(method_named("symplectic"), kUnset);
  laws.steps_in_units = setting.method == kDormandPrince || setting.method == kFehlberg ||
                        setting.method == kFehlbergInJoints || setting.method == kGaussInJoints;
  scene::Scene scene = bench.scene;
  if (setting.method == kLocated) scene.contact->plastic_impacts = scene::PlasticImpacts::kLocated;
  if (setting.method.ends_with("joint coordinates"))
    scene.coordinates = scene::Coordinates::kReduced;
  std::string engine = "rd";
  for (const auto& [word, method] : kEventEngines)
    if (setting.method == method) engine = word;
  engines::RunOptions options = options_of(engine);
  if (std::isfinite(setting.step)) options.step_s = setting.step;
  options.frame_rate_hz = 1.0 / bench.sample_times.front();
  if (bench.watches_first_body) options.frame_rate_hz = 1.0 / bench.sample_times.back();
  Observed run;
  Clock clock(run, reached);
  engines::run_scene(scene, laws, options, clock);
  if (!clock.stopped_by().empty()) throw std::runtime_error(clock.stopped_by());
  return run;
}

/// Whether this tree has an engine of that name, and laws for it.
bool has_engine(const std::string& word) {
  scene::Scene scene = truths::empty_scene("nothing", 1e-3, 1e-3);
  scene.bodies = {truths::point_mass("point", 1.0, Vector3d::Zero(), Vector3d::Zero())};
  TrajectoryRecorder recorder;
  try {
    engines::run_scene(scene, testing::reference_laws(), options_of(word), recorder);
  } catch (const UserError&) {
    return false;
  }
  return true;
}

std::vector<std::vector<Setting>> ladders(const BenchCase& bench) {
  const std::string scene = bench.id.substr(0, 2);
  auto all = step_ladders(bench, {kRungeKutta});
  if (scene == "S8") {  // one step each: what does not finish takes the whole cap
    const double step = bench.steps.size() > 2 ? bench.steps[2] : bench.steps.front();
    all = {{{kRungeKutta, step}}, {{kLocated, step}}};
  }
  if (scene == "S2" || scene == "S6") {
    all.emplace_back();
    for (const double step : bench.steps) all.back().push_back({kRungeKuttaInJoints, step});
    all.emplace_back();
    for (const double tolerance : {1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-10, 1e-12})
      all.back().push_back({kFehlbergInJoints, bench.sample_times.front(), tolerance});
  }
  if (scene == "S2") {  // where little accuracy is enough
    all.emplace_back();
    for (const double step : bench.steps) all.back().push_back({kSymplecticInJoints, step});
  }
  if (scene == "S6") {
    // parts of the time between samples: its steps need not follow the links' swings
    all.emplace_back();
    for (const double part : {1.0, 2.0, 5.0, 10.0, 20.0, 96.0})
      all.back().push_back({kGaussInJoints, bench.sample_times.front() / part});
  }
  if (scene == "S1" || scene == "S2" || scene == "S6") {
    const double within = scene == "S1"   ? kAdaptiveStepOfTop
                          : scene == "S6" ? kAdaptiveStepOfBob
                                          : kAdaptiveStep;
    for (const std::string& method : {kDormandPrince, kFehlberg}) {
      all.emplace_back();
      for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14})
        all.back().push_back({method, within, tolerance});
    }
  }
  const bool only_flies =
      bench.scene.effects.of<effects::JointSpec>().empty() && !bench.scene.contact;
  for (const auto& [word, method] : kEventEngines)
    // one body has nobody to run ahead of
    if (only_flies && (word != "tw" || scene == "S3") && has_engine(word))
      all.push_back({{method}});
  return all;
}

}  // namespace
}  // namespace tumble::peers

int main(int argc, char** argv) {
  using namespace tumble::peers;
  const char* tree = std::getenv("TUMBLE_TREE");  // run.sh says which commit
  return peer_main(
      argc, argv,
      {.name = "Tumble",
       .version = tree == nullptr ? "this tree" : tree,
       .settings = "the reference modules' laws; frames at the samples are part of the price",
       .ladders = ladders,
       .build = {},
       .run = run});
}
