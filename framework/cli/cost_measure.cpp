#include "framework/cli/cost_measure.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <cstdio>

#include <fmt/format.h>

#include "framework/cli/read_truth.h"
#include "framework/cli/record.h"
#include "framework/core/cpu_time.h"
#include "framework/core/error.h"
#include "framework/core/text.h"
#include "framework/cost/cost.h"
#include "framework/cost/reading.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/scene/sized_scenes.h"
#include "framework/scene/words.h"

namespace tumble::cli {
namespace {

using cost::CostMethod;
using cost::CostReference;
using cost::CostResult;

constexpr double kLeastRunTime = 2.0;  // s of CPU of a run that is always allowed
constexpr double kLeastShare = 0.2;    // the same as a fraction of a small budget
// of the size of the motion: larger errors do not show the order
constexpr double kAnAnswer = 0.1;
// of the remaining budget: a run below this is always worth its cost
constexpr double kTrifle = 0.03;
// error is weighed against cost at this rate, so that a method is not preferred only because it has
// spent more
constexpr double kUsualOrder = 4.0;
// range of credible slopes of error over cost
constexpr double kLeastSlope = 0.5, kMostSlope = 12.0;
constexpr double kForTheBest = 0.4;  // of the budget: for the refinement with the least error
constexpr double kLongest = 2.0;     // times its share of the budget, for the same
// s of CPU of a run without a reference solution before any has finished: its result is the only
// one
constexpr double kFirstRight = 25.0;
constexpr double kLongestFirst = 0.5;  // of the budget, for such a run with a reference solution
// of the scene's duration: a shorter reference solution says less than the scene's numbers
constexpr double kWorthATruth = 0.1;
// budgets, and s of CPU, for the search for a reference solution
constexpr double kSearch = 3.0, kLeastSearch = 6.0;
constexpr double kLeastProbe = 1.0;  // s, and
// of the budget, where a module runs in a sandbox: the other process uses as much again
constexpr double kHostsPart = 0.5;
// of the budget: for the run that shows whether a scene's size fits
constexpr double kProbe = 0.1;
constexpr int kSmaller = 3;  // the factor by which the size shrinks otherwise

// of the tolerances of the scene's numbers: required errors without a reference solution
const std::vector<double> kSharesAllowed = {1.0, 0.1};

struct Refinement {
  CostMethod method;
  std::vector<CostResult> results;
};

std::string fineness_of(const CostResult& result) {
  if (std::isfinite(result.tolerance)) return tolerance_in_words(result.tolerance);
  if (!std::isfinite(result.step_s)) return "no step";
  return step_in_words(result.step_s) + "\u00a0s";
}

bool is_smooth(const scene::Scene& scene) {
  const auto collide = std::count_if(scene.bodies.begin(), scene.bodies.end(),
                                     [](const scene::BodySpec& body) { return body.collides; });
  return collide < 2 && !scene::asks_for(scene, [](const scene::Traits& traits) {
           return traits.constrains || traits.looks;
         });
}

/// Median cost, without runs whose error is no answer.
double middle_price(const std::vector<Refinement>& refinements, const CostReference& reference) {
  std::vector<double> prices;
  for (const Refinement& refinement : refinements)
    for (const CostResult& result : refinement.results)
      if (result.stopped_by.empty() && result.error_m < reference.scale_m)
        prices.push_back(result.cpu_s);
  if (prices.empty()) return 1.0;
  std::sort(prices.begin(), prices.end());
  return prices[prices.size() / 2];
}

/// The meaning of a method's counter, for people.
std::string counted_in_words(std::string counter) {
  if (counter == "derivative_evaluations") return "derivatives asked for";
  if (counter == "gap_evaluations") return "gaps looked at";
  std::replace(counter.begin(), counter.end(), '_', ' ');
  return counter;
}

report::CostCurve curve_of(const Refinement& refinement, const CostReference& reference,
                           double price, bool smooth) {
  report::CostCurve curve;
  curve.name = refinement.method.name;
  curve.reading = cost::read_refinement(refinement.method, refinement.results, reference, smooth);
  curve.counted = counted_in_words(refinement.method.counted);
  curve.is_subject = refinement.method.is_subject;
  const auto fit = cost::order_of(refinement.method, refinement.results, reference);
  if (fit && fit->pairs >= kPairsOfAnOrder && !refinement.method.controlled)
    curve.order = fit->order;
  double closest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < refinement.results.size(); ++k) {
    const CostResult& result = refinement.results[k];
    // no run is known to be better than the reference solution
    curve.points.push_back({fineness_of(result),
                            refinement.method.controlled ? kUnset : result.step_s,
                            std::max(result.error_m, reference.floor_m), result.cpu_s,
                            static_cast<double>(result.evaluations), result.stopped_by});
    const double off = std::abs(std::log(result.cpu_s / price));
    if (!result.stopped_by.empty() || !(off < closest)) continue;
    closest = off;
    curve.example = k;
    curve.times = result.times;
    curve.energy_errors = result.energy_errors;
    curve.stage_seconds = result.stage_seconds;
  }
  return curve;
}

std::string what_error_is(const CostReference& reference) {
  if (reference.by_numbers)
    return fmt::format(
        "There is no reference solution ({}). So each run is judged as tumble run judges it, and "
        "its error is the worst of the scene's numbers relative to its tolerance: up to 1 is "
        "right. "
        "A run that exceeds a tolerance of 0 has no such error and is not drawn.",
        reference.why_by_numbers);
  return fmt::format(
      "Errors are against {}: {} m. The error of a body is the distance of its centre of mass "
      "from the reference, plus the angle of its rotation error times its radius of gyration; the "
      "largest over all movable bodies and samples counts. An error larger than the motion, {} m, "
      "is not drawn.",
      reference.what, few_digits(reference.floor_m), few_digits(reference.scale_m));
}

bool any_gets_through(const Refinement& refinement) {
  return std::any_of(refinement.results.begin(), refinement.results.end(),
                     [](const CostResult& result) { return result.stopped_by.empty(); });
}

/// All refinements within one budget: a first share each, and the rest to the most promising.
class Refinements {
 public:
  Refinements(const CostSubject& subject, const CostReference& reference, const CostWords& words,
              const cost::CostOptions& options)
      : scene_(subject.scene),
        reference_(reference),
        words_{words.steps_s(), words.tolerances},
        budget_((subject.connections.empty() ? 1.0 : kHostsPart) * words.budget()),
        options_(options),
        until_(cpu_seconds() + budget_) {
    for (const CostMethod& method : subject.methods) refinements.push_back({method, {}});
  }

