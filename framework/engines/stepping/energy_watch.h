/// Looks on while a world moves: energy that nothing brings in, or nothing takes out.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/dynamics/laws.h"
#include "framework/dynamics/world.h"
#include "framework/effects/invariants.h"
#include "framework/effects/registry.h"
#include "framework/engines/base/run_counters.h"
#include "framework/engines/stepping/energy_loss.h"
#include "framework/engines/stepping/link_forces.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::engines {

/// Energy that nothing can have brought in.
struct Runaway {
  int body;                     // that has most of it
  double energy, first_energy;  // of the world, now and where the run started [J]
  double by_impacts;            // of the difference, what impacts have brought in [J]
};

/// Looks on while a world moves: energy that nothing can have brought in is the method's, or a
/// wrong law's.
class EnergyWatch {
 public:
  /// @param restitution_threshold  of impacts that do not bounce [m/s]: the energy of so slow a
  /// motion is not asked for
  /// @param step  of the run [s]
  /// @param sees_switches  whether it looks at each instant at which a force begins or ends, or a
  /// control law looks: else worlds go unwatched whose effects bring in what depends on each step
  EnergyWatch(double restitution_threshold, double step, bool sees_switches)
      : restitution_threshold_(restitution_threshold),
        step_(step),
        sees_switches_(sees_switches),
        loss_(sees_switches) {}

  /// An impact has taken place: what it did to the energy, as measured; else the work j (u + u') /
  /// 2 of its impulse.
  void note(const Event& event) {
    loss_.note(event);
    if (event.kind != EventKind::kCollision) return;
    by_impacts_ +=
        event.energy_change == event.energy_change
            ? event.energy_change
            : 0.5 * event.impulse * (event.normal_velocity_before + event.normal_velocity_after);
  }
  /// Two bodies may have been kept apart in a step since the last look. @param a, b  -1: none
  void note_touch(int a, int b) { loss_.note_touch(a, b); }
  /// As those of EnergyLoss.
  bool has_damped() const { return loss_.has_damped(); }
  void pass(double time, int body, const World& world, const std::vector<RigidBodyState>& states) {
    loss_.pass(time, body, world, states);
  }
  double last_look() const { return loss_.last_look(); }
  void note_lost_at_contacts(const std::vector<int>& bodies, double energy) {
    loss_.note_lost_at_contacts(bodies, energy);
  }
  /// A body has fallen asleep since the last look: sleep takes what it still had.
  void note_sleep(int body) { loss_.note_sleep(body); }
  /// @param contacts  persistent ones of the step that leads to these states
  /// @param pass_steps  as of EnergyLoss
  /// @return nothing while all is well, and for worlds that moving walls drive
  std::optional<Runaway> look(double time, const World& world,
                              const std::vector<RigidBodyState>& states,
                              const std::vector<ContactPoint>& contacts,
                              const EnergyLoss::PassSteps& pass_steps = {});
  /// Entries have been appended to the world: what they bring in is measured, too.
  void take_in(const World& world);
  /// Notes what energy has risen by above the least it has been, where that is more than steps
  /// leave of all that the world had to give; and what was lost where nothing takes any.
  void tell(const World& world, const Laws& laws, RunCounters& counters) const;

 private:
  struct Rise {
    double time, size;   // [s], [J]
    int body;            // that had most of the world's energy then
    bool is_at_contact;  // of that body, or of what it is linked with
  };
  void begin(const World& world, const EnergyByBody& energy);
  void add_work_of_effects(double energy);
  bool sees_enough() const;
  void tell_of_rises(const World& world, RunCounters& counters) const;
  void tell_of_losses(const World& world, const Laws& laws, RunCounters& counters) const;
  void note_rounding(double time, double kinetic, const World& world,
                     const std::vector<RigidBodyState>& states);
  void note_rise(double time, double energy, double kinetic, const World& world,
                 const std::vector<RigidBodyState>& states);
  bool is_at_contact(int body, const World& world) const;
  /// What the model itself is free to make: what moves slower than the restitution threshold, and
  /// lies, is lifted by this part of its size. [J]
  double unseen(double lifted) const { return of_restitution_threshold_ + lifted * of_sizes_; }
  double available() const { return scale_ + given_ + (first_potential_ - lowest_potential_); }

  double restitution_threshold_, step_;
  bool sees_switches_, is_first_step_ = true;
  // of the effects that bring energy into the world, from the first look on
  std::vector<std::unique_ptr<effects::WorkMeter>> meters_;
  bool has_meters_ = false;
  std::vector<const effects::Effect*> metered_;
  std::vector<effects::Work> brought_;  // since the last look, by body
  // what effects have brought in, at most, and without its sign [J]
  double work_ = 0.0, given_ = 0.0;
  // without what effects have brought in, at the first look and at the last; the others [J]
  double first_energy_ = kUnset, last_energy_ = kUnset, scale_ = 0.0, first_potential_ = 0.0,
         lowest_potential_ = 0.0, by_impacts_ = 0.0;
  // the least so far; of all bodies m v^2 of the restitution threshold, and m g size [J]
  double least_energy_ = 0.0, of_restitution_threshold_ = 0.0, of_sizes_ = 0.0;
  double rounding_ = 0.0;  // what it leaves of an energy, where one has risen [J]
  // bodies in persistent contact at this look and at the one before
  std::vector<int> touching_, touching_before_;
  std::vector<Rise> rises_;  // each larger than the one before
  EnergyByBody energy_;      // at the last look
  EnergyLoss loss_;
};

/// What acts on bodies at an instant.
struct ActingForces {
  const std::vector<RigidBodyState>& states;
  const LinkForces& links;
  const std::vector<ContactPoint>& contacts;
};

/// What a run says that ends because of it: the body, the time, and the effect that most likely put
/// the energy in: impacts where they have brought in half of it, else the spring, rod, joint or
/// contact that pulls hardest at the body, else the integration.
std::string runaway_message(double time, const World& world, const Runaway& runaway,
                            const ActingForces& acting, const Laws& laws);

}  // namespace tumble::engines
