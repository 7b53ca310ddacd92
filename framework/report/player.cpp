#include "framework/report/player.h"

#include <fstream>
#include <iterator>
#include <map>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/zip.h"
#include "framework/report/channels.h"
#include "framework/report/comparison.h"
#include "framework/report/html.h"
#include "framework/report/packed_run.h"
#include "framework/report/player_files.h"
#include "framework/report/player_parts.h"
#include "framework/report/player_scene.h"
#include "framework/report/player_still.h"
#include "framework/scene/build_shape.h"
#include "framework/trajectory/record.h"

namespace tumble::report {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// In the order of the page: each script uses only earlier ones.
constexpr const char* kScripts[] = {"decode.js",
                                    "model.js",
                                    "shapes.js",
                                    "marks.js",
                                    "pick.js",
                                    "stage.js",
                                    "plot.js",
                                    "curves.js",
                                    "events.js",
                                    "views.js",
                                    "save.js",
                                    "player.js",
                                    "panel_virtual_times.js",
                                    "main.js"};

std::string library(const fs::path& folder, const char* file) {
  std::ifstream in(folder / file, std::ios::binary);
  if (!in)
    throw UserError((folder / file).string(),
                    "three.js is missing, which a page that plays a run needs",
                    "Install Debian's package libjs-three.");
  return {std::istreambuf_iterator<char>(in), {}};
}

// That file holds the page's scripts, too: without it none runs, and the page says why itself.
std::string when_three_is_missing(const fs::path& three_file) {
  return "document.documentElement.className='lost';const words="
         "document.getElementById('complaint');words.hidden=false;words.textContent='" +
         three_file.filename().string() +
         " is missing, so that the motion cannot be drawn. Keep this page in its folder, and that "
         "file where the grader wrote it. Plots and a table of the run are below.'";
}

std::string packed_three(const PlayerOptions& options) { return deflated(three_js(options.three)); }

std::string script_text() {
  std::string text = "'use strict';\n(() => {\n";
  for (const char* name : kScripts) text += std::string(player_file(name)) + "\n";
  return text + "})();\n";
}

// "</" would end a script element; JSON allows an escape for the less-than sign.
std::string json_text(const Json& json) {
  std::string text;
  for (const char c : json.dump(-1, ' ', false, Json::error_handler_t::replace))
    c == '<' ? text += "\\u003c" : text += c;
  return text;
}

std::string data_element(const std::string& id, const std::string& deflated_bytes) {
  return "<script type=\"application/octet-stream\" id=\"" + id + "\">" + base64(deflated_bytes) +
         "</script>\n";
}

// What the page is about. A page alone has it as text, for whoever looks into its source; of many
// pages it is deflated.
std::string about_element(const std::string& json, bool is_alone) {
  return is_alone ? "<script type=\"application/json\" id=\"about-run\">" + json + "</script>\n"
                  : data_element("about-run", deflated(json));
}

std::string filled(std::string_view page, const std::map<std::string, std::string>& words) {
  std::string text;
  for (;;) {
    const std::size_t open = page.find("{{"),
                      close = open == page.npos ? page.npos : page.find("}}", open);
    if (close == page.npos) return text + std::string(page);
    text += page.substr(0, open);
    text += words.at(std::string(page.substr(open + 2, close - open - 2)));
    page.remove_prefix(close + 2);
  }
}

Json panels_json(const std::vector<PlayerPanel>& panels) {
  Json all = Json::array();
  for (const PlayerPanel& panel : panels)
    all.push_back(
        {{"kind", panel.kind}, {"title", panel.title}, {"data", Json::parse(panel.data_json)}});
  return all;
}

std::string record_and_notices(const std::vector<PlayedRun>& runs) {
  std::string record = html_escape(tumble::record_of(runs.front().run.info));
  for (const PlayedRun& played : runs)  // notes of the run, such as changed initial velocities
    for (const std::string& notice : played.run.counters.notices)
      record += "<br>note" + (played.label.empty() ? "" : " (" + html_escape(played.label) + ")") +
                ": " + html_escape(notice);
  return record;
}

std::vector<Shape> shapes_of(const scene::Scene& scene, const fs::path& root) {
  std::vector<Shape> shapes;
  for (const scene::Solid& solid : scene::build_solids(scene, root)) shapes.push_back(solid.shape);
  return shapes;
}

void check(const scene::Scene& scene, const std::vector<PlayedRun>& runs) {
  require(runs.size() == 1 || runs.size() == 2, "report: a page plays one run or two");
  for (const PlayedRun& played : runs) {
    if (played.run.frames.empty())
      throw UserError(scene.name, "the run has no frame to show", played.run.stopped_by);
    if (played.run.bodies.size() != scene.bodies.size())
      throw UserError(scene.name,
                      fmt::format("the run has {} bodies and the scene {}",
                                  played.run.bodies.size(), scene.bodies.size()),
                      "Show a run with the scene that it was made from.");
  }
}

// Whether the second run's channels would be those of the first, byte for byte: as of a right
// submission beside the reference.
bool is_same_motion(const scene::Scene& scene, const std::vector<PlayedRun>& runs,
                    const Comparison& comparison, double sight_m, const PlayerOptions& options) {
  if (comparison.first || comparison.early_end) return false;
  const auto channels = [&](const PlayedRun& played) {
    return pack_run(scene, played, comparison.apart_m, sight_m, options).channels;
  };
  return channels(runs[0]) == channels(runs[1]);
}

}  // namespace

