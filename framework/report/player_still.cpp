#include "framework/report/player_still.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "framework/report/comparison.h"
#include "framework/report/html.h"
#include "framework/report/plot.h"

namespace tumble::report {
namespace {

constexpr std::size_t kMostStillPoints = 120;  // per curve: a static plot is 500 pixels wide
constexpr std::size_t kMostEvents = 40;

struct Wanted {
  const char *plot, *title, *axis;
};
constexpr Wanted kWanted[] = {{"energy", "Energy", "energy"},
                              {"drift", "Change of the total energy", "E − E(0)"},
                              {"momentum", "Momentum of all movable bodies", "momentum"}};

Curve curve_of(const Series& series, const std::vector<double>& times_s, const std::string& name) {
  Curve curve{name, {}, {}};
  const std::size_t stride = std::max<std::size_t>(1, times_s.size() / kMostStillPoints);
  const auto add = [&](std::size_t i) {
    curve.x.push_back(times_s[i]);
    curve.y.push_back(series.values[i]);
  };
  for (std::size_t i = 0; i < times_s.size(); i += stride) add(i);
  if (!times_s.empty() && (times_s.size() - 1) % stride != 0) add(times_s.size() - 1);
  return curve;
}

std::string name_of(int body, const Trajectory& run) {
  return body < 0 ? "" : run.bodies[static_cast<std::size_t>(body)].name;
}

std::string table_of_events(const Trajectory& run) {
  std::string html =
      "<table><thead><tr><th>time [s]</th><th>what</th><th>bodies</th><th>impulse [N "
      "s]</th></tr></thead><tbody>\n";
  for (std::size_t i = 0; i < std::min(run.events.size(), kMostEvents); ++i) {
    const Event& event = run.events[i];
    const std::string second = name_of(event.body_b, run);
    html +=
        fmt::format("<tr><td>{:.4f}</td><td>{}</td><td>{}</td><td>{:.4g}</td></tr>\n", event.time,
                    name_of_event(event.kind),
                    html_escape(name_of(event.body_a, run) + (second.empty() ? "" : ", " + second)),
                    event.impulse);
  }
  html += "</tbody></table>\n";
  if (run.events.size() > kMostEvents)
    html += fmt::format("<p>The first {} of {} events.</p>\n", kMostEvents, run.events.size());
  return html;
}

}  // namespace

std::string player_still(const std::vector<PlayedRun>& runs, const std::vector<PackedRun>& packed) {
  std::string html;
  for (const Wanted& wanted : kWanted) {
    Plot plot{
        .title = wanted.title, .x = {"time", "s"}, .y = {wanted.axis}, .curves = {}, .limits = {}};
    for (std::size_t r = 0; r < runs.size(); ++r)
      for (const Series& series : packed[r].series) {
        if (series.plot != wanted.plot) continue;
        plot.y.unit = series.unit;
        plot.curves.push_back(curve_of(
            series, packed[r].times_s,
            series.name + (runs[r].label.empty() || runs.size() < 2 ? "" : ", " + runs[r].label)));
      }
    html += "<figure class=\"both\">" + svg_of(plot) + narrow_svg_of(plot) + "</figure>\n";
  }
  for (const PlayedRun& played : runs)
    if (!played.run.events.empty())
      html += "<h2>Events" + (played.label.empty() ? "" : ", " + html_escape(played.label)) +
              "</h2>\n" + table_of_events(played.run);
  return html;
}

}  // namespace tumble::report