  /// @param each  called after each part
  void run(const std::function<void()>& each) {
    each_ = each;
    const double first_until = until_ - kForTheBest * budget_;
    for (std::size_t k = 0; k < refinements.size(); ++k) {
      const double share =
          std::max(0.0, first_until - cpu_seconds()) / static_cast<double>(refinements.size() - k);
      if (k > 0 && left() <= 0.0)
        leave_out(k);
      else
        extend(k, share);
      // Where one run takes more than its share, the others would use up the budget before any
      // shows a result.
      if (k == 0 && !refinements[0].results.empty() &&
          refinements[0].results.back().spent_s > share)
        while (next_mark() > 0.0 && can_go_on(0)) extend(0, 0.0);
    }
    while (const std::optional<std::size_t> best = closest()) extend(*best, 0.0);
    std::erase_if(refinements,
                  [](const Refinement& refinement) { return refinement.results.empty(); });
  }

  std::vector<Refinement> refinements;
  std::vector<std::string> not_run;  // methods left out, with the reason

 private:
  double left() const { return std::max(0.0, until_ - cpu_seconds()); }

  void leave_out(std::size_t k) {
    not_run.push_back(fmt::format("{}: the budget of {:g} s was used up before its turn",
                                  refinements[k].method.name, budget_));
    fmt::print(stderr, "{:>2}/{} not run: {}\n", k + 1, refinements.size(), not_run.back());
  }

