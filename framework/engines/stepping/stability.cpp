#include "framework/engines/stepping/stability.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "framework/core/decompositions.h"
#include "framework/core/error.h"
#include "framework/core/numbers.h"
#include "framework/dynamics/anchors.h"
#include "framework/effects/invariants.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/tolerances.h"

namespace tumble::engines {
namespace {

// factor over a run by which a method may lengthen a swing: more is refused
constexpr double kRuin = 1e3;
// of the longest step at which a swing does not grow: links that come taut set it going, and it has
// to be followed, not only outlived
constexpr double kJerk = 0.1;
// times all the energy there was to begin with: more has run away
constexpr double kRunaway = 10.0;

// Up to `step`, of what goes at this rate [1/s]. @param amplified  by a step of a given length
double largest_stable_step(const std::function<double(double)>& amplified, double rate,
                           double step) {
  double stable = 0.0, unstable = step;
  // Down to a thousandth of a radian a step: a method that still lengthens the swing there always
  // does.
  for (double h = step; h * rate > 1e-3 && stable == 0.0; h *= 0.5) {
    if (amplified(h) <= 1.0 + kNegligible)
      stable = h;
    else
      unstable = h;
  }
  if (stable == 0.0) return 0.0;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (stable + unstable);
    (amplified(middle) <= 1.0 + kNegligible ? stable : unstable) = middle;
  }
  return stable;
}

// Of v' = -rate v, in a step; with the place beside it, for methods that treat places and
// velocities differently.
double amplification_of_decay(const Laws& laws, double rate, double step) {
  const OdeFunction decay = [&](double, const VectorXd& y) {
    VectorXd dy(2);
    dy << y[1], -rate * y[1];
    return dy;
  };
  VectorXd y = VectorXd::Zero(2);
  y[1] = 1.0;
  return std::abs(laws.integrate_step(decay, 0.0, y, step)[1]);
}

// What a joint holds cannot grow, and what it leaves free goes slower than the body alone: its
// rates say nothing.
bool is_jointed(const std::vector<effects::Carrier>& carriers, int body) {
  return std::any_of(carriers.begin(), carriers.end(), [&](const effects::Carrier& one) {
    return one.length == 0.0 && (one.a.body == body || one.b.body == body);
  });
}

bool is_held_beside_its_centre(const std::vector<effects::Carrier>& carriers, int body) {
  const auto beside = [&](const Anchor& anchor) {
    return anchor.body == body && !anchor.point_body.isZero(0.0);
  };
  return std::any_of(carriers.begin(), carriers.end(), [&](const effects::Carrier& one) {
    return one.length > 0.0 && (beside(one.a) || beside(one.b));
  });
}

/// Largest size of the two eigenvalues; they are real where `discriminant` is not negative, else a
/// conjugate pair.
double spectral_radius(const Eigen::Matrix2d& m) {
  const double middle = 0.5 * (m(0, 0) + m(1, 1));
  const double half_difference = 0.5 * (m(0, 0) - m(1, 1));
  const double discriminant = half_difference * half_difference + m(0, 1) * m(1, 0);
  return discriminant < 0.0 ? std::sqrt(m.determinant())
                            : std::abs(middle) + std::sqrt(discriminant);
}

}  // namespace

double amplification(const Laws& laws, double frequency, double damping, double step) {
  const OdeFunction swing = [&](double, const VectorXd& y) {
    VectorXd dy(2);
    dy << y[1], -frequency * frequency * y[0] - damping * y[1];
    return dy;
  };
  const double rate = std::max(frequency, damping);
  Eigen::Matrix2d matrix;
  for (int column = 0; column < 2; ++column) {
    VectorXd y = VectorXd::Zero(2);
    y[column] = column == 0 ? 1.0 : rate;  // in the units of the swing, or of the decay
    const VectorXd after = laws.integrate_step(swing, 0.0, y, step);
    matrix(0, column) = after[0];
    matrix(1, column) = after[1] / rate;
  }
  return spectral_radius(matrix);
}

double largest_stable_step(const Laws& laws, double frequency, double damping, double step) {
  return largest_stable_step([&](double h) { return amplification(laws, frequency, damping, h); },
                             std::max(frequency, damping), step);
}

