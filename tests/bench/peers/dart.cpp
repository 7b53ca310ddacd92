// DART: reduced coordinates for joints, contacts as a linear complementarity problem (Dantzig's
// method). Its own collision detector knows balls and boxes only: walls are thick boxes, and rocks
// are not run.
#include <algorithm>

#include <dart/collision/dart/DARTCollisionDetector.hpp>
#include <dart/constraint/ConstraintSolver.hpp>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/BoxShape.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/SphereShape.hpp>
#include <dart/dynamics/WeldJoint.hpp>
#include <dart/simulation/World.hpp>

#include "framework/effects/joint/joint.h"
#include "tests/bench/peers/harness.h"

namespace tumble::peers {
namespace {

namespace dd = dart::dynamics;

// m: half-spaces are boxes of this half size, so deep
constexpr double kWallReach = 20.0, kWallDepth = 1.0;

Eigen::Isometry3d transform_of(const RigidBodyState& state) {
  Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
  transform.linear() = state.world_from_body.toRotationMatrix();
  transform.translation() = state.com_world;
  return transform;
}

class DartWorld final : public PeerWorld {
 public:
  DartWorld(const BenchCase& bench, const World& world, const Setting& setting)
      : world_(dart::simulation::World::create()), chain_(dd::Skeleton::create("chain")) {
    world_->setGravity(world.gravity_world.value_or(Vector3d::Zero()));
    world_->setTimeStep(setting.step);
    world_->getConstraintSolver()->setCollisionDetector(
        dart::collision::DARTCollisionDetector::create());
    world_->getConstraintSolver()->getCollisionOption().maxNumContacts = 20000;
    for (const WorldBody& body : world.bodies) add_body(bench, world, body);
    if (chain_->getNumBodyNodes() > 0) world_->addSkeleton(chain_);
  }

  void step(double) override { world_->step(); }

  BodyPose pose(int body) override {
    const dd::BodyNode& node = *nodes_[body];
    const Eigen::Isometry3d& there = node.getWorldTransform();
    return {there.translation(), Quaterniond(there.linear()), node.getLinearVelocity(),
            node.getAngularVelocity()};
  }

 private:
  static dd::BodyNode::Properties properties_of(const WorldBody& body) {
    const dd::Inertia inertia =
        body.immovable()
            ? dd::Inertia()
            : dd::Inertia(body.inertia.mass, Eigen::Vector3d::Zero(), body.inertia.inertia_body);
    return dd::BodyNode::Properties(dd::BodyNode::AspectProperties(body.name, inertia));
  }

  void add_body(const BenchCase& bench, const World& world, const WorldBody& body) {
    for (const effects::JointSpec& joint : bench.scene.effects.of<effects::JointSpec>())
      if (joint.body_a == body.name) return add_hinged(world, body, joint);
    const dd::SkeletonPtr skeleton = dd::Skeleton::create(body.name);
    if (body.immovable()) {
      dd::WeldJoint::Properties weld;
      weld.mT_ParentBodyToJoint = transform_of(body.state);
      nodes_.push_back(
          skeleton->createJointAndBodyNodePair<dd::WeldJoint>(nullptr, weld, properties_of(body))
              .second);
    } else {
      const auto [joint, node] = skeleton->createJointAndBodyNodePair<dd::FreeJoint>(
          nullptr, dd::FreeJoint::Properties(), properties_of(body));
      joint->setPositions(dd::FreeJoint::convertToPositions(transform_of(body.state)));
      joint->setLinearVelocity(body.state.momentum_world * body.inertia.inverse_mass);
      joint->setAngularVelocity(omega_of(body.state, body.inertia));
      nodes_.push_back(node);
    }
    if (body.collides) add_shape(body, *nodes_.back());
    skeleton->setMobile(!body.immovable());
    world_->addSkeleton(skeleton);
  }

  void add_hinged(const World& world, const WorldBody& body, const effects::JointSpec& joint) {
    dd::BodyNode* carrier = nullptr;
    Eigen::Isometry3d world_from_carrier = Eigen::Isometry3d::Identity(),
                      world_from_joint = Eigen::Isometry3d::Identity();
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (world.bodies[i].name == joint.body_b)
        carrier = nodes_[i], world_from_carrier = transform_of(world.bodies[i].state);
    world_from_joint.translation() = joint.point_m;
    dd::RevoluteJoint::Properties hinge;
    hinge.mAxis = joint.axis;
    hinge.mT_ParentBodyToJoint = world_from_carrier.inverse() * world_from_joint;
    hinge.mT_ChildBodyToJoint = transform_of(body.state).inverse() * world_from_joint;
    nodes_.push_back(
        chain_->createJointAndBodyNodePair<dd::RevoluteJoint>(carrier, hinge, properties_of(body))
            .second);
  }

  void add_shape(const WorldBody& body, dd::BodyNode& node) {
    dd::ShapePtr shape;
    Eigen::Isometry3d in_body = Eigen::Isometry3d::Identity();
    if (const auto* sphere = std::get_if<Sphere>(&body.shape)) {
      shape = std::make_shared<dd::SphereShape>(sphere->radius);
    } else if (const auto* box = std::get_if<Box>(&body.shape)) {
      shape = std::make_shared<dd::BoxShape>(2 * box->half_extents_body);
    } else {
      shape = std::make_shared<dd::BoxShape>(
          Eigen::Vector3d(2 * kWallReach, 2 * kWallReach, kWallDepth));
      in_body.translation().z() = -kWallDepth / 2;
    }
    dd::ShapeNode* made = node.createShapeNodeWith<dd::CollisionAspect, dd::DynamicsAspect>(shape);
    made->setRelativeTransform(in_body);
    made->getDynamicsAspect()->setFrictionCoeff(body.friction);
    // of a pair it takes the product
    made->getDynamicsAspect()->setRestitutionCoeff(body.immovable() ? 1.0 : body.restitution);
  }

  dart::simulation::WorldPtr world_;
  dd::SkeletonPtr chain_;
  std::vector<dd::BodyNode*> nodes_;
};

std::vector<std::vector<Setting>> ladders(const BenchCase& bench) {
  const std::string scene = bench.id.substr(0, 2);
  // no hulls; 6,000 coordinates beyond any cap
  if (scene == "S8" || bench.id == "S3-1000") return {};
  return step_ladders(bench, {"semi-implicit Euler"});
}

}  // namespace
}  // namespace tumble::peers

int main(int argc, char** argv) {
  using namespace tumble::peers;
  Engine engine;
  engine.name = "DART";
  engine.version = TUMBLE_PEER_VERSION;
  engine.settings =
      "defaults (Dantzig's method, ERP 0.01), its own collision detector, which knows balls and "
      "boxes only: half-spaces are thick boxes, rocks are not run";
  engine.ladders = ladders;
  engine.build = [](const BenchCase& bench, const tumble::World& world,
                    const Setting& setting) -> std::unique_ptr<PeerWorld> {
    return std::make_unique<DartWorld>(bench, world, setting);
  };
  return peer_main(argc, argv, engine);
}
