#include "tests/support/places.h"
#include "tests/bench/peers/judge.h"

#include <algorithm>
#include <cmath>

#include "framework/cli/read_truth.h"
#include "framework/effects/invariants.h"
#include "framework/effects/joint/joint.h"
#include "tests/support/overlap.h"

namespace tumble::peers {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

truths::Case truth_named(const std::string& name) {
  return cli::read_truth(test::source_dir() + "/tests/truths/" + name + ".json");
}

std::vector<RigidBodyState> states_of(const World& world, const std::vector<BodyPose>& poses) {
  std::vector<RigidBodyState> states;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const WorldBody& body = world.bodies[i];
    RigidBodyState state = body.state;
    if (!body.immovable())
      state = {poses[i].com_world, poses[i].world_from_body,
               body.inertia.mass * poses[i].velocity_world,
               angular_momentum_of(poses[i].omega_world, poses[i].world_from_body, body.inertia)};
    states.push_back(state);
  }
  return states;
}

double energy_of(const World& world, const std::vector<BodyPose>& poses) {
  const Invariants sums = invariants_of(world, states_of(world, poses));
  return sums.kinetic_energy + sums.potential_energy;
}

bool finite(const Observed& run) {
  for (const auto& poses : run.samples)
    for (const BodyPose& pose : poses)
      if (!pose.com_world.allFinite() || !pose.world_from_body.coeffs().allFinite() ||
          !pose.velocity_world.allFinite())
        return false;
  return true;
}

/// Largest |E - E0| over the run. [J]
double energy_error(const World& world, const Observed& run) {
  const double start = energy_of(world, run.samples.front());
  double worst = 0.0;
  for (const auto& poses : run.samples)
    worst = std::max(worst, std::abs(energy_of(world, poses) - start));
  return worst;
}

Vector3d place_of(const Anchor& anchor, const std::vector<BodyPose>& poses) {
  return anchor.body < 0 ? anchor.point_body
                         : Vector3d(poses[anchor.body].com_world +
                                    poses[anchor.body].world_from_body * anchor.point_body);
}

/// Largest distance of two points that a joint should hold together. [m]
double joint_opening(const World& world, const Observed& run) {
  double worst = 0.0;
  for (const auto& poses : run.samples)
    for (const effects::JointLink& joint : world.effects.of<effects::JointLink>())
      worst = std::max(worst, (place_of(joint.a, poses) - place_of(joint.b, poses)).norm());
  return worst;
}

double overlap(const World& world, const Observed& run) {
  double worst = 0.0;
  for (const auto& poses : run.samples)
    worst = std::max(worst, testing::deepest_overlap(world, poses));
  return worst;
}

Judgement worse_of(const std::string& a, double value_a, const std::string& b, double value_b) {
  return {std::max(value_a, value_b), {{a, value_a}, {b, value_b}}};
}

Judgement judge_top(const Observed& run) {
  // scalar first
  const VectorXd wxyz =
      truth_named("free_top_asymmetric__dzhanibekov_123").output("q_t60").vector();
  const Quaterniond turn = Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]).conjugate() *
                           run.samples.back()[0].world_from_body.normalized();
  const double angle = 2 * std::atan2(turn.vec().norm(), std::abs(turn.w()));
  return {angle, {{"angle [rad]", angle}}};
}

Judgement judge_chain(const World& world, const Observed& run, double link) {
  // m g times the height above hanging: from where it was let go to the lowest that joints allow
  double fall = 0.0;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const Vector3d& place = run.samples.front()[i].com_world;
    fall += world.bodies[i].inertia.mass * kGravity * (place.z() + place.norm());
  }
  return worse_of("energy", energy_error(world, run) / fall, "joints over link",
                  joint_opening(world, run) / link);
}

Judgement judge_balls(const World& world, const Observed& run) {
  return worse_of("energy", energy_error(world, run) / energy_of(world, run.samples.front()),
                  "overlap over radius", overlap(world, run) / kBallRadius);
}

Judgement judge_bounces(const Observed& run) {
  const VectorXd times = truth_named("bouncing_ball__e0.8").output("impact_times").vector();
  constexpr int kBounces = 10;
  const double rest = std::abs(run.samples.back()[0].com_world.z() - 0.1);
  if (static_cast<int>(run.bounces.size()) < kBounces)
    return {kNothing,
            {{"bounces", static_cast<double>(run.bounces.size())}, {"height at rest [m]", rest}}};
  double worst = 0.0;
  for (int k = 0; k < kBounces; ++k) worst = std::max(worst, std::abs(run.bounces[k] - times[k]));
  return {worst, {{"bounces [s]", worst}, {"height at rest [m]", rest}}};
}

Judgement judge_stack(const Observed& run) {
  double drift = 0.0;
  // the floor is the last body
  const auto top = [](const auto& poses) -> const Vector3d& {
    return poses[poses.size() - 2].com_world;
  };
  for (const auto& poses : run.samples)
    drift = std::max(drift, (top(poses) - top(run.samples.front())).norm());
  return {drift, {{"drift [m]", drift}}};
}

Judgement judge_bullet(const BenchCase& bench, const Observed& run) {
  const double speed = bullet_speed(bench), meets = -kBulletWall / 2 - kBulletRadius,
               time_to_wall = (meets - kBulletStart) / speed;
  const Vector3d expected(meets - speed * (bench.sample_times.back() - time_to_wall), 0, 0);
  const double error = (run.samples.back()[0].com_world - expected).norm();
  return {error, {{"place [m]", error}}};
}

}  // namespace

Judgement judge(const BenchCase& bench, const World& world, const Observed& run) {
  if (!finite(run)) return {kNothing, {{"not a number", 1.0}}};
  const std::string scene = bench.id.substr(0, 2);
  if (scene == "S1") return judge_top(run);
  if (scene == "S2") return judge_chain(world, run, kChainLink);
  if (scene == "S3") return judge_balls(world, run);
  if (scene == "S4") return judge_bounces(run);
  if (scene == "S5") return judge_stack(run);
  if (scene == "S6") return judge_chain(world, run, kBobLink);
  if (scene == "S7") return judge_bullet(bench, run);
  const double deepest = overlap(world, run);
  return {deepest, {{"overlap [m]", deepest}}};
}

}  // namespace tumble::peers
