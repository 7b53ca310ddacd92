#include "framework/engines/stepping/energy_watch.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "framework/core/numbers.h"
#include "framework/engines/base/tolerances.h"
#include "framework/engines/stepping/linked_groups.h"
#include "framework/engines/stepping/loss_remedy.h"

namespace tumble::engines {
namespace {

// times all the energy there was to begin with: more has run away
constexpr double kRunaway = 10.0;

int body_with_most_energy(const World& world, const std::vector<RigidBodyState>& states) {
  int fastest = 0;
  double most = -1.0;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    if (world.bodies[i].immovable()) continue;
    const double kinetic = kinetic_energy(states[i], world.bodies[i].inertia);
    if (!(kinetic > most)) continue;
    most = kinetic;
    fastest = static_cast<int>(i);
  }
  return fastest;
}

// What moves, and what effects have stored. [J]
double energy_at_work(const EnergyByBody& energy) {
  return std::accumulate(energy.at_work.begin(), energy.at_work.end(), 0.0);
}

// What it brings in is not measured.
bool has_driven(const World& world) {
  return std::any_of(world.bodies.begin(), world.bodies.end(), [](const WorldBody& body) {
    return body.immovable() && is_driven(body.motion);
  });
}

// The terms that the energy is a sum of: what its rounding goes by. [J] A height is found from
// turned bodies and from places that rods and joints have drawn together: it is rounded as all
// coordinates are, however near to 0 it is.
double terms_of_energy(const World& world, const std::vector<RigidBodyState>& states,
                       double kinetic) {
  double terms = kinetic;
  if (world.gravity_world)
    for (std::size_t i = 0; i < world.bodies.size(); ++i)
      if (!world.bodies[i].immovable())
        terms +=
            world.bodies[i].inertia.mass * world.gravity_world->norm() * states[i].com_world.norm();
  for (const effects::Effect* effect : effects::all())
    effect->add_energy_terms(world, states, terms);
  return terms;
}

// Of a body at rest: m v^2 of the restitution threshold, and m g times its size. [J]
struct Unseen {
  double of_restitution_threshold, of_size;
};
Unseen unseen_of(const WorldBody& body, double gravity, double restitution_threshold) {
  // a perfectly inelastic body is separated at the restitution threshold, a box by each of its
  // corners
  constexpr double kCorners = 8.0;
  // of gyration [m]
  const double size =
      std::sqrt(0.5 * body.inertia.inertia_body.trace() * body.inertia.inverse_mass);
  return {kCorners * body.inertia.mass * restitution_threshold * restitution_threshold,
          body.inertia.mass * gravity * size};
}

// Of the bodies' sizes: how far what lies is lifted where it is kept apart. Contact margins are
// 1e-10 of the smaller body, those of large islands 1e-4.
constexpr double kLifted = 1e-5, kLiftedInLargeIslands = 1e-3;

}  // namespace

// What the world has to give: its kinetic energy, what its springs hold, and (available()) how far
// it falls.
void EnergyWatch::begin(const World& world, const EnergyByBody& energy) {
  first_energy_ = least_energy_ = energy.kinetic + energy.potential;
  lowest_potential_ = first_potential_ = energy.potential;
  scale_ = energy_at_work(energy);
  const double gravity = world.gravity_world ? world.gravity_world->norm() : 0.0;
  for (const WorldBody& body : world.bodies) {
    if (body.immovable()) continue;
    const Unseen of_body = unseen_of(body, gravity, restitution_threshold_);
    of_restitution_threshold_ += of_body.of_restitution_threshold;
    of_sizes_ += of_body.of_size;
  }
}

void EnergyWatch::note_rounding(double time, double kinetic, const World& world,
                                const std::vector<RigidBodyState>& states) {
  rounding_ = std::max(rounding_, kDeviations * kEpsilon * (1.0 + std::sqrt(time / step_)) *
                                      terms_of_energy(world, states, kinetic));
}

void EnergyWatch::note_rise(double time, double energy, double kinetic, const World& world,
                            const std::vector<RigidBodyState>& states) {
  const double rise = energy - least_energy_;
  least_energy_ = std::min(least_energy_, energy);
  if (!(rise > unseen(kLifted)) || (!rises_.empty() && !(rise > kSeen * rises_.back().size)))
    return;
  note_rounding(time, kinetic, world, states);
  const int body = body_with_most_energy(world, states);
  rises_.push_back({time, rise, body, is_at_contact(body, world)});
}

