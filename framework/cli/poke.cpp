// tumble poke SCENE: pushes a body at a pixel, along a ray or at a point, and shows the motion.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "framework/cli/pick_face.h"
#include "framework/cli/scene_run.h"
#include "framework/core/nearest_word.h"
#include "framework/effects/build_world.h"
#include "framework/effects/registry.h"
#include "framework/render/camera.h"
#include "framework/scene/build_shape.h"
#include "framework/scene/write_entries.h"

namespace tumble::cli {
namespace {

constexpr const char* kPushKey = "point_forces";  // of the scene's entries: what pushes

struct PokeWords : RunWords {
  std::string pixel, ray, point;  // position of the force; exactly one of them
  std::string force;              // "FX,FY,FZ" [N]
  double push_s = 0.0;
};

/// The point of the force, and how it was found.
struct Target {
  std::string body;
  Vector3d point_world;
  std::string found;  // for people
};

/// A force on a point of a body, from the start.
struct Push {
  std::string body;
  Vector3d force_world, point_world;  // [N], [m]
  double duration_s;
};

std::string show(const Vector3d& v) {
  // no "-0" and no round-off in messages
  const auto clean = [](double x) { return std::abs(x) < 1e-12 ? 0.0 : x; };
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", clean(v.x()), clean(v.y()), clean(v.z()));
}

Ray ray_of_words(const PokeWords& words, const scene::Scene& scene) {
  char rest = 0;
  if (!words.pixel.empty()) {
    double x = 0, y = 0;
    const PictureSize size = parse_size(words.size);
    if (std::sscanf(words.pixel.c_str(), "%lf,%lf%c", &x, &y, &rest) != 2 ||
        !(x >= 0 && x < size.width && y >= 0 && y < size.height))
      throw UserError(
          "--pixel " + words.pixel,
          fmt::format("expected X,Y inside a picture of {}x{}; (0,0) is the top left corner",
                      size.width, size.height),
          "Give the picture's size with --size where it is another.");
    // through the centre of the pixel
    return render::pixel_ray(scene.camera, size.width, size.height, x + 0.5, y + 0.5);
  }
  Ray ray{Vector3d::Zero(), Vector3d::Zero()};
  Vector3d& o = ray.origin_world;
  Vector3d& d = ray.direction_world;
  if (std::sscanf(words.ray.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf%c", &o.x(), &o.y(), &o.z(), &d.x(),
                  &d.y(), &d.z(), &rest) != 6 ||
      !o.allFinite() || !d.allFinite() || d.isZero(0))
    throw UserError("--ray " + words.ray,
                    "expected OX,OY,OZ,DX,DY,DZ: a point and a direction that is not 0",
                    "For example --ray 0,-5,1,0,1,0.");
  return ray;
}

Target named_point(const std::string& text, const scene::Scene& scene) {
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos)
    throw UserError("--point " + text, "expected BODY,X,Y,Z", "For example --point box,0,0,1.");
  return {text.substr(0, comma), parse_vector("--point BODY,", text.substr(comma + 1)),
          "point given by hand in scene " + scene.name};
}

Target find_target(const Context& context, const PokeWords& words, const scene::Scene& scene,
                   const Laws& laws) {
  if (!words.point.empty()) return named_point(words.point, scene);
  const Ray ray = ray_of_words(words, scene);
  const auto hit = pick_face(scene, laws, ray, context.root);
  if (!hit)
    throw UserError(
        words.pixel.empty() ? "--ray " + words.ray : "--pixel " + words.pixel,
        "nothing is hit: the ray from " + show(ray.origin_world) + " along " +
            show(ray.direction_world) + " passes all bodies; " +
            nearest_miss(scene, ray, context.root),
        "Look at the scene first: tumble run " + scene.name + " --png look.png --at-s 0");
  const std::string& body = scene.bodies[static_cast<std::size_t>(hit->body)].name;
  return {body, hit->point_world,
          fmt::format("hit body '{}', face {}, at {} m, {:.4g} m from the eye", body, hit->face,
                      show(hit->point_world), hit->distance)};
}

const scene::BodySpec& pushed_body(const scene::Scene& scene, const Target& target) {
  std::string movable;
  std::vector<std::string> names;
  for (const auto& body : scene.bodies) {
    names.push_back(body.name);
    if (body.name == target.body && !body.immovable) return body;
    if (body.name == target.body)
      throw UserError("poke", "body '" + body.name + "' is immovable: no force moves it",
                      "Aim at a movable body.");
    if (!body.immovable && movable.size() < 200)
      movable += (movable.empty() ? "" : ", ") + body.name;
  }
  throw UserError("poke",
                  "no body is named '" + target.body + "'." + did_you_mean(target.body, names),
                  "Movable bodies: " + movable + ".");
}

/// Momentum and angular momentum of a closed system after the push, and the tolerance of the
/// latter.
struct AfterPush {
  // the latter about the world's origin
  Vector3d momentum = Vector3d::Zero(), angular_momentum = Vector3d::Zero();
  // scales of rounding errors
  double momentum_scale = 0.0, angular_scale = 0.0;
  // at most, during the push [m]
  double point_travel = 0.0;
};

/// Whether everything beside the push acts between two bodies of the scene: a force on one body
/// alone, such as gravity's or drag's, and a link to the world bring momentum in or take it out.
bool is_closed(const scene::Scene& scene) {
  const World world = build_world(scene);
  for (const effects::Effect* effect : effects::all()) {
    if (effect->key() == kPushKey) continue;
    for (int entry = 0; entry < effect->count_in(world); ++entry) {
      const std::vector<int> bodies = effect->bodies_of(world, entry);
      if (bodies.size() < 2 || std::count(bodies.begin(), bodies.end(), -1) > 0) return false;
    }
  }
  return true;
}

/// @return nothing where a force from outside or an immovable body may exchange momentum
std::optional<AfterPush> after_push(const Context& context, const scene::Scene& scene,
                                    const Push& push) {
  if (!is_closed(scene)) return std::nullopt;
  AfterPush after;
  const double time = push.duration_s;
  after.momentum = time * push.force_world;
  after.angular_momentum = push.point_world.cross(time * push.force_world);
  after.momentum_scale = after.momentum.norm();
  after.angular_scale = push.point_world.norm() * after.momentum.norm();
  const auto solids = scene::build_solids(scene, context.root);
  for (std::size_t i = 0; i < solids.size(); ++i) {
    if (solids[i].is_immovable()) return std::nullopt;
    const scene::BodySpec& body = scene.bodies[i];
    const Matrix3d rotation = body.world_from_body.toRotationMatrix();
    const Matrix3d inertia_world = rotation * solids[i].inertia_body_kg_m2 * rotation.transpose();
    const Vector3d momentum = solids[i].mass_kg * body.velocity_m_s,
                   spin = inertia_world * body.omega_world_rad_s;
    after.momentum += momentum;
    after.angular_momentum += spin + body.position_m.cross(momentum);
    after.momentum_scale += momentum.norm();
    after.angular_scale += spin.norm() + body.position_m.norm() * momentum.norm();
    if (body.name != push.body) continue;
    const Vector3d arm = push.point_world - body.position_m, w = body.omega_world_rad_s;
    const double turning = (inertia_world.inverse() * arm.cross(push.force_world)).norm();
    const double acceleration =
        push.force_world.norm() / solids[i].mass_kg + arm.norm() * (turning + w.squaredNorm());
    // v T + a T^2 / 2 at a constant acceleration; twice the last term, because the acceleration
    // changes as the body rotates.
    after.point_travel =
        (body.velocity_m_s + w.cross(arm)).norm() * time + acceleration * time * time;
  }
  return after;
}

scene::CheckSpec expectation(const char* kind, const Vector3d& expected, double tolerance,
                             const std::string& why) {
  scene::CheckSpec check;
  check.kind = kind;
  check.expected = {expected.x(), expected.y(), expected.z()};
  check.tolerance = tolerance;
  check.why = why;
  return check;
}

/// The scene's checks apply to a run without this push: those that hold for any run are kept, and
/// the momenta of a closed system after a push are known.
void replace_checks(const Context& context, scene::Scene& scene, const Push& push) {
  std::erase_if(scene.checks, [](const scene::CheckSpec& check) {
    return check.kind != "gap" && check.kind != "restitution_law" && check.kind != "side_of_wall";
  });
  const auto after = after_push(context, scene, push);
  if (!after) return;
  const double travel_moment = push.force_world.norm() * push.duration_s * after->point_travel;
  scene.checks.insert(
      scene.checks.begin(),
      {expectation("momentum", after->momentum, 1e-9 * after->momentum_scale,
                   "exact: what was there, and force times time; 1e-9 of it for rounding"),
       expectation(
           "angular_momentum", after->angular_momentum, travel_moment + 1e-9 * after->angular_scale,
           fmt::format("what was there, and torque times time; the point is fixed in the body and "
                       "moves by at most {:.2g} m in the push, which changes the arm by that",
                       after->point_travel))});
}

void poke(Context& context, const PokeWords& words) {
  if ((words.pixel.empty() ? 0 : 1) + (words.ray.empty() ? 0 : 1) + (words.point.empty() ? 0 : 1) !=
      1)
    throw UserError("poke", "expected exactly one of --pixel, --ray, --point",
                    "For example --pixel 200,250.");
  // a model is at rest before the push
  scene::Scene scene = scene_of_words(context, words, false);
  const ChosenLaws chosen = choose_laws(
      context, scene, parse_module_words(words.modules, context.registry), words.engine);
  if (!chosen.laws.wrench_of_point_force)
    throw UserError("--modules", "no module here turns a point force into force and torque",
                    "Build a1, or name one: --modules a1=PATH.cpp");

  const Vector3d force = parse_vector("--force", words.force);
  const Target target = find_target(context, words, scene, chosen.laws);
  const scene::BodySpec& body = pushed_body(scene, target);
  const Wrench wrench =
      chosen.laws.wrench_of_point_force(force, target.point_world, body.position_m);
  const std::string extra = fmt::format(
      "{}\n  force {} N for {:.4g} s at an arm of {} m: force {} N on the centre of mass, torque "
      "{} N m about it",
      target.found, show(force), words.push_s, show(target.point_world - body.position_m),
      show(wrench.force_world), show(wrench.torque_world));

  const Push push{target.body, force, target.point_world, words.push_s};
  // instead of the scene's own: the motion shows this push
  scene::remove_entries(scene, kPushKey);
  scene::EntryWriter{scene}(kPushKey, {{"body", push.body},
                                       {"force_n", push.force_world},
                                       {"point_m", push.point_world},
                                       {"duration_s", push.duration_s}});
  // s: time to see the motion afterwards
  scene.duration_s = std::max(scene.duration_s, words.push_s + 2.0);
  scene.title = "Poked by hand: scene " + scene.name;
  scene.about.clear();
  replace_checks(context, scene, push);
  run_and_tell(context, scene, chosen, words, extra);
}

}  // namespace

