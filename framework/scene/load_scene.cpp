#include "framework/scene/load_scene.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>

#include "framework/core/digest.h"
#include "framework/scene/check_scene.h"
#include "framework/scene/load_body.h"
#include "framework/scene/load_links.h"
#include "framework/scene/load_sampling.h"
#include "framework/scene/read_entry.h"
#include "framework/scene/read_json.h"
#include "framework/scene/scene_schema.h"
#include "framework/scene/words.h"

namespace tumble::scene {
namespace {

using nlohmann::json;

CheckSpec check(const json& value) {
  CheckSpec spec;
  spec.kind = value.at("kind");
  spec.tolerance = value.at("tolerance");
  spec.why = value.at("why");
  read(value, "unit", spec.unit);
  read(value, "body", spec.body);
  read(value, "other", spec.other);
  read(value, "axis", spec.axis);
  // check_scene refuses a zero axis
  if (spec.axis && spec.axis->norm() > 0) spec.axis->normalize();
  read(value, "link", spec.link);
  read(value, "bodies", spec.bodies);
  read(value, "expected", spec.expected);
  read(value, "at_s", spec.at_s);
  return spec;
}

/// The list under a key; empty where there is none.
const json& entries(const json& root, const char* key) {
  static const json none = json::array();
  return root.contains(key) ? root.at(key) : none;
}

void read_bodies(const Document& document, Scene& scene) {
  const json& bodies = entries(document.json, "bodies");
  const json& repeats = entries(document.json, "repeat");
  for (std::size_t i = 0; i < bodies.size(); ++i)
    scene.bodies.push_back(read_body(bodies.at(i), document, "/bodies/" + std::to_string(i)));
  for (std::size_t i = 0; i < repeats.size(); ++i) {
    const RepeatSpec repeat = read_repeat(repeats.at(i), document, "/repeat/" + std::to_string(i));
    if (repeats.at(i).contains("seed")) scene.seeds.push_back(repeat.seed);
    for (auto& copy : write_out(repeat)) scene.bodies.push_back(std::move(copy));
  }
}

void check_names(const Document& document, const Scene& scene) {
  std::map<std::string, std::string> first;
  for (const BodySpec& body : scene.bodies) {
    const auto [at, is_new] = first.emplace(body.name, body.pointer);
    if (!is_new)
      document.refuse(body.pointer + "/name",
                      "the name '" + body.name + "' is taken by " + at->second,
                      "Give every body a name of its own.");
  }
}

/// scene.schema.json, and what each effect adds to it.
const json& scene_schema() {
  static const json schema = [] {
    json whole = json::parse(kSceneSchema);
    json& check_kinds = whole["definitions"]["check"]["properties"]["kind"]["enum"];
    for (const Words* words : all_words()) {
      const json said = json::parse(words->schema());
      for (const auto& [part, entries] : said.items()) whole[part].update(entries);
      for (const LinkCheck& check : words->link_checks()) check_kinds.push_back(check.kind);
    }
    return whole;
  }();
  return schema;
}

void read_effects(const Document& document, Anchors& anchors, Scene& scene) {
  for (const Words* words : all_words()) {
    const std::string key = words->key();
    if (!document.json.contains(key)) continue;
    const json& value = document.json.at(key);
    const bool is_list = scene_schema().at("properties").at(key).value("type", "") == "array";
    for (std::size_t i = 0; i < (is_list ? value.size() : 1); ++i) {
      EntrySource source{is_list ? value.at(i) : value, document, anchors};
      Entry entry(source, "/" + key + (is_list ? "/" + std::to_string(i) : ""),
                  static_cast<int>(i) + 1);
      words->read(entry, scene);
    }
  }
}

void read_view(const json& root, Scene& scene) {
  if (root.contains("camera")) {
    const json& entry = root.at("camera");
    read(entry, "eye_m", scene.camera.eye_m);
    read(entry, "target_m", scene.camera.target_m);
    read(entry, "field_of_view_deg", scene.camera.field_of_view_deg);
    read(entry, "follow", scene.camera.follow);
  }
  if (root.contains("grid")) {
    scene.grid_spacing_m = root.at("grid").at("spacing_m").get<double>();
    read(root.at("grid"), "height_m", scene.grid_height_m);
  }
}

}  // namespace

Scene parse_scene(const std::string& text, const std::filesystem::path& file) {
  const Document document = parse_document(text, file);
  check_against_schema(document, scene_schema());
  const json& root = document.json;

  Scene scene;
  scene.name = file.stem().string();
  scene.file = file;
  scene.lines = document.lines;
  scene.digest = digest(text);
  scene.title = root.at("title");
  read(root, "about", scene.about);
  read(root, "needs", scene.needs);
  read(root, "engine", scene.engine);
  scene.duration_s = root.at("duration_s");
  if (root.contains("step_s"))
    read(root, "step_s", scene.step_s);
  else
    scene.step_s = std::min(scene.step_s, scene.duration_s);
  scene.gives_rest_speed = root.contains("rest_speed_m_s");
  read(root, "rest_speed_m_s", scene.rest_speed_m_s);
  // Bodies first, then the entries that name them.
  read_bodies(document, scene);
  Anchors anchors(document, scene);
  read_chains(document, anchors, scene);
  check_names(document, scene);  // before any look-up by name
  read_effects(document, anchors, scene);
  read_links(document, anchors, scene);
  read_view(root, scene);
  for (const auto& entry : entries(root, "checks")) scene.checks.push_back(check(entry));

  check_scene(scene, [&](const std::string& pointer, const std::string& problem,
                         const std::string& remedy) { document.refuse(pointer, problem, remedy); });
  read_sampling(document, scene);  // refuses what is impossible
  return scene;
}

Scene load_scene(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream || std::filesystem::is_directory(file))
    throw UserError(file.string(),
                    std::filesystem::exists(file) ? "this cannot be read as a file"
                                                  : "there is no such scene file",
                    "Scenes are in assignments/*/scenes.");
  std::ostringstream text;
  text << stream.rdbuf();
  return parse_scene(text.str(), file);
}

}  // namespace tumble::scene
