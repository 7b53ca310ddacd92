#include "framework/cli/cost_measure.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>

#include "framework/cli/read_truth.h"
#include "framework/cli/record.h"
#include "framework/core/cpu_time.h"
#include "framework/core/error.h"
#include "framework/engines/cost/cost.h"
#include "framework/engines/cost/reading.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/scene/sized_scenes.h"
#include "framework/scene/words.h"

namespace tumble::cli {
namespace {

using engines::CostRung;
using engines::CostTruth;
using engines::CostWay;

constexpr double kLeastRung = 2.0;   // s of CPU that any run may take
constexpr double kLeastShare = 0.2;  // or so much of a small budget
constexpr double kAnAnswer = 0.1;    // of how far bodies move: errors above it do not show where they lead
constexpr double kTrifle = 0.03;     // of what is left of the budget: a run that costs less need not be promising
constexpr double kUsualOrder = 4.0;  // price and error are exchanged at this rate, so that who has spent more is not taken for who is better
constexpr double kLeastSlope = 0.5, kMostSlope = 12.0;   // of error over price, to be believed
constexpr double kForTheBest = 0.4;  // of the budget: to go on where the least error was
constexpr double kLongest = 2.0;     // shares of the budget, likewise
constexpr double kFirstRight = 25.0; // s of CPU that a run may take where there is no truth and none has got through yet: it is all there is to know
constexpr double kLongestFirst = 0.5;   // of the budget, that it may take where there is a truth
constexpr double kWorthATruth = 0.1; // of the scene: a truth that holds for less says less than its numbers
constexpr double kSearch = 3.0, kLeastSearch = 6.0;   // budgets, and s of CPU, of the search for a truth
constexpr double kLeastProbe = 1.0;  // s, and
constexpr double kHostsPart = 0.5;   // of the budget, where a module runs in a sandbox: the other process takes as much again
constexpr double kProbe = 0.1;       // of the budget: of the run that shows whether a scene's size fits into it
constexpr int kSmaller = 3;          // and else it gets so many times smaller

const std::vector<double> kSharesAllowed = {1.0, 0.1};   // of what a scene's numbers are allowed: what is asked where there is no truth

struct Ladder {
  CostWay way;
  std::vector<CostRung> rungs;
};

std::string fineness_of(const CostRung& rung) {
  if (std::isfinite(rung.tolerance)) return fmt::format("tolerance\u00a0{:.0e}", rung.tolerance);
  if (!std::isfinite(rung.step_s)) return "no step";
  return 1.0 / rung.step_s >= 10 ? fmt::format("1/{:.0f}\u00a0s", 1.0 / rung.step_s) : fmt::format("{:.3g} s", rung.step_s);
}

bool is_smooth(const scene::Scene& scene) {
  const auto collide = std::count_if(scene.bodies.begin(), scene.bodies.end(), [](const scene::BodySpec& body) { return body.collides; });
  return collide < 2 && !scene::asks_for(scene, [](const scene::Traits& traits) { return traits.constrains || traits.looks; });
}

/// Runs whose error is no answer cost nothing worth comparing.
double middle_price(const std::vector<Ladder>& ladders, const CostTruth& truth) {
  std::vector<double> prices;
  for (const Ladder& ladder : ladders)
    for (const CostRung& rung : ladder.rungs)
      if (rung.stopped_by.empty() && rung.error_m < truth.scale_m) prices.push_back(rung.cpu_s);
  if (prices.empty()) return 1.0;
  std::sort(prices.begin(), prices.end());
  return prices[prices.size() / 2];
}

/// What a way's evaluations are, for people.
std::string counted_in_words(std::string counter) {
  if (counter == "derivative_evaluations") return "derivatives asked for";
  if (counter == "gap_evaluations") return "gaps looked at";
  std::replace(counter.begin(), counter.end(), '_', ' ');
  return counter;
}

report::CostCurve curve_of(const Ladder& ladder, const CostTruth& truth, double price, bool smooth) {
  report::CostCurve curve;
  curve.name = ladder.way.name;
  curve.reading = engines::read_ladder(ladder.way, ladder.rungs, truth, smooth);
  curve.counted = counted_in_words(ladder.way.counted);
  curve.is_subject = ladder.way.name.starts_with("your ");
  const auto fit = engines::order_of(ladder.way, ladder.rungs, truth);
  if (fit && !ladder.way.controlled) curve.order = fit->order;
  double closest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < ladder.rungs.size(); ++k) {
    const CostRung& rung = ladder.rungs[k];
    curve.points.push_back({fineness_of(rung), ladder.way.controlled ? kUnset : rung.step_s, std::max(rung.error_m, truth.floor_m), rung.cpu_s, static_cast<double>(rung.evaluations), rung.stopped_by});   // nobody is known to be better than the truth
    const double off = std::abs(std::log(rung.cpu_s / price));
    if (!rung.stopped_by.empty() || !(off < closest)) continue;
    closest = off;
    curve.example = k;
    curve.times = rung.times;
    curve.energy_errors = rung.energy_errors;
    curve.stage_seconds = rung.stage_seconds;
  }
  return curve;
}

std::string what_error_is(const CostTruth& truth) {
  if (truth.by_numbers)
    return fmt::format("There is no truth to compare places with ({}). So each run is judged as tumble run judges it, and its error is the worst of the scene's numbers over what that number is allowed: up to 1 is right. "
                       "Where nothing at all is allowed and something is there, a run has no such error and is not drawn.", truth.why_by_numbers);
  return fmt::format("Errors are against {}: {:.1e} m. The error of a body is how far its centre of mass is out of place, plus the angle by which it is turned wrongly times its radius of gyration; the "
                     "largest over all movable bodies and samples counts. An error of {:.1e} m, which is as far as bodies move, is no answer, and is not drawn.", truth.what, truth.floor_m, truth.scale_m);
}

bool any_gets_through(const Ladder& ladder) {
  return std::any_of(ladder.rungs.begin(), ladder.rungs.end(), [](const CostRung& rung) { return rung.stopped_by.empty(); });
}

/// All ladders within one budget: a first part each, and what is left to those that come closest.
class Ladders {
 public:
  Ladders(const CostSubject& subject, const CostTruth& truth, const CostWords& words, const engines::CostOptions& options)
      : scene_(subject.scene), truth_(truth), words_{words.steps_s(), words.tolerances}, budget_((subject.connections.empty() ? 1.0 : kHostsPart) * words.budget()), options_(options), until_(cpu_seconds() + budget_) {
    for (const CostWay& way : subject.ways) ladders.push_back({way, {}});
  }

