// The Open Dynamics Engine (Debian: double precision). Joints are constraints; contacts are joints
// made anew every step.
#include <algorithm>

#include <ode/ode.h>

#include "framework/effects/joint/joint.h"
#include "tests/bench/peers/harness.h"

namespace tumble::peers {
namespace {

const std::string kDirect = "dWorldStep (Dantzig)", kSweeps = "dWorldQuickStep (20 sweeps)";
constexpr int kMostContacts = 8;  // of a pair

class OdeWorld final : public PeerWorld {
 public:
  OdeWorld(const BenchCase& bench, const World& world, const Setting& setting)
      : scene_(bench.scene), specs_(world), is_direct_(setting.method == kDirect) {
    world_ = dWorldCreate();
    const Vector3d g = world.gravity_world.value_or(Vector3d::Zero());
    dWorldSetGravity(world_, g.x(), g.y(), g.z());
    space_ = dHashSpaceCreate(nullptr);
    contacts_ = dJointGroupCreate(0);
    for (int i = 0; i < static_cast<int>(world.bodies.size()); ++i) add_body(i);
    for (const effects::JointSpec& joint : scene_.effects.of<effects::JointSpec>())
      add_hinge(joint);
  }
  ~OdeWorld() override {
    dJointGroupDestroy(contacts_);
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
  }

  void step(double h) override {
    dSpaceCollide(space_, this, near);
    if (is_direct_)
      dWorldStep(world_, h);
    else
      dWorldQuickStep(world_, h);
    dJointGroupEmpty(contacts_);
  }

  BodyPose pose(int body) override {
    const dBodyID id = bodies_[body];
    const dReal *p = dBodyGetPosition(id), *q = dBodyGetQuaternion(id), *v = dBodyGetLinearVel(id),
                *w = dBodyGetAngularVel(id);
    return {{p[0], p[1], p[2]}, {q[0], q[1], q[2], q[3]}, {v[0], v[1], v[2]}, {w[0], w[1], w[2]}};
  }

 private:
  struct Convex {
    std::vector<dReal> planes, points;
    std::vector<unsigned> polygons;
  };

  void add_body(int i) {
    const WorldBody& spec = specs_.bodies[i];
    const Vector3d& x = spec.state.com_world;
    const Quaterniond& q = spec.state.world_from_body;
    const dQuaternion orientation{q.w(), q.x(), q.y(), q.z()};
    bodies_.push_back(nullptr);
    if (!spec.immovable()) {
      bodies_.back() = dBodyCreate(world_);
      dMass mass;
      const Matrix3d& inertia = spec.inertia.inertia_body;
      dMassSetParameters(&mass, spec.inertia.mass, 0, 0, 0, inertia(0, 0), inertia(1, 1),
                         inertia(2, 2), inertia(0, 1), inertia(0, 2), inertia(1, 2));
      dBodySetMass(bodies_.back(), &mass);
      dBodySetPosition(bodies_.back(), x.x(), x.y(), x.z());
      dBodySetQuaternion(bodies_.back(), orientation);
      const Vector3d v = spec.state.momentum_world * spec.inertia.inverse_mass,
                     w = omega_of(spec.state, spec.inertia);
      dBodySetLinearVel(bodies_.back(), v.x(), v.y(), v.z());
      dBodySetAngularVel(bodies_.back(), w.x(), w.y(), w.z());
    }
    if (!spec.collides) return;
    const dGeomID geom = shape_of(spec);
    dGeomSetData(geom, reinterpret_cast<void*>(static_cast<std::intptr_t>(i)));
    if (bodies_.back() != nullptr) {
      dGeomSetBody(geom, bodies_.back());
    } else if (!std::holds_alternative<HalfSpace>(spec.shape)) {
      dGeomSetPosition(geom, x.x(), x.y(), x.z());
      dGeomSetQuaternion(geom, orientation);
    }
  }

  dGeomID shape_of(const WorldBody& spec) {
    if (const auto* sphere = std::get_if<Sphere>(&spec.shape))
      return dCreateSphere(space_, sphere->radius);
    if (const auto* box = std::get_if<Box>(&spec.shape))
      return dCreateBox(space_, 2 * box->half_extents_body.x(), 2 * box->half_extents_body.y(),
                        2 * box->half_extents_body.z());
    if (const auto* mesh = std::get_if<MeshSolid>(&spec.shape)) {
      if (convex_.points.empty()) fill(mesh->mesh_body);  // one model a scene
      return dCreateConvex(space_, convex_.planes.data(),
                           static_cast<unsigned>(convex_.planes.size() / 4), convex_.points.data(),
                           static_cast<unsigned>(convex_.points.size() / 3),
                           convex_.polygons.data());
    }
    const Vector3d normal = spec.state.world_from_body * Vector3d::UnitZ();
    return dCreatePlane(space_, normal.x(), normal.y(), normal.z(),
                        normal.dot(spec.state.com_world));
  }

