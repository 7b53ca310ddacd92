// Of row 31: bodies with a curved surface. A rattleback turns back when it is spun one way and goes
// on when it is spun the other; a tippe top keeps Jellett's invariant however it slides and rolls.
// (Under Coulomb's law this one soon rolls and does not turn upside down: that takes friction that
// grows with the speed of sliding.)
//
// Truth: the equations of a body with an ellipsoid's surface that rolls on a level plane without
// slipping, integrated by a library. In the body frame, origin at the centre of mass, g the
// vertical, c the ellipsoid's middle, A its semi-axes:
//   r = c - A^2 g / |A g|
//       from the centre of mass to the contact
//   g' = -w x g,    v = -w x r                                   rolling
//   (I + m (r.r - r r^T)) w' = -w x I w + m r x (G g - w x r' - w x (w x r))
// with G the acceleration of gravity: Euler's law, the force taken from Newton's, m v' = F - m G g.
// Sources: T. R. Kane, D. A. Levinson, Int. J. Non-Linear Mechanics 17 (1982) 175, whose body this
// is; A. Garcia, M. Hubbard, Proc. R. Soc. A 418 (1988) 165.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

// GCC 12 sees uninitialized members where a stepper is copied before its first step.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#include <boost/numeric/odeint/integrate/integrate_adaptive.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <fmt/format.h>

#include "tests/stability/cases.h"
#include "tests/stability/support.h"

namespace tumble::battery {
namespace {

namespace odeint = boost::numeric::odeint;

// 40 cm long, 1 kg; the axes of inertia are turned by 0.8 degrees against those of the surface.
constexpr double kMass = 1.0;                                        // kg
const Vector3d kSemiAxes(0.2, 0.03, 0.02), kMiddle(0.0, 0.0, 0.01);  // m
constexpr double kTurned = -2e-5;                                    // kg m^2
Matrix3d inertia(double turned) {
  return (Matrix3d() << 2e-4, turned, 0, turned, 16e-4, 0, 0, 0, 17e-4).finished();
}
// Half a degree out of the level about both axes: enough to start it rocking. It needs a friction
// of 0.76 and never leaves the plane.
const Quaterniond kStart = Eigen::AngleAxisd(0.5 * std::numbers::pi / 180, Vector3d::UnitX()) *
                           Eigen::AngleAxisd(0.5 * std::numbers::pi / 180, Vector3d::UnitY());

/// @param turned  entry of the tensor of inertia beside its diagonal [kg m^2]
scene::Scene rattleback_scene(double spin, double turned) {
  scene::BodySpec body =
      rough(truths::ball("rattleback", kMass, 1.0, Vector3d::Zero(), Vector3d::Zero(), 0.0), 1.0);
  body.shape = scene::EllipsoidSpec{kSemiAxes, kMiddle};
  body.inertia_body_kg_m2 = inertia(turned);
  body.world_from_body = kStart;
  const Vector3d g = kStart.conjugate() * Vector3d::UnitZ(), across = kSemiAxes.cwiseProduct(g);
  const Vector3d r = kStart * Vector3d(kMiddle - kSemiAxes.cwiseProduct(across) / across.norm());
  body.position_m = Vector3d(0, 0, -r.z());
  body.omega_world_rad_s = Vector3d(0, 0, spin);
  body.velocity_m_s = -body.omega_world_rad_s.cross(r);
  return with_contact("rattleback", {body, floor_of(1.0)});
}

struct Moment {
  // [s]; of the long axis about the vertical, whole turns included [rad]; [rad/s]
  double time, heading, spin;
};

/// Heading and spin of the body at equal intervals.
class Headings {
 public:
  void add(double time, const Quaterniond& world_from_body, double spin) {
    const Vector3d along = world_from_body * Vector3d::UnitX();
    double heading = std::atan2(along.y(), along.x());
    if (!moments_.empty())
      heading += 2 * std::numbers::pi *
                 std::round((moments_.back().heading - heading) / (2 * std::numbers::pi));
    moments_.push_back({time, heading, spin});
  }
  const std::vector<Moment>& moments() const { return moments_; }

