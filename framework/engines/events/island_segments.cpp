#include "framework/engines/events/passages.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/step_limits.h"

namespace tumble::engines {
namespace {

constexpr double kNoPartOfStep = 1e-9;         // of the step: a shorter rest of it is taken with the next one

}  // namespace

Passages::Passages(const World& whole, ShapeOf shape_of, const Laws& laws, ProcessRules rules)
    : whole_(whole), entries_(whole), shape_of_(std::move(shape_of)), laws_(laws), rules_(rules) {
  if (!whole_.contact) return;
  for (int i = 0; i < static_cast<int>(whole_.bodies.size()); ++i)
    if (whole_.bodies[i].immovable() && whole_.bodies[i].collides) obstacles_.push_back(i);
}

// ---- Small worlds ----------------------------------------------------------------------------------------------------------

// Only a set of members that is asked about by one thread alone has a machine that stands still: none is thrown away while threads share them.
Passages::Machine& Passages::machine_of(const std::vector<int>& members, int still) {
  Machine* machine = nullptr;
  {
    const std::lock_guard lock(mutex_);
    const auto known = machines_.find({members, still});
    if (known != machines_.end() && known->second.world) return known->second;
    if (machines_.size() > clear_at_ && !is_shared_) {
      std::erase_if(machines_, [this](const auto& old) {
        if (old.second.users > 0) return false;
        past_.add(old.second.counters);
        return true;
      });
      clear_at_ = std::max(kMachines, 2 * machines_.size());   // where most are in use, looking at all for each new one would take its square
    }
    machine = &machines_[{members, still}];
  }
  std::vector<int> immovable = obstacles_;
  if (still >= 0) immovable.push_back(still);
  machine->world = std::make_unique<ProcessWorld>(whole_, entries_, shape_of_, laws_, rules_, machine->counters, members, immovable);
  return *machine;
}

void Passages::add_counts_to(RunCounters& counters) const {
  counters.add(past_);
  counters.passages_begun += begun_;
  counters.passages_let_go += let_go_;
  for (const auto& [members, machine] : machines_) counters.add(machine.counters);
}

ProcessWorld& Passages::world_of(const std::vector<int>& members, int still) { return *machine_of(members, still).world; }

// ---- Passages --------------------------------------------------------------------------------------------------------------

int Passages::begin(const ProcessState& state) {
  auto passage = std::make_unique<Passage>();
  passage->machine = &machine_of(state.members, -1);
  passage->start.emplace(state.without_memory());
  passage->front.emplace(state);
  passage->holders = static_cast<int>(state.members.size());
  const std::lock_guard lock(mutex_);
  ++passage->machine->users;
  ++begun_;
  const int number = passages_.take();
  passages_[number] = std::move(passage);
  return number;
}

void Passages::release(int number) {
  const std::lock_guard lock(mutex_);
  Passage& passage = at(number);
  if (--passage.holders > 0) return;
  kept_ -= passage.steps.size();
  --passage.machine->users;
  ++let_go_;
  passages_.give_back(number);
}

void Passages::forget_before(double t) { forgotten_ = t; }

std::size_t Passages::place(int passage, int body) const {
  const std::vector<int>& members = at(passage).start->members;
  return static_cast<std::size_t>(std::lower_bound(members.begin(), members.end(), body) - members.begin());
}

std::string Passages::names(const std::vector<int>& members) const {
  return fmt::format("body '{}'{}", whole_.bodies[static_cast<std::size_t>(members.front())].name, members.size() > 1 ? " and what moves with it" : "");
}

void Passages::take_step(Passage& passage) {
  // Steps end on a grid that all processes share, as frames do: bodies in contact fit each other's surfaces where steps end.
  const double now = passage.front->time, due = (std::floor((now + kNoPartOfStep * rules_.step) / rules_.step) + 1) * rules_.step;
  ProcessWorld::Outcome outcome = naming(fmt::format("at t = {:.6f} s, {}", now, names(passage.start->members)), [&] { return passage.machine->world->step(*passage.front, due); });
  passage.idle = outcome.step.end > now ? 0 : passage.idle + 1;
  if (passage.idle > kMostIdleSteps) throw StoppedRun(fmt::format("at t = {:.6f} s, {}: time stands still, its bodies meet again and again", now, names(passage.start->members)));
  while (passage.steps.size() > 1 && passage.steps.front().end < forgotten_ - 2 * rules_.step) {
    passage.steps.pop_front();
    --kept_;
  }
  passage.steps.push_back(std::move(outcome.step));
  ++kept_;
  const bool is_one = passage.start->near.empty() || !falls_apart_(outcome.after);
  if (outcome.events.empty() && is_one) passage.front.emplace(std::move(outcome.after));
  else passage.end.emplace(PassageEnd{passage.steps.back().end, std::move(outcome.after), std::move(outcome.events)});
}

// Until a step goes beyond t: what holds at the end of one step is what the next one begins with.
void Passages::reach(int number, double t) {
  Passage& passage = at(number);
  while (!passage.end && !(passage.front->time > t)) take_step(passage);
}

const PassageEnd* Passages::end_by(int number, double to) {
  reach(number, to);
  const Passage& passage = at(number);
  return passage.end && passage.end->time <= to ? &*passage.end : nullptr;
}

const ProcessStep& Passages::step_at(int number, double t) {
  reach(number, t);
  const std::deque<ProcessStep>& steps = at(number).steps;
  std::size_t k = steps.size() - 1;
  while (k > 0 && steps[k].from.time > t) --k;
  return steps[k];
}

double Passages::step_end(int number, double t) { return std::max(t, step_at(number, t).end); }

RigidBodyState Passages::body_state(int passage, int body, double t) { return step_at(passage, t).state_at(place(passage, body), t); }

collision::MotionState Passages::motion_at(int passage, int body, double t) { return step_at(passage, t).motion_at(place(passage, body), t, whole_.bodies[static_cast<std::size_t>(body)].inertia); }

ProcessState Passages::state_at(int number, double t) {
  const ProcessStep& step = step_at(number, t);
  ProcessState state(step.from);
  if (t == step.from.time) return state;
  state.time = t;
  for (std::size_t k = 0; k < state.members.size(); ++k) state.states[k] = step.state_at(k, t);
  return state;
}

std::vector<RigidBodyState> Passages::shown_at(int number, double t) {
  const ProcessStep& step = step_at(number, t);
  const ProcessState state = state_at(number, t);
  return t > step.from.time && t < step.end ? at(number).machine->world->shown(state).states : state.states;
}

collision::Motion Passages::motion_in_step(int number, int body, double low) {
  const ProcessStep& step = step_at(number, low);
  const std::size_t member = place(number, body);
  const Inertia* inertia = &whole_.bodies[static_cast<std::size_t>(body)].inertia;
  return {[&step, member, inertia](double t) { return step.motion_at(member, t, *inertia); }, step.paths.empty() ? collision::MotionBounds{} : step.paths[member].bounds()};
}

}  // namespace tumble::engines
