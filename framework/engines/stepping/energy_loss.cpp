#include "framework/engines/stepping/energy_loss.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "framework/effects/registry.h"
#include "framework/engines/base/run_watch.h"
#include "framework/engines/base/tolerances.h"

namespace tumble::engines {
namespace {

/// At most what is taken in a step at whose ends it is taken at these rates. Of a swing that turns
/// by a radian a step the mean of v^2 is up to 1.2 times that at both ends; of a fall or a decay it
/// lies between the two.
double taken_at_most(double passed, double power_before, double power) {
  constexpr double kMean = 1.25;
  return passed * (kMean * std::max(power_before, power) + std::abs(power - power_before));
}

bool moves_alike(const scene::PrescribedMotion& a, const scene::PrescribedMotion& b) {
  return a.velocity_m_s == b.velocity_m_s && a.amplitude_m == b.amplitude_m &&
         (a.amplitude_m.isZero(0.0) || a.angular_frequency_rad_s == b.angular_frequency_rad_s);
}

}  // namespace

void EnergyLoss::note(const Event& event) {
  if (event.kind == EventKind::kForceOn || event.kind == EventKind::kForceOff) return;
  note_touch(event.body_a, event.body_b);
  // it stays where its support goes
  if (event.kind == EventKind::kRest) resting_.insert(resting_.end(), {event.body_a, event.body_b});
}

EnergyLoss::Seen EnergyLoss::seen_from(const WorldBody& frame, double time) {
  Seen seen;
  if (!is_driven(frame.motion)) return seen;
  seen.displacement = prescribed_position(frame, time) - frame.com_at_0_world;
  seen.velocity = prescribed_velocity(frame, time);
  const double w = frame.motion.angular_frequency_rad_s;
  if (w != 0.0) seen.acceleration = -w * w * (seen.displacement - frame.motion.velocity_m_s * time);
  return seen;
}

/// What inertial forces do between two looks: -m a dx of a part's centre of mass, exact where a
/// stays; besides, at most what a differs by from the mean of both ends along the way.
effects::Work EnergyLoss::inertial_work(const Seen& before, const Seen& after, double passed) {
  constexpr double kMean = 1.25;  // of momenta between two looks: as in taken_at_most
  effects::Work work;
  work.done =
      -0.5 *
      (before.acceleration + after.acceleration).dot(after.first_moment - before.first_moment);
  work.most = kMean * passed * std::max(before.momentum.norm(), after.momentum.norm()) *
              (after.acceleration - before.acceleration).norm();
  return work;
}

EnergyLoss::Part* EnergyLoss::part_with(int body) {
  const int part = body < 0 ? -1 : part_of_[static_cast<std::size_t>(body)];
  return part < 0 ? nullptr : &parts_[static_cast<std::size_t>(part)];
}

// Of all these bodies, one heap from now on.
EnergyLoss::Heap& EnergyLoss::heap_of(const std::vector<int>& bodies) {
  const int first = met_.find(bodies.front());
  const bool is_one =
      std::all_of(bodies.begin(), bodies.end(), [&](int body) { return met_.find(body) == first; });
  const auto known = heaps_.find(first);
  if (is_one && known != heaps_.end()) return known->second;
  std::set<int> leaders;
  for (const int body : bodies) leaders.insert(met_.find(body));
  Heap all;
  for (const int leader : leaders) {
    met_.unite(leader, first);
    const auto found = heaps_.find(leader);
    if (found == heaps_.end()) {
      all.bodies.push_back(leader);
      continue;
    }
    const Heap& heap = found->second;
    all.bodies.insert(all.bodies.end(), heap.bodies.begin(), heap.bodies.end());
    all.made += heap.made;
    all.highest += heap.highest;
    all.losses.insert(all.losses.end(), heap.losses.begin(), heap.losses.end());
    heaps_.erase(found);
  }
  std::sort(all.bodies.begin(), all.bodies.end());
  return heaps_[met_.find(first)] = std::move(all);
}

void EnergyLoss::note_lost_at_contacts(const std::vector<int>& bodies, double energy) {
  Heap& heap = heap_of(bodies);
  heap.made -= energy;
  heap.highest = std::max(heap.highest, heap.made);
  heap.is_changed = true;
}

bool EnergyLoss::look_at_heaps(double time) {
  bool is_more = false;
  for (auto& [first, heap] : heaps_) {
    if (!std::exchange(heap.is_changed, false)) continue;
    std::vector<int>& parts = parts_of_heap_;
    parts.clear();
    for (const int body : heap.bodies) parts.push_back(part_of_[static_cast<std::size_t>(body)]);
    std::sort(parts.begin(), parts.end());
    parts.erase(std::unique(parts.begin(), parts.end()), parts.end());
    const auto part = [&](int k) -> const Part& { return parts_[static_cast<std::size_t>(k)]; };
    if (!std::all_of(parts.begin(), parts.end(), [&](int k) { return part(k).is_watched; }))
      continue;
    heap.whole = 0.0;
    for (const int k : parts) heap.whole += part(k).whole;
    const double lost = heap.highest - heap.made;
    if (!(lost > kEnergyLost * heap.whole) ||
        (!heap.losses.empty() && !(lost > kSeen * heap.losses.back().size)))
      continue;
    heap.losses.push_back({time, lost, false, false});
    is_more = true;
  }
  return is_more;
}

void EnergyLoss::begin(const World& world) {
  is_begun_ = true;
  for (auto& [first, heap] : heaps_)
    if (!heap.losses.empty()) former_heaps_.push_back(std::move(heap));
  heaps_.clear();
  met_ = DisjointSets(static_cast<int>(world.bodies.size()));
  left_out_ = 0;
  const auto moves = [&](int body) {
    return body >= 0 && !world.bodies[static_cast<std::size_t>(body)].immovable();
  };
  const auto motion_of = [&](int body) {
    return body < 0 ? scene::PrescribedMotion{}
                    : world.bodies[static_cast<std::size_t>(body)].motion;
  };
  const auto swings = [&](int body) {
    const scene::PrescribedMotion motion = motion_of(body);
    return is_driven(motion) && !motion.amplitude_m.isZero(0.0);
  };
  for (Part& part : parts_)
    if (!part.losses.empty()) former_.push_back(std::move(part));
  parts_.clear();

  DisjointSets linked(static_cast<int>(world.bodies.size()));
  struct Entry {
    const effects::Effect* effect;
    int entry, body;
    bool is_unknown;
    std::optional<int> frame;  // what is immovable among its bodies
  };
  std::vector<Entry> entries;
  for (const effects::Effect* effect : effects::all()) {
    const int count = effect->count_in(world);
    if (count == 0) continue;
    const auto meter = sees_switches_ ? nullptr : effect->work_meter(world);
    const bool needs_steps = meter && meter->needs_steps();
    for (int k = 0; k < count; ++k) {
      int first = -1;
      const bool takes_power = effect->takes(world, k) == effects::Takes::kPower;
      bool is_unknown = needs_steps || effect->takes(world, k) == effects::Takes::kUnknown;
      const std::vector<int> bodies = effect->bodies_of(world, k);
      // what names one body holds it by the world, or slows it down by what rests in it
      std::optional<int> frame;
      if (bodies.size() == 1) frame = kWorld;
      for (const int body : bodies) {
        if (!moves(body)) {
          is_unknown =
              is_unknown ||
              (!sees_switches_ && (swings(body) || (is_driven(motion_of(body)) && takes_power)));
          frame = body;
          continue;
        }
        if (first >= 0) linked.unite(first, body);
        first = first < 0 ? body : first;
      }
      if (first >= 0) entries.push_back({effect, k, first, is_unknown, frame});
    }
  }
  part_of_.assign(world.bodies.size(), -1);
  for (int body = 0; body < static_cast<int>(world.bodies.size()); ++body) {
    if (!moves(body)) continue;
    const auto leader = static_cast<std::size_t>(linked.find(body));
    if (part_of_[leader] < 0) {
      part_of_[leader] = static_cast<int>(parts_.size());
      parts_.emplace_back();
    }
    part_of_[static_cast<std::size_t>(body)] = part_of_[leader];
    parts_[static_cast<std::size_t>(part_of_[leader])].bodies.push_back(body);
  }
  for (const Entry& entry : entries) {
    const int part = part_of_[static_cast<std::size_t>(entry.body)];
    Part& its = parts_[static_cast<std::size_t>(part)];
    const bool is_torn =
        entry.frame && its.frame && !moves_alike(motion_of(*entry.frame), motion_of(*its.frame));
    if (entry.frame) its.frame = entry.frame;
    if (entry.is_unknown || is_torn)
      its.is_watched = false;
    else if (entry.effect->takes(world, entry.entry) == effects::Takes::kPower)
      its.takers.push_back({entry.effect, entry.entry});
  }
}

double EnergyLoss::power_of(const Part& part, const World& world,
                            const std::vector<RigidBodyState>& states) {
  double power = 0.0;
  for (const Taker& taker : part.takers)
    power += taker.effect->power_taken(world, states, taker.entry);
  return power;
}

// What is taken up to this instant, at most.
void EnergyLoss::take(Part& part, double time, double power) {
  const double power_before = std::exchange(part.power, power),
               before = std::exchange(part.power_at, time);
  if (power_before > 0.0 || (power > 0.0 && !std::isnan(before)))
    part.taken += taken_at_most(time - before, power_before, power);
}

bool EnergyLoss::look(double time, const World& world, const std::vector<RigidBodyState>& states,
                      const EnergyByBody& energy, const std::vector<effects::Work>& brought,
                      const PassSteps& pass_steps) {
  if (!is_begun_) begin(world);
  bool is_more = false;
  const double passed = time - last_look_;
  for (; left_out_ < resting_.size(); ++left_out_)
    if (Part* part = part_with(resting_[left_out_])) part->is_watched = false;
  for (const int body : touched_)
    if (Part* part = part_with(body)) part->is_touched = true;
  touched_.clear();
  for (const int body : fell_asleep_)
    if (Part* part = part_with(body)) part->fell_asleep = true;
  fell_asleep_.clear();
  for (Part& part : parts_) {
    if (!part.is_watched) continue;
    double at_work = 0.0, height = 0.0;
    effects::Work work;
    Seen seen;
    if (part.frame.value_or(kWorld) >= 0)
      seen = seen_from(world.bodies[static_cast<std::size_t>(*part.frame)], time);
    for (const int body : part.bodies) {
      const auto i = static_cast<std::size_t>(body);
      at_work += energy.at_work[i];
      height += energy.height[i];
      const double mass = world.bodies[i].inertia.mass;
      at_work +=
          0.5 * mass * seen.velocity.squaredNorm() - seen.velocity.dot(states[i].momentum_world);
      if (world.gravity_world) height += mass * world.gravity_world->dot(seen.displacement);
      seen.first_moment += mass * (states[i].com_world - seen.displacement);
      seen.momentum += states[i].momentum_world - mass * seen.velocity;
      if (brought.empty()) continue;
      work.done += brought[i].done;
      work.most += brought[i].most;
    }
    const double all = at_work + height;
    if (!part.takers.empty()) {
      const double power = power_of(part, world, states);
      if (pass_steps &&
          part.energy - all >
              taken_at_most(time - part.power_at, part.power, power) + kEpsilon * part.whole &&
          !pass_steps(part.bodies.front()))
        part.is_touched = true;
      take(part, time, power);
    }
    const double taken = std::exchange(part.taken, 0.0);
    const double before = std::exchange(part.energy, all);
    const Seen seen_before = std::exchange(part.seen, seen);
    part.highest_place = std::max(part.highest_place, height);
    part.whole = std::max({part.whole, at_work, part.highest_place - height});
    const bool is_touched = std::exchange(part.is_touched, false) || std::isinf(work.most),
               fell_asleep = std::exchange(part.fell_asleep, false);
    if (std::isnan(before)) {  // the first look
      part.highest = part.least = all;
      continue;
    }
    if (is_touched) {
      part.offset -= all - before;
      part.offset_of_rises -= all - before;
      continue;
    }
    const double ledger_before = before + part.offset;
    const effects::Work inertial = inertial_work(seen_before, seen, passed);
    work.done += inertial.done;
    work.most += inertial.most;
    part.offset -= work.done - work.most;
    part.offset_of_rises -= work.done + work.most;
    part.offset += taken;
    part.least = std::min(part.least, all + part.offset_of_rises);
    if (const double rise = all + part.offset_of_rises - part.least; rise > part.rise) {
      if (rise > kEnergyRises * part.whole) {
        // the first that counts is told
        if (!(part.rise > kEnergyRises * part.whole)) part.risen_at = time;
        is_more = true;
      }
      part.rise = rise;
    }
    part.highest = std::max(part.highest, all + part.offset);
    part.largest_fall = std::max(part.largest_fall, ledger_before - (all + part.offset));
    const double lost = part.highest - (all + part.offset);
    if (!(lost > kEnergyLost * part.whole) ||
        (!part.losses.empty() && !(lost > kSeen * part.losses.back().size)))
      continue;
    part.losses.push_back({time, lost, part.largest_fall > 0.5 * lost, fell_asleep});
    is_more = true;
  }
  last_look_ = time;
  return look_at_heaps(time) || is_more;
}

std::vector<LostEnergy> EnergyLoss::losses(double rounding) const {
  std::vector<LostEnergy> found;
  for (const std::vector<Part>* parts : {&former_, &parts_})
    for (const Part& part : *parts) {
      for (const Loss& loss : part.losses) {
        // energy that swings, as that of symplectic methods does, is told of where it rises
        if (part.rise > kEnergyRises * part.whole && !(loss.size > 2.0 * part.rise)) continue;
        if (loss.size > kEnergyLost * part.whole + rounding)
          found.push_back({part.bodies, loss.size, part.whole, loss.time, last_look_,
                           loss.is_sudden, loss.is_by_sleep});
      }
    }
  const auto add = [&](const Heap& heap) {
    for (const Loss& loss : heap.losses)
      if (loss.size > kEnergyLost * heap.whole + rounding)
        found.push_back(
            {heap.bodies, loss.size, heap.whole, loss.time, last_look_, false, false, true});
  };
  for (const Heap& heap : former_heaps_) add(heap);
  for (const auto& [first, heap] : heaps_) add(heap);
  return found;
}

std::vector<RisenEnergy> EnergyLoss::rises(double rounding) const {
  std::vector<RisenEnergy> found;
  for (const Part& part : parts_)
    if (part.is_watched && part.rise > kEnergyRises * part.whole + rounding)
      found.push_back({part.bodies, part.rise, part.whole, part.risen_at});
  return found;
}

}  // namespace tumble::engines