// A contact acts on all that rods, joints and springs link with its bodies. What has opened since
// the look before may have made the rise that is seen now.
bool EnergyWatch::is_at_contact(int body, const World& world) const {
  const auto touches = [&](int one) {
    return std::count(touching_.begin(), touching_.end(), one) +
               std::count(touching_before_.begin(), touching_before_.end(), one) >
           0;
  };
  if (touching_.empty() && touching_before_.empty()) return false;
  if (touches(body)) return true;
  const std::vector<LinkedGroup> groups = groups_of_linked_bodies(world);
  return std::any_of(groups.begin(), groups.end(), [&](const LinkedGroup& group) {
    return std::binary_search(group.bodies.begin(), group.bodies.end(), body) &&
           std::any_of(group.bodies.begin(), group.bodies.end(), touches);
  });
}

void EnergyWatch::tell(const World& world, const Laws& laws, RunCounters& counters) const {
  tell_of_rises(world, counters);
  tell_of_losses(world, laws, counters);
}

void EnergyWatch::tell_of_losses(const World& world, const Laws& laws,
                                 RunCounters& counters) const {
  const double gravity = world.gravity_world ? world.gravity_world->norm() : 0.0;
  // what stands settles by what places are corrected by
  const auto is_seen = [&](const LostEnergy& one) {
    double least = kEnergyLost * one.whole + rounding_;
    for (const int body : one.bodies) {
      const Unseen of_body =
          unseen_of(world.bodies[static_cast<std::size_t>(body)], gravity, restitution_threshold_);
      least += of_body.of_restitution_threshold + kLifted * of_body.of_size;
    }
    return one.lost > least;
  };
  for (const LostEnergy& one : loss_.losses(rounding_))
    if (!one.is_at_contacts || is_seen(one))
      counters.watch.note(RunWatch::Kind::kEnergyLost, names_of(world, one.bodies),
                          told_of_loss(one, world, laws, step_));
}

void EnergyWatch::tell_of_rises(const World& world, RunCounters& counters) const {
  if (has_driven(world))
    for (const RisenEnergy& one : loss_.rises(rounding_))
      counters.watch.note(RunWatch::Kind::kEnergyRises, names_of(world, one.bodies),
                          {one.risen / one.whole, kEnergyRises, one.time, step_, kOrderOfMethods});
  const double whole =
      available() +
      (unseen(counters.watch.has_large_islands() ? kLiftedInLargeIslands : kLifted) + rounding_) /
          kEnergyRises;
  for (const Rise& rise : rises_)
    counters.watch.note(RunWatch::Kind::kEnergyRises,
                        fmt::format("'{}'", world.bodies[static_cast<std::size_t>(rise.body)].name),
                        {rise.size / whole, kEnergyRises, rise.time, step_,
                         rise.is_at_contact ? kOrderAtContacts : kOrderOfMethods});
}

// What effects have brought in since the last look, at most. Where looks are rare and that is not
// known, all that the energy has changed by.
void EnergyWatch::add_work_of_effects(double energy) {
  const bool is_known =
      sees_switches_ || std::all_of(brought_.begin(), brought_.end(), [](const effects::Work& one) {
        return std::isfinite(one.most);
      });
  if (!is_known) {
    const double brought = std::isnan(last_energy_) ? 0.0 : energy - work_ - last_energy_;
    work_ += brought;
    given_ += std::abs(brought);
    return;
  }
  for (const effects::Work& one : brought_) {
    if (!std::isfinite(one.most)) continue;
    work_ += one.done + one.most;
    given_ += std::abs(one.done) + one.most;
  }
}

// Whether the work of effects is known without a look at each step.
bool EnergyWatch::sees_enough() const {
  return sees_switches_ || std::none_of(meters_.begin(), meters_.end(),
                                        [](const auto& meter) { return meter->needs_steps(); });
}

void EnergyWatch::take_in(const World& world) {
  has_meters_ = true;
  loss_.begin_again();
  for (const effects::Effect* effect : effects::all()) {
    if (std::find(metered_.begin(), metered_.end(), effect) != metered_.end()) continue;
    if (auto meter = effect->work_meter(world)) {
      meters_.push_back(std::move(meter));
      metered_.push_back(effect);
    }
  }
}

