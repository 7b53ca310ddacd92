#include "framework/grading/grades/measure_cost.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/engines/cost/cost.h"
#include "framework/engines/cost/reading.h"
#include "framework/engines/cost/showcase.h"
#include "framework/grading/verdicts/call_log.h"
#include "framework/grading/course/laws_around.h"
#include "framework/grading/verdicts/plain_text.h"
#include "framework/grading/grades/scheduler_section.h"
#include "framework/grading/worker/worker_connection.h"
#include "framework/scene/load_scene.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;
using engines::CostRung;
using engines::CostTruth;
using engines::CostWay;
using modules::AnyModule;
using modules::ModuleKind;

constexpr double kCoarsest = 1.0 / 8.0;   // s: the largest step
constexpr int kResolutions = 8;                 // halvings down to 1/1024 s

struct Measured {
  CostWay way;
  std::vector<CostRung> rungs;
  std::string story;                      // what ended it; empty: it is complete
  bool is_reference = false;
};

/// The module's own methods, then all its laws together: methods alone do not test the derivative
/// and the renormalisation.
std::vector<CostWay> ways_of(const ModuleKind& kind, const AnyModule& module, const Laws& right, const Laws& whole, const std::string& whose) {
  std::vector<CostWay> ways;
  for (const modules::NamedMethod& named : kind.methods) {
    CostWay way;
    way.name = whose + " " + named.name;
    way.method = [step = named.step(module)](double) { return step; };
    way.order = named.order;
    way.laws = right;
    ways.push_back(std::move(way));
  }
  CostWay all;
  all.name = fmt::format("{} {} as a whole", whose, kind.id);
  all.laws = whole;
  if (!kind.methods.empty()) all.order = kind.methods.back().order;
  if (kind.methods.empty()) {   // its laws, with the library's classical method
    all.method = [](double) { return step_of(method_named("rk4"), kUnset); };
    all.order = method_named("rk4").order;
  }
  ways.push_back(std::move(all));
  return ways;
}

std::vector<Measured> measure(const scene::Scene& scene, std::vector<CostWay> ways, const CostTruth& truth, const std::function<void()>& between) {
  engines::CostOptions options;
  options.runs = 1;
  std::vector<double> steps;
  for (int k = 0; k < kResolutions; ++k) steps.push_back(kCoarsest * std::pow(0.5, k));
  std::vector<Measured> all;
  for (CostWay& way : ways) {
    Measured measured{std::move(way), {}, "", false};
    between();
    try {
      engines::run_ladder(scene, measured.way, truth, 0.0, options, steps, {}, [&](const CostRung& rung) {
        measured.rungs.push_back(rung);
        if (call_log().noted && !rung.not_attempted) throw std::runtime_error(call_log().story);   // it hangs or crashes, and would do so again
      });
    } catch (const std::exception& error) {
      measured.story = error.what();
    }
    all.push_back(std::move(measured));
  }
  return all;
}

CostLine line_of(const Measured& measured, const CostTruth& truth) {
  CostLine line;
  line.is_attempted = measured.rungs.empty() || !measured.rungs.back().not_attempted;
  if (!measured.story.empty()) line.reading = fmt::format("{}: the refinement sequence ended early. {}", measured.way.name, plain_text(measured.story));
  else line.reading = plain_text(engines::read_ladder(measured.way, measured.rungs, truth, true));
  line.is_right = measured.story.empty() && line.is_attempted && engines::keeps_promise(measured.way, measured.rungs, truth);
  line.reading[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(line.reading[0])));
  return line;
}

report::Plot plot_of(const std::vector<Measured>& all, const CostTruth& truth, report::Axis across, const std::string& title, double (*x)(const CostRung&), const std::string& caption) {
  report::Plot plot{title, std::move(across), {"error of places", "m", report::Scale::kLog}, {}, {}, caption};
  for (const Measured& measured : all) {
    if (measured.is_reference) plot.curves.resize(std::max(plot.curves.size(), report::kReferenceStyles));   // the submission's colours with hollow marks
    const auto fit = engines::order_of(measured.way, measured.rungs, truth);
    report::Curve curve{fit ? fmt::format("{}, order {:.2f}", measured.way.name, fit->order) : measured.way.name, {}, {}, true};
    for (const CostRung& rung : measured.rungs) {
      if (!rung.stopped_by.empty() || !(rung.error_m < truth.scale_m) || !(x(rung) > 0)) continue;
      curve.x.push_back(x(rung));
      curve.y.push_back(std::max(rung.error_m, truth.floor_m));
    }
    if (curve.x.empty()) curve.name.clear();
    plot.curves.push_back(std::move(curve));
  }
  plot.limits.push_back({truth.floor_m, "error of the reference solution"});
  return plot;
}

fs::path scene_file(const Course& course, const ModuleKind& kind) { return course.root / "assignments" / kind.folder / "scenes" / (kind.note<engines::CostShowcase>().scene + ".json"); }

}  // namespace

CostSection measure_cost(const Course& course, const std::string& id, const fs::path& submission, const CostSectionOptions& options) {
  const ModuleKind& kind = course.registry->find(id);
  if (kind.is_scheduler) return measure_scheduler(course, kind, submission, options);
  const AnyModule reference = reference_of(course, kind);
  if (!kind.note<engines::CostShowcase>().is_graded || (!reference && kind.methods.empty())) return {};
  const scene::Scene scene = scene::load_scene(scene_file(course, kind));
  const Laws right = laws_around(course, kind, kind.methods.empty() ? reference : nullptr, "reference", scene);
  engines::CostOptions looking;
  looking.duration_s = kind.note<engines::CostShowcase>().duration_s;
  const CostTruth truth = engines::find_truth(scene, right, looking);

  WorkerOptions worker;
  worker.id = kind.id;
  worker.module = submission;
  worker.programs = course.build / "bin";
  worker.call_own_s = options.call_wall_s;
  worker.session_own_s = options.session_wall_s;
  worker.callback_budget = 100'000'000;   // above what the wall-clock limit allows
  call_log() = CallLog{};
  WorkerConnection connection(worker);
  const AnyModule proxy = kind.make_proxy(connection);
  std::vector<Measured> all = measure(scene, ways_of(kind, proxy, right, laws_around(course, kind, proxy, "submission", scene), "your"), truth, [&] {
    connection.reset();
    call_log() = CallLog{};   // each curve is independent
  });

  CostSection section;
  section.scene = scene.title;
  section.truth = fmt::format("Errors are against {}: {:.1e} m; the error is the distance of a body's centre of mass from its reference position, plus the angle between its orientations times its radius of gyration.", truth.what, truth.floor_m);
  for (const Measured& measured : all) section.lines.push_back(line_of(measured, truth));
  if (reference) {
    const Laws whole = laws_around(course, kind, reference, "reference", scene);
    for (Measured& measured : measure(scene, ways_of(kind, reference, right, whole, "reference"), truth, [] {})) {
      measured.is_reference = true;
      all.push_back(std::move(measured));
    }
  }
  section.plots.push_back(plot_of(all, truth, {"step", "s", report::Scale::kLog}, "Error against the step", [](const CostRung& rung) { return rung.step_s; },
                                  "The slope is the order: halving the step divides the error of a method of order p by 2^p."));
  section.plots.push_back(plot_of(all, truth, {"derivatives asked for", "-", report::Scale::kLog}, "Error against force evaluations", [](const CostRung& rung) { return static_cast<double>(rung.evaluations); },
                                  "The cost of accuracy in counts that are the same on any machine: left is cheaper, down is more accurate."));
  return section;
}

}  // namespace tumble::grading
