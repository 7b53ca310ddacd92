#include "framework/engines/base/run_watch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include <fmt/format.h>

namespace tumble::engines {
namespace {

/// What a kind is called, and what a reader is to know of it.
struct Words {
  const char *kind, *meaning, *remedy;
};

const Words& words_of(RunWatch::Kind kind) {
  static const Words kWords[] = {
      {"link_open",
       "rods and joints hold together: farther apart than this part of their size they are another "
       "mechanism",
       "masses that differ less"},
      {"projection_open",
       "the correction onto rods and joints ends on them: here it did not, and what follows is of "
       "another mechanism",
       "masses that differ less; or, in a loop, more digits in \"point_m\" and \"axis\": joints "
       "that "
       "contradict each other cannot all be closed"},
      {"contact_unsolved",
       "impulses of contacts keep bodies apart and within friction: here none were found that do, "
       "by this part of the speed",
       "less friction where there is any, or masses that differ less"},
      {"energy_rises",
       "beside what forces and motors bring in, energy cannot rise: the steps have made this part "
       "of the energy that the scene has",
       "a method that chooses its steps (--method fehlberg78 --tolerance 1e-8)"},
      {"energy_lost",
       "nothing takes energy from these bodies but what has been counted: the rest is lost by the "
       "step",
       ""},
      {"turn_unresolved",
       "beyond half a turn a step cannot be told from a turn the other way round: orientations, "
       "and what hangs on them, are not to be trusted",
       "a slower body, or --propagator auto where nothing but gravity acts on it"},
      {"turns_wrong",
       "without a torque the angular momentum stays, and tells how the body turns: its steps have "
       "turned it wrong by this angle [rad]",
       "--propagator auto where nothing but gravity acts on it, or --engine ordered: both turn it "
       "in closed form"},
      {"overlap_left",
       "bodies stay apart: here the corrections of their places have ended with an overlap of this "
       "part of the smaller one's radius",
       "more room between what drives or presses them together, or masses that differ less"},
  };
  return kWords[static_cast<std::size_t>(kind)];
}

// Of the step that went wrong, what the size of the error asks for: energy is off by a power of the
// step (Size::order), of other errors half a step is the first to try.
double likely_part(RunWatch::Kind kind, double times_what_is_allowed, double order) {
  constexpr double kSafety = 0.8, kLeast = 0.01, kMost = 0.5;
  // a radian a step
  if (kind == RunWatch::Kind::kTurnUnresolved) return 1.0 / (kTurnResolved * times_what_is_allowed);
  if (kind != RunWatch::Kind::kEnergyRises && kind != RunWatch::Kind::kEnergyLost &&
      kind != RunWatch::Kind::kTurnsWrong)
    return kMost;
  return std::min(kMost, std::max(kLeast, kSafety * std::pow(times_what_is_allowed, -1.0 / order)));
}

bool is_worse(double candidate, double known) {
  return std::isnan(candidate) ? !std::isnan(known) : candidate > known;
}

}  // namespace

void RunWatch::note(Kind kind, const std::string& subject, const Size& size) {
  if (size.found <= size.allowed) return;  // never true of NaN, which is noted
  const auto [found, is_new] = incidents_.try_emplace(kind, Incident{size, size, subject, {}, 0});
  Incident& incident = found->second;
  ++incident.count;
  incident.subjects.insert(subject);
  if (size.time < incident.first.time) incident.first = size;
  if (is_new || !is_worse(size.found / size.allowed, incident.worst.found / incident.worst.allowed))
    return;
  incident.worst = size;
  incident.worst_subject = subject;
}

void RunWatch::say(const std::string& subject, double time, const std::string& words) {
  const auto [known, is_new] = notices_.try_emplace(subject, time, words);
  if (!is_new && time < known->second.first) known->second = {time, words};
}

bool RunWatch::has_said(const std::string& subject, double t) const {
  const auto known = notices_.find(subject);
  return known != notices_.end() && known->second.first <= t;
}

void RunWatch::add(const RunWatch& other) {
  if (std::isnan(named_step_)) named_step_ = other.named_step_;
  large_island_at_ = std::min(large_island_at_, other.large_island_at_);
  for (const auto& [subject, notice] : other.notices_) {
    const auto [known, is_new] = notices_.try_emplace(subject, notice);
    if (!is_new) known->second = std::min(known->second, notice);
  }
  for (const auto& [kind, theirs] : other.incidents_) {
    const auto [found, is_new] = incidents_.try_emplace(kind, theirs);
    if (is_new) continue;
    Incident& ours = found->second;
    ours.count += theirs.count;
    ours.subjects.insert(theirs.subjects.begin(), theirs.subjects.end());
    if (theirs.first.time < ours.first.time) ours.first = theirs.first;
    // Of two that are as bad, the earlier one, at one time the one whose name comes first, and of
    // one body the one of the shorter step or the lower order.
    const double candidate = theirs.worst.found / theirs.worst.allowed,
                 known = ours.worst.found / ours.worst.allowed;
    const auto place = [](const Incident& incident) {
      return std::tie(incident.worst.time, incident.worst_subject, incident.worst.step,
                      incident.worst.order, incident.worst.allowed);
    };
    const bool comes_first = place(theirs) < place(ours);
    if (!is_worse(candidate, known) && (is_worse(known, candidate) || !comes_first)) continue;
    ours.worst = theirs.worst;
    ours.worst_subject = theirs.worst_subject;
  }
}

void RunWatch::drop_after(double t) {
  std::erase_if(incidents_, [t](const auto& known) { return known.second.first.time > t; });
  std::erase_if(notices_, [t](const auto& known) { return known.second.first > t; });
  if (large_island_at_ > t) large_island_at_ = kInfinity;
}

void RunWatch::name_step(double step) { named_step_ = step; }

std::vector<RunFault> RunWatch::faults() const {
  std::vector<RunFault> faults;
  double step = std::numeric_limits<double>::infinity();
  for (const auto& [kind, incident] : incidents_) {
    const Size& worst = incident.worst;
    if (!std::isnan(worst.mending_step))
      step = std::min(step, worst.mending_step);
    else if (worst.step > 0)
      step =
          std::min(step, likely_part(kind, worst.found / worst.allowed, worst.order) * worst.step);
  }
  // A criterion of stability that the step breaks explains all that follows, and its step is
  // computed, not a guess from a size.
  if (std::isfinite(named_step_)) step = named_step_;
  // what goes wrong in the last rounding of a time is mended by no step
  constexpr double kShortestNamed = 1e-7;  // [s]
  if (step < kShortestNamed) step = std::numeric_limits<double>::infinity();
  const std::string said =
      std::isfinite(named_step_) ? fmt::format("{:.4g}", step) : fmt::format("{:.2g}", step);
  for (const auto& [kind, incident] : incidents_) {
    const Words& words = words_of(kind);
    RunFault fault;
    fault.kind = words.kind;
    fault.subject = incident.worst_subject;
    if (incident.subjects.size() > 1)
      fault.subject += fmt::format(" (and {} more)", incident.subjects.size() - 1);
    fault.worst = incident.worst.found;
    fault.allowed = incident.worst.allowed;
    fault.first_s = incident.first.time;
    fault.worst_s = incident.worst.time;
    fault.count = incident.count;
    fault.meaning = incident.worst.meaning.empty() ? words.meaning : incident.worst.meaning;
    if (!std::isnan(incident.worst.whole))
      fault.meaning +=
          fmt::format(": {:.3g} J of the {:.3g} J that moved, were stored or came down",
                      incident.worst.found * incident.worst.whole, incident.worst.whole);
    const std::string remedy = incident.worst.remedy.empty() ? words.remedy : incident.worst.remedy;
    fault.remedy = remedy.empty() ? "another method, or another scene: no step helps" : remedy;
    if (std::isfinite(step))
      fault.remedy =
          fmt::format("{}a step of at most {} s (\"step_s\"){}{}", incident.worst.first_remedy,
                      said, remedy.empty() ? "" : ", or ", remedy);
    // there no method is of a higher order than the impulses of a step
    if (kind == Kind::kEnergyRises && incident.worst.order < kOrderOfMethods)
      fault.remedy +=
          ", which helps away from contacts only: at contacts the error goes with the "
          "step itself, whatever the method";
    faults.push_back(std::move(fault));
  }
  return faults;
}

std::vector<std::string> RunWatch::notices() const {
  std::vector<std::pair<double, std::string>> in_order;
  for (const auto& [subject, notice] : notices_) in_order.push_back(notice);
  std::sort(in_order.begin(), in_order.end());
  std::vector<std::string> words;
  for (const auto& [time, said] : in_order) words.push_back(said);
  return words;
}

std::string names_of(const World& world, const std::vector<int>& bodies) {
  constexpr std::size_t kMost = 3;
  std::string names;
  for (std::size_t k = 0; k < std::min(kMost, bodies.size()); ++k) {
    const bool is_last = k + 1 == bodies.size();
    names += fmt::format("{}'{}'",
                         k == 0    ? ""
                         : is_last ? " and "
                                   : ", ",
                         world.bodies[static_cast<std::size_t>(bodies[k])].name);
  }
  if (bodies.size() > kMost) names += fmt::format(" and {} more", bodies.size() - kMost);
  return names;
}

}  // namespace tumble::engines
