#include "framework/effects/joint/joint.h"
#include "tests/bench/peers/bullet_chain.h"

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

namespace tumble::peers {
namespace {

btVector3 bt(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }
btQuaternion bt(const Quaterniond& q) { return {q.x(), q.y(), q.z(), q.w()}; }
Vector3d vector_of(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

class BulletChain final : public PeerWorld {
 public:
  BulletChain(const BenchCase& bench, const World& world)
      : dispatcher_(&configuration_),
        dynamics_(&dispatcher_, &broadphase_, &solver_, &configuration_),
        chain_(static_cast<int>(world.bodies.size()), 0.0, btVector3(0, 0, 0), true, false) {
    dynamics_.setGravity(bt(world.gravity_world.value_or(Vector3d::Zero())));
    chain_.setBaseWorldTransform(btTransform::getIdentity());
    for (int i = 0; i < static_cast<int>(world.bodies.size()); ++i)
      add_link(bench.scene.effects.of<effects::JointSpec>()[i], world, i);
    chain_.finalizeMultiDof();
    chain_.setLinearDamping(0);
    chain_.setAngularDamping(0);
    dynamics_.addMultiBody(&chain_);
    update();
  }
  ~BulletChain() override { dynamics_.removeMultiBody(&chain_); }

  void step(double h) override { dynamics_.stepSimulation(h, 0); }
  void look() override { update(); }

  BodyPose pose(int body) override {
    const btTransform& there = chain_.getLink(body).m_cachedWorldTransform;
    const btQuaternion q = there.getRotation();
    const auto in_world = [&](const btVector3& v) { return vector_of(there.getBasis() * v); };
    return {vector_of(there.getOrigin()), Quaterniond(q.w(), q.x(), q.y(), q.z()),
            in_world(velocities_[body + 1]), in_world(omegas_[body + 1])};
  }

 private:
  // Link i hangs on link i - 1, the first on the world.
  void add_link(const effects::JointSpec& joint, const World& world, int i) {
    const WorldBody& body = world.bodies[i];
    const Quaterniond world_from_parent =
        i == 0 ? Quaterniond::Identity() : world.bodies[i - 1].state.world_from_body;
    const Vector3d parent = i == 0 ? Vector3d::Zero() : world.bodies[i - 1].state.com_world;
    const Quaterniond body_from_world = body.state.world_from_body.conjugate();
    chain_.setupRevolute(i, body.inertia.mass, bt(Vector3d(body.inertia.inertia_body.diagonal())),
                         i - 1, bt(Quaterniond(body_from_world * world_from_parent)),
                         bt(Vector3d(body_from_world * joint.axis)),
                         bt(Vector3d(world_from_parent.conjugate() * (joint.point_m - parent))),
                         bt(Vector3d(body_from_world * (body.state.com_world - joint.point_m))),
                         true);
  }

  // Places and velocities that belong to the angles as they are.
  void update() {
    btAlignedObjectArray<btQuaternion> turns;
    btAlignedObjectArray<btVector3> places;
    chain_.updateCollisionObjectWorldTransforms(turns, places);
    chain_.forwardKinematics(turns, places);
    omegas_.resize(chain_.getNumLinks() + 1);
    velocities_.resize(chain_.getNumLinks() + 1);
    chain_.compTreeLinkVelocities(omegas_.data(), velocities_.data());  // in each link's own frame
  }

  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btMultiBodyConstraintSolver solver_;
  btMultiBodyDynamicsWorld dynamics_;
  btMultiBody chain_;
  std::vector<btVector3> omegas_, velocities_;  // the base first
};

}  // namespace

std::unique_ptr<PeerWorld> make_bullet_chain(const BenchCase& bench, const World& world) {
  return std::make_unique<BulletChain>(bench, world);
}

}  // namespace tumble::peers
