// Bullet in double precision (Debian's -float64 libraries).
#include <algorithm>

#include <Eigen/Eigenvalues>

#include <btBulletDynamicsCommon.h>

#include "framework/effects/joint/joint.h"
#include "tests/bench/peers/bullet_chain.h"

namespace tumble::peers {
namespace {

const std::string kSweeps = "sequential impulses (10 sweeps)",
                  kManySweeps = "sequential impulses (100 sweeps)",
                  kSwept = "with continuous collision",
                  kReduced = "reduced coordinates (btMultiBody)";
// m: hulls are thickened by it; the default of 4 cm would keep rocks of 0.9 m visibly apart
constexpr double kHullMargin = 0.001;

btVector3 bt(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Vector3d vector_of(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
btTransform transform_of(const RigidBodyState& state) {
  const Quaterniond& q = state.world_from_body;
  return btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), bt(state.com_world));
}

btScalar smaller_friction(const btCollisionObject* a, const btCollisionObject* b) {
  return std::min(a->getFriction(), b->getFriction());
}
btScalar smaller_restitution(const btCollisionObject* a, const btCollisionObject* b) {
  return std::min(a->getRestitution(), b->getRestitution());
}

class BulletWorld final : public PeerWorld {
 public:
  BulletWorld(const BenchCase& bench, const World& world, const Setting& setting)
      : dispatcher_(&configuration_),
        dynamics_(&dispatcher_, &broadphase_, &solver_, &configuration_),
        is_swept_(setting.method == kSwept) {
    // of a pair the smaller, as everywhere here; by default the product
    gCalculateCombinedFrictionCallback = smaller_friction;
    gCalculateCombinedRestitutionCallback = smaller_restitution;
    dynamics_.setGravity(bt(world.gravity_world.value_or(Vector3d::Zero())));
    dynamics_.getSolverInfo().m_restitutionVelocityThreshold = 0;
    // What bounces is to have no speed from overlaps that are taken back, at any depth; by default
    // only beyond 4 cm, most of a ball here. Stacks and rocks are better off with the default.
    const bool bounces = std::any_of(world.bodies.begin(), world.bodies.end(),
                                     [](const WorldBody& body) { return body.restitution > 0; });
    if (bounces) dynamics_.getSolverInfo().m_splitImpulsePenetrationThreshold = 0;
    if (setting.method == kManySweeps) dynamics_.getSolverInfo().m_numIterations = 100;
    for (const WorldBody& body : world.bodies) add_body(body);
    for (const effects::JointSpec& joint : bench.scene.effects.of<effects::JointSpec>())
      add_hinge(world, joint);
  }
  ~BulletWorld() override {
    for (auto& hinge : hinges_) dynamics_.removeConstraint(hinge.get());
    for (auto& body : bodies_) dynamics_.removeRigidBody(body.get());
  }

  void step(double h) override { dynamics_.stepSimulation(h, 0); }

  BodyPose pose(int body) override {
    const btRigidBody& b = *bodies_[body];
    const btQuaternion q = b.getOrientation();
    return {vector_of(b.getCenterOfMassPosition()),
            Quaterniond(q.w(), q.x(), q.y(), q.z()) * body_from_principal_[body].conjugate(),
            vector_of(b.getLinearVelocity()), vector_of(b.getAngularVelocity())};
  }

 private:
  btCollisionShape* shape_of(const WorldBody& body) {
    if (const auto* sphere = std::get_if<Sphere>(&body.shape))
      return new btSphereShape(sphere->radius);
    if (const auto* box = std::get_if<Box>(&body.shape))
      return new btBoxShape(bt(box->half_extents_body));
    if (std::holds_alternative<HalfSpace>(body.shape))
      return new btStaticPlaneShape(btVector3(0, 0, 1), 0);
    auto* hull = new btConvexHullShape;
    for (const Vector3d& v : std::get<MeshSolid>(body.shape).mesh_body.vertices)
      hull->addPoint(bt(body_from_principal_.back().conjugate() * v), false);
    hull->recalcLocalAabb();
    hull->setMargin(kHullMargin);
    return hull;
  }