  void extend(std::size_t k, double share) {
    cost::CostOptions own = options_;
    const bool first = std::none_of(refinements.begin(), refinements.end(), any_gets_through) &&
                       (reference_.by_numbers || k == 0);
    const double allowed = !first                  ? std::min(kLeastRunTime, kLeastShare * budget_)
                           : reference_.by_numbers ? kFirstRight
                                                   : kLongestFirst * left();
    own.most_of_run_s = std::max(allowed, std::min(left(), kLongest * share));
    if (share == 0.0) own.most_of_run_s = std::max(kLeastShare * budget_, left());
    cost::extend_refinement(
        scene_, refinements[k].method, reference_, share, own, words_, refinements[k].results,
        [&](const CostResult& result) {
          const std::string found =
              result.stopped_by.empty()
                  ? fmt::format("error {}{}, {}", few_digits(result.error_m),
                                reference_.by_numbers ? " of the tolerance" : " m",
                                report::price_of(result.cpu_s))
                  : "stopped";
          fmt::print(stderr, "{:>2}/{} {:<28} {:<16} {:<28} at most {:.0f} s left\n", k + 1,
                     refinements.size(), refinements[k].method.name, fineness_of(result), found,
                     left());
        });
    if (!each_) return;
    const double before = cpu_seconds();
    each_();
    until_ += cpu_seconds() - before;
  }

  bool can_go_on(std::size_t k) const {
    const Refinement& refinement = refinements[k];
    return !refinement.results.empty() && cost::next_price(refinement.results) <= left() &&
           !cost::refinement_is_done(scene_, refinement.method, reference_, refinement.results,
                                     words_);
  }

  /// The largest required error above the floor that no run has reached; 0: there is none.
  double next_mark() const {
    const std::vector<double> marks =
        reference_.by_numbers ? kSharesAllowed : report::CostPage().marks;
    for (const double mark : marks) {
      const auto reaches = [&](const CostResult& result) {
        return result.stopped_by.empty() && std::max(result.error_m, reference_.floor_m) <= mark;
      };
      if (mark >= reference_.floor_m &&
          std::none_of(refinements.begin(), refinements.end(), [&](const Refinement& refinement) {
            return std::any_of(refinement.results.begin(), refinement.results.end(), reaches);
          }))
        return mark;
    }
    return 0.0;
  }

  /// Of the refinements that can continue within the rest: one that costs next to nothing, else the
  /// most promising.
  std::optional<std::size_t> closest() const {
    std::optional<std::size_t> best;
    std::pair<int, double> least;
    const double mark = next_mark();
    for (std::size_t k = 0; k < refinements.size(); ++k) {
      if (!can_go_on(k)) continue;
      const double next = cost::next_price(refinements[k].results);
      const std::pair<int, double> here =
          next < kTrifle * left() ? std::pair{0, next} : hope(refinements[k].results, next, mark);
      if (best && here >= least) continue;
      best = k;
      least = here;
    }
    return best;
  }

  /// Rank, small is good: refinements that reach the next required error in the remaining time, by
  /// cost; then those with an error, by error at its cost; then those that diverged, because half
  /// the step may be stable; last those without an answer.
  std::pair<int, double> hope(const std::vector<CostResult>& results, double next,
                              double mark) const {
    const CostResult& result = results.back();
    if (reference_.by_numbers)
      return result.stopped_by.empty() && std::isfinite(result.error_m)
                 ? std::pair{2, result.error_m}
                 : std::pair{3, next};
    if (!result.stopped_by.empty() || !std::isfinite(result.error_m)) return {3, next};
    if (result.error_m > kAnAnswer * reference_.scale_m) return {4, next};
    const double price =
        mark > 0.0 ? result.spent_s * std::pow(result.error_m / mark, 1.0 / slope_of(results))
                   : std::numeric_limits<double>::infinity();
    return price < left() ? std::pair{1, price}
                          : std::pair{2, result.error_m * std::pow(result.cpu_s, kUsualOrder)};
  }

  /// Exponent of the error against the cost in the last part of a refinement.
  double slope_of(const std::vector<CostResult>& results) const {
    if (results.size() < 2 || !results[results.size() - 2].stopped_by.empty()) return kUsualOrder;
    const CostResult &coarse = results[results.size() - 2], &fine = results.back();
    const double slope =
        std::log(coarse.error_m / fine.error_m) / std::log(fine.spent_s / coarse.spent_s);
    return std::isfinite(slope) ? std::clamp(slope, kLeastSlope, kMostSlope) : kUsualOrder;
  }