std::vector<StepLimit> judge_decays(const World& world, const Laws& laws, double step) {
  std::vector<StepLimit> limits;
  std::vector<effects::Drain> drains;
  for (const effects::Effect* effect : effects::all()) effect->append_drains(world, drains);
  const Carriers carriers(world);
  for (const effects::Drain& drain : drains) {
    const WorldBody& body = world.bodies[drain.body];
    if (body.immovable() || is_jointed(carriers.all, drain.body)) continue;
    const double least_moment =
        1.0 / symmetric_eigen(body.inertia.inverse_inertia_body).values.maxCoeff();
    const double turning =
        is_held_beside_its_centre(carriers.all, drain.body) ? 0.0 : drain.angular / least_moment;
    for (const auto& [rate, way] : {std::pair{drain.linear * body.inertia.inverse_mass, "velocity"},
                                    std::pair{turning, "turning"}}) {
      const auto amplified = [&laws, rate = rate](double h) {
        return amplification_of_decay(laws, rate, h);
      };
      if (amplified(step) > 1.0 + kNegligible)
        limits.push_back(
            {fmt::format("what {} takes from its {} ({:.4g} 1/s)", drain.of, way, rate),
             amplified(step), largest_stable_step(amplified, rate, step), drain.remedy});
    }
  }
  if (!world.stabilisation || world.stabilisation->kind != scene::StabilisationKind::kBaumgarte ||
      !laws.baumgarte_acceleration)
    return limits;
  const double T = world.stabilisation->time_constant_s;
  const double stiffness = -laws.baumgarte_acceleration(1.0, 0.0, T),
               damping = -laws.baumgarte_acceleration(0.0, 1.0, T);
  if (!(stiffness > 0) || !(damping >= 0)) return limits;  // a wrong law is no matter of the step
  const double frequency = std::sqrt(stiffness),
               amplified = amplification(laws, frequency, damping, step);
  if (amplified > 1.0 + kNegligible)
    limits.push_back({fmt::format("the errors of rods and joints that Baumgarte's term takes back "
                                  "(time constant {:.4g} s)",
                                  T),
                      amplified, largest_stable_step(laws, frequency, damping, step),
                      "a longer \"time_constant_s\", or projection"});
  return limits;
}