void add_poke(CLI::App& app, Context& context) {
  auto words = std::make_shared<PokeWords>();
  Verb verb(app, "poke", "Push a body where a pixel, a ray or a point says, and watch");
  add_run_words(verb, *words);
  verb.option("--pixel", words->pixel,
              "X,Y in the scene's picture (see --size); (0,0) is the top left corner")
      .type_name("X,Y");
  verb.option("--ray", words->ray, "OX,OY,OZ,DX,DY,DZ: from a point [m] along a direction, world")
      .type_name("RAY");
  verb.option("--point", words->point,
              "BODY,X,Y,Z: a point that moves with the body, where it is at the start [m], world")
      .type_name("POINT");
  verb.option("--force", words->force, "FX,FY,FZ [N], world, constant while it lasts")
      .required()
      .type_name("FORCE");
  verb.option("--duration-s", words->push_s, "How long the force lasts [s]").required().positive();
  verb.footer(
      "The face is found through a tree of boxes over the model, then asked of your own ray "
      "function, whose answer counts.\n"
      "Example: tumble poke poked_box --pixel 200,250 --force 0,60,0 --duration-s 0.2 --video "
      "poke.mp4\n         tumble poke t_handle.3ds --pixel 320,240 --force 0,40,0 --duration-s 0.2 "
      "--html poke.html");
  verb.runs([&context, words] { poke(context, *words); });
}

}  // namespace tumble::cli
