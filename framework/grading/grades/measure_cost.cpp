#include "framework/grading/grades/measure_cost.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/core/text.h"
#include "framework/cost/cost.h"
#include "framework/cost/reading.h"
#include "framework/cost/showcase.h"
#include "framework/grading/verdicts/call_log.h"
#include "framework/grading/course/laws_around.h"
#include "framework/grading/verdicts/plain_text.h"
#include "framework/grading/grades/scheduler_section.h"
#include "framework/grading/worker/worker_connection.h"
#include "framework/scene/load_scene.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;
using cost::CostMethod;
using cost::CostReference;
using cost::CostResult;
using modules::AnyModule;
using modules::ModuleKind;

constexpr double kCoarsest = 1.0 / 8.0;  // s: the largest step
constexpr int kResolutions = 8;          // halvings down to 1/1024 s

struct Measured {
  CostMethod method;
  std::vector<CostResult> results;
  std::string story;  // what ended it; empty: it is complete
  bool is_reference = false;
};

/// The module's own methods, then all its laws together: methods alone do not test the derivative
/// and the renormalisation.
std::vector<CostMethod> methods_of(const ModuleKind& kind, const AnyModule& module,
                                   const Laws& right, const Laws& whole, const std::string& whose) {
  std::vector<CostMethod> methods;
  for (const modules::NamedMethod& named : kind.methods) {
    CostMethod method;
    method.name = whose + " " + named.name;
    method.step_function = [step = named.step(module)](double) { return step; };
    method.order = named.order;
    method.laws = right;
    methods.push_back(std::move(method));
  }
  CostMethod all;
  all.name = fmt::format("{} {} as a whole", whose, kind.id);
  all.laws = whole;
  if (!kind.methods.empty()) all.order = kind.methods.back().order;
  if (kind.methods.empty()) {  // its laws, with the library's classical method
    all.step_function = [](double) { return step_of(method_named("rk4"), kUnset); };
    all.has_library_step = true;
    all.order = method_named("rk4").order;
  }
  methods.push_back(std::move(all));
  return methods;
}

std::vector<Measured> measure(const scene::Scene& scene, std::vector<CostMethod> methods,
                              const CostReference& reference,
                              const std::function<void()>& between) {
  cost::CostOptions options;
  options.runs = 1;
  std::vector<double> steps;
  for (int k = 0; k < kResolutions; ++k) steps.push_back(kCoarsest * std::pow(0.5, k));
  std::vector<Measured> all;
  for (CostMethod& method : methods) {
    Measured measured{std::move(method), {}, "", false};
    between();
    try {
      cost::run_refinement(scene, measured.method, reference, 0.0, options, steps, {},
                           [&](const CostResult& result) {
                             measured.results.push_back(result);
                             // it hangs or crashes, and would do so again
                             if (call_log().noted && !result.not_attempted)
                               throw std::runtime_error(call_log().story);
                           });
    } catch (const std::exception& error) {
      measured.story = error.what();
    }
    all.push_back(std::move(measured));
  }
  return all;
}

CostLine line_of(const Measured& measured, const CostReference& reference) {
  CostLine line =
      line_that_says(measured.story.empty()
                         ? cost::read_refinement(measured.method, measured.results, reference, true)
                         : fmt::format("{}: the refinement sequence ended early: {}",
                                       measured.method.name, measured.story));
  line.is_attempted = measured.results.empty() || !measured.results.back().not_attempted;
  line.is_right = measured.story.empty() && line.is_attempted &&
                  cost::keeps_promise(measured.method, measured.results, reference);
  return line;
}