std::optional<StepLimit> judge_rods(const World& world,
                                    const std::vector<effects::Carrier>& carriers,
                                    const std::vector<double>& loads, const Laws& laws,
                                    double step) {
  constexpr std::size_t kMostBodies = 100;  // a dense eigenvalue problem of three times that
  const auto beside_centre = [](const Anchor& anchor) {
    return anchor.body >= 0 && !anchor.point_body.isZero(0.0);
  };
  const auto is_other = [&](const effects::Carrier& one) {
    return one.length == 0.0 || beside_centre(one.a) || beside_centre(one.b);
  };
  if (carriers.empty() || std::any_of(carriers.begin(), carriers.end(), is_other))
    return std::nullopt;
  std::vector<RigidBodyState> states;
  std::vector<Eigen::Index> place(world.bodies.size(), -1);
  Eigen::Index n = 0;
  for (const WorldBody& body : world.bodies) states.push_back(body.state);
  // How hard rods hold each body, by blocks of K (Gershgorin): the most bounds the swings without
  // rods, which are faster than those with them. Mostly that will do.
  std::vector<double> held(world.bodies.size(), 0.0);
  const auto lightness = [&](const Anchor& anchor) {
    return anchor.body < 0 ? 0.0 : std::sqrt(world.bodies[anchor.body].inertia.inverse_mass);
  };
  for (std::size_t k = 0; k < carriers.size(); ++k) {
    const effects::Carrier& rod = carriers[k];
    const double stiffness = std::abs(loads[k]) / rod.length,
                 both = lightness(rod.a) + lightness(rod.b);
    if (rod.a.body >= 0) held[rod.a.body] += stiffness * lightness(rod.a) * both;
    if (rod.b.body >= 0) held[rod.b.body] += stiffness * lightness(rod.b) * both;
  }
  const double bound = *std::max_element(held.begin(), held.end());
  if (!(bound > 0) || amplification(laws, std::sqrt(bound), 0.0, step) <= 1.0 + kNegligible)
    return std::nullopt;
  // Of many bodies, those that are held hardest, the others kept still: what they do alone is no
  // faster than what all can do.
  std::vector<std::size_t> chosen(world.bodies.size());
  std::iota(chosen.begin(), chosen.end(), std::size_t{0});
  std::stable_sort(chosen.begin(), chosen.end(),
                   [&](std::size_t a, std::size_t b) { return held[a] > held[b]; });
  const bool all = chosen.size() <= kMostBodies || held[chosen[kMostBodies]] == 0.0;
  if (!all) chosen.resize(kMostBodies);
  for (const std::size_t body : chosen)
    if (held[body] > 0.0) place[body] = 3 * n++;
  const auto end_of = [&](const Anchor& anchor) -> Eigen::Index {
    return anchor.body < 0 ? -1 : place[anchor.body];
  };
  // In places times sqrt(m): A = M^-1/2 K M^-1/2, the rods' rows J M^-1/2.
  std::vector<std::size_t> rods;
  for (std::size_t k = 0; k < carriers.size(); ++k)
    if (end_of(carriers[k].a) >= 0 || end_of(carriers[k].b) >= 0) rods.push_back(k);
  MatrixXd A = MatrixXd::Zero(3 * n, 3 * n),
           J = MatrixXd::Zero(static_cast<Eigen::Index>(rods.size()), 3 * n);
  for (Eigen::Index k = 0; k < J.rows(); ++k) {
    const effects::Carrier& rod = carriers[rods[static_cast<std::size_t>(k)]];
    const Vector3d along = (anchor_point(rod.a, states) - anchor_point(rod.b, states)).normalized();
    const Matrix3d across = loads[rods[static_cast<std::size_t>(k)]] / rod.length *
                            (Matrix3d::Identity() - along * along.transpose());
    const auto root = [&](const Anchor& anchor) {
      return std::sqrt(world.bodies[anchor.body].inertia.inverse_mass);
    };
    const Eigen::Index a = end_of(rod.a), b = end_of(rod.b);
    if (a >= 0)
      A.block<3, 3>(a, a) += root(rod.a) * root(rod.a) * across,
          J.block<1, 3>(k, a) = root(rod.a) * along.transpose();
    if (b >= 0)
      A.block<3, 3>(b, b) += root(rod.b) * root(rod.b) * across,
          J.block<1, 3>(k, b) = -root(rod.b) * along.transpose();
    if (a < 0 || b < 0) continue;
    A.block<3, 3>(a, b) -= root(rod.a) * root(rod.b) * across;
    A.block<3, 3>(b, a) -= root(rod.a) * root(rod.b) * across;
  }
  const MatrixXd keep = MatrixXd::Identity(3 * n, 3 * n) - pseudo_inverse(J) * J;
  const SymmetricEigen eigen = symmetric_eigen(MatrixXd(keep * A * keep));
  const double squared = eigen.values[3 * n - 1];
  if (!(squared > 0)) return std::nullopt;
  const double frequency = std::sqrt(squared),
               amplified = amplification(laws, frequency, 0.0, step);
  if (amplified <= 1.0 + kNegligible) return std::nullopt;
  Eigen::Index most = 0;
  eigen.vectors.col(3 * n - 1).cwiseAbs().maxCoeff(&most);
  const auto body = std::find(place.begin(), place.end(), most - most % 3) - place.begin();
  return StepLimit{
      fmt::format("the swing of body '{}' across its rods ({:.4g} rad/s where they pull most)",
                  world.bodies[static_cast<std::size_t>(body)].name, frequency),
      amplified, largest_stable_step(laws, all ? frequency : std::sqrt(bound), 0.0, step),
      "masses that differ less"};
}