  void run() {
    const double first_until = until_ - kForTheBest * budget_;
    for (std::size_t k = 0; k < ladders.size(); ++k) {
      const double share = std::max(0.0, first_until - cpu_seconds()) / static_cast<double>(ladders.size() - k);
      if (k > 0 && left() <= 0.0) leave_out(k);
      else extend(k, share);
      // Where one run takes more than its share, the others would use up the budget before any shows what accuracy costs.
      if (k == 0 && !ladders[0].rungs.empty() && ladders[0].rungs.back().spent_s > share)
        while (next_mark() > 0.0 && can_go_on(0)) extend(0, 0.0);
    }
    while (const std::optional<std::size_t> best = closest()) extend(*best, 0.0);
    std::erase_if(ladders, [](const Ladder& ladder) { return ladder.rungs.empty(); });
  }

  std::vector<Ladder> ladders;
  std::vector<std::string> not_run;   // which ways, and why

 private:
  double left() const { return std::max(0.0, until_ - cpu_seconds()); }

  void leave_out(std::size_t k) {
    not_run.push_back(fmt::format("{}: the budget of {:g} s was used up before its turn", ladders[k].way.name, budget_));
    fmt::print(stderr, "{:>2}/{} not run: {}\n", k + 1, ladders.size(), not_run.back());
  }

