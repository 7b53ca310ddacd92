#include "framework/live/served_files.h"

#include "framework/live/page_files.h"
#include "framework/report/player_parts.h"

namespace tumble::live {

std::optional<Served> served_file(const std::string& path,
                                  const std::function<std::string(const std::string&)>& handout) {
  if (path.empty()) return Served{"text/html; charset=utf-8", std::string(page_file("live.html"))};
  if (path == "three.js") return Served{"text/javascript", report::three_js()};
  if (path == "live.css") return Served{"text/css", std::string(page_file("live.css"))};
  if (path == "live.js") {
    // One script: parts of the player's page, then those of this page.
    std::string text = "'use strict';\n(() => {\n";
    for (const char* part : {"model.js", "shapes.js", "marks.js", "pick.js", "stage.js", "plot.js"})
      text += std::string(report::player_source(part)) + "\n";
    for (const char* part : {"live_run.js", "live_stage.js", "live_curves.js", "live_scenes.js",
                             "live_verdicts.js", "live_panes.js", "live_said.js", "live_main.js"})
      text += std::string(page_file(part)) + "\n";
    return Served{"text/javascript; charset=utf-8", text + "})();\n"};
  }
  if (path.starts_with("handouts/") && handout)
    if (const std::string text = handout(path.substr(9)); !text.empty())
      return Served{
          path.ends_with(".html") ? "text/html; charset=utf-8" : "text/plain; charset=utf-8", text,
          "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri "
          "'none'; form-action 'none'; frame-ancestors 'none'"};
  return std::nullopt;
}

}  // namespace tumble::live
