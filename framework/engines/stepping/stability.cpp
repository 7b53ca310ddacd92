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
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/base/tolerances.h"

namespace tumble::engines {
namespace {

// factor over a run by which a method may lengthen a swing: more is refused
constexpr double kRuin = 1e3;
// rad of its motion that a driven body may go in a step. What it carries asks where it is a few
// times a step: at one radian a pendulum on a shaken base is off by 2 %, at a quarter turn a shaken
// floor may seem to stand still in every step.
constexpr double kFollowed = 1.0;
// of the longest step at which a swing does not grow: links that come taut set it going, and it has
// to be followed, not only outlived
constexpr double kJerk = 0.1;

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

// Whether contacts, springs, rods or joints may lead from a body to others; impacts find it at any
// instant.
bool carries(const World& world, int body) {
  if (world.contact && world.bodies[static_cast<std::size_t>(body)].collides) return true;
  for (const effects::Effect* effect : effects::all())
    for (int entry = 0; entry < effect->count_in(world); ++entry) {
      const std::vector<int> bodies = effect->bodies_of(world, entry);
      if (std::find(bodies.begin(), bodies.end(), body) != bodies.end()) return true;
    }
  return false;
}

// Reports what is driven to and fro faster than the steps follow.
void report_fast_driven(const World& world, double step, std::vector<std::string>& notices) {
  for (std::size_t k = 0; k < world.bodies.size(); ++k) {
    const scene::PrescribedMotion& motion = world.bodies[k].motion;
    const double rate = motion.amplitude_m.isZero(0.0) ? 0.0 : motion.angular_frequency_rad_s;
    if (!world.bodies[k].immovable() || rate * step <= kFollowed * (1 + kNegligible) ||
        !carries(world, static_cast<int>(k)))
      continue;
    notices.push_back(fmt::format(
        "a step of {:.3g} s is {:.3g} rad of the motion of '{}': contacts, springs, rods and "
        "joints feel that motion at a few instants of each step, and may miss it; steps of at most "
        "{:.2g} s (\"step_s\") follow it",
        step, rate * step, world.bodies[k].name, kFollowed / rate));
  }
}

}  // namespace

std::string place_of_step(const scene::Scene& scene, double step) {
  const std::string pointer = "/step_s";
  if (step == scene.step_s && scene.lines.contains(pointer)) return scene::place_of(scene, pointer);
  return scene.file.empty() ? scene.name : scene.file.string();
}

void refuse_unstable_steps(const World& world, const Laws& laws, const StepsOfARun& steps,
                           const std::string& where, std::vector<std::string>& notices) try {
  report_fast_driven(world, steps.step, notices);
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

}  // namespace tumble::engines