namespace {

// Natural logarithm of the growth over the run; what a step does, and how large one may be.
double growth_over(const StepsOfARun& steps, double amplification) {
  return std::log(amplification) * steps.duration / steps.step;
}
std::string words_of(const StepLimit& limit, const Laws& laws, double step) {
  return fmt::format("a step of {:.3g} s of {} lengthens {} by a factor {:.6g} each time", step,
                     laws.integrator_source, limit.of, limit.amplification);
}
std::string smaller_steps(const StepLimit& limit) {
  return limit.largest_step > 0
             ? fmt::format("; steps of at most {:.4g} s do not", limit.largest_step)
             : "; this method does at every step size";
}

void refuse_or_tell(const StepLimit& limit, const Laws& laws, const StepsOfARun& steps,
                    const std::string& where, std::vector<std::string>& notices) {
  const double over_the_run = growth_over(steps, limit.amplification);
  const std::string what = words_of(limit, laws, steps.step);
  if (over_the_run > std::log(kRuin))
    throw UserError(
        where, what + fmt::format(", 10^{:.0f} times over the run", over_the_run / std::log(10.0)),
        limit.largest_step > 0 ? fmt::format("take a step of at most {:.4g} s (\"step_s\"), {}",
                                             limit.largest_step, limit.remedy)
                               : "this method lengthens it at every step size: take another method "
                                 "(a2's rk4_step), or " +
                                     limit.remedy);
  if (over_the_run > std::log(kSeen)) notices.push_back(what + smaller_steps(limit));
}

}  // namespace

void refuse_unstable_steps(const World& world, const Laws& laws, const StepsOfARun& steps,
                           const std::string& where, std::vector<std::string>& notices) try {
  if (const auto dampers = judge_dampers(world, laws, steps.step))
    refuse_or_tell(*dampers, laws, steps, where, notices);
  const auto springs = judge_springs(world, laws, steps.step);
  if (springs && springs->amplification > 1.0 && !springs->is_overdamped())
    refuse_or_tell({fmt::format("the swing of {} ({:.4g} rad/s where the run starts)", springs->of,
                                springs->angular_frequency),
                    springs->amplification, springs->largest_step,
                    springs->largest_step > 0 ? springs->remedy : springs->last_remedy},
                   laws, steps, where, notices);
  for (const StepLimit& limit : judge_decays(world, laws, steps.step))
    refuse_or_tell(limit, laws, steps, where, notices);
} catch (const StoppedRun&) {
  // A law that fails here fails in the first step too, and names the body.
}

std::optional<double> report_unstable_links(const World& world, const LinkForces& at_start,
                                            const Laws& laws, const StepsOfARun& steps,
                                            std::vector<std::string>& notices) try {
  const Carriers carriers(world);
  LinkLoads loads = largest_link_loads(world, carriers.all);
  for (std::size_t k = 0; k < carriers.all.size(); ++k) {
    const std::vector<double>& pulls = at_start.of_effects[carriers.effect[k]];
    if (const auto entry = static_cast<std::size_t>(carriers.all[k].entry);
        carriers.all[k].length > 0.0 && entry < pulls.size())
      loads.loads[k] = std::max(loads.loads[k], std::abs(pulls[entry]));
  }
  std::optional<double> named;
  for (std::optional<StepLimit> limit :
       {judge_rods(world, carriers.all, loads.loads, laws, steps.step),
        judge_joints(world, carriers.all, loads.loads, laws, steps.step)}) {
    // A method that lengthens every swing is reported by its energy.
    if (!limit || !(limit->largest_step > 0) ||
        !(growth_over(steps, limit->amplification) > std::log(kRuin)))
      continue;
    if (loads.by_falling) limit->largest_step *= kJerk;
    notices.push_back(words_of(*limit, laws, steps.step) + smaller_steps(*limit));
    named = std::min(named.value_or(limit->largest_step), limit->largest_step);
  }
  return named;
} catch (const StoppedRun&) {
  // As above; and a law that takes whole bodies only can move them nevertheless.
  return std::nullopt;
}

namespace {

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
double energy_at_work(const World& world, const std::vector<RigidBodyState>& states,
                      const Invariants& sums) {
  double scale = sums.kinetic_energy;
  for (const effects::Effect* effect : effects::all())
    if (effect->traits().stores_energy) effect->add_potential_energy(world, states, scale);
  return scale;
}

// The terms that the energy is a sum of: what its rounding goes by. [J]
double terms_of_energy(const World& world, const std::vector<RigidBodyState>& states,
                       double kinetic) {
  double terms = kinetic;
  for (const effects::Effect* effect : effects::all())
    effect->add_energy_terms(world, states, terms);
  return terms;
}

// Of the bodies' sizes: how far what lies is lifted where it is kept apart. Contact margins are
// 1e-10 of the smaller body, those of large islands 1e-4.
constexpr double kLifted = 1e-5, kLiftedInLargeIslands = 1e-3;

}  // namespace

