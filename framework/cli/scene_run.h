/// What `run` and `poke` share: the words of a run, finding a scene by name, running it and telling how it went.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/cli/module_choice.h"
#include "framework/cli/verb.h"
#include "framework/scene/model_scene.h"
#include "framework/scene/scene.h"

namespace tumble::cli {

/// The words of the command line that say how a scene is run and shown.
struct RunWords {
  std::string scene;                   // a path, or a bare name
  std::string modules;
  std::string engine, propagator;   // engine empty: the scene's, or rd
  std::optional<int> n;                // of a scene whose size is a parameter
  std::optional<double> scale, density;   // of a scene made of a .3ds file: metres a unit, kg/m^3
  bool drop = false;                   // the same: onto a floor
  int threads = 1, most_states = 0;    // of timewarp
  std::optional<double> step_s, duration_s;
  std::optional<double> accuracy_m, budget_s;        // what is asked for in place of engine, method and step; see planned_run.h
  std::string method;                  // of integration, in place of the laws' own; empty: theirs
  std::optional<double> tolerance;     // of a method that has one
  std::string png, sheet, video, trajectory, html;   // files to write; empty: none
  std::string virtual_times;           // file of a chart; empty: none
  std::vector<std::size_t> moves;      // of the scheduler, that it shows
  std::optional<double> chart_until_s; // as far as it goes
  std::string beside;                  // how a second run in the page differs; see run_page.h
  double at_s = -1.0;                  // of the PNG; negative: the end
  double speed = 1.0;                  // of the video: 0.25 is slow motion
  std::string size = "640x480";
  bool json = false;
};

struct PictureSize {
  int width, height;
};

/// Declares the words on a verb. `words` must outlive the parse.
void add_run_words(Verb& verb, RunWords& words);

/// @throws UserError unless "WxH" with both in [16, 4096]
PictureSize parse_size(const std::string& text);

/// Three comma-separated numbers after a flag, such as "1,0,-2".
Vector3d parse_vector(const std::string& flag, const std::string& text);

/// @param word   path of a scene file, or the bare name of one under assignments/*/scenes,
///               or the name of a scene whose size is a parameter,
///               or a .3ds file (a path, or one of models/): the scene is made of it (scene/model_scene.h)
/// @param n      that size; nothing: its default
/// @param model  how a scene is made of a .3ds file
/// @throws UserError naming the scenes there are, that a scene has one size only, or what is wrong with a model
scene::Scene find_scene(const Context& context, const std::string& word, std::optional<int> n = std::nullopt, const scene::ModelSceneOptions& model = {});

/// The scene that the words of a run name. @param turns  of a .3ds file: whether it turns by itself
/// @throws UserError also where words about a model stand beside a scene that is none
scene::Scene scene_of_words(const Context& context, const RunWords& words, bool turns);

/// A .3ds file by its path, or by its name in models/ with or without its ending; the word itself where there is none.
std::filesystem::path find_model_file(const Context& context, const std::string& word);

/// The names of every scene there is: those of the assignments, then those with a size.
std::vector<std::string> scene_names(const Context& context);

/// Runs the scene, writes the files asked for, prints the summary and sets context.exit.
/// @param extra  a line of talk that stands in the summary under the title (may be empty)
void run_and_tell(Context& context, const scene::Scene& scene, const ChosenLaws& chosen, const RunWords& words, const std::string& extra = "");

}  // namespace tumble::cli