  void add_body(const WorldBody& body) {
    // Bullet's bodies turn in their principal axes: so hulls are turned into them.
    Vector3d moments = Vector3d::Zero();
    body_from_principal_.push_back(Quaterniond::Identity());
    if (!body.immovable()) {
      moments = body.inertia.inertia_body.diagonal();
      if (std::holds_alternative<MeshSolid>(body.shape)) {
        const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(body.inertia.inertia_body);
        Matrix3d rotation = axes.eigenvectors();
        if (rotation.determinant() < 0) rotation.col(0) *= -1;
        moments = axes.eigenvalues();
        body_from_principal_.back() = Quaterniond(rotation);
      }
    }
    shapes_.emplace_back(shape_of(body));
    btRigidBody::btRigidBodyConstructionInfo info(body.immovable() ? 0.0 : body.inertia.mass,
                                                  nullptr, shapes_.back().get(), bt(moments));
    RigidBodyState principal = body.state;
    principal.world_from_body = body.state.world_from_body * body_from_principal_.back();
    info.m_startWorldTransform = transform_of(principal);
    info.m_friction = body.friction;
    info.m_restitution = body.restitution;
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    btRigidBody& made = *bodies_.back();
    made.setActivationState(DISABLE_DEACTIVATION);
    // A contact that is looked ahead to takes the way that is left from the speed of a bounce: what
    // bounces waits until it touches.
    if (body.restitution > 0) made.setContactProcessingThreshold(0);
    if (!body.immovable()) {
      made.setLinearVelocity(bt(body.state.momentum_world * body.inertia.inverse_mass));
      made.setAngularVelocity(bt(omega_of(body.state, body.inertia)));
    }
    if (is_swept_ && !body.immovable()) {
      made.setCcdMotionThreshold(0.5 * bounding_radius(body.shape));
      made.setCcdSweptSphereRadius(0.5 * bounding_radius(body.shape));
    }
    if (body.collides)
      dynamics_.addRigidBody(&made);
    else
      dynamics_.addRigidBody(&made, 0, 0);  // a group that meets none
  }

  btRigidBody& body_named(const World& world, const std::string& name) {
    for (std::size_t i = 0; i < world.bodies.size(); ++i)
      if (world.bodies[i].name == name) return *bodies_[i];
    return btTypedConstraint::getFixedBody();
  }

  void add_hinge(const World& world, const effects::JointSpec& joint) {
    btRigidBody &a = body_named(world, joint.body_a), &b = body_named(world, joint.body_b);
    const auto local = [](const btRigidBody& body, const btVector3& point) {
      return body.getCenterOfMassTransform().inverse() * point;
    };
    const auto local_axis = [&](const btRigidBody& body) {
      return body.getCenterOfMassTransform().getBasis().transpose() * bt(joint.axis);
    };
    hinges_.push_back(std::make_unique<btHingeConstraint>(a, b, local(a, bt(joint.point_m)),
                                                          local(b, bt(joint.point_m)),
                                                          local_axis(a), local_axis(b)));
    dynamics_.addConstraint(hinges_.back().get(), true);
  }

  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld dynamics_;
  bool is_swept_;
  std::vector<Quaterniond> body_from_principal_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::vector<std::unique_ptr<btTypedConstraint>> hinges_;
};

std::vector<std::vector<Setting>> ladders(const BenchCase& bench) {
  const std::string scene = bench.id.substr(0, 2);
  if (scene == "S7") return step_ladders(bench, {kSweeps, kSwept});
  if (scene == "S1" || scene == "S4") return step_ladders(bench, {kSweeps});
  if (scene == "S2" || scene == "S6") return step_ladders(bench, {kSweeps, kManySweeps, kReduced});
  return step_ladders(bench, {kSweeps, kManySweeps});
}

std::unique_ptr<PeerWorld> build(const BenchCase& bench, const World& world,
                                 const Setting& setting) {
  if (setting.method == kReduced) return make_bullet_chain(bench, world);
  return std::make_unique<BulletWorld>(bench, world, setting);
}

}  // namespace
}  // namespace tumble::peers

int main(int argc, char** argv) {
  using namespace tumble::peers;
  return peer_main(
      argc, argv,
      {.name = "Bullet",
       .version = TUMBLE_PEER_VERSION,
       .settings = "defaults of the manual (implicit gyroscopic term, margin 4 cm inside boxes); "
                   "hulls with a margin of 1 mm; where bodies bounce: from any speed, contacts "
                   "wait until they touch (contact processing threshold 0), overlaps are split off "
                   "at any depth; no damping, no sleep",
       .ladders = ladders,
       .build = build,
       .run = {}});
}