// What the world has to give: its kinetic energy, what its springs hold, and (available()) how far
// it falls.
void EnergyWatch::begin(const World& world, const std::vector<RigidBodyState>& states,
                        const Invariants& sums) {
  first_energy_ = least_energy_ = sums.kinetic_energy + sums.potential_energy;
  // a perfectly inelastic body is separated at the restitution threshold, a box by each of its
  // corners
  constexpr double kCorners = 8.0;
  lowest_potential_ = first_potential_ = sums.potential_energy;
  scale_ = energy_at_work(world, states, sums);
  const double gravity = world.gravity_world ? world.gravity_world->norm() : 0.0;
  for (const WorldBody& body : world.bodies) {
    if (body.immovable()) continue;
    // of gyration [m]
    const double size =
        std::sqrt(0.5 * body.inertia.inertia_body.trace() * body.inertia.inverse_mass);
    of_restitution_threshold_ +=
        kCorners * body.inertia.mass * restitution_threshold_ * restitution_threshold_;
    of_sizes_ += body.inertia.mass * gravity * size;
  }
}

void EnergyWatch::note_rise(double time, double energy, double kinetic, const World& world,
                            const std::vector<RigidBodyState>& states) {
  const double rise = energy - least_energy_;
  least_energy_ = std::min(least_energy_, energy);
  if (!(rise > unseen(kLifted)) || (!rises_.empty() && !(rise > kSeen * rises_.back().size)))
    return;
  rounding_ = std::max(rounding_, kDeviations * kEpsilon * (1.0 + std::sqrt(time / step_)) *
                                      terms_of_energy(world, states, kinetic));
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

void EnergyWatch::tell(const World& world, RunCounters& counters) const {
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

// What effects have brought in since the last look, at most.
double EnergyWatch::work_since(double time, const std::vector<RigidBodyState>& states) {
  double work = 0.0, most = 0.0;
  for (const auto& meter : meters_) {
    const effects::Work since = meter->since_last(time, states);
    work += since.done;
    most += since.most;
  }
  given_ += std::abs(work) + most;
  return work + most;
}

void EnergyWatch::take_in(const World& world) {
  has_meters_ = true;
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
                                         const std::vector<ContactPoint>& contacts) {
  const auto driven = [](const WorldBody& b) { return b.immovable() && is_driven(b.motion); };
  if (!has_meters_) take_in(world);
  if ((!sees_switches_ && !meters_.empty()) ||
      std::any_of(world.bodies.begin(), world.bodies.end(), driven))
    return std::nullopt;
  const Invariants sums = invariants_of(world, states);
  work_ += work_since(time, states);
  const double energy = sums.kinetic_energy + sums.potential_energy - work_;
  if (std::isnan(first_energy_)) begin(world, states, sums);
  // methods whose energy swings, as symplectic ones' does, have begun to by now: that is no runaway
  else if (std::exchange(is_first_step_, false)) {
    first_energy_ = std::max(first_energy_, energy);
    scale_ = std::max(scale_, energy_at_work(world, states, sums));
  }
  lowest_potential_ = std::min(lowest_potential_, sums.potential_energy);
  std::swap(touching_before_, touching_);
  touching_.clear();
  for (const ContactPoint& contact : contacts)
    for (const int body : {contact.body_a, contact.body_b})
      if (!world.bodies[static_cast<std::size_t>(body)].immovable()) touching_.push_back(body);
  note_rise(time, energy, sums.kinetic_energy, world, states);
  if (energy - first_energy_ <=
      kRunaway * available() + unseen(kLiftedInLargeIslands) + kSixDigits * std::abs(first_energy_))
    return std::nullopt;
  if (available() == 0.0 && first_energy_ == 0.0 && !(sums.kinetic_energy > 0)) return std::nullopt;
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
    effect =
        fmt::format("integration (integrate_step, state_derivative of {})", laws.integrator_source);
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