  void extend(std::size_t k, double share) {
    engines::CostOptions own = options_;
    const bool first = std::none_of(ladders.begin(), ladders.end(), any_gets_through) && (truth_.by_numbers || k == 0);
    const double allowed = !first ? std::min(kLeastRung, kLeastShare * budget_) : truth_.by_numbers ? kFirstRight : kLongestFirst * left();
    own.most_of_rung_s = std::max(allowed, std::min(left(), kLongest * share));
    if (share == 0.0) own.most_of_rung_s = std::max(kLeastShare * budget_, left());
    engines::extend_ladder(scene_, ladders[k].way, truth_, share, own, words_, ladders[k].rungs, [&](const CostRung& rung) {
      const std::string found = rung.stopped_by.empty() ? fmt::format("error {:.1e}{}, {}", rung.error_m, truth_.by_numbers ? " of allowed" : " m", report::price_of(rung.cpu_s)) : "stopped";
      fmt::print(stderr, "{:>2}/{} {:<28} {:<16} {:<28} at most {:.0f} s left\n", k + 1, ladders.size(), ladders[k].way.name, fineness_of(rung), found, left());
    });
  }

  bool can_go_on(std::size_t k) const {
    const Ladder& ladder = ladders[k];
    return !ladder.rungs.empty() && engines::next_price(ladder.rungs) <= left() && !engines::ladder_is_done(scene_, ladder.way, truth_, ladder.rungs, words_);
  }

  /// The largest of the errors whose price is asked that the truth can tell and nothing has reached; 0: there is none.
  double next_mark() const {
    const std::vector<double> marks = truth_.by_numbers ? kSharesAllowed : report::CostPage().marks;
    for (const double mark : marks) {
      const auto reaches = [&](const CostRung& rung) { return rung.stopped_by.empty() && std::max(rung.error_m, truth_.floor_m) <= mark; };
      if (mark >= truth_.floor_m && std::none_of(ladders.begin(), ladders.end(), [&](const Ladder& ladder) { return std::any_of(ladder.rungs.begin(), ladder.rungs.end(), reaches); })) return mark;
    }
    return 0.0;
  }

  /// Of the ladders that can go on in what is left: what costs next to nothing first, then the one that promises most.
  std::optional<std::size_t> closest() const {
    std::optional<std::size_t> best;
    std::pair<int, double> least;
    const double mark = next_mark();
    for (std::size_t k = 0; k < ladders.size(); ++k) {
      if (!can_go_on(k)) continue;
      const double next = engines::next_price(ladders[k].rungs);
      const std::pair<int, double> here = next < kTrifle * left() ? std::pair{0, next} : hope(ladders[k].rungs, next, mark);
      if (best && here >= least) continue;
      best = k;
      least = here;
    }
    return best;
  }

  /// Small is good: what reaches the next mark in the time that is left, by the least; then an error, at what it cost; then what blew up, for
  /// half the step may hold; last what gives answers that are none.
  std::pair<int, double> hope(const std::vector<CostRung>& rungs, double next, double mark) const {
    const CostRung& rung = rungs.back();
    if (truth_.by_numbers) return rung.stopped_by.empty() && std::isfinite(rung.error_m) ? std::pair{2, rung.error_m} : std::pair{3, next};
    if (!rung.stopped_by.empty() || !std::isfinite(rung.error_m)) return {3, next};
    if (rung.error_m > kAnAnswer * truth_.scale_m) return {4, next};
    const double price = mark > 0.0 ? rung.spent_s * std::pow(rung.error_m / mark, 1.0 / slope_of(rungs)) : std::numeric_limits<double>::infinity();
    return price < left() ? std::pair{1, price} : std::pair{2, rung.error_m * std::pow(rung.cpu_s, kUsualOrder)};
  }

  /// By which power of its price the error of a ladder fell last.
  double slope_of(const std::vector<CostRung>& rungs) const {
    if (rungs.size() < 2 || !rungs[rungs.size() - 2].stopped_by.empty()) return kUsualOrder;
    const CostRung &coarse = rungs[rungs.size() - 2], &fine = rungs.back();
    const double slope = std::log(coarse.error_m / fine.error_m) / std::log(fine.spent_s / coarse.spent_s);
    return std::isfinite(slope) ? std::clamp(slope, kLeastSlope, kMostSlope) : kUsualOrder;
  }

