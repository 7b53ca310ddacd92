// MuJoCo: reduced coordinates for joints, soft contacts. It has no coefficient of restitution:
// bounces come of springs in the contacts.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>
#include <mujoco/mujoco.h>
#include <unistd.h>

#include "framework/effects/joint/joint.h"
#include "tests/bench/peers/harness.h"

namespace tumble::peers {
namespace {

const std::string kEuler = "Euler", kRungeKutta = "RK4", kSoft = "Euler, default contacts",
                  kStiff = "Euler, stiffest contacts (solref 2 h)",
                  kHard = "Euler, hard contacts (solimp 0.9999)";
// a spring's half swing: fewer are not resolved, more sink deeper
constexpr double kStepsOfABounce = 10;

std::string words(const Vector3d& v) {
  return fmt::format("{:.17g} {:.17g} {:.17g}", v.x(), v.y(), v.z());
}
std::string words(const Quaterniond& q) {
  return fmt::format("{:.17g} {:.17g} {:.17g} {:.17g}", q.w(), q.x(), q.y(), q.z());
}

/// Writes a world as MuJoCo's own XML: free bodies beside each other, jointed ones inside the body
/// that carries them.
class Writer {
 public:
  Writer(const BenchCase& bench, const World& world, const Setting& setting)
      : scene_(bench.scene), world_(world), setting_(setting) {}

  std::string write() {
    // Memory is claimed beforehand, and what does not fit is dropped: room for what balls and rocks
    // can have.
    const bool is_rough = std::any_of(world_.bodies.begin(), world_.bodies.end(),
                                      [](const WorldBody& body) { return body.friction > 0; });
    const std::size_t contacts = 200 + 8 * world_.bodies.size(),
                      rows = (is_rough ? 3 : 1) * contacts;
    std::string xml = fmt::format(
        "<mujoco><compiler angle=\"radian\"/><size nconmax=\"{}\" njmax=\"{}\"/><option "
        "timestep=\"{:.17g}\" gravity=\"{}\" integrator=\"{}\" cone=\"elliptic\"/>\n",
        contacts, rows, setting_.step, words(world_.gravity_world.value_or(Vector3d::Zero())),
        setting_.method == kRungeKutta ? "RK4" : "Euler");
    xml += "<default><geom " + contact() + "/></default>\n<asset>" + model() +
           "</asset>\n<worldbody>\n";
    for (std::size_t i = 0; i < world_.bodies.size(); ++i)
      if (carrier_of(i).empty()) xml += body(i, nullptr);
    return xml + "</worldbody></mujoco>\n";
  }

 private:
  /// What contacts are like: by default; as stiff as the step allows; harder, so that they give
  /// less; or springs that give back a share e of the speed.
  std::string contact() const {
    double bounciest = 0.0;
    for (const WorldBody& body : world_.bodies)
      bounciest = std::max(bounciest, body.collides && !body.immovable() ? body.restitution : 0.0);
    if (bounciest > 0) {
      const double swing = std::numbers::pi / (kStepsOfABounce * setting_.step),
                   decay = -std::log(bounciest) / std::numbers::pi,
                   damping = decay / std::hypot(1.0, decay);
      return fmt::format("solref=\"{:.17g} {:.17g}\" solimp=\"0.9999 0.9999 0.001\"",
                         -swing * swing, -2 * damping * swing);
    }
    if (setting_.method == kHard) return "solimp=\"0.9999 0.9999 0.001\"";
    return setting_.method == kStiff ? fmt::format("solref=\"{:.17g} 1\"", 2 * setting_.step) : "";
  }

  std::string model() const {
    for (const WorldBody& body : world_.bodies)
      if (const auto* mesh = std::get_if<MeshSolid>(&body.shape)) {
        std::string corners;
        for (const Vector3d& v : mesh->mesh_body.vertices) corners += words(v) + ' ';
        return "<mesh name=\"model\" vertex=\"" + corners + "\"/>";
      }
    return "";
  }

  // joints hang body_a on body_b; the bob of S6 too
  const effects::JointSpec* joint_of(std::size_t i) const {
    for (const effects::JointSpec& joint : scene_.effects.of<effects::JointSpec>())
      if (joint.body_a == world_.bodies[i].name) return &joint;
    return nullptr;
  }
  std::string carrier_of(std::size_t i) const {
    return joint_of(i) == nullptr ? "" : joint_of(i)->body_b;
  }