report::Plot plot_of(const std::vector<Measured>& all, const CostReference& reference,
                     report::Axis across, const std::string& title, double (*x)(const CostResult&),
                     const std::string& caption) {
  report::Plot plot{
      title, std::move(across), {"error of places", "m", report::Scale::kLog}, {}, {}, caption};
  for (const Measured& measured : all) {
    // the submission's colours with hollow marks
    if (measured.is_reference)
      plot.curves.resize(std::max(plot.curves.size(), report::kReferenceStyles));
    const auto fit = cost::order_of(measured.method, measured.results, reference);
    report::Curve curve{fit ? fmt::format("{}, order {:.2f}", measured.method.name, fit->order)
                            : measured.method.name,
                        {},
                        {},
                        true};
    for (const CostResult& result : measured.results) {
      if (!result.stopped_by.empty() || !(result.error_m < reference.scale_m) || !(x(result) > 0))
        continue;
      curve.x.push_back(x(result));
      curve.y.push_back(std::max(result.error_m, reference.floor_m));
    }
    if (curve.x.empty()) curve.name.clear();
    plot.curves.push_back(report::sorted_by_x(std::move(curve)));
  }
  plot.limits.push_back({reference.floor_m, "error of the reference solution"});
  return plot;
}

fs::path scene_file(const Course& course, const ModuleKind& kind) {
  return course.root / "assignments" / kind.folder / "scenes" /
         (kind.note<cost::CostShowcase>().scene + ".json");
}

}  // namespace

CostLine line_that_says(const std::string& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  CostLine line;
  line.reading = sentence(plain_text(text.substr(0, end)));
  if (end < text.size()) line.more = plain_text(text.substr(end + 1));
  return line;
}

CostSection measure_cost(const Course& course, const std::string& id, const fs::path& submission,
                         const CostSectionOptions& options) {
  const ModuleKind& kind = course.registry->find(id);
  if (kind.is_scheduler) return measure_scheduler(course, kind, submission, options);
  const AnyModule reference_module = reference_of(course, kind);
  if (!kind.note<cost::CostShowcase>().is_graded || (!reference_module && kind.methods.empty()))
    return {};
  const scene::Scene scene = scene::load_scene(scene_file(course, kind));
  const Laws right = laws_around(course, kind, kind.methods.empty() ? reference_module : nullptr,
                                 "reference", scene);
  cost::CostOptions looking;
  looking.duration_s = kind.note<cost::CostShowcase>().duration_s;
  const CostReference reference = cost::find_reference(scene, right, looking);

  WorkerOptions worker;
  worker.id = kind.id;
  worker.module = submission;
  worker.programs = course.build / "bin";
  worker.call_own_s = options.call_wall_s;
  worker.session_own_s = options.session_wall_s;
  worker.callback_budget = 100'000'000;  // above what the wall-clock limit allows
  call_log() = CallLog{};
  WorkerConnection connection(worker);
  const AnyModule proxy = kind.make_proxy(connection);
  std::vector<Measured> all = measure(
      scene,
      methods_of(kind, proxy, right, laws_around(course, kind, proxy, "submission", scene), "your"),
      reference, [&] {
        connection.reset();
        call_log() = CallLog{};  // each curve is independent
      });

  CostSection section;
  section.scene = scene.title;
  section.truth = fmt::format(
      "Errors are against {}: {} m; the error is the distance of a body's centre of mass from "
      "its reference position, plus the angle between its orientations times its radius of "
      "gyration.",
      reference.what, few_digits(reference.floor_m));
  for (const Measured& measured : all) section.lines.push_back(line_of(measured, reference));
  if (reference_module) {
    const Laws whole = laws_around(course, kind, reference_module, "reference", scene);
    for (Measured& measured :
         measure(scene, methods_of(kind, reference_module, right, whole, "reference"), reference,
                 [] {})) {
      measured.is_reference = true;
      all.push_back(std::move(measured));
    }
  }
  section.plots.push_back(plot_of(
      all, reference, {"step", "s", report::Scale::kLog}, "Error against the step",
      [](const CostResult& result) { return result.step_s; },
      "The slope is the order: halving the step divides the error of a method of order p by 2^p."));
  section.plots.push_back(plot_of(
      all, reference, {"derivatives asked for", "-", report::Scale::kLog},
      "Error against derivatives asked for",
      [](const CostResult& result) { return static_cast<double>(result.evaluations); },
      "The cost of accuracy in counts that are the same on any machine: left is cheaper, down is "
      "more accurate."));
  return section;
}

}  // namespace tumble::grading
