// Simbody: reduced coordinates and integrators with error control. Its contacts are compliant (and
// its rigid ones a prototype), and boxes, hulls and restitution are not in them: it runs the scenes
// without contact.
#include <Simbody.h>

#include "framework/effects/joint/joint.h"
#include "tests/bench/peers/harness.h"

namespace tumble::peers {
namespace {

using SimTK::Rotation;
using SimTK::Transform;
using SimTK::UnitVec3;
using SimTK::Vec3;

Vec3 vec(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Vector3d vector_of(const Vec3& v) { return {v[0], v[1], v[2]}; }
Rotation rotation_of(const Quaterniond& q) {
  return Rotation(SimTK::Quaternion(q.w(), q.x(), q.y(), q.z()));
}

class SimbodyWorld final : public PeerWorld {
 public:
  SimbodyWorld(const BenchCase& bench, const World& world, const Setting& setting)
      : matter_(system_),
        forces_(system_),
        gravity_(forces_, matter_, vec(world.gravity_world.value_or(Vector3d::Zero()))),
        integrator_(system_) {
    for (const WorldBody& body : world.bodies) add_body(bench, world, body);
    SimTK::State state = system_.realizeTopology();
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      // hinges begin at rest, at angle 0
      if (joint_of(bench, world.bodies[i].name) != nullptr) continue;
      const WorldBody& body = world.bodies[i];
      bodies_[i].setQToFitTransform(
          state, Transform(rotation_of(body.state.world_from_body), vec(body.state.com_world)));
      bodies_[i].setUToFitVelocity(state,
                                   {vec(omega_of(body.state, body.inertia)),
                                    vec(body.state.momentum_world * body.inertia.inverse_mass)});
    }
    integrator_.setAccuracy(setting.tolerance);
    integrator_.setReturnEveryInternalStep(false);
    integrator_.initialize(state);
  }

  void step(double) override {}
  bool advance_to(double time) override {
    while (integrator_.getTime() < time) integrator_.stepTo(time);
    return true;
  }
  void look() override { system_.realize(integrator_.getState(), SimTK::Stage::Velocity); }
  BodyPose pose(int body) override {
    const SimTK::State& state = integrator_.getState();
    const Transform& there = bodies_[body].getBodyTransform(state);
    const SimTK::Quaternion q = there.R().convertRotationToQuaternion();
    const SimTK::SpatialVec& velocity = bodies_[body].getBodyVelocity(state);
    return {vector_of(there.p()), Quaterniond(q[0], q[1], q[2], q[3]), vector_of(velocity[1]),
            vector_of(velocity[0])};
  }

 private:
  static const effects::JointSpec* joint_of(const BenchCase& bench, const std::string& body) {
    for (const effects::JointSpec& joint : bench.scene.effects.of<effects::JointSpec>())
      if (joint.body_a == body) return &joint;
    return nullptr;
  }

  void add_body(const BenchCase& bench, const World& world, const WorldBody& body) {
    const Matrix3d& I = body.inertia.inertia_body;
    const SimTK::Body::Rigid rigid(SimTK::MassProperties(
        body.inertia.mass, Vec3(0),
        SimTK::Inertia(I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2))));
    const effects::JointSpec* joint = joint_of(bench, body.name);
    if (joint == nullptr) {
      bodies_.push_back(
          SimTK::MobilizedBody::Free(matter_.Ground(), Transform(), rigid, Transform()));
      return;
    }
    // A pin turns about z of its frame, which is put at the joint on both sides, z along the axis.
    const Rotation hinge(UnitVec3(vec(joint->axis)), SimTK::ZAxis);
    const auto seen_from = [&](const RigidBodyState& state) {
      return ~Transform(rotation_of(state.world_from_body), vec(state.com_world)) *
             Transform(hinge, vec(joint->point_m));
    };
    SimTK::MobilizedBody* carrier = &matter_.Ground();
    Transform in_carrier(hinge, vec(joint->point_m));
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      if (world.bodies[i].name == joint->body_b)
        carrier = &bodies_[i], in_carrier = seen_from(world.bodies[i].state);
    bodies_.push_back(
        SimTK::MobilizedBody::Pin(*carrier, in_carrier, rigid, seen_from(body.state)));
  }

  SimTK::MultibodySystem system_;
  SimTK::SimbodyMatterSubsystem matter_;
  SimTK::GeneralForceSubsystem forces_;
  SimTK::Force::UniformGravity gravity_;
  std::vector<SimTK::MobilizedBody> bodies_;
  SimTK::RungeKuttaMersonIntegrator integrator_;
};

std::vector<std::vector<Setting>> ladders(const BenchCase& bench) {
  const std::string scene = bench.id.substr(0, 2);
  if (scene != "S1" && scene != "S2" && scene != "S6") return {};
  std::vector<Setting> ladder;
  const std::vector<double> tolerances =
      bench.steps.size() > 3
          ? std::vector{1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12}
          : std::vector{1e-3, 1e-5};
  for (const double tolerance : tolerances)
    ladder.push_back({"Runge-Kutta-Merson", std::nan(""), tolerance});
  return {ladder};
}

}  // namespace
}  // namespace tumble::peers

int main(int argc, char** argv) {
  using namespace tumble::peers;
  Engine engine;
  engine.name = "Simbody";
  engine.version = TUMBLE_PEER_VERSION;
  engine.settings =
      "the Runge-Kutta-Merson integrator that its manual recommends, over its accuracy; scenes "
      "without contact only";
  engine.ladders = ladders;
  engine.build = [](const BenchCase& bench, const tumble::World& world,
                    const Setting& setting) -> std::unique_ptr<PeerWorld> {
    return std::make_unique<SimbodyWorld>(bench, world, setting);
  };
  return peer_main(argc, argv, engine);
}
