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

constexpr double kFar = 30.0;  // deviations: beyond 38 a double holds no probability

/// Mills' ratio of the standard normal distribution: the probability above z over the density at z.
/// Its continued fraction 1 / (z + 1 / (z + 2 / (z + ...))). @pre z >= kFar, where 12 terms leave
/// less than a rounding
double mills_ratio(double z) {
  double rest = z;
  for (int k = 12; k > 0; --k) rest = z + k / rest;
  return 1.0 / rest;
}

/// The z of a standard normal number that is at most `high`, at which a share u of the probability
/// between `low` and `high` lies below z.
///   Q(a + d) / Q(a) = exp(-a d - d^2 / 2) m(a + d) / m(a)
///   Q(z): the probability above z, and below -z; a = -high; m: Mills' ratio
/// is solved for d by Newton's method on its logarithm, whose slope is -1 / m(a + d). The logarithm
/// is concave and the first d is too large: every step approaches the solution from above.
/// @pre low < high <= -kFar
double far_below(double low, double high, double u) {
  const double a = -high, b = -low, m_a = mills_ratio(a);
  const double log_rest = -0.5 * (b - a) * (b + a) + std::log(mills_ratio(b) / m_a);
  const double beyond = std::exp(log_rest), within = -std::expm1(log_rest);
  // each where it does not cancel
  const double log_share =
      u < 0.5 ? std::log(beyond + within * u) : std::log1p(-within * (1.0 - u));
  double d = -log_share / a;
  for (int step = 0; step < 50; ++step) {
    const double m = mills_ratio(a + d);
    const double change = m * (-a * d - 0.5 * d * d + std::log(m / m_a) - log_share);
    d += change;
    if (std::abs(change) <= 1e-15 * d) break;
  }
  return high - d;
}

/// The number at which a share u of a normal prior's probability lies: below it; above it where the
/// whole range is above the mean. There the mirror image is drawn, because probabilities near 1 are
/// not told apart, and those near 0 are.
double normal_drawn(const Prior& prior, double u) {
  const bool is_above = prior.low > prior.mean;
  const double sign = is_above ? -1.0 : 1.0;
  const double low = sign * ((is_above ? prior.high : prior.low) - prior.mean) / prior.deviation,
               high = sign * ((is_above ? prior.low : prior.high) - prior.mean) / prior.deviation;
  const double z = high <= -kFar ? far_below(low, high, u)
                                 : normal_quantile(below(low) + (below(high) - below(low)) * u);
  return std::clamp(prior.mean + sign * prior.deviation * z, prior.low, prior.high);
}

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
    x[i] = normal_drawn(prior, u);
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
