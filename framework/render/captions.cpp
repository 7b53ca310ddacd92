#include "framework/render/captions.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/core/text.h"

namespace tumble::render {
namespace {

constexpr double kLineSpacing = 1.25;    // relative to the font size
constexpr const char* kBetween = " · ";  // what is said of a run

std::string engine_name(const std::string& id) {
  if (id == "rd") return "retroactive detection";
  if (id == "ca") return "conservative advancement";
  if (id == "tw") return "timewarp";
  return id.empty() ? "unknown engine" : id;
}

// "a4 work/a4_timewarp.cpp" without the folders, for which a picture has no room.
std::string without_folders(const std::string& source) {
  std::string text, word;
  for (const char letter : source + ' ') {
    if (letter == '/') {
      word.clear();
    } else if (letter == ' ') {
      text += (text.empty() ? "" : " ") + word;
      word.clear();
    } else {
      word += letter;
    }
  }
  return text;
}

/// Text in one line, or in two where it is too wide; the second is cut where it does not fit.
std::vector<std::string> in_lines(const TextWriter& writer, const std::string& text, double size,
                                  double room, bool bold) {
  if (writer.width(text, size, bold) <= room) return {text};
  std::size_t end = std::string::npos;  // of the first line: its last space
  for (std::size_t space = text.find(' ');
       space != std::string::npos && writer.width(text.substr(0, space), size, bold) <= room;
       space = text.find(' ', space + 1))
    end = space;
  if (end == std::string::npos) return {writer.fitted(text, size, room, bold)};
  return {text.substr(0, end), writer.fitted(text.substr(end + 1), size, room, bold)};
}

}  // namespace

std::string made_by(const TrajectoryInfo& info) {
  std::string text = engine_name(info.engine) + ", step " + step_in_words(info.step_s) + " s";
  std::vector<std::pair<std::string, std::string>> whose;  // "impulses, motion", "reference"
  const auto add = [&](const char* what, const std::string& source) {
    if (source.empty() || source == "none") return;
    const auto known = std::find_if(whose.begin(), whose.end(),
                                    [&](const auto& one) { return one.second == source; });
    if (known == whose.end())
      whose.emplace_back(what, source);
    else
      known->first += std::string(", ") + what;
  };
  add("scheduler", info.scheduling_source);
  add("impulses", info.impulse_source);
  add("motion", info.integrator_source);
  add("constraints", info.constraint_source);
  for (const auto& [what, source] : whose)
    text += fmt::format("{}{}: {}", kBetween, what, without_folders(source));
  return text;
}

double clear_baseline(double baseline, double right, double size,
                      const std::vector<WordInPicture>& words) {
  for (const WordInPicture& word : words)
    if (word.left < right && word.top < baseline && word.baseline > baseline - kLineSpacing * size)
      baseline = word.top - 0.3 * size;  // 0.3: of letters that reach below their line
  return baseline;
}

std::string time_text(const Trajectory& run, std::size_t frame) {
  // of log10: frames 0.01 s apart need two decimals, whatever the rounding of their times
  constexpr double kRoundOff = 1e-6;
  const double intervals = static_cast<double>(run.frames.size()) - 1.0;
  const double spacing_s = (run.frames.back().time - run.frames.front().time) / intervals;
  const double needed = std::ceil(-std::log10(spacing_s) - kRoundOff);
  // A single frame has no spacing.
  const int decimals = std::isfinite(needed) ? static_cast<int>(std::clamp(needed, 2.0, 9.0)) : 2;
  return fmt::format("t = {:.{}f} s", run.frames[frame].time, decimals);
}

void write_captions(Image& image, const TextWriter& writer, const scene::Scene& scene,
                    const Trajectory& run, const Stage& stage, std::size_t frame,
                    const Moment& moment, const std::string& label, Words words) {
  const double w = image.width, h = image.height;
  const double unit = std::min(w / 640.0, h / 480.0);  // sizes are for 640 x 480
  const double margin = 14.0 * unit, small = std::max(11.0 * unit, 9.5),
               large = std::max(17.0 * unit, 11.0);
  for (const Label& place : moment.labels)
    if (const auto at = project(moment.drawing.view, image.width, image.height, place.point_world))
      writer.write(image, place.text, at->x(), at->y() + 1.5 * small + place.drop_pixels,
                   small * 1.08, kDark, Align::kCentre, true);

  const std::string time = time_text(run, frame);
  writer.write(image, time, margin, h - margin, words == Words::kAll ? 15.0 * unit : small, kDark,
               Align::kLeft, true);
  const auto write_end = [&](double baseline) {
    if (run.stopped_by.empty() || frame + 1 != run.frames.size()) return;
    const double size = 1.15 * small;
    const std::string words =
        writer.fitted("stopped: " + run.stopped_by, size, w - 2 * margin, true);
    const double right = margin + writer.width(words, size, true);
    std::vector<WordInPicture> labels;
    for (const Label& place : moment.labels)
      if (const auto at =
              project(moment.drawing.view, image.width, image.height, place.point_world))
        labels.push_back({at->x() - 0.5 * writer.width(place.text, small * 1.08, true),
                          at->y() - 0.5 * small, at->y() + 1.5 * small + place.drop_pixels});
    baseline = clear_baseline(baseline, right, size, labels);
    writer.write(image, words, margin, baseline, size, kAlarm, Align::kLeft, true);
  };
  if (words == Words::kTimeOnly) return write_end(h - margin - kLineSpacing * small - 4.0 * unit);

  // For runs side by side the label is below the title: half a picture is too narrow for both in
  // one line.
  const std::string& title = scene.title.empty() ? scene.name : scene.title;
  double baseline = margin + large * 0.8;
  for (const std::string& part : in_lines(writer, title, large, w - 2 * margin, true)) {
    writer.write(image, part, margin, baseline, large, kDark, Align::kLeft, true);
    baseline += kLineSpacing * large;
  }
  if (!label.empty())
    writer.write(image, writer.fitted(label, large * 0.9, w - 2 * margin, true), margin, baseline,
                 large * 0.9, kSoft, Align::kLeft, true);

  std::string right = made_by(run.info);
  if (stage.grid_spacing_m() > 0.0 && !stage.has_scale_bar())
    right = fmt::format("grid {:g} m · ", stage.grid_spacing_m()) + right;
  const double room = w - 3 * margin - writer.width(time, 15.0 * unit, true);
  std::vector<std::string> made = in_lines(writer, right, small, room, false);
  if (made.size() == 2) {  // a dot stands between words, not at an end of a line
    constexpr std::string_view kDotBehind = " ·", kDotBefore = "· ";
    if (made[0].ends_with(kDotBehind)) made[0].resize(made[0].size() - kDotBehind.size());
    if (made[1].starts_with(kDotBefore)) made[1].erase(0, kDotBefore.size());
  }
  double from_below = h - margin;
  for (auto line = made.rbegin(); line != made.rend(); ++line, from_below -= kLineSpacing * small)
    writer.write(image, *line, w - margin, from_below, small, kSoft, Align::kRight);

  write_end(from_below - 10.0 * unit);
}

}  // namespace tumble::render