void expect_player(const PlayerOptions& options) { three_js(options.three); }

std::string three_js(const fs::path& folder) {
  return library(folder, "three.min.js") + "\n" +
         library(folder, "examples/js/controls/OrbitControls.js") + "\n" +
         library(folder, "examples/js/exporters/GLTFExporter.js");
}

std::string_view player_source(std::string_view name) { return player_file(name); }

std::string player_scene_text(const scene::Scene& scene, const fs::path& root, const Frame& first) {
  return player_scene(scene, shapes_of(scene, root), first)
      .dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string player_page(const scene::Scene& scene, const std::vector<PlayedRun>& runs,
                        const PlayerOptions& options) {
  check(scene, runs);
  const std::vector<Shape> shapes = shapes_of(scene, options.root);

  Json head = player_scene(scene, shapes, runs.front().run.frames.front());
  Comparison comparison;
  if (runs.size() == 2) {
    comparison =
        compare(scene, radii_of(shapes), runs[0].run, runs[0].label, runs[1].run, runs[1].label);
    head["difference"] = comparison.first ? Json{{"time", comparison.first->time_s},
                                                 {"what", comparison.first->what},
                                                 {"body", comparison.first->body}}
                                          : Json();
    if (const auto& end = comparison.early_end)
      head["stopped"] = {{"time", end->time_s},
                         {"run", end->is_first ? 0 : 1},
                         {"end", runs[end->is_first ? 1 : 0].run.frames.back().time}};
  }
  const double sight_m = (scene.camera.eye_m - scene.camera.target_m).norm();
  std::vector<PackedRun> packed;
  const bool is_alone = options.three_file.empty();
  std::string data = is_alone ? data_element("three", packed_three(options)) : "";
  head["runs"] = Json::array();
  for (std::size_t r = 0; r < runs.size(); ++r) {
    packed.push_back(pack_run(scene, runs[r], r == 0 ? comparison.apart_m : std::vector<double>{},
                              sight_m, options));
    head["runs"].push_back(packed.back().head);
    if (r == 1 && is_same_motion(scene, runs, comparison, sight_m, options)) {
      // the channels of the first, which begin with the distance between the two
      head["runs"].back()["series"] = packed[0].head["series"];
      head["runs"].back()["channelsOf"] = 0;
      continue;
    }
    data += data_element("run" + std::to_string(r), packed.back().channels);
  }
  head["panels"] = panels_json(options.panels);
  return filled(
      player_file("page.html"),
      {{"beside", is_alone ? "" : " 'self' file:"},
       {"title", html_escape(scene.title.empty() ? scene.name : scene.title)},
       {"about", html_escape(scene.about)},
       {"style", std::string(player_file("player.css"))},
       {"script", is_alone ? "<script>\n" + script_text() + "</script>"
                           : "<script src=\"" + link_to(options.three_file) + "\" onerror=\"" +
                                 html_escape(when_three_is_missing(options.three_file)) +
                                 "\"></script>"},
       {"data", about_element(json_text(head), is_alone) + data},
       {"still", player_still(runs, packed)},
       {"record", record_and_notices(runs)}});
}

std::size_t write_player(const fs::path& file, const scene::Scene& scene,
                         const std::vector<PlayedRun>& runs, const PlayerOptions& options) {
  const std::string page = player_page(scene, runs, options);
  write_whole(file, page);
  return page.size();
}

void write_three(const fs::path& file, const PlayerOptions& options) {
  write_whole(file,
              "window.tumbleThree = '" + base64(packed_three(options)) + "';\n" + script_text());
}

}  // namespace tumble::report
