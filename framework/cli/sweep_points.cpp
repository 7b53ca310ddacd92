#include "framework/cli/sweep_points.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "framework/cli/planned_run.h"
#include "framework/core/cpu_time.h"
#include "framework/core/nearest_word.h"
#include "framework/effects/registry.h"
#include "framework/engines/judging/judge.h"
#include "framework/engines/run.h"
#include "framework/grading/worker/worker_connection.h"

namespace tumble::cli {
namespace {

using nlohmann::ordered_json;

/// The kinds of checks on rods and joints that are lengths.
std::vector<std::string> kinds_of_links(const scene::Scene& scene) {
  std::vector<std::string> kinds;
  for (const effects::Effect* effect : effects::all()) {
    if (effect->links(scene).empty()) continue;
    for (const scene::LinkCheck& check : effect->link_checks())
      if (check.unit == "m") kinds.push_back(check.kind);
  }
  return kinds;
}

std::vector<Measure> fixed(const scene::Scene& scene) {
  std::vector<Measure> all = {{"energy", "energy at the end less that at the start", "J"}};
  const auto colliding = std::count_if(scene.bodies.begin(), scene.bodies.end(),
                                       [](const scene::BodySpec& body) { return body.collides; });
  if (colliding > 1) all.push_back({"gap", "smallest gap", "m"});
  if (!kinds_of_links(scene).empty())
    all.push_back({"joint", "largest error of rods and joints", "m", true});
  all.push_back({"collisions", "collisions", ""});
  all.push_back({"cpu", "CPU time", "s"});
  return all;
}

double number(const ordered_json& value) {
  return value.is_number() ? value.get<double>() : kUnset;
}

double energy_of(const Frame& frame) { return frame.kinetic_energy + frame.potential_energy; }

double value_of(const Measure& measure, const Trajectory& run,
                const std::vector<engines::CheckResult>& links, double cpu_s) {
  const Frame &first = run.frames.front(), &last = run.frames.back();
  if (measure.word == "energy") return energy_of(last) - energy_of(first);
  if (measure.word == "cpu") return cpu_s;
  if (measure.word == "collisions")
    return static_cast<double>(
        std::count_if(run.events.begin(), run.events.end(),
                      [](const Event& event) { return event.kind == EventKind::kCollision; }));
  if (measure.word == "gap") {
    double least = std::numeric_limits<double>::infinity();
    for (const Frame& frame : run.frames) least = std::min(least, frame.smallest_gap);
    return least;
  }
  if (measure.word == "joint") {
    double most = 0.0;
    for (const engines::CheckResult& check : links) most = std::max(most, check.value);
    return most;
  }
  const std::string body = measure.word.substr(0, measure.word.size() - 2);
  for (std::size_t i = 0; i < run.bodies.size(); ++i)
    if (run.bodies[i].name == body) return last.poses[i].com_world[measure.word.back() - 'x'];
  return kUnset;
}

/// Why a run cannot be trusted, from the checks behind those that were asked for: what its watch
/// and its impacts found.
std::string faults_of(const std::vector<engines::CheckResult>& checks, std::size_t asked) {
  std::string text;
  for (std::size_t i = asked; i < checks.size(); ++i)
    if (!checks[i].passed)
      text +=
          fmt::format("{}{} of {}: {:.3g}{}{}, at most {:.3g} is allowed", text.empty() ? "" : "; ",
                      checks[i].kind, checks[i].subject, checks[i].value,
                      checks[i].unit.empty() ? "" : " ", checks[i].unit, checks[i].threshold);
  return text;
}

}  // namespace

std::vector<Measure> measures_of(const std::vector<std::string>& words, const scene::Scene& scene) {
  const std::vector<Measure> known = fixed(scene);
  std::vector<Measure> all;
  if (words.empty()) {
    std::copy_if(known.begin(), known.end(), std::back_inserter(all),
                 [](const Measure& measure) { return measure.word != "collisions"; });
    return all;
  }
  std::vector<std::string> names, bodies;
  for (const Measure& measure : known) names.push_back(measure.word);
  for (const scene::BodySpec& body : scene.bodies) bodies.push_back(body.name);
  const std::string remedy = fmt::format(
      "Known: {}, and BODY.x, BODY.y, BODY.z: where a body ends.", fmt::join(names, ", "));
  for (const std::string& word : words) {
    for (const Measure& other : all)
      if (other.word == word)
        throw UserError("--measure " + word, "it is named twice", "Name it once.");
    const auto found = std::find_if(known.begin(), known.end(),
                                    [&](const Measure& one) { return one.word == word; });
    if (found != known.end()) {
      all.push_back(*found);
      continue;
    }
    const bool is_place =
        word.size() > 2 && word[word.size() - 2] == '.' && word.back() >= 'x' && word.back() <= 'z';
    if (!is_place)
      throw UserError("--measure " + word,
                      word == "joint" ? "the scene has no rods and no joints"
                      : word == "gap" ? "the scene has no two bodies that collide"
                                      : "this cannot be measured." + did_you_mean(word, names),
                      remedy);
    const std::string body = word.substr(0, word.size() - 2);
    if (std::find(bodies.begin(), bodies.end(), body) == bodies.end())
      throw UserError("--measure " + word,
                      "the scene has no body '" + body + "'." + did_you_mean(body, bodies), remedy);
    all.push_back({word, fmt::format("{} of {} at the end", word.back(), body), "m"});
  }
  return all;
}

PointResult run_point(const Context& context, const scene::Scene& scene, const ChosenLaws& chosen,
                      const RunWords& words, const std::vector<Measure>& measures) {
  PointResult result;
  result.values.assign(measures.size(), kUnset);
  TrajectoryRecorder recorder;
  std::string stopped_by;
  const double begun = cpu_seconds();
  try {
    const PlannedRun plan = plan_run(context, scene, chosen, words);
    engines::run_scene(plan.scene, plan.laws, plan.options, recorder);
  } catch (const grading::CallEnded& error) {
    stopped_by = error.what();
    result.may_pass = true;
  } catch (const UserError& error) {
    stopped_by = error.what();
  }
  result.cpu_s = cpu_seconds() - begun;
  const Trajectory& run = recorder.trajectory();
  if (stopped_by.empty()) stopped_by = run.stopped_by;
  if (!stopped_by.empty() || run.frames.empty()) {
    result.state = PointState::kStopped;
    result.reason = stopped_by.empty() ? "it has no frame" : stopped_by;
    return result;
  }
  // The scene's own checks are about its own values: only its links are measured, and what no run
  // may do is judged.
  scene::Scene judged = scene;
  judged.checks.clear();
  for (const std::string& kind : kinds_of_links(scene)) {
    scene::CheckSpec check;
    check.kind = kind;
    check.unit = "m";
    judged.checks.push_back(check);
  }
  const auto checks = engines::judge_run(judged, run);
  const std::vector<engines::CheckResult> links(
      checks.begin(), checks.begin() + static_cast<std::ptrdiff_t>(judged.checks.size()));
  for (std::size_t i = 0; i < measures.size(); ++i)
    result.values[i] = value_of(measures[i], run, links, result.cpu_s);
  result.reason = faults_of(checks, judged.checks.size());
  result.state = result.reason.empty() ? PointState::kFine : PointState::kNotTrusted;
  return result;
}

std::string text_of(const PointResult& result) {
  return ordered_json{{"state", static_cast<int>(result.state)},
                      {"reason", result.reason},
                      {"may_pass", result.may_pass},
                      {"values", result.values},
                      {"cpu_s", result.cpu_s}}
      .dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

PointResult point_of(const std::string& text) {
  const auto json = ordered_json::parse(text);
  PointResult result;
  result.state = static_cast<PointState>(json.at("state").get<int>());
  result.reason = json.at("reason");
  result.may_pass = json.at("may_pass");
  for (const auto& value : json.at("values")) result.values.push_back(number(value));
  result.cpu_s = number(json.at("cpu_s"));
  return result;
}

std::string name_of(PointState state) {
  switch (state) {
    case PointState::kMissing: return "missing";
    case PointState::kFine: return "fine";
    case PointState::kStopped: return "stopped";
    case PointState::kNotTrusted: return "not trusted";
  }
  return "missing";
}

}  // namespace tumble::cli