  std::string body(std::size_t i, const WorldBody* carrier) {
    const WorldBody& body = world_.bodies[i];
    const RigidBodyState& state = body.state;
    const Quaterniond back =
        carrier == nullptr ? Quaterniond::Identity() : carrier->state.world_from_body.conjugate();
    const Vector3d from = carrier == nullptr ? Vector3d::Zero() : carrier->state.com_world;
    const Quaterniond turn = back * state.world_from_body;
    std::string xml = fmt::format("<body name=\"{}\" pos=\"{}\" quat=\"{}\">", body.name,
                                  words(back * (state.com_world - from)), words(turn));
    if (!body.immovable()) {
      const Matrix3d& I = body.inertia.inertia_body;
      xml += fmt::format(
          "<inertial pos=\"0 0 0\" mass=\"{:.17g}\" fullinertia=\"{:.17g} {:.17g} {:.17g} {:.17g} "
          "{:.17g} {:.17g}\"/>",
          body.inertia.mass, I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
      const Quaterniond into = state.world_from_body.conjugate();
      if (const effects::JointSpec* joint = joint_of(i))
        xml += fmt::format("<joint type=\"hinge\" pos=\"{}\" axis=\"{}\"/>",
                           words(into * (joint->point_m - state.com_world)),
                           words(into * joint->axis));
      else
        xml += "<freejoint/>";
    }
    if (body.collides)
      xml += "<geom " + shape(body) +
             fmt::format(" friction=\"{:.17g} 0 0\" condim=\"{}\"/>", body.friction,
                         body.friction > 0 ? 3 : 1);
    for (std::size_t child = 0; child < world_.bodies.size(); ++child)
      if (carrier_of(child) == body.name) xml += this->body(child, &body);
    return xml + "</body>\n";
  }

  std::string shape(const WorldBody& body) const {
    if (const auto* sphere = std::get_if<Sphere>(&body.shape))
      return fmt::format("type=\"sphere\" size=\"{:.17g}\"", sphere->radius);
    if (const auto* box = std::get_if<Box>(&body.shape))
      return "type=\"box\" size=\"" + words(box->half_extents_body) + "\"";
    if (std::holds_alternative<HalfSpace>(body.shape)) return "type=\"plane\" size=\"10 10 1\"";
    return "type=\"mesh\" mesh=\"model\"";
  }

  const scene::Scene& scene_;
  const World& world_;
  const Setting& setting_;
};

class MujocoWorld final : public PeerWorld {
 public:
  MujocoWorld(const BenchCase& bench, const World& world, const Setting& setting) {
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / fmt::format("tumble_peers_{}.xml", getpid());
    std::ofstream(file) << Writer(bench, world, setting).write();
    std::array<char, 1000> error{};
    model_ = mj_loadXML(file.c_str(), nullptr, error.data(), static_cast<int>(error.size()));
    std::filesystem::remove(file);
    if (model_ == nullptr) throw std::runtime_error(error.data());
    data_ = mj_makeData(model_);
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      ids_.push_back(mj_name2id(model_, mjOBJ_BODY, world.bodies[i].name.c_str()));
      const int joint = model_->body_jntadr[ids_.back()];
      if (world.bodies[i].immovable() || joint < 0 || model_->jnt_type[joint] != mjJNT_FREE)
        continue;
      const WorldBody& body = world.bodies[i];
      const Vector3d v = body.state.momentum_world * body.inertia.inverse_mass,
                     w = body.state.world_from_body.conjugate() *
                         omega_of(body.state, body.inertia);
      mjtNum* speed = data_->qvel + model_->jnt_dofadr[joint];
      // linear in the world's, angular in the body's frame
      for (int k = 0; k < 3; ++k) speed[k] = v[k], speed[3 + k] = w[k];
    }
  }
  ~MujocoWorld() override {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }

  void step(double) override { mj_step(model_, data_); }

  void look() override {  // after a step, bodies' places are still those before it
    if (data_->warning[mjWARN_CONTACTFULL].number + data_->warning[mjWARN_CNSTRFULL].number > 0)
      throw std::runtime_error("contacts were dropped for want of memory");
    mj_kinematics(model_, data_);
    mj_comPos(model_, data_);
    mj_comVel(model_, data_);
  }

  BodyPose pose(int body) override {
    const int id = ids_[body];
    if (const int joint = model_->body_jntadr[id];
        joint >= 0 && model_->jnt_type[joint] == mjJNT_FREE) {
      const mjtNum *q = data_->qpos + model_->jnt_qposadr[joint],
                   *v = data_->qvel + model_->jnt_dofadr[joint];
      const Quaterniond turn(q[3], q[4], q[5], q[6]);
      return {{q[0], q[1], q[2]}, turn, {v[0], v[1], v[2]}, turn * Vector3d(v[3], v[4], v[5])};
    }
    mjtNum velocity[6];
    mj_objectVelocity(model_, data_, mjOBJ_XBODY, id, velocity, 0);
    const mjtNum *x = data_->xpos + 3 * id, *q = data_->xquat + 4 * id;
    return {{x[0], x[1], x[2]},
            {q[0], q[1], q[2], q[3]},
            {velocity[3], velocity[4], velocity[5]},
            {velocity[0], velocity[1], velocity[2]}};
  }

 private:
  mjModel* model_;
  mjData* data_;
  std::vector<int> ids_;
};

std::vector<std::vector<Setting>> ladders(const BenchCase& bench) {
  const std::string scene = bench.id.substr(0, 2);
  if (scene == "S1" || scene == "S2" || scene == "S6")
    return step_ladders(bench, {kEuler, kRungeKutta});
  // with the stiffest it jumps apart
  if (scene == "S5") return step_ladders(bench, {kSoft, kHard});
  // hard ones are dearer and sink deeper
  if (scene == "S8") return step_ladders(bench, {kSoft, kStiff});
  return step_ladders(bench, {kEuler});
}

}  // namespace
}  // namespace tumble::peers

int main(int argc, char** argv) {
  using namespace tumble::peers;
  // else it writes a log into the folder it is called from; a run that breaks shows in its row
  mju_user_warning = [](const char*) {};
  return peer_main(
      argc, argv,
      {.name = "MuJoCo",
       .version = mj_versionString(),
       .settings = "the manual's defaults (Newton's method, tolerance 1e-8) with elliptic cones; "
                   "where bodies bounce, contacts are springs of ten steps' half swing (solref -k "
                   "-b, solimp 0.9999), as its manual advises, for it has no restitution",
       .ladders = ladders,
       .build = [](const BenchCase& bench, const tumble::World& world,
                   const Setting& setting) -> std::unique_ptr<PeerWorld> {
         return std::make_unique<MujocoWorld>(bench, world, setting);
       },
       .run = {}});
}