std::optional<Runaway> EnergyWatch::look(double time, const World& world,
                                         const std::vector<RigidBodyState>& states,
                                         const std::vector<ContactPoint>& contacts,
                                         const EnergyLoss::PassSteps& pass_steps) {
  if (!has_meters_) take_in(world);
  sum_energy(world, states, energy_);
  const EnergyByBody& now = energy_;
  if (!meters_.empty()) {
    brought_.assign(world.bodies.size(), {});
    for (const auto& meter : meters_) meter->add_work(time, states, brought_);
  }
  for (const ContactPoint& contact : contacts) loss_.note_touch(contact.body_a, contact.body_b);
  if (loss_.look(time, world, states, now, brought_, pass_steps))
    note_rounding(time, now.kinetic, world, states);
  if (!sees_enough() || has_driven(world)) return std::nullopt;
  add_work_of_effects(now.kinetic + now.potential);
  const double energy = last_energy_ = now.kinetic + now.potential - work_;
  if (std::isnan(first_energy_)) begin(world, now);
  // methods whose energy swings, as symplectic ones' does, have begun to by now: that is no runaway
  else if (std::exchange(is_first_step_, false)) {
    first_energy_ = std::max(first_energy_, energy);
    scale_ = std::max(scale_, energy_at_work(now));
  }
  lowest_potential_ = std::min(lowest_potential_, now.potential);
  std::swap(touching_before_, touching_);
  touching_.clear();
  for (const ContactPoint& contact : contacts)
    for (const int body : {contact.body_a, contact.body_b})
      if (!world.bodies[static_cast<std::size_t>(body)].immovable()) touching_.push_back(body);
  note_rise(time, energy, now.kinetic, world, states);
  if (energy - first_energy_ <=
      kRunaway * available() + unseen(kLiftedInLargeIslands) + kSixDigits * std::abs(first_energy_))
    return std::nullopt;
  if (available() == 0.0 && first_energy_ == 0.0 && !(now.kinetic > 0)) return std::nullopt;
  return Runaway{body_with_most_energy(world, states), energy, first_energy_, by_impacts_};
}

namespace {

bool brings_energy(const World& world) {
  return std::any_of(
      effects::all().begin(), effects::all().end(),
      [&](const effects::Effect* effect) { return effect->work_meter(world) != nullptr; });
}

bool has_control_laws(const World& world) {
  return std::any_of(effects::all().begin(), effects::all().end(),
                     [&](const effects::Effect* effect) {
                       return effect->traits().looks && effect->count_in(world) > 0;
                     });
}

}  // namespace

std::string runaway_message(double time, const World& world, const Runaway& runaway,
                            const ActingForces& acting, const Laws& laws) {
  std::string effect;
  double hardest = 0.0;
  const auto pulls = [&](int a, int b, double force, const auto& words) {
    if ((a != runaway.body && b != runaway.body) || !(std::abs(force) > hardest)) return;
    hardest = std::abs(force);
    effect = fmt::format("{}, with {:.3g} N", words(), hardest);
  };
  std::vector<effects::Pull> all;
  for (std::size_t k = 0; k < effects::all().size(); ++k)
    effects::all()[k]->append_pulls(world, acting.states, acting.links.of_effects[k], laws, all);
  for (const effects::Pull& pull : all)
    pulls(pull.body_a, pull.body_b, pull.force, [&] { return pull.words; });
  for (const ContactPoint& contact : acting.contacts)
    pulls(contact.body_a, contact.body_b, contact.force_on_a_world.norm(), [&] {
      const int other = contact.body_a == runaway.body ? contact.body_b : contact.body_a;
      return fmt::format("persistent contact with '{}' ({} of {})",
                         world.bodies[static_cast<std::size_t>(other)].name,
                         contact.by_contact_forces ? "contact_forces" : "impulses",
                         contact.by_contact_forces || laws.friction_impulses
                             ? laws.source_of_contacts()
                             : "the framework");
    });
  if (runaway.by_impacts >= 0.5 * (runaway.energy - runaway.first_energy))
    effect = fmt::format("collision (collision_impulse, apply_impulse of {})", laws.impulse_source);
  else if (effect.empty())
    effect = fmt::format("integration ({}, {} of {})", laws.step_function, laws.derivative_function,
                         laws.integrator_source);
  return fmt::format(
      "at t = {:.6f} s, body '{}': runaway energy: the world has {:.4g} J, it began with {:.4g} "
      "J{}. Most likely it comes from {}; a shorter step or another method "
      "(here {}) is needed, or that is wrong{}",
      time, world.bodies[static_cast<std::size_t>(runaway.body)].name, runaway.energy,
      runaway.first_energy,
      !brings_energy(world) ? " and nothing brings energy in"
                            : ", without what forces and motors bring in",
      effect, laws.integrator_source,
      !has_control_laws(world)
          ? ""
          : "; a motor that turns its hinge too far while it holds its torque needs a shorter "
            "\"period_s\"");
}

}  // namespace tumble::engines