  const scene::Scene& scene_;
  const CostTruth& truth_;
  engines::LadderWords words_;
  double budget_;
  engines::CostOptions options_;
  double until_;
};

/// Whether one of a scene's numbers shows how nearly right a run is: a gap that must not be negative is kept to or not.
bool allows_something(const scene::Scene& scene) {
  return std::any_of(scene.checks.begin(), scene.checks.end(), [](const scene::CheckSpec& check) { return check.tolerance > 0.0; });
}

report::CostPage page_of(const Context& context, const std::vector<Ladder>& ladders, const CostTruth& truth, const CostSubject& subject) {
  report::CostPage page;
  page.title = subject.title;
  page.about = subject.scene.about;
  page.truth = truth.what;
  page.what_error_is = what_error_is(truth);
  if (truth.by_numbers) {
    page.error_name = "worst number over what is allowed";
    page.error_unit.clear();
    page.marks = allows_something(subject.scene) ? kSharesAllowed : std::vector<double>{1.0};
  }
  page.floor = truth.floor_m;
  page.scale = truth.scale_m;
  page.record = record_of(context, subject.scene);
  const double price = middle_price(ladders, truth);
  for (const Ladder& ladder : ladders) page.curves.push_back(curve_of(ladder, truth, price, is_smooth(subject.scene)));
  page.readings = verdicts(page);
  if (truth.by_numbers && !allows_something(subject.scene))
    page.readings.push_back("The scene's numbers allow nothing at all, so a run keeps to them or does not: nothing here tells how accurate one is, only which runs are right and what these cost.");
  if (truth.by_numbers) page.readings.push_back("Judged by the scene's own numbers, for there is no truth to compare places with: " + truth.why_by_numbers + ".");
  else if (truth.duration_s < (1.0 - 1e-9) * truth.asked_s)
    page.readings.push_back(fmt::format("Looked at are the first {:.3g} s of {:.3g} s: {}.", truth.duration_s, truth.asked_s, truth.shortened_by));
  if (!subject.note.empty()) page.readings.push_back(subject.note);
  return page;
}

struct SizedWords {
  CostWords words;
  std::optional<int> usual_n;   // where the scene's usual size was too large
};

/// A scene whose size is a parameter gets a size of which a run fits into the budget many times, unless one was asked for.
SizedWords with_size_that_fits(const Context& context, CostWords words, engines::CostOptions options) {
  const scene::SizedScene* sized = scene::sized_scene_named(words.scene);
  if (sized == nullptr || words.n || std::filesystem::is_regular_file(words.scene)) return {words, std::nullopt};
  options.runs = 1;
  options.most_of_rung_s = std::max(kLeastProbe, kProbe * words.budget());
  options.duration_s = words.duration_s;
  for (int n = sized->default_n;; n = std::max(1, n / kSmaller)) {
    words.n = n;
    const CostSubject subject = find_subject(context, words);
    const CostTruth whole = engines::by_numbers(subject.scene, options, "");
    fmt::print(stderr, "tumble: {} with n = {}: whether a run of it fits into {:.3g} s\n", words.scene, n, options.most_of_rung_s);
    const CostWay way = engines::goes_in_closed_form(subject.scene) ? way_by_engine("ca", subject.truth_laws, true) : way_by_method(method_named("rk4"), subject.truth_laws);
    if (n > 1 && !engines::run_rung(subject.scene, way, whole, 1, kUnset, options).stopped_by.empty()) continue;
    return {words, n == sized->default_n ? std::nullopt : std::optional<int>(sized->default_n)};
  }
}

}  // namespace

const report::CostCurve* cheapest_curve(const report::CostPage& page, double mark) {
  const report::CostCurve* best = nullptr;
  for (const report::CostCurve& curve : page.curves) {
    const report::CostPoint* point = report::cheapest(curve, mark);
    if (point != nullptr && (best == nullptr || point->cpu_s < report::cheapest(*best, mark)->cpu_s)) best = &curve;
  }
  return best;
}