 private:
  std::vector<Moment> moments_;
};

using Rolling = std::array<double, 7>;  // quaternion w x y z; w in the body frame

void rolling_rates(const Rolling& y, Rolling& rates, double) {
  const Quaterniond q = Quaterniond(y[0], y[1], y[2], y[3]);
  const Vector3d w(y[4], y[5], y[6]), g = q.normalized().conjugate() * Vector3d::UnitZ();
  const Vector3d squares = kSemiAxes.cwiseProduct(kSemiAxes), g_rate = -w.cross(g),
                 lean = squares.cwiseProduct(g);
  const double s = std::sqrt(g.dot(lean));  // |A g|
  const Vector3d r = kMiddle - lean / s, r_rate = -squares.cwiseProduct(g_rate) / s +
                                                  lean * (lean.dot(g_rate) / (s * s * s));
  const Matrix3d own = inertia(kTurned),
                 about_contact =
                     own + kMass * (r.squaredNorm() * Matrix3d::Identity() - r * r.transpose());
  const Vector3d w_rate = about_contact.ldlt().solve(
      -w.cross(own * w) + kMass * r.cross(kG * g - w.cross(r_rate) - w.cross(w.cross(r))));
  const Quaterniond q_rate = q * Quaterniond(0, w.x(), w.y(), w.z());
  rates = {0.5 * q_rate.w(), 0.5 * q_rate.x(), 0.5 * q_rate.y(), 0.5 * q_rate.z(),
           w_rate.x(),       w_rate.y(),       w_rate.z()};
}

std::vector<Moment> true_motion(double spin, double duration, int intervals) {
  constexpr double kTolerance = 1e-12;
  const Vector3d w = kStart.conjugate() * Vector3d(0, 0, spin);
  Rolling y{kStart.w(), kStart.x(), kStart.y(), kStart.z(), w.x(), w.y(), w.z()};
  auto stepper =
      odeint::make_controlled<odeint::runge_kutta_fehlberg78<Rolling>>(kTolerance, kTolerance);
  Headings headings;
  for (int i = 0;; ++i) {
    const Quaterniond q = Quaterniond(y[0], y[1], y[2], y[3]).normalized();
    headings.add(duration * i / intervals, q, (q * Vector3d(y[4], y[5], y[6])).z());
    if (i == intervals) return headings.moments();
    odeint::integrate_adaptive(stepper, rolling_rates, y, duration * i / intervals,
                               duration * (i + 1) / intervals, 1e-4);
  }
}

std::vector<Moment> moments_of(const Trajectory& run) {
  Headings headings;
  for (const Frame& frame : run.frames)
    headings.add(frame.time, frame.poses[0].world_from_body, frame.poses[0].omega_world.z());
  return headings.moments();
}

/// When the heading is farthest from where it began, after which it goes back.
double time_of_reversal(const std::vector<Moment>& moments) {
  const auto farther = [&](const Moment& a, const Moment& b) {
    return std::abs(a.heading - moments.front().heading) <
           std::abs(b.heading - moments.front().heading);
  };
  return std::max_element(moments.begin(), moments.end(), farther)->time;
}

}  // namespace

namespace {

// L . r, r from the centre of mass to the contact: constant for a round body under any force that
// acts at the contact, because (r x F) . r = 0 and r' = w x (e a), a its axis, along which L and w
// differ. Source: J. H. Jellett, A Treatise on the Theory of Friction, 1872.
void tippe_top(const Given& given, Findings& findings) {
  // kg, m: mass, radius, centre of mass below the middle
  constexpr double kTop = 0.006, kRound = 0.015, kBeside = 0.2 * kRound;
  const Matrix3d own =
      (kTop * kRound * kRound * Vector3d(131.0 / 350, 131.0 / 350, 0.4)).asDiagonal();
  const auto to_contact = [&](const Vector3d& axis_world) -> Vector3d {
    return kBeside * axis_world - kRound * Vector3d::UnitZ();
  };
  scene::BodySpec top =
      rough(truths::ball("top", kTop, kRound, Vector3d::Zero(), Vector3d::Zero(), 0.0), 0.1);
  top.shape = scene::EllipsoidSpec{Vector3d::Constant(kRound), Vector3d(0, 0, kBeside)};
  top.inertia_body_kg_m2 = own;
  top.world_from_body = Quaterniond(Eigen::AngleAxisd(0.5, Vector3d::UnitY()));
  const Vector3d axis = top.world_from_body * Vector3d::UnitZ();
  top.position_m = Vector3d(0, 0, -to_contact(axis).z());
  top.omega_world_rad_s = 155.0 * axis;
  const Trajectory run = run_by_steps(with_contact("tippe top", {top, floor_of(0.1)}), given.laws,
                                      given.is_long ? 6.0 : 1.0, 1.0 / 2000, 500);
  double first = 0.0, off = 0.0;
  for (const Frame& frame : run.frames) {
    const Quaterniond& q = frame.poses[0].world_from_body;
    const Vector3d angular_momentum_world =
        q * (own * (q.conjugate() * frame.poses[0].omega_world));
    const double jellett = angular_momentum_world.dot(to_contact(q * Vector3d::UnitZ()));
    if (first == 0.0) first = jellett;
    off = std::max(off, std::abs(jellett / first - 1));
  }
  findings.at_most("tippe top that slides, then rolls: Jellett's invariant", off, 1e-5, "",
                   "conserved whatever friction does; w h = 0.08. A contact at the pole instead of "
                   "the lowest point changes it by a tenth");
  findings.at_most("tippe top: rise of the energy above an earlier value", energy_rise(run), 1e-6,
                   "", "friction only takes");
  findings.at_least("tippe top: smallest gap", smallest_gap(run), 0.0, "m", "nothing sinks in");
}

}  // namespace

void rattleback(const Given& given, Findings& findings) {
  constexpr double kDuration = 5.0, kStep = 1.0 / 2000;
  constexpr int kFrames = 5000;
  report::Plot plot{
      "Spin of a rattleback",
      {"time", "s"},
      {"angle turned about the vertical", "rad"},
      {},
      {},
      "Spun against its sense it begins to rattle, stops and turns back; spun with it, it goes on. "
      "The equations of rolling, integrated on their own, lie under the curves."};
  const auto rolled = [&](double spin, double turned, double step) {
    return run_by_steps(rattleback_scene(spin, turned), given.laws, kDuration, step, kFrames);
  };
  for (const double spin : {-5.0, 5.0}) {
    const std::string name = fmt::format("rattleback spun with {:g} rad/s", spin);
    findings.part(name, [&] {
      const Trajectory run = rolled(spin, kTurned, kStep);
      const std::vector<Moment> truth = true_motion(spin, kDuration, kFrames),
                                found = moments_of(run);
      double off = 0.0, reached = 0.0;
      for (std::size_t i = 0; i < truth.size(); ++i) {
        off = std::max(off, std::abs(found[i].heading - truth[i].heading));
        reached = std::max(reached, std::abs(truth[i].heading - truth[0].heading));
      }
      findings.at_most(name + ": angle turned, error over the largest", off / reached, 0.01, "",
                       "the table's 1 %; the truth integrates the equations of rolling to 1e-12");
      if (spin < 0) {
        const double back = time_of_reversal(truth);
        findings.at_most(name + fmt::format(": time at which it turns back against {:.4g} s", back),
                         std::abs(time_of_reversal(found) / back - 1), 0.01, "", "the table's 1 %");
        findings.at_least(name + ": spin after 5 s", found.back().spin, 1.0, "rad/s",
                          "it has turned back");
        const double coarse = energy_rise(rolled(spin, kTurned, 2 * kStep));
        findings.at_least(name + ": rise of the energy at twice the step, over that",
                          coarse / std::max(energy_rise(run), 1e-9), 3.0, "",
                          "4 for a method of second order: none of it is the law's");
      } else {
        findings.at_least(name + ": spin after 5 s", found.back().spin, 4.0, "rad/s", "it goes on");
      }
      // It swings at w = 107 rad/s along its length: m G (a^2 / c - h) over its moment about the
      // contact.
      findings.at_most(
          name + ": rise of the energy above an earlier value", energy_rise(run), 3e-3, "",
          "rolling loses and gains nothing; a step's error is of second order, (w h)^2 = 3e-3");
      findings.at_least(name + ": smallest gap", smallest_gap(run), 0.0, "m", "nothing sinks in");
      plot.curves.push_back({fmt::format("{:g} rad/s", spin), {}, {}});
      plot.curves.push_back({fmt::format("{:g} rad/s, equations", spin), {}, {}, true});
      for (std::size_t i = 0; i < truth.size(); i += 10) {
        plot.curves[plot.curves.size() - 2].x.push_back(found[i].time),
            plot.curves[plot.curves.size() - 2].y.push_back(found[i].heading);
        if (i % 200 == 0)
          plot.curves.back().x.push_back(truth[i].time),
              plot.curves.back().y.push_back(truth[i].heading);
      }
    });
  }
  findings.part("body that is no rattleback", [&] {
    const std::vector<Moment> found = moments_of(rolled(-5.0, 0.0, kStep));
    findings.must_fail(
        "axes of inertia along those of the surface: spin against its sense after 5 s",
        -found.back().spin, 1.0, "rad/s",
        "without axes turned against each other nothing couples spin and rocking: it turns on");
  });
  findings.plot(std::move(plot));
  findings.part("tippe top", [&] { tippe_top(given, findings); });
}

}  // namespace tumble::battery
