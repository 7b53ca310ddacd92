// tumble scenes [WORD]: every scene with a line each, and what it needs.
#include <cstdio>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "framework/cli/find_scene.h"
#include "framework/cli/json_output.h"
#include "framework/core/terminal.h"
#include "framework/core/text.h"
#include "framework/core/version.h"

namespace tumble::cli {
namespace {

struct ScenesWords {
  std::string filter;
  bool json = false;
};

std::string needs_of(const ListedScene& scene) {
  std::string text;
  for (const std::string& id : scene.needs) text += (text.empty() ? "" : " ") + id;
  return text.empty() ? "-" : text;
}

bool is_meant(const ListedScene& scene, const std::string& filter) {
  if (filter.empty() || scene.folder.starts_with(filter + "_")) return true;
  return lowercase(scene.name + "\n" + scene.title).find(lowercase(filter)) != std::string::npos;
}

void print_table(const std::vector<ListedScene>& scenes, const std::string& filter) {
  std::size_t widest = 0;
  for (const ListedScene& scene : scenes) widest = std::max(widest, scene.name.size());
  const std::size_t columns = terminal_columns(STDOUT_FILENO);
  std::string folder = "-";
  for (const ListedScene& scene : scenes) {
    if (scene.folder != folder) {
      if (folder != "-") fmt::print("\n");
      fmt::print("{}\n", scene.folder.empty() ? "of any size (--n N)" : scene.folder);
      folder = scene.folder;
    }
    const std::string line =
        fmt::format("  {:<{}}  {:<8}  {}", scene.name, widest, needs_of(scene), scene.title);
    fmt::print("{}\n", wrapped(line, columns, widest + 14));
  }
  fmt::print("\n{} scene{}{}. Run one: tumble run NAME; what it asks for: tumble explain NAME\n",
             scenes.size(), scenes.size() == 1 ? "" : "s",
             filter.empty() ? "" : " with '" + filter + "'");
}

void print_json(const std::vector<ListedScene>& scenes) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const ListedScene& scene : scenes) {
    nlohmann::ordered_json row = {{"name", scene.name},
                                  {"title", scene.title},
                                  {"needs", scene.needs},
                                  {"file", scene.file.string()}};
    if (scene.default_n > 0) row["default_n"] = scene.default_n;
    if (!scene.problem.empty()) row["problem"] = scene.problem;
    list.push_back(row);
  }
  fmt::print("{}\n", json_text({{"version", kProgramVersion}, {"scenes", list}}, 2));
}

void list_scenes(Context& context, const ScenesWords& words) {
  std::vector<ListedScene> scenes = listed_scenes(context);
  std::erase_if(scenes, [&](const ListedScene& s) { return !is_meant(s, words.filter); });
  if (words.json)
    print_json(scenes);
  else
    print_table(scenes, words.filter);
  for (const ListedScene& scene : scenes)
    if (!scene.problem.empty()) context.exit = ExitCode::kUserError;
}

}  // namespace

void add_scenes(CLI::App& app, Context& context) {
  auto words = std::make_shared<ScenesWords>();
  Verb verb(app, "scenes", "List every scene with a line each, and which assignments it needs");
  verb.option("word", words->filter,
              "An assignment (a1), or letters of names and titles: only the scenes with it");
  verb.flag("--json", words->json, "For machines");
  verb.footer("Exit: 0 fine, 2 a scene file that cannot be read (its line says why).");
  verb.runs([&context, words] { list_scenes(context, *words); });
}

}  // namespace tumble::cli