  void fill(const TriangleMesh& mesh) {
    for (const Vector3d& v : mesh.vertices)
      convex_.points.insert(convex_.points.end(), {v.x(), v.y(), v.z()});
    for (const Face& face : mesh.faces) {
      const Vector3d &a = mesh.vertices[face[0]], &b = mesh.vertices[face[1]],
                     &c = mesh.vertices[face[2]];
      const Vector3d normal = (b - a).cross(c - a).normalized();
      convex_.planes.insert(convex_.planes.end(),
                            {normal.x(), normal.y(), normal.z(), normal.dot(a)});
      convex_.polygons.insert(convex_.polygons.end(),
                              {3U, static_cast<unsigned>(face[0]), static_cast<unsigned>(face[1]),
                               static_cast<unsigned>(face[2])});
    }
  }

  dBodyID body_named(const std::string& name) const {
    for (std::size_t i = 0; i < specs_.bodies.size(); ++i)
      if (specs_.bodies[i].name == name) return bodies_[i];
    return nullptr;  // the world
  }

  void add_hinge(const effects::JointSpec& joint) {
    const dJointID hinge = dJointCreateHinge(world_, nullptr);
    dJointAttach(hinge, body_named(joint.body_a), body_named(joint.body_b));
    dJointSetHingeAnchor(hinge, joint.point_m.x(), joint.point_m.y(), joint.point_m.z());
    dJointSetHingeAxis(hinge, joint.axis.x(), joint.axis.y(), joint.axis.z());
  }

  static void near(void* data, dGeomID a, dGeomID b) {
    auto& self = *static_cast<OdeWorld*>(data);
    const dBodyID body_a = dGeomGetBody(a), body_b = dGeomGetBody(b);
    if (body_a == nullptr && body_b == nullptr) return;
    const auto spec = [&](dGeomID geom) -> const WorldBody& {
      return self.specs_
          .bodies[static_cast<std::size_t>(reinterpret_cast<std::intptr_t>(dGeomGetData(geom)))];
    };
    dContact contacts[kMostContacts];
    const int count = dCollide(a, b, kMostContacts, &contacts[0].geom, sizeof(dContact));
    for (int k = 0; k < count; ++k) {
      dContact& contact = contacts[k];
      contact.surface = {};
      contact.surface.mode = dContactBounce | dContactApprox1;
      contact.surface.mu = std::min(spec(a).friction, spec(b).friction);
      contact.surface.bounce = std::min(spec(a).restitution, spec(b).restitution);
      contact.surface.bounce_vel = 0.0;
      dJointAttach(dJointCreateContact(self.world_, self.contacts_, &contact), body_a, body_b);
    }
  }

  const scene::Scene& scene_;
  const World& specs_;
  bool is_direct_;
  dWorldID world_;
  dSpaceID space_;
  dJointGroupID contacts_;
  std::vector<dBodyID> bodies_;  // by body of the world; nullptr: immovable
  Convex convex_;
};

std::vector<std::vector<Setting>> ladders(const BenchCase& bench) {
  const std::string scene = bench.id.substr(0, 2);
  // one body: nothing to choose
  if (scene == "S1" || scene == "S4" || scene == "S7") return step_ladders(bench, {kSweeps});
  return step_ladders(bench, {kDirect, kSweeps});
}

}  // namespace
}  // namespace tumble::peers

int main(int argc, char** argv) {
  using namespace tumble::peers;
  dInitODE2(0);
  dAllocateODEDataForThread(dAllocateMaskAll);
  return peer_main(
      argc, argv,
      {.name = "ODE",
       .version = TUMBLE_PEER_VERSION,
       .settings = "the manual's defaults (ERP 0.2, CFM 1e-10 in double precision, 20 sweeps, "
                   "gyroscopic term on); bounce from any speed; no damping, no sleep; hash space",
       .ladders = ladders,
       .build = [](const BenchCase& bench, const tumble::World& world,
                   const Setting& setting) -> std::unique_ptr<PeerWorld> {
         return std::make_unique<OdeWorld>(bench, world, setting);
       },
       .run = {}});
}