  const scene::Scene& scene_;
  const CostReference& reference_;
  cost::RefinementWords words_;
  double budget_;
  cost::CostOptions options_;
  double until_;
  std::function<void()> each_;
};

/// Whether one of a scene's numbers measures accuracy: a gap with tolerance 0 is only kept or not.
bool allows_something(const scene::Scene& scene) {
  return std::any_of(scene.checks.begin(), scene.checks.end(),
                     [](const scene::CheckSpec& check) { return check.tolerance > 0.0; });
}

/// Whether no method and no step errs by more than the least of the marks: a scene at rest.
bool is_right_at_every_step(const report::CostPage& page) {
  bool any = false;
  for (const report::CostCurve& curve : page.curves)
    for (const report::CostPoint& point : curve.points) {
      if (!(point.error <= page.marks.back())) return false;
      any = true;
    }
  return any;
}

report::CostPage page_of(const Context& context, const std::vector<Refinement>& refinements,
                         const CostReference& reference, const CostSubject& subject) {
  report::CostPage page;
  page.title = subject.title;
  page.about = subject.scene.about;
  page.truth = reference.what;
  page.what_error_is = what_error_is(reference);
  if (reference.by_numbers) {
    page.error_name = "worst number over its tolerance";
    page.error_unit.clear();
    page.marks = allows_something(subject.scene) ? kSharesAllowed : std::vector<double>{1.0};
  }
  page.floor = reference.floor_m;
  page.scale = reference.scale_m;
  page.record = record_of(context, subject.scene);
  const double price = middle_price(refinements, reference);
  for (const Refinement& refinement : refinements)
    page.curves.push_back(curve_of(refinement, reference, price, is_smooth(subject.scene)));
  page.readings = verdicts(page);
  if (const std::string compared = coordinates_compared(page); !compared.empty())
    page.readings.push_back(compared);
  if (!reference.by_numbers && is_right_at_every_step(page))
    page.readings.insert(
        page.readings.begin(),
        fmt::format("Every method is right to {} at every step here: the page shows what a step "
                    "costs, not what accuracy costs. That takes a scene that moves more.",
                    report::mark_in_words(page, page.marks.back())));
  if (reference.by_numbers && !allows_something(subject.scene))
    page.readings.push_back(
        "All tolerances of the scene's numbers are 0, so a run keeps to them or does not: the page "
        "shows which runs are right and their cost, but not how accurate they are.");
  if (reference.by_numbers)
    page.readings.push_back(
        "Judged by the scene's own numbers, because there is no reference solution: " +
        reference.why_by_numbers + ".");
  else if (reference.duration_s < (1.0 - 1e-9) * reference.asked_s)
    page.readings.push_back(fmt::format("Compared are the first {:.3g} s of {:.3g} s: {}.",
                                        reference.duration_s, reference.asked_s,
                                        reference.shortened_by));
  if (!subject.note.empty()) page.readings.push_back(subject.note);
  return page;
}

struct SizedWords {
  CostWords words;
  std::optional<int> usual_n;  // set where the scene's usual size was too large
};

/// Gives a scene whose size is a parameter a size of which a run fits into the budget many times,
/// unless the words give one.
SizedWords with_size_that_fits(const Context& context, CostWords words, cost::CostOptions options) {
  const scene::SizedScene* sized = scene::sized_scene_named(words.scene);
  if (sized == nullptr || words.n || std::filesystem::is_regular_file(words.scene))
    return {words, std::nullopt};
  options.runs = 1;
  options.most_of_run_s = std::max(kLeastProbe, kProbe * words.budget());
  options.duration_s = words.duration_s;
  for (int n = sized->default_n;; n = std::max(1, n / kSmaller)) {
    words.n = n;
    const CostSubject subject = find_subject(context, words);
    const CostReference whole = cost::by_numbers(subject.scene, options, "");
    fmt::print(stderr, "tumble: {} with n = {}: testing whether a run fits into {:.3g} s\n",
               words.scene, n, options.most_of_run_s);
    const CostMethod method = cost::goes_in_closed_form(subject.scene)
                                  ? method_by_engine("ca", subject.truth_laws, true)
                                  : method_by_integrator(method_named("rk4"), subject.truth_laws);
    if (n > 1 && !cost::run_at_resolution(subject.scene, method, whole, 1, kUnset, options)
                      .stopped_by.empty())
      continue;
    return {words, n == sized->default_n ? std::nullopt : std::optional<int>(sized->default_n)};
  }
}

}  // namespace

