#include "framework/live/recipe.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "framework/core/error.h"
#include "framework/scene/write_entries.h"

namespace tumble::live {
namespace {

using Json = nlohmann::ordered_json;

Json triple_of(const Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

Vector3d vector_in(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

void need(bool holds, const std::string& what, const std::string& range) {
  if (!holds) throw UserError(what, "this is no value that a scene may have", range);
}

std::optional<double> number_in(const Json& value, const std::string& what, double least,
                                double most, const std::string& range) {
  if (value.is_null()) return std::nullopt;
  need(value.is_number(), what, range);
  const double x = value.get<double>();
  need(std::isfinite(x) && x >= least && x <= most, what, range);
  return x;
}

// The entry of a body of its own; null where it is one of many made by one entry.
Json* entry_of(Json& scene, const std::string& name) {
  for (Json& body : scene["bodies"])
    if (body.value("name", "") == name && !body.contains("repeat")) return &body;
  return nullptr;
}

void set_mass(Json& body, double kg) {
  body.erase("density_kg_m3");
  body["mass_kg"] = kg;
}

/// Nothing: as long as the scene says. A run on the page goes on after that, and so may what is
/// done to it; the scene that has these pushes lasts until the last of them.
std::optional<double> duration_of(const Recipe& recipe, double of_scene_s) {
  if (recipe.duration_s) return recipe.duration_s;
  double end = of_scene_s;
  for (const std::string& text : recipe.pushes) {
    const Json push = Json::parse(text);
    end = std::max(end, push.at("start_s").get<double>() + push.at("duration_s").get<double>());
  }
  if (end > of_scene_s) return end;
  return std::nullopt;
}

Json changed(const Recipe& recipe) {
  Json scene = Json::parse(recipe.document);
  const Changes& changes = recipe.changes;
  if (changes.gravity_m_s2) scene["gravity_m_s2"] = triple_of(*changes.gravity_m_s2);
  if (scene.contains("bodies"))
    for (Json& body : scene["bodies"]) {
      if (changes.restitution) body["restitution"] = *changes.restitution;
      if (changes.friction) body["friction"] = *changes.friction;
    }
  // Friction acts in persistent contact only.
  if (changes.friction.value_or(0.0) > 0 && !scene.contains("contact"))
    scene["contact"] = Json::object();
  for (const auto& [name, kg] : changes.mass_kg) {
    Json* body = scene.contains("bodies") ? entry_of(scene, name) : nullptr;
    if (body == nullptr)
      throw UserError("body '" + name + "'",
                      "is one of many that an entry of the scene makes: its mass cannot be changed "
                      "alone",
                      "Choose another body.");
    set_mass(*body, kg);
  }
  if (changes.step_s) scene["step_s"] = *changes.step_s;
  if (!changes.engine.empty()) scene["engine"] = changes.engine;
  if (!changes.coordinates.empty()) scene["coordinates"] = changes.coordinates;
  if (const auto duration =
          duration_of(recipe, scene.value("duration_s", scene::Scene{}.duration_s)))
    scene["duration_s"] = *duration;
  for (const std::string& push : recipe.pushes) scene["point_forces"].push_back(Json::parse(push));
  return scene;
}

}  // namespace

void change(Changes& changes, const std::string& text) {
  const Json all = Json::parse(text);
  for (const auto& [key, value] : all.items()) {
    if (key == "gravity_m_s2") {
      if (value.is_null()) {
        changes.gravity_m_s2.reset();
        continue;
      }
      const Vector3d gravity = vector_in(value);
      need(gravity.allFinite() && gravity.norm() <= 1e4, "gravity", "At most 10000 m/s^2.");
      changes.gravity_m_s2 = gravity;
    } else if (key == "restitution") {
      changes.restitution = number_in(value, "restitution", 0, 1, "From 0 to 1.");
    } else if (key == "friction") {
      changes.friction = number_in(value, "friction", 0, 100, "From 0 to 100.");
    } else if (key == "step_s") {
      changes.step_s = number_in(value, "step", 1e-5, 1, "From 0.00001 s to 1 s.");
    } else if (key == "engine") {
      changes.engine = value.is_null() ? "" : value.get<std::string>();
    } else if (key == "method") {
      changes.method = value.is_null() ? "" : value.get<std::string>();
    } else if (key == "coordinates") {
      changes.coordinates = value.is_null() ? "" : value.get<std::string>();
      if (!changes.coordinates.empty())
        scene::coordinates_named(changes.coordinates, "coordinates");
    } else if (key == "mass_kg") {
      for (const auto& [name, kg] : value.items()) {
        const auto mass = number_in(kg, "mass", 1e-9, 1e12, "From 1e-9 kg to 1e12 kg.");
        if (mass)
          changes.mass_kg[name] = *mass;
        else
          changes.mass_kg.erase(name);
      }
    } else if (key == "all") {  // {"all": null}: the scene as it is
      changes = {};
    } else {
      throw UserError(key, "the page cannot change this", "");
    }
  }
}

std::string document_of(const Recipe& recipe) { return changed(recipe).dump(2) + "\n"; }

std::string saved_document(Recipe recipe, double until_s, const std::string& again) {
  recipe.pushes = before(recipe.pushes, until_s);
  Json scene = changed(recipe);
  const double step_s = scene.value("step_s", scene::Scene{}.step_s);
  scene["duration_s"] = until_s + 2 * step_s;  // the last step of a run may be a part of one
  scene["title"] = scene.value("title", std::string("A scene")) + ", with a hand in it";
  scene["about"] = "Made by tumble live. Runs again by: " + again;
  // The scene's checks apply to a run without a hand: those that hold for any run are kept.
  if (scene.contains("checks")) {
    Json kept = Json::array();
    for (const Json& check : scene["checks"]) {
      const std::string kind = check.value("kind", "");
      if (kind == "gap" || kind == "restitution_law" || kind == "side_of_wall")
        kept.push_back(check);
    }
    scene["checks"] = kept;
    if (kept.empty()) scene.erase("checks");
  }
  return scene.dump(2) + "\n";
}

void apply(const Recipe& recipe, scene::Scene& scene) {
  const Changes& changes = recipe.changes;
  scene::EntryWriter write(scene);
  if (changes.gravity_m_s2) {
    scene::remove_entries(scene, "gravity_m_s2");
    write("gravity_m_s2", *changes.gravity_m_s2);
  }
  for (scene::BodySpec& body : scene.bodies) {
    if (changes.restitution) body.restitution = *changes.restitution;
    if (changes.friction) body.friction = *changes.friction;
    const auto mass = changes.mass_kg.find(body.name);
    if (mass == changes.mass_kg.end()) continue;
    body.mass_kg = mass->second;
    body.density_kg_m3.reset();
  }
  if (changes.friction.value_or(0.0) > 0 && !scene.contact) scene.contact.emplace();
  if (changes.step_s) scene.step_s = *changes.step_s;
  if (!changes.engine.empty()) scene.engine = changes.engine;
  if (!changes.coordinates.empty())
    scene.coordinates = scene::coordinates_named(changes.coordinates, "coordinates");
  if (const auto duration = duration_of(recipe, scene.duration_s)) scene.duration_s = *duration;
  for (const std::string& text : recipe.pushes) {
    const Json push = Json::parse(text);
    write("point_forces", {{"body", push.at("body").get<std::string>()},
                           {"force_n", vector_in(push.at("force_n"))},
                           {"point_m", vector_in(push.at("point_m"))},
                           {"start_s", push.at("start_s").get<double>()},
                           {"duration_s", push.at("duration_s").get<double>()}});
  }
}

std::vector<std::string> before(const std::vector<std::string>& pushes, double time_s) {
  std::vector<std::string> kept;
  for (const std::string& push : pushes)
    if (Json::parse(push).at("start_s").get<double>() < time_s) kept.push_back(push);
  return kept;
}

std::string as_text(const Recipe& recipe) {
  const Changes& changes = recipe.changes;
  Json all{{"document", recipe.document},       {"file", recipe.file.string()},
           {"engine", changes.engine},          {"method", changes.method},
           {"mass_kg", changes.mass_kg},        {"pushes", recipe.pushes},
           {"coordinates", changes.coordinates}};
  if (changes.gravity_m_s2) all["gravity_m_s2"] = triple_of(*changes.gravity_m_s2);
  if (changes.restitution) all["restitution"] = *changes.restitution;
  if (changes.friction) all["friction"] = *changes.friction;
  if (changes.step_s) all["step_s"] = *changes.step_s;
  if (recipe.duration_s) all["duration_s"] = *recipe.duration_s;
  return all.dump();
}

Recipe recipe_of(const std::string& text) {
  const Json all = Json::parse(text);
  Recipe recipe;
  recipe.document = all.at("document");
  recipe.file = all.at("file").get<std::string>();
  recipe.changes.engine = all.at("engine");
  recipe.changes.method = all.at("method");
  recipe.changes.coordinates = all.at("coordinates");
  recipe.changes.mass_kg = all.at("mass_kg").get<std::map<std::string, double>>();
  recipe.pushes = all.at("pushes").get<std::vector<std::string>>();
  if (all.contains("gravity_m_s2")) recipe.changes.gravity_m_s2 = vector_in(all.at("gravity_m_s2"));
  if (all.contains("restitution")) recipe.changes.restitution = all.at("restitution");
  if (all.contains("friction")) recipe.changes.friction = all.at("friction");
  if (all.contains("step_s")) recipe.changes.step_s = all.at("step_s");
  if (all.contains("duration_s")) recipe.duration_s = all.at("duration_s");
  return recipe;
}

}  // namespace tumble::live
