#include "tests/fuzz/draw_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "framework/core/math.h"
#include "framework/core/random.h"

namespace tumble::fuzz {
namespace {

struct Model {
  const char* file;
  // radius of the bounding ball about the centre of mass, at 1 m per unit, rounded up [m]
  double reach;
};
constexpr std::array<Model, 8> kModels{{{"box.3ds", 0.9},
                                        {"wedge.3ds", 0.9},
                                        {"rock_1.3ds", 0.9},
                                        {"rock_2.3ds", 0.9},
                                        {"rock_3.3ds", 0.9},
                                        {"rod.3ds", 0.6},
                                        {"l_shape.3ds", 2.0},
                                        {"t_handle.3ds", 0.9}}};

Json as_json(const Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

/// The random properties of one movable body before it has a position.
struct Drawn {
  Json body;
  double reach;  // of its bounding ball [m]
  // of a shape that can be stacked (a level box, a ball): centre to top [m]; 0: it cannot
  double half_height;
  double mass;  // [kg]
};

class SceneMaker {
 public:
  SceneMaker(std::uint64_t number, const DrawOptions& options)
      : random_(number), options_(options), number_(number) {}
  Json make();

 private:
  bool chance(double p) { return random_.unit() < p; }
  int among(int low, int high) {
    return low + static_cast<int>(random_.below(static_cast<std::uint64_t>(high - low + 1)));
  }
  double log_between(double low, double high) {
    return std::exp(random_.between(std::log(low), std::log(high)));
  }
  template <class T>
  const T& one_of(const std::vector<T>& all) {
    return all[random_.below(all.size())];
  }
  Vector3d direction();
  double decimals(double value) { return rounded_ ? std::round(value * grid_) / grid_ : value; }
  Vector3d decimals(const Vector3d& v) {
    return {decimals(v.x()), decimals(v.y()), decimals(v.z())};
  }

  Json draw_shape(Drawn& drawn);
  void draw_mass(Drawn& drawn);
  Drawn draw_body(int index);
  void draw_motion(Json& body);
  void place_apart(std::vector<Drawn>& drawn);
  void place_stacked(std::vector<Drawn>& drawn);
  void add_floor();
  void add_links(const std::vector<Drawn>& drawn);
  void add_link(const Drawn& a, const Drawn* b);
  void add_chain();
  void add_repeat();
  void add_effects(const std::vector<Drawn>& drawn);

  Random random_;
  const DrawOptions options_;
  const std::uint64_t number_;
  Json scene_;
  double size_ = 1.0;  // of a typical body [m]
  double typical_mass_ = 1.0;
  double speed_ = 0.0;    // typical [m/s]
  double gravity_ = 0.0;  // [m/s^2], along -z
  double step_ = 0.0, duration_ = 0.0;
  double spread_ = 1.0;   // sizes and masses differ by up to this factor
  bool rounded_ = false;  // positions are decimals, as in files written by hand
  double grid_ = 1000.0;
  bool has_contact_ = false, has_floor_ = false, is_linked_ = false, has_ellipsoids_ = false;
  Vector3d origin_ = Vector3d::Zero();  // the scene's centre: often far from the world's origin
};

Vector3d SceneMaker::direction() {
  const double z = random_.between(-1.0, 1.0), angle = random_.between(0.0, 2.0 * std::numbers::pi),
               around = std::sqrt(1.0 - z * z);
  return {around * std::cos(angle), around * std::sin(angle), z};
}

Json SceneMaker::draw_shape(Drawn& drawn) {
  const double scale = std::clamp(size_ * log_between(1.0 / spread_, spread_), 1e-3, 100.0);
  const int kind = among(0, 9);
  if (kind <= 3) {
    const double radius = decimals(scale / 2) > 0 ? decimals(scale / 2) : scale / 2;
    drawn.reach = drawn.half_height = radius;
    return {{"sphere", {{"radius_m", radius}}}};
  }
  if (kind <= 7 || (kind == 8 && !has_ellipsoids_)) {
    const bool is_cube = chance(0.4);
    Vector3d edges;
    for (int i = 0; i < 3; ++i) {
      edges[i] = is_cube ? scale : scale * log_between(0.2, 1.5);
      if (decimals(edges[i]) > 0) edges[i] = decimals(edges[i]);
    }
    drawn.reach = edges.norm() / 2;
    drawn.half_height = edges.z() / 2;
    return {{"box", {{"size_m", as_json(edges)}}}};
  }
  if (kind == 8) {  // the only movable shape of such a scene is an ellipsoid or does not collide
    Vector3d axes(scale / 2 * log_between(0.4, 1.0), scale / 2 * log_between(0.4, 1.0),
                  scale / 2 * log_between(0.4, 1.0));
    drawn.reach = axes.maxCoeff();
    drawn.half_height = 0.0;
    return {{"ellipsoid", {{"semi_axes_m", as_json(axes)}}}};
  }
  const Model& model = kModels[random_.below(kModels.size())];
  drawn.reach = model.reach * scale;
  drawn.half_height = 0.0;
  return {{"model", {{"file", model.file}, {"metres_per_unit", scale}}}};
}

void SceneMaker::draw_mass(Drawn& drawn) {
  drawn.mass = std::clamp(typical_mass_ * log_between(1.0 / spread_, spread_), 1e-3, 1e4);
  const double density = log_between(100.0, 8000.0),
               mass = density * std::pow(2.0 * drawn.reach, 3);
  if (chance(0.2) && mass > 1e-3 && mass < 1e4)
    drawn.body["density_kg_m3"] = density;
  else
    drawn.body["mass_kg"] = drawn.mass;
}

Drawn SceneMaker::draw_body(int index) {
  Drawn drawn;
  drawn.body["name"] = "b" + std::to_string(index);
  drawn.body["shape"] = draw_shape(drawn);
  draw_mass(drawn);
  if (chance(0.7)) drawn.body["restitution"] = one_of<double>({0.0, 0.0, 0.3, 0.5, 0.9, 1.0});
  if (has_contact_ && chance(0.7))
    drawn.body["friction"] = one_of<double>({0.1, 0.3, 0.5, 1.0, 10.0});
  return drawn;
}

void SceneMaker::draw_motion(Json& body) {
  if (chance(0.7)) body["velocity_m_s"] = as_json(decimals(speed_ * random_.unit() * direction()));
  // Up to half a radian per step: faster rotations are refused or reported, which a few scenes
  // test.
  if (chance(0.4))
    body["angular_velocity_rad_s"] =
        as_json((chance(0.9) ? 0.5 : 5.0) / step_ * random_.unit() * random_.unit() * direction());
}

/// On a lattice, wide enough for the bounding balls: above the floor, with random orientations.
void SceneMaker::place_apart(std::vector<Drawn>& drawn) {
  double reach = 0.0;
  for (const Drawn& one : drawn) reach = std::max(reach, one.reach);
  const double cell = 2.0 * reach * random_.between(1.05, 1.6);
  const int side = static_cast<int>(std::ceil(std::cbrt(static_cast<double>(drawn.size()))));
  const double height = has_floor_ ? reach * random_.between(1.05, 3.0) : 0.0;
  for (int i = 0; i < static_cast<int>(drawn.size()); ++i) {
    const Vector3d at(cell * (i % side), cell * (i / side % side),
                      height + cell * (i / (side * side)));
    Vector3d place = origin_ + at;
    // shifts by at most half a grid cell, which is 1e-3 of the size
    if (rounded_) place = decimals(place);
    Json& body = drawn[static_cast<std::size_t>(i)].body;
    body["position_m"] = as_json(place);
    if (chance(0.5))
      body["orientation"] = {
          {"rotation_vector_rad", as_json(random_.between(0.0, 3.0) * direction())}};
    draw_motion(body);
  }
}

/// One on the other, touching exactly up to decimals and rounding, or with a tiny gap; at rest or
/// nearly so.
void SceneMaker::place_stacked(std::vector<Drawn>& drawn) {
  const double hair = one_of<double>({0.0, 0.0, 1e-12, 1e-9});
  const bool is_still = chance(0.7);
  double top = origin_.z();
  for (Drawn& one : drawn) {
    if (one.half_height == 0.0) {  // models and ellipsoids do not stack: replaced by a box
      const double edge = 2.0 * one.reach / std::sqrt(3.0);
      one.body["shape"] = {{"box", {{"size_m", as_json(Vector3d::Constant(edge))}}}};
      one.half_height = edge / 2;
    }
    const bool is_off = one.body["shape"].contains("box") && chance(0.4);
    Vector3d place(origin_.x(), origin_.y(), top + one.half_height + hair);
    if (is_off)
      place += Vector3d(random_.between(-0.05, 0.05) * one.half_height,
                        random_.between(-0.05, 0.05) * one.half_height, 0);
    one.body["position_m"] = as_json(place);
    if (!is_still) one.body["velocity_m_s"] = as_json(0.05 * speed_ * direction());
    top = place.z() + one.half_height;
  }
}

void SceneMaker::add_floor() {
  Json floor{{"name", "floor"},
             {"shape", {{"plane", Json::object()}}},
             {"immovable", true},
             {"position_m", as_json(origin_)}};
  if (has_contact_ && chance(0.7)) floor["friction"] = one_of<double>({0.2, 0.5, 1.0, 10.0});
  if (chance(0.15)) {
    Json motion{{"velocity_m_s", as_json(size_ * random_.between(0.0, 2.0) * Vector3d(1, 0, 0))}};
    if (chance(0.5)) {
      motion["amplitude_m"] = as_json(0.2 * size_ * random_.unit() * direction());
      motion["angular_frequency_rad_s"] = random_.between(1.0, 0.1 / step_);
    }
    floor["motion"] = motion;
  }
  scene_["bodies"].push_back(floor);
}

void SceneMaker::add_link(const Drawn& a, const Drawn* b) {
  const auto at = [](const Drawn& one) {
    return Vector3d(one.body["position_m"][0], one.body["position_m"][1],
                    one.body["position_m"][2]);
  };
  const Vector3d from = at(a), to = b != nullptr
                                        ? at(*b)
                                        : Vector3d(from + (1.5 * a.reach + size_) * direction());
  const std::string name_a = a.body["name"];
  const Json end_b =
      b != nullptr ? Json{{"body", b->body["name"]}} : Json{{"point_world_m", as_json(to)}};
  const double lighter = b != nullptr ? std::min(a.mass, b->mass) : a.mass;
  const int kind = among(0, 4);
  if (kind == 0) {
    Json spring{{"a", {{"body", name_a}}}, {"b", end_b}};
    // omega h below RK4's limit for most: beyond it a run is refused
    const double rate = random_.between(0.02, 0.7) / step_;
    spring["stiffness_n_m"] = lighter * rate * rate * 0.5;
    if (chance(0.5)) spring["damping_n_s_m"] = lighter * rate * random_.between(0.0, 0.5);
    if (chance(0.3)) spring["rest_length_m"] = (to - from).norm() * random_.between(0.5, 1.5);
    scene_["springs"].push_back(spring);
    return;
  }
  if (kind == 1) {
    Json end_a{{"body", name_a}};
    if (chance(0.3)) end_a["point_world_m"] = as_json(from + 0.5 * a.reach * direction());
    scene_["rods"].push_back({{"a", end_a}, {"b", end_b}});
    return;
  }
  Json joint{{"name", "j" + std::to_string(scene_["joints"].size())},
             {"kind", kind == 2   ? "ball"
                      : kind == 3 ? "hinge"
                                  : "weld"},
             {"body_a", name_a}};
  if (b != nullptr) joint["body_b"] = b->body["name"];
  joint["point_m"] = as_json(b != nullptr ? Vector3d(0.5 * (from + to)) : to);
  if (kind == 3) joint["axis"] = as_json(direction());
  scene_["joints"].push_back(joint);
  if (kind == 3 && chance(0.3)) {
    const double torque = lighter * a.reach * a.reach * 10.0;
    scene_["motors"].push_back({{"joint", joint["name"]},
                                {"amplitude_rad", 0.5},
                                {"frequency_hz", 1.0},
                                {"stiffness_n_m_rad", torque},
                                {"damping_n_m_s_rad", 0.05 * torque},
                                {"largest_torque_n_m", torque}});
  }
}

void SceneMaker::add_links(const std::vector<Drawn>& drawn) {
  for (const char* kind : {"springs", "rods", "joints", "motors"}) scene_[kind] = Json::array();
  const bool hangs = chance(0.6);
  if (hangs) add_link(drawn[0], nullptr);
  for (std::size_t i = 1; i < drawn.size(); ++i)
    if (chance(0.75)) add_link(drawn[i - 1], &drawn[i]);
  for (const char* kind : {"springs", "rods", "joints", "motors"})
    if (scene_[kind].empty()) scene_.erase(kind);
  const bool has_bilateral = scene_.contains("rods") || scene_.contains("joints");
  if (has_bilateral && chance(0.15))
    scene_["stabilisation"] = {{"kind", one_of<std::string>({"none", "baumgarte", "projection"})}};
}

void SceneMaker::add_chain() {
  const int links = among(2, options_.quick ? 4 : 8);
  Json link{{"name", "link"},
            {"shape", {{"sphere", {{"radius_m", 0.2 * size_}}}}},
            {"mass_kg", typical_mass_}};
  Json chain{{"kind", one_of<std::string>({"rods", "ball_joints", "hinges", "springs"})},
             {"links", links},
             {"spacing_m", size_},
             {"direction", as_json(direction())},
             {"link", link}};
  chain["from"] = {{"point_world_m", as_json(origin_ + Vector3d(0, 0, 50 * size_))}};
  if (chain["kind"] == "hinges") chain["axis"] = as_json(direction());
  if (chain["kind"] == "springs") {
    const double rate = random_.between(0.02, 0.4) / step_;
    chain["stiffness_n_m"] = typical_mass_ * rate * rate * 0.25;
  }
  scene_["chains"] = Json::array({chain});
}

void SceneMaker::add_repeat() {
  Json body{{"name", "copy"},
            {"shape", {{"sphere", {{"radius_m", 0.3 * size_}}}}},
            {"mass_kg", typical_mass_},
            {"position_m",
             as_json(origin_ + Vector3d(0, 0, -40 * size_ + (has_floor_ ? 80 * size_ : 0.0)))}};
  if (chance(0.5)) body["restitution"] = 0.5;
  Json repeat{{"body", body},
              {"counts", Json::array({2, among(1, 2), 1})},
              {"spacing_m", as_json(Vector3d::Constant(1.5 * size_))},
              {"speed_m_s", 0.2 * speed_},
              {"seed", static_cast<int>(random_.below(1000))}};
  scene_["repeat"] = Json::array({repeat});
}

void SceneMaker::add_effects(const std::vector<Drawn>& drawn) {
  // forces switch at frames, so that their work can be summed from the frames alone
  constexpr double kFrame = 1.0 / 60.0;
  if (chance(0.2)) {
    const Drawn& body = one_of(drawn);
    Json drag{{"body", body.body["name"]},
              {"linear_n_s_m", body.mass * random_.between(0.0, 0.3) / step_}};
    if (chance(0.5))
      drag["angular_n_m_s"] =
          body.mass * body.reach * body.reach * random_.between(0.0, 0.02) / step_;
    scene_["drag"] = Json::array({drag});
  }
  if (chance(0.2)) {
    const Drawn& body = one_of(drawn);
    const Vector3d at(body.body["position_m"][0], body.body["position_m"][1],
                      body.body["position_m"][2]);
    const double strength =
        body.mass * std::max(gravity_, speed_ / duration_) * random_.between(0.1, 5.0);
    scene_["point_forces"] =
        Json::array({{{"body", body.body["name"]},
                      {"force_n", as_json(strength * direction())},
                      {"point_m", as_json(at + 0.3 * body.reach * direction())},
                      {"start_s", 0.0},
                      {"duration_s", kFrame * among(1, 10)}}});
  }
}

Json SceneMaker::make() {
  scene_["title"] = "drawn by lot, number " + std::to_string(number_);
  size_ = log_between(1e-3, 100.0);
  typical_mass_ = log_between(1e-3, 1e4);
  spread_ = one_of<double>({1.0, 1.5, 3.0, 3.0, 30.0, 1000.0});
  rounded_ = chance(0.4);
  grid_ = std::pow(10.0, std::ceil(3.0 - std::log10(size_)));
  if (chance(0.3)) origin_ = decimals(Vector3d(size_ * log_between(1.0, 1e4) * direction()));
  step_ = one_of<double>({1.0 / 30, 1.0 / 60, 1.0 / 60, 1.0 / 240, 1.0 / 1000});
  duration_ = std::min(options_.quick ? 60 * step_ : 500 * step_, one_of<double>({0.25, 0.5, 1.0}));
  duration_ = std::max(1.0, std::round(duration_ * 60.0)) / 60.0;
  scene_["duration_s"] = duration_;
  scene_["step_s"] = step_;
  if (chance(0.8)) {
    gravity_ = chance(0.8) ? 9.81 : log_between(0.1, 100.0);
    scene_["gravity_m_s2"] = as_json(Vector3d(0, 0, -gravity_));
  }
  // Velocities: some sizes per second, or the speed of a fall by some sizes; sometimes anything up
  // to 1000 m/s.
  speed_ =
      chance(0.85) ? std::min(1000.0, size_ * log_between(0.1, 30.0)) : log_between(0.01, 1000.0);
  has_contact_ = chance(0.65);
  if (has_contact_) {
    Json contact = Json::object();
    if (chance(0.3)) contact["plastic_impacts"] = "in_step";
    if (chance(0.2)) contact["impact_law"] = "simultaneous";
    if (!options_.all_engines && chance(0.2)) contact["sleep"] = true;
    scene_["contact"] = contact;
  }
  has_floor_ = chance(0.7);
  scene_["bodies"] = Json::array();
  if (has_floor_) add_floor();
  has_ellipsoids_ = has_floor_ && chance(0.1);
  const bool is_stack = has_floor_ && !has_ellipsoids_ && chance(0.3);
  const int most = has_ellipsoids_ ? 1 : options_.quick ? 4 : 8;
  std::vector<Drawn> drawn;
  for (int i = 0, n = among(1, most); i < n; ++i) drawn.push_back(draw_body(i));
  if (is_stack)
    place_stacked(drawn);
  else
    place_apart(drawn);
  is_linked_ = chance(is_stack ? 0.1 : 0.4);
  if (is_linked_) add_links(drawn);
  if (!has_ellipsoids_ && !is_stack && chance(0.05)) add_chain();
  if (!has_ellipsoids_ && chance(0.05)) add_repeat();
  add_effects(drawn);
  for (const Drawn& one : drawn) scene_["bodies"].push_back(one.body);
  return scene_;
}

}  // namespace

Json draw_scene(std::uint64_t number, const DrawOptions& options) {
  return SceneMaker(number, options).make();
}

}  // namespace tumble::fuzz