const report::CostCurve* cheapest_curve(const report::CostPage& page, double mark) {
  const report::CostCurve* best = nullptr;
  for (const report::CostCurve& curve : page.curves) {
    const report::CostPoint* point = report::cheapest(curve, mark);
    if (point != nullptr &&
        (best == nullptr || point->cpu_s < report::cheapest(*best, mark)->cpu_s))
      best = &curve;
  }
  return best;
}

std::string tolerance_in_words(double tolerance) {
  constexpr double kPlain = 1e-3;  // 0.1, 0.01, 0.001, 1e-4
  std::string number = few_digits(tolerance);
  if (tolerance > 0 && tolerance < kPlain && number.find('e') == number.npos) {
    const double exponent = std::floor(std::log10(tolerance) + 1e-9);
    number = few_digits(tolerance / std::pow(10.0, exponent)) + fmt::format("e{:.0f}", exponent);
  }
  return "tolerance\u00a0" + number;
}

std::vector<std::string> verdicts(const report::CostPage& page) {
  std::vector<std::string> words;
  for (const double mark : page.marks) {
    const report::CostCurve* best = cheapest_curve(page, mark);
    const std::string what =
        !page.error_unit.empty() ? "An error of " + report::mark_in_words(page, mark)
        : mark == 1.0            ? "A run that is right"
                                 : fmt::format("A run within {:g} of what is allowed", mark);
    if (best == nullptr)
      words.push_back(fmt::format("{}: none of these reaches it.", what));
    else
      words.push_back(fmt::format("{} costs at least {}: {}, {}.", what,
                                  report::price_of(report::cheapest(*best, mark)->cpu_s),
                                  best->name, report::cheapest(*best, mark)->fineness));
  }
  return words;
}

std::string coordinates_compared(const report::CostPage& page) {
  report::CostPage with_rows = page, in_joints = page;
  const auto is_in_joints = [](const report::CostCurve& curve) {
    return curve.name.ends_with(kInJointCoordinates);
  };
  std::erase_if(with_rows.curves, is_in_joints);
  std::erase_if(in_joints.curves, std::not_fn(is_in_joints));
  if (with_rows.curves.empty() || in_joints.curves.empty()) return "";
  std::string words;  // of what one of the two reaches: the other may have had no time for it
  for (auto mark = page.marks.rbegin(); mark != page.marks.rend(); ++mark) {
    const report::CostCurve *rows = cheapest_curve(with_rows, *mark),
                            *joints = cheapest_curve(in_joints, *mark);
    if (joints == nullptr && rows == nullptr) continue;
    const std::string error = report::mark_in_words(page, *mark);
    if (joints == nullptr || rows == nullptr) {
      if (words.empty())
        words =
            fmt::format("Of these runs only those {} reach {} ({}). ",
                        joints == nullptr ? "with six coordinates a body" : "in joint coordinates",
                        error, (joints == nullptr ? rows : joints)->name);
      continue;
    }
    const double price = report::cheapest(*joints, *mark)->cpu_s,
                 ratio = report::cheapest(*rows, *mark)->cpu_s / price;
    return words + fmt::format(
                       "{} costs {} in joint coordinates, and {:.1f} times {} with six coordinates "
                       "a body and "
                       "their rows ({}).",
                       error, report::price_of(price), ratio >= 1.0 ? ratio : 1.0 / ratio,
                       ratio >= 1.0 ? "as much" : "less", rows->name);
  }
  if (!words.empty()) words.pop_back();
  return words;
}

void check_with_files(const Context& context, const scene::Scene& scene, const Laws& laws,
                      CostReference& reference) {
  const std::filesystem::path folder = context.root / "tests" / "truths";
  if (!std::filesystem::is_directory(folder)) return;
  for (const auto& file : find_truths(folder)) {
    const truths::Case known = read_truth(file);
    cost::check_reference(scene, laws, truths::known_positions(scene, known),
                          "tests/truths/" + file.filename().string(), reference);
  }
}

