#include "framework/sampling/worlds.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/normal.h"
#include "framework/engines/run.h"

namespace tumble::sampling {
namespace {

using scene::PerturbationSpec;

double below(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

int index_of(const scene::Scene& scene, const std::string& body) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    if (scene.bodies[i].name == body) return static_cast<int>(i);
  throw PreconditionError("a perturbed body that the scene does not have: " + body);
}

/// "velocity_x_m_s" begins with "velocity_"; its axis is 0.
bool is(const std::string& what, const std::string& beginning, int& axis) {
  if (!what.starts_with(beginning) || what.size() <= beginning.size()) return false;
  axis = what[beginning.size()] - 'x';
  return axis >= 0 && axis < 3;
}

void set(scene::BodySpec& body, const PerturbationSpec& spec, double value) {
  int axis = 0;
  if (spec.what == "restitution") {
    body.restitution = value;
  } else if (spec.what == "friction") {
    body.friction = value;
  } else if (is(spec.what, "position_", axis)) {
    body.position_m[axis] = value;
  } else if (is(spec.what, "angular_velocity_", axis)) {
    body.omega_world_rad_s[axis] = value;
  } else if (is(spec.what, "velocity_", axis)) {
    body.velocity_m_s[axis] = value;
  } else if (is(spec.what, "turn_", axis)) {
    const Quaterniond turn(Eigen::AngleAxisd(value, Vector3d::Unit(axis)));
    body.world_from_body = (turn * body.world_from_body).normalized();
  } else {
    throw PreconditionError("nothing is perturbed by '" + spec.what + "'");
  }
}

/// Keeps the last frame and what stopped the run.
class LastFrame final : public TrajectorySink {
 public:
  void begin(const TrajectoryInfo&, const std::vector<TrajectoryBody>&) override {}
  void frame(const Frame& frame) override { last_ = frame; }
  void event(const Event&) override {}
  void end(const Counters&, const std::string& stopped_by) override { stopped_by_ = stopped_by; }
  const Frame& last() const { return last_; }
  const std::string& stopped_by() const { return stopped_by_; }

 private:
  Frame last_;
  std::string stopped_by_ = "it did not begin";
};

}  // namespace

std::vector<Prior> priors_of(const SampledScene& sampled) {
  std::vector<Prior> priors;
  for (const PerturbationSpec& spec : sampled.sampling.perturbed)
    priors.push_back({spec.is_normal ? PriorKind::kNormal : PriorKind::kUniform, spec.mean,
                      spec.deviation, spec.low, spec.high});
  return priors;
}

Proposal proposal_of(const SampledScene& sampled) {
  Proposal proposal{{}, sampled.sampling.wide_share, sampled.sampling.wide_factor};
  for (const PerturbationSpec& spec : sampled.sampling.perturbed)
    proposal.moves.push_back({spec.multiplies ? MoveKind::kMultiply : MoveKind::kAdd, spec.step});
  return proposal;
}

std::vector<std::string> names_of(const SampledScene& sampled) {
  std::vector<std::string> names;
  for (const PerturbationSpec& spec : sampled.sampling.perturbed)
    names.push_back(spec.body + " " + spec.what);
  return names;
}

VectorXd drawn_from_prior(const std::vector<Prior>& priors, Random& random) {
  VectorXd x(static_cast<Eigen::Index>(priors.size()));
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const Prior& prior = priors[static_cast<std::size_t>(i)];
    const double u = random.unit() + 0x1.0p-54;
    if (prior.kind == PriorKind::kUniform) {
      x[i] = prior.low + (prior.high - prior.low) * u;
      continue;
    }
    const double low = below((prior.low - prior.mean) / prior.deviation),
                 high = below((prior.high - prior.mean) / prior.deviation);
    const double z = normal_quantile(low + (high - low) * u);
    x[i] = std::clamp(prior.mean + prior.deviation * z, prior.low, prior.high);
  }
  return x;
}

scene::Scene world_of(const SampledScene& sampled, const VectorXd& x) {
  scene::Scene world = sampled.scene;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const PerturbationSpec& spec = sampled.sampling.perturbed[static_cast<std::size_t>(i)];
    set(world.bodies[static_cast<std::size_t>(index_of(world, spec.body))], spec, x[i]);
  }
  return world;
}

double violation_of(const SampledScene& sampled, const Frame& last) {
  double squares = 0.0;
  for (const scene::AskedSpec& asked : sampled.sampling.asked) {
    const BodyPose& pose =
        last.poses[static_cast<std::size_t>(index_of(sampled.scene, asked.body))];
    double lacks = 0.0;
    if (asked.is_place) {
      const Vector3d point_world = pose.com_world + pose.world_from_body * asked.point_body;
      const Vector3d nearest_world = point_world.cwiseMax(asked.low_m).cwiseMin(asked.high_m);
      lacks = (point_world - nearest_world).norm();
    } else {
      const double cosine = asked.direction_world.dot(pose.world_from_body * asked.axis_body);
      const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
      lacks = std::max({0.0, asked.least_rad - angle, angle - asked.most_rad});
    }
    squares += (lacks / asked.softness) * (lacks / asked.softness);
  }
  return std::sqrt(squares);
}

WorldEnd end_of(const SampledScene& sampled, const Laws& laws, engines::RunOptions options,
                const VectorXd& x) {
  options.frame_rate_hz = 1.0 / options.duration_s.value_or(sampled.scene.duration_s);
  LastFrame sink;
  try {
    engines::run_scene(world_of(sampled, x), laws, options, sink);
  } catch (const UserError& error) {  // bodies that overlap at the start, and the like
    return {kUnset, error.what()};
  }
  if (!sink.stopped_by().empty()) return {kUnset, sink.stopped_by()};
  return {violation_of(sampled, sink.last()), ""};
}

Trajectory run_of(const SampledScene& sampled, const Laws& laws, const engines::RunOptions& options,
                  const VectorXd& x) {
  TrajectoryRecorder recorder;
  engines::run_scene(world_of(sampled, x), laws, options, recorder);
  return recorder.trajectory();
}

}  // namespace tumble::sampling