std::vector<std::string> verdicts(const report::CostPage& page) {
  std::vector<std::string> words;
  for (const double mark : page.marks) {
    const report::CostCurve* best = cheapest_curve(page, mark);
    if (best == nullptr) words.push_back(fmt::format("{}: nothing here gets there.", report::mark_in_words(page, mark)));
    else words.push_back(fmt::format("{} costs {} at least: {}, {}.", report::mark_in_words(page, mark), report::price_of(report::cheapest(*best, mark)->cpu_s), best->name, report::cheapest(*best, mark)->fineness));
  }
  return words;
}

void check_with_files(const Context& context, const scene::Scene& scene, const Laws& laws, CostTruth& truth) {
  const std::filesystem::path folder = context.root / "tests" / "truths";
  if (!std::filesystem::is_directory(folder)) return;
  for (const auto& file : find_truths(folder)) {
    const truths::Case known = read_truth(file);
    engines::check_truth(scene, laws, truths::known_places(scene, known), "tests/truths/" + file.filename().string(), truth);
  }
}

MeasuredCost measure_cost(const Context& context, const CostWords& asked) {
  asked.steps_s();   // refused before anything is run
  engines::CostOptions options;
  options.timewarp = engines::fast_timewarp();
  options.told = [](const std::string& what) { fmt::print(stderr, "tumble: {}\n", what); };
  options.most_of_search_s = std::clamp(kSearch * asked.budget(), kLeastSearch, options.most_of_search_s);
  const auto [words, usual_n] = with_size_that_fits(context, asked, options);
  CostSubject subject = find_subject(context, words);
  options.duration_s = words.duration_s ? words.duration_s : subject.duration_s;
  if (!options.duration_s && !subject.scene.checks.empty()) options.least_share = kWorthATruth;
  std::string why;
  const std::optional<CostTruth> found = engines::try_truth(subject.scene, subject.truth_laws, options, why);
  if (!found && subject.scene.checks.empty()) throw UserError(subject.scene.name, "there is no truth to compare with (" + why + "), and the scene has no numbers to be judged by", "Give it \"checks\", or a shorter --duration-s.");
  CostTruth truth = found ? *found : engines::by_numbers(subject.scene, options, why);
  if (!found) fmt::print(stderr, "tumble: no truth ({}): runs are judged by the scene's numbers\n", why);
  if (found) check_with_files(context, subject.scene, subject.truth_laws, truth);
  if (truth.by_numbers || subject.scene.contact)   // there the method of integration hardly matters: the usual one comes first
    std::stable_partition(subject.ways.begin(), subject.ways.end(), [](const CostWay& way) { return way.word == "rk4"; });
  Ladders all(subject, truth, words, options);
  all.run();
  const std::vector<Ladder>& ladders = all.ladders;
  MeasuredCost measured;
  measured.page = page_of(context, ladders, truth, subject);
  measured.page.not_run = subject.not_run;
  measured.page.not_run.insert(measured.page.not_run.end(), all.not_run.begin(), all.not_run.end());
  if (usual_n) {
    measured.size = fmt::format("n = {}", *words.n);
    measured.page.title += ", " + measured.size;
    measured.page.readings.push_back(fmt::format("Looked at with n = {}: at its usual size, {}, one run takes longer than {:.3g} s here. Ask for it with --n {} and a larger --budget-s.", *words.n, *usual_n, std::max(kLeastProbe, kProbe * words.budget()), *usual_n));
  }
  if (truth.by_numbers) measured.against = fmt::format("judged by its numbers, over {:.3g} s: the worst of them over what it is allowed [-]", truth.duration_s);
  else measured.against = fmt::format("error: against {}: {:.1e} m, over {:.3g} s", truth.what, truth.floor_m, truth.duration_s);
  measured.duration_s = truth.duration_s;
  measured.asked_s = truth.asked_s;
  const auto unwritten = [](const Ladder& ladder) { return !ladder.rungs.empty() && ladder.rungs.back().not_attempted; };
  measured.not_attempted = std::any_of(ladders.begin(), ladders.end(), unwritten);
  return measured;
}

}  // namespace tumble::cli