MeasuredCost measure_cost(const Context& context, const CostWords& asked, const CostSoFar& each) {
  asked.steps_s();  // refused before any run
  cost::CostOptions options;
  options.timewarp = engines::fast_timewarp();
  options.progress = [](const std::string& what) { fmt::print(stderr, "tumble: {}\n", what); };
  options.most_of_search_s =
      std::clamp(kSearch * asked.budget(), kLeastSearch, options.most_of_search_s);
  // Subject, reference solution, and the scene's own numbers where there is none.
  const auto [words, usual_n] = with_size_that_fits(context, asked, options);
  CostSubject subject = find_subject(context, words);
  options.duration_s = words.duration_s ? words.duration_s : subject.duration_s;
  if (!options.duration_s && !subject.scene.checks.empty()) options.least_share = kWorthATruth;
  std::string why;
  const std::optional<CostReference> found =
      cost::try_reference(subject.scene, subject.truth_laws, options, why);
  if (!found && subject.scene.checks.empty())
    throw UserError(
        subject.scene.name,
        "there is no reference solution (" + why + "), and the scene has no numbers of its own",
        "Give it \"checks\", or a shorter --duration-s.");
  CostReference reference = found ? *found : cost::by_numbers(subject.scene, options, why);
  if (!found)
    fmt::print(stderr,
               "tumble: no reference solution ({}): runs are judged by the scene's numbers\n", why);
  if (found) check_with_files(context, subject.scene, subject.truth_laws, reference);
  // there the method of integration hardly matters: the usual one comes first
  if (reference.by_numbers || subject.scene.contact)
    std::stable_partition(subject.methods.begin(), subject.methods.end(),
                          [](const CostMethod& method) { return method.word == "rk4"; });
  // Runs all methods within the budget.
  Refinements all(subject, reference, words, options);
  // The page and its summary.
  const auto measured_so_far = [&, &words = words, &usual_n = usual_n] {
    std::vector<Refinement> refinements;
    MeasuredCost measured;
    for (const Refinement& refinement : all.refinements)
      if (!refinement.results.empty()) refinements.push_back(refinement);
    measured.page = page_of(context, refinements, reference, subject);
    measured.page.not_run = subject.not_run;
    measured.page.not_run.insert(measured.page.not_run.end(), all.not_run.begin(),
                                 all.not_run.end());
    if (usual_n) {
      measured.size = fmt::format("n = {}", *words.n);
      measured.page.title += ", " + measured.size;
      measured.page.readings.push_back(fmt::format(
          "Measured with n = {}: at its usual size, {}, one run takes longer than {:.3g} "
          "s here. Request it with --n {} and a larger --budget-s.",
          *words.n, *usual_n, std::max(kLeastProbe, kProbe * words.budget()), *usual_n));
    }
    if (reference.by_numbers)
      measured.against = fmt::format(
          "judged by its numbers, over {:.3g} s: the worst of them over its tolerance [-]",
          reference.duration_s);
    else
      measured.against = fmt::format("error: against {}: {} m, over {:.3g} s", reference.what,
                                     few_digits(reference.floor_m), reference.duration_s);
    measured.duration_s = reference.duration_s;
    measured.asked_s = reference.asked_s;
    const auto unwritten = [](const Refinement& refinement) {
      return !refinement.results.empty() && refinement.results.back().not_attempted;
    };
    measured.not_attempted = std::any_of(refinements.begin(), refinements.end(), unwritten);
    return measured;
  };
  const std::size_t methods = all.refinements.size();
  all.run([&] {
    if (!each) return;
    MeasuredCost so_far = measured_so_far();
    const auto is_left_out = [&](const std::string& name) {
      return std::any_of(all.not_run.begin(), all.not_run.end(),
                         [&](const std::string& why) { return why.starts_with(name + ": "); });
    };
    for (const Refinement& refinement : all.refinements)
      if (refinement.results.empty() && !is_left_out(refinement.method.name))
        so_far.page.not_run.push_back(refinement.method.name +
                                      ": its turn had not come when this page was written");
    each(so_far, so_far.page.curves.size(), methods);
  });
  return measured_so_far();
}

}  // namespace tumble::cli
