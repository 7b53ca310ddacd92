// Sentences about the work of a scheduler. They name a cause only where the counts show it.
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "framework/core/text.h"
#include "framework/cost/scheduler_work.h"

namespace tumble::cost {
namespace {

using Kind = SchedulerReading::Kind;

// At the head of a sentence: "The reference scheduler".
std::string subject_of(const SchedulerCurve& curve) {
  return curve.name.starts_with("reference ") ? "The " + curve.name : curve.name;
}

// times the reference: the variation of correct orders of execution
constexpr double kAlike = 1.25;
// bodies rolled back per impact: two take part in one, and sometimes another impact had affected
// them
constexpr double kOfOne = 2.5;
constexpr double kWorthAWord = 1e-3;  // of the events: smaller fractions are not reported

/// Counts over the runs that are right, both of the scheduler and of the reference.
struct Sum {
  double events = 0.0, integrations = 0.0, undone = 0.0, rollbacks = 0.0, impacts = 0.0,
         checks = 0.0, states = 0.0, processes = 0.0;
  void add(const SchedulerRun& run) {
    events += static_cast<double>(run.committed);
    integrations += static_cast<double>(run.integrations);
    undone += static_cast<double>(run.undone);
    rollbacks += static_cast<double>(run.rollbacks);
    impacts += static_cast<double>(run.impacts);
    checks += static_cast<double>(run.checks);
    states += static_cast<double>(run.states_kept);
    processes += static_cast<double>(run.processes);
  }
};

std::string in_words(const SchedulerRun& run) {
  return run.n > 0 ? fmt::format("{} processes", run.processes)
                   : fmt::format("steps of {} s", step_in_words(run.step_s));
}

const SchedulerRun* same_run(const SchedulerRun& run, const SchedulerCurve& reference) {
  for (const auto* refinement : {&reference.by_step, &reference.by_size})
    for (const SchedulerRun& other : *refinement)
      if (other.n == run.n && other.step_s == run.step_s && other.due == run.due) return &other;
  return nullptr;
}

double ratio(double a, double b) {
  return b > 0.0 ? a / b : a > 0.0 ? std::numeric_limits<double>::infinity() : 1.0;
}

std::string times(double ratio) {
  return ratio < 9.95 ? fmt::format("{:.1f} times", ratio) : fmt::format("{:.0f} times", ratio);
}

/// The cause of unnecessary rollbacks.
std::string why_undone(const Sum& own, const Sum& right) {
  std::string why;
  const double sent = own.rollbacks / own.impacts, sent_right = right.rollbacks / right.impacts;
  const double depth = ratio(own.undone, own.rollbacks),
               depth_right = ratio(right.undone, right.rollbacks);
  const double tries = own.impacts / own.events, tries_right = right.impacts / right.events;
  if (sent > kAlike * sent_right)
    why += fmt::format(
        " For each impact that it executes it rolls back {:.1f} bodies where {:.1f} suffice: "
        "bodies that the collision did not touch.",
        sent, sent_right);
  if (depth > kAlike * depth_right)
    why += fmt::format(
        " A rollback costs {:.1f} integrations where {:.1f} suffice: it goes further back than to "
        "the impact.",
        depth, depth_right);
  if (tries > kAlike * tries_right)
    why += fmt::format(
        " It executes {:.1f} impacts for each that it commits, where {:.1f} suffice: right ones "
        "are rolled back and repeated.",
        tries, tries_right);
  return why;
}

std::vector<SchedulerReading> beside(const Sum& own, const Sum& right) {
  std::vector<SchedulerReading> readings;
  if (own.undone > kAlike * right.undone + kWorthAWord * own.events) {
    const std::string much =
        right.undone > 0.0 ? times(own.undone / right.undone) + " what the reference rolls back"
                           : "what the reference does not roll back";
    readings.push_back(
        {fmt::format("It rolls back {}: {:.2f} integrations per event, where {:.2f} suffice.{}",
                     much, own.undone / own.events, right.undone / right.events,
                     why_undone(own, right)),
         Kind::kWasteful});
  }
  if (own.checks > kAlike * right.checks)
    readings.push_back(
        {fmt::format("It checks its pairs {} as often as the reference: {:.1f} checks per event, "
                     "where {:.1f} suffice. A check returns sooner than its bodies could meet "
                     "(next_check_time), or repeats an interval.",
                     times(ratio(own.checks, right.checks)), own.checks / own.events,
                     right.checks / right.events),
         Kind::kWasteful});
  if (own.states > kAlike * right.states)
    readings.push_back(
        {fmt::format(
             "It keeps {} as many states as the reference: {:.1f} per body at its fullest, where "
             "{:.1f} suffice. States before global virtual time are not discarded "
             "(states_to_purge), or global virtual time lags.",
             times(ratio(own.states, right.states)), own.states / own.processes,
             right.states / right.processes),
         Kind::kWasteful});
  if (readings.empty())
    readings.push_back(
        {fmt::format("It pays what the reference pays: {:.2f} integrations per event, of which "
                     "{:.2f} are rolled back (reference: {:.2f} and {:.2f}).",
                     own.integrations / own.events, own.undone / own.events,
                     right.integrations / right.events, right.undone / right.events),
         Kind::kRight});
  return readings;
}

std::vector<SchedulerReading> alone(const Sum& own) {
  const double sent = own.rollbacks / own.impacts;
  const std::string pays = fmt::format(
      "It pays {:.2f} integrations per event, rolls back {:.2f} of them, checks pairs {:.1f} times "
      "and keeps {:.1f} states per body at its fullest.",
      own.integrations / own.events, own.undone / own.events, own.checks / own.events,
      own.states / own.processes);
  if (sent > kOfOne)
    return {
        {fmt::format("{} For each impact that it executes it rolls back {:.1f} bodies: two take "
                     "part in one, so most of these are bodies that the collision did not touch.",
                     pays, sent),
         Kind::kWasteful}};
  return {
      {fmt::format(
           "{} For each impact that it executes it rolls back {:.1f} bodies; two take part in one.",
           pays, sent),
       Kind::kRight}};
}

/// The result over all runs.
SchedulerReading of_trace(const SchedulerCurve& curve) {
  const SchedulerRun* wrong = nullptr;
  std::size_t right = 0, runs = 0, events = 0;
  for (const auto* refinement : {&curve.by_step, &curve.by_size})
    for (const SchedulerRun& run : *refinement) {
      ++runs;
      right += run.is_right() ? 1 : 0;
      events += run.committed;
      if (!run.is_right() && (wrong == nullptr || (wrong->not_attempted && !run.not_attempted)))
        wrong = &run;
    }
  if (runs == 0) return {fmt::format("{} was not run.", subject_of(curve)), Kind::kWrong};
  if (wrong == nullptr) {
    const char* however =
        curve.by_size.empty() ? "for any step" : "for any step and any number of processes";
    return {fmt::format("{} commits what the ordered reference commits, {}: {} events in {} runs, "
                        "to the last bit.",
                        subject_of(curve), however, events, runs),
            Kind::kRight};
  }
  if (wrong->not_attempted)
    return {fmt::format("{}: {}.", subject_of(curve), wrong->stopped_by), Kind::kNotWritten};
  const std::string rest = right == 0 ? "in no run" : fmt::format("in {} of {} runs", right, runs);
  return {fmt::format("{} commits what the ordered reference commits {}. With {} it commits {} of "
                      "{} events: {}",
                      subject_of(curve), rest, in_words(*wrong), wrong->committed, wrong->due,
                      wrong->stopped_by),
          Kind::kWrong};
}

}  // namespace

std::vector<SchedulerReading> read_scheduler(const SchedulerCurve& curve,
                                             const SchedulerCurve* reference) {
  std::vector<SchedulerReading> readings{of_trace(curve)};
  Sum own, right;
  for (const auto* refinement : {&curve.by_step, &curve.by_size})
    for (const SchedulerRun& run : *refinement) {
      const SchedulerRun* other = reference == nullptr ? nullptr : same_run(run, *reference);
      if (!run.is_right() || run.impacts == 0 ||
          (reference != nullptr && (other == nullptr || !other->is_right())))
        continue;
      own.add(run);
      if (other != nullptr) right.add(*other);
    }
  if (own.events == 0.0) return readings;
  for (SchedulerReading& reading : reference == nullptr ? alone(own) : beside(own, right))
    readings.push_back(std::move(reading));
  return readings;
}

}  // namespace tumble::cost
