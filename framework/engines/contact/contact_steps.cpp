// One step of a group in contact: the impulses, where they lead, and the shifts that take back what is left of overlaps. Part of
// LastingContacts.
#include <algorithm>
#include <cmath>

#include "framework/dynamics/solve_contacts.h"
#include "framework/engines/base/guarded_laws.h"
#include "framework/engines/contact/lasting_contacts.h"

namespace tumble::engines {
namespace {

constexpr double kEnough = 1e-8;          // of the group's speed: what is left of approach and slip; problems at rest come out to rounding
// A heap that is asked for in steps, not in instants, gets answers of that kind.
constexpr std::size_t kPile = 60;         // contacts of a group
constexpr double kEnoughOfAPile = 1e-5;
constexpr int kSweepsOfAPile = 120;
constexpr double kFarOff = 1e-3;          // of the group's speed: an answer this wrong is not taken without another attempt
constexpr double kSamePoint = 1e-2;       // of the smaller body: nearer to where an impulse acted in the last step a point takes it as its guess
constexpr double kSamePointOfAPile = 0.5; // there points come and go, and the sum of a pair's impulses is worth more than their places
constexpr int kMostShifts = 10;           // rounds of taking back overlaps
constexpr int kHeldRounds = 5;            // of these, in which points that push are drawn to their shells too
constexpr double kHeldReach = 1e-3;       // of the smaller body: what turning may leave between points that push
constexpr double kShiftReach = 4.0;       // shifts: how far apart points may be to matter
constexpr double kMissed = 1e-6, kMissedAtMost = 1e-3;   // shifts: of what is missing a round may leave, and what it is taken with where it does not get so far
constexpr double kSolverRounding = 1e-13;       // relative, of a solver's answer
constexpr double kNotYet = 1e3;           // shells: a point farther away at the start has come down in the step
constexpr double kMoving = 10.0;          // rest speeds
constexpr int kMostOfStudents = 64;       // contacts of a group that the laws' contact_forces is asked for: it is given a dense matrix
constexpr int kMostLocated = 12;          // contacts of a group whose end of sliding is located in time
constexpr int kMostSearches = 16;         // for ends of sliding within a step: bodies that chatter stop with the step
constexpr double kSlides = 1e-9;          // of the group's speed: slower than this nothing slides

Vector3d velocity_at(const PushedBody& body, const Vector3d& velocity, const Vector3d& omega, const Vector3d& point) {
  return velocity + omega.cross(point - body.com_world);
}

Matrix3d inverse_inertia_world(const WorldBody& body, const Quaterniond& q) {
  const Matrix3d R = q.normalized().toRotationMatrix();
  return R * body.inertia.inverse_inertia_body * R.transpose();
}

// A shift is no motion: where masses differ by more than a solver's digits bear, the lightest count as heavier ones.
void limit_ratios(ContactProblem& problem) {
  constexpr double kMostRatio = 1e4;
  double least = std::numeric_limits<double>::infinity();   // inverse mass of what moves
  for (const PushedBody& body : problem.bodies)
    if (body.inverse_mass > 0) least = std::min(least, body.inverse_mass);
  for (PushedBody& body : problem.bodies) {
    if (!(body.inverse_mass > kMostRatio * least)) continue;
    const double factor = kMostRatio * least / body.inverse_mass;
    body.inverse_mass *= factor;
    body.inverse_inertia_world *= factor;
  }
}

}  // namespace

Quaterniond turned(const Quaterniond& q, const Vector3d& turn) {
  const double angle = turn.norm();
  return angle > 0 ? (Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) * q).normalized() : q;
}

// Puts a body into the problem. With `velocities`: those of a state; without: none, as for shifts.
int LastingContacts::place(int body, double t, std::map<int, int>& places, const std::vector<RigidBodyState>& states, const RigidBodyState* velocities,
                           ContactProblem& problem) const {
  const auto [found, is_new] = places.try_emplace(body, static_cast<int>(problem.bodies.size()));
  if (!is_new) return found->second;
  const WorldBody& b = moving_.world().bodies[body];
  PushedBody pushed;
  pushed.com_world = states[body].com_world;
  pushed.velocity_world = pushed.omega_world = Vector3d::Zero();
  if (b.immovable()) {
    if (velocities) pushed.velocity_world = prescribed_velocity(b, t);
  } else {
    pushed.inverse_mass = b.inertia.inverse_mass;
    pushed.inverse_inertia_world = inverse_inertia_world(b, velocities ? velocities->world_from_body : states[body].world_from_body);
    if (velocities) {
      pushed.velocity_world = b.inertia.inverse_mass * velocities->momentum_world;
      pushed.omega_world = omega_of(*velocities, b.inertia);
    }
  }
  problem.bodies.push_back(pushed);
  return found->second;
}

// Rods and joints of the group. Velocities: what the free step has made of them stays. Places: their errors go.
void LastingContacts::add_rows(const Group& group, const std::vector<RigidBodyState>& states, double t, const std::map<int, int>& places, bool of_places,
                               ContactProblem& problem) {
  for (const int index : group.linked) engines::add_rows(moving_.linked_groups()[static_cast<std::size_t>(index)], states, t, places, problem);
  if (!of_places) return keep_rates(problem);
  problem.row_targets.resize(static_cast<Eigen::Index>(problem.rows.size()));
  for (std::size_t k = 0; k < problem.rows.size(); ++k) problem.row_targets[static_cast<Eigen::Index>(k)] = -problem.rows[k].row.value;
}

// Over a step of length h, which changes the velocities that the bodies would end with; with h = 0 those that they have now.
// With `ends`, the places that contact will leave them in: there a free body's momenta would be other velocities, and impulses change
// momenta. Without that, a body that spins about its slender axis gains or loses energy in proportion to the step.
ContactProblem LastingContacts::problem_of(const Group& group, const std::vector<Touch>& touches, const std::vector<RigidBodyState>& states, double h, const std::vector<RigidBodyState>* ends) {
  ContactProblem problem;
  std::map<int, int> places;
  const bool at_once = h == 0.0;
  const double t = at_once ? moving_.time() : moving_.target();
  for (const int body : group.bodies) {
    RigidBodyState free = at_once ? states[body] : moving_.path_end(body);
    if (ends) free.world_from_body = (*ends)[body].world_from_body;
    place(body, t, places, states, &free, problem);
  }
  for (const Touch& touch : touches) {
    PushingContact contact;
    contact.body_a = place(touch.pair.first, t, places, states, &states[touch.pair.first], problem);
    contact.body_b = place(touch.pair.second, t, places, states, &states[touch.pair.second], problem);
    contact.point_world = point_of(touch.pair, touch.point);
    contact.normal_b_to_a_world = touch.point.normal_b_to_a_world;
    contact.friction = friction(touch.pair);
    contact.target = touch.target;
    contact.slip_target_world = touch.slip_target_world;
    problem.contacts.push_back(contact);
  }
  if (!at_once) give_guesses(touches, states, h, group.pile ? kSamePointOfAPile : kSamePoint, problem);
  add_rows(group, moving_.states(), moving_.time(), places, false, problem);
  return problem;
}

// What an earlier attempt at this step has found for the pair, or else the last step.
const std::vector<LastingContacts::Warm>* LastingContacts::known_impulses(Pair pair) const {
  for (const auto* store : {&tried_, &warm_})
    if (const auto known = store->find(pair); known != store->end()) return &known->second;
  return nullptr;
}

// Impulses that are known already, each to the point that is nearest to where it acted.
void LastingContacts::give_guesses(const std::vector<Touch>& touches, const std::vector<RigidBodyState>& states, double h, double farthest, ContactProblem& problem) const {
  for (std::size_t from = 0, to = 0; from < touches.size(); from = to) {
    const Pair& pair = touches[from].pair;
    while (to < touches.size() && touches[to].pair == pair) ++to;
    const std::vector<Warm>* const warm = known_impulses(pair);
    if (!warm) continue;
    const RigidBodyState& a = states[pair.first];
    const double size = size_of(pair);
    for (const Warm& known : *warm) {
      const Vector3d acted = a.com_world + a.world_from_body * known.point_body_a;
      PushingContact* nearest = nullptr;
      double least = farthest * size;
      for (std::size_t i = from; i < to; ++i) {
        const double distance = (problem.contacts[i].point_world - acted).norm();
        if (distance >= least) continue;
        least = distance;
        nearest = &problem.contacts[i];
      }
      // A longer step needs more where the force lasts, no more where it was a blow.
      if (nearest) nearest->guess_world += std::min(1.0, h / known.duration) * known.impulse_world;
    }
  }
}

ContactSolution LastingContacts::solve(const Group& group, const ContactProblem& problem, double h) {
  ++counters_.contact_solves;
  counters_.contact_points += problem.contacts.size();
  const auto smooth = [](const PushingContact& c) { return c.friction == 0.0; };
  const bool frictionless = std::all_of(problem.contacts.begin(), problem.contacts.end(), smooth);
  if (!frictionless) counters_.friction_points += static_cast<std::uint64_t>(std::count_if(problem.contacts.begin(), problem.contacts.end(), [&](const auto& c) { return !smooth(c); }));
  if (!frictionless || !problem.rows.empty() || static_cast<int>(problem.contacts.size()) > kMostOfStudents) {
    ContactOptions options;
    if (static_cast<int>(problem.contacts.size()) > kMostLocated) options.tolerance = kEnough;
    if (speed(group) > kMoving * rest_speed_) options.enough = kEnough;   // what stands has to be found to the last digit
    if (rules_.plastic_impacts == scene::PlasticImpacts::kInStep && problem.contacts.size() > kPile) {
      options.tolerance = kEnoughOfAPile;
      options.largest_direct = 0;
      options.most_sweeps_alone = kSweepsOfAPile;
    }
    ContactSolution solution = laws_.friction_impulses ? laws_.friction_impulses(problem, options) : solve_contacts(problem, options);
    if (!laws_.friction_impulses && !solution.converged && solution.residual > kFarOff) {   // a guess can lead astray: once more from nothing, with every means
      ContactProblem afresh = problem;
      for (PushingContact& contact : afresh.contacts) contact.guess_world.setZero();
      ContactOptions every;
      every.tolerance = options.tolerance;
      ContactSolution again = solve_contacts(afresh, every);
      again.sweeps += solution.sweeps;
      again.factorisations += solution.factorisations;
      if (again.residual < solution.residual) solution = std::move(again);
    }
    counters_.contact_sweeps += static_cast<std::uint64_t>(solution.sweeps);
    sweeps_ += static_cast<std::uint64_t>(solution.sweeps);
    counters_.contact_factorisations += static_cast<std::uint64_t>(solution.factorisations);
    if (!solution.converged) ++counters_.contact_unsolved;
    return solution;
  }
  // The laws' part: A f + b are accelerations, f forces.
  const Eigen::Index m = static_cast<Eigen::Index>(problem.contacts.size()), n = 6 * static_cast<Eigen::Index>(problem.bodies.size());
  MatrixXd J = MatrixXd::Zero(m, n), MJ = MatrixXd::Zero(n, m);
  VectorXd b(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const PushingContact& c = problem.contacts[i];
    double rate = 0.0;
    for (const auto& [index, sign] : {std::pair{c.body_a, 1.0}, std::pair{c.body_b, -1.0}}) {
      const PushedBody& body = problem.bodies[index];
      const Vector3d push = sign * c.normal_b_to_a_world, turn = (c.point_world - body.com_world).cross(push);
      J.block<1, 3>(i, 6 * index) = push.transpose();
      J.block<1, 3>(i, 6 * index + 3) = turn.transpose();
      MJ.block<3, 1>(6 * index, i) = body.inverse_mass * push;
      MJ.block<3, 1>(6 * index + 3, i) = body.inverse_inertia_world * turn;
      rate += push.dot(velocity_at(body, body.velocity_world, body.omega_world, c.point_world));
    }
    b[i] = (rate - c.target) / h;
  }
  const VectorXd f = naming("body '" + moving_.world().bodies[group.bodies.front()].name + "' and what it touches", [&] { return laws_.contact_forces(J * MJ, b); });
  if (f.size() != m) throw StoppedRun("lasting contact (contact_forces of " + laws_.constraint_source + ") returned " + std::to_string(f.size()) + " forces for " + std::to_string(m) + " points");
  const VectorXd change = MJ * (h * f);
  ContactSolution solution;
  for (Eigen::Index i = 0; i < m; ++i) {
    solution.impulses_world.push_back(h * f[i] * problem.contacts[i].normal_b_to_a_world);
    solution.modes.push_back(f[i] > 0 ? ContactMode::kSlide : ContactMode::kOpen);
  }
  for (std::size_t k = 0; k < problem.bodies.size(); ++k)
    solution.velocities.push_back({problem.bodies[k].velocity_world + change.segment<3>(6 * static_cast<Eigen::Index>(k)),
                                   problem.bodies[k].omega_world + change.segment<3>(6 * static_cast<Eigen::Index>(k) + 3)});
  solution.converged = true;
  return solution;
}

// Where a pair that slid and would stick at the end of the step stops sliding: when the friction that stops it is all there can be. What
// stops the slip is A + F s, with F the steady forces along it, the friction at hand M s; two steps of different lengths tell A and F.
std::optional<double> LastingContacts::stop_of_sliding(const ContactProblem& problem, const std::vector<Touch>& touches, const ContactSolution& solution, double h) {
  if (static_cast<int>(touches.size()) > kMostLocated) return std::nullopt;
  const Pair* stopping = nullptr;
  double least = 1.0, stopping_impulse = 0.0, at_hand = 0.0;
  for (std::size_t i = 0; i < touches.size();) {
    const Pair& pair = touches[i].pair;
    Vector3d along = Vector3d::Zero();
    Vector3d slips = Vector3d::Zero();   // of the point that slides fastest
    double limit = 0.0, slip = 0.0, speed = 0.0;
    bool sticks = true;
    for (; i < touches.size() && touches[i].pair == pair; ++i) {
      const PushingContact& c = problem.contacts[i];
      const Vector3d& n = c.normal_b_to_a_world;
      const auto velocity = [&](int body) -> Vector3d {
        const Body b = moving_.body_at_impact(body);
        const Vector3d arm = point_of(pair, touches[i].point) - b.com_world;
        if (!moving_.world().bodies[body].immovable()) speed = std::max(speed, b.velocity_world.norm() + b.omega_world.norm() * arm.norm());
        return b.velocity_world + b.omega_world.cross(arm);
      };
      const Vector3d va = velocity(pair.first), vb = velocity(pair.second), relative = va - vb;   // at the step's start, where it touched then
      if (const Vector3d slides = relative - relative.dot(n) * n; slides.norm() > slip) {
        slips = slides;
        slip = slides.norm();
      }
      speed = std::max({speed, va.norm(), vb.norm()});
      const double normal = solution.impulses_world[i].dot(n);
      along += solution.impulses_world[i] - normal * n;
      limit += c.friction * normal;
      sticks = sticks && (solution.modes[i] == ContactMode::kStick || (solution.modes[i] == ContactMode::kOpen && normal == 0.0));
    }
    // What friction stops within a billionth of the step has stopped.
    const double within_step = limit * (moving_.world().bodies[pair.first].inertia.inverse_mass + moving_.world().bodies[pair.second].inertia.inverse_mass);
    if (!sticks || stuck_.contains(pair) || !(limit > 0) || slip <= kSlides * (speed + within_step)) continue;
    if (along.norm() >= least * limit) continue;
    least = along.norm() / limit;
    stopping = &pair;
    stopping_impulse = -along.dot(slips) / slip;   // signed: on a slope gravity may do more than stop it, and friction holds it then
    at_hand = limit;
  }
  if (!stopping) return std::nullopt;
  if (!(moving_.time() < searched_from_ + step_)) {
    searched_from_ = moving_.time();
    searches_ = 0;
  }
  if (++searches_ > kMostSearches) return std::nullopt;
  if (locating_ && locating_->pair == *stopping && locating_->start == moving_.time()) {
    if (locating_->found) return std::nullopt;
    const double F = (locating_->impulse - stopping_impulse) / (locating_->duration - h), A = stopping_impulse - F * h, M = at_hand / h;
    const double stop = A / (M - F);
    if (!(stop > kShortest * step_) || !(stop < locating_->duration)) return std::nullopt;
    locating_->found = true;
    return moving_.time() + stop;
  }
  if (least >= 1 - 1e-12 || h <= kShortest * step_) return std::nullopt;
  locating_ = Locating{*stopping, moving_.time(), h, stopping_impulse, false};
  return moving_.time() + h * std::max(least, 1e-3);
}

// Does anything come down in this step that did not touch before?
bool LastingContacts::lands(const std::vector<Touch>& touches, const ContactSolution& solution) {
  for (std::size_t i = 0; i < touches.size(); ++i)
    if (touches[i].lands && solution.impulses_world[i].squaredNorm() > 0.0) return true;
  return false;
}

// Where the group's bodies come out with these impulses.
// @param at  where the problem took the inertia of the bodies, null: at the end of their free paths
std::vector<RigidBodyState> LastingContacts::ends_of(const Group& group, const ContactProblem& problem, const ContactSolution& solution, double h, bool landing, const std::vector<RigidBodyState>* at) const {
  std::vector<RigidBodyState> ends = moving_.states();
  for (std::size_t k = 0; k < group.bodies.size(); ++k) {   // the problem's first bodies are the group's
    const int body = group.bodies[k];
    const Inertia& inertia = moving_.world().bodies[body].inertia;
    const Velocity& after = solution.velocities[k];
    RigidBodyState& end = ends[body];
    if (landing) {
      end.com_world += h * after.linear_world;
      end.world_from_body = turned(end.world_from_body, h * after.angular_world);
      end.angular_momentum_world = angular_momentum_of(after.angular_world, end.world_from_body, inertia);
    } else {
      const RigidBodyState& free = moving_.path_end(body);
      const Vector3d turning = after.angular_world - problem.bodies[k].omega_world;
      end.com_world = free.com_world + 0.5 * h * (after.linear_world - problem.bodies[k].velocity_world);
      end.world_from_body = turned(free.world_from_body, 0.5 * h * turning);
      end.angular_momentum_world = free.angular_momentum_world + angular_momentum_of(turning, (at ? (*at)[body] : free).world_from_body, inertia);
    }
    end.momentum_world = inertia.mass * after.linear_world;
  }
  return ends;
}

// The angle that the fastest of the group's bodies turns in the step; a ball looks the same however it turns.
double LastingContacts::largest_turn(const Group& group, const std::vector<RigidBodyState>& ends, double h) const {
  double turn = 0.0;
  for (const int body : group.bodies)
    if (!moving_.shape(body).is_ball()) turn = std::max(turn, omega_of(ends[body], moving_.world().bodies[body].inertia).norm() * h);
  return turn;
}

// The angle that the normal between two balls turns most in the step: the one that slides or rolls on the other follows its curve.
double LastingContacts::turn_of_normals(const Group& group, const std::vector<RigidBodyState>& ends) const {
  double turn = 0.0;
  for (const Pair& pair : group.pairs) {
    if (!are_balls(pair) || points_.at(pair).empty()) continue;
    const auto end = [&](int body) -> Vector3d { return moving_.world().bodies[body].immovable() ? prescribed_position(moving_.world().bodies[body], moving_.target()) : ends[body].com_world; };
    const Vector3d start = moving_.state(pair.first).com_world - moving_.state(pair.second).com_world, stop = end(pair.first) - end(pair.second);
    turn = std::max(turn, std::atan2(start.cross(stop).norm(), start.dot(stop)));
  }
  return turn;
}

// The point of `points` that is `p` at another time: fixed in one of the two bodies. Null where none lies as near as that.
const collision::NearPoint* LastingContacts::same_point(Pair pair, const collision::NearPoint& p, const std::vector<RigidBodyState>& p_at, const Points& points,
                                                        const std::vector<RigidBodyState>& at, double near) {
  const auto in = [](const RigidBodyState& s, const Vector3d& x) -> Vector3d { return s.world_from_body.conjugate() * (x - s.com_world); };
  const collision::NearPoint* best = nullptr;
  double distance = near;
  for (const collision::NearPoint& q : points) {
    const double d = std::min((in(p_at[pair.first], p.point_a_world) - in(at[pair.first], q.point_a_world)).norm(),
                              (in(p_at[pair.second], p.point_b_world) - in(at[pair.second], q.point_b_world)).norm());
    if (d >= distance) continue;
    distance = d;
    best = &q;
  }
  return best;
}

// Contacts of a group that turns: at the middle of the step, where their forces act evenly, with targets that make the velocities at the
// step's end fit the surfaces there: J_middle v' = target - (J_end - J_middle) v'. Without that a body that tips over its edge gains or
// loses energy in proportion to the step.
std::vector<LastingContacts::Touch> LastingContacts::touches_midway(const Group& group, const std::vector<Touch>& touches, const std::vector<RigidBodyState>& ends,
                                                                    std::vector<RigidBodyState>& middle) const {
  const std::vector<RigidBodyState>& starts = moving_.states();
  for (const int body : group.bodies) {
    middle[body].com_world = 0.5 * (starts[body].com_world + ends[body].com_world);
    middle[body].world_from_body = starts[body].world_from_body.slerp(0.5, ends[body].world_from_body);
  }
  const auto slip = [&](Pair pair, const std::vector<RigidBodyState>& at, const collision::NearPoint& p) -> Vector3d {
    const Vector3d point = point_of(pair, p);
    const auto velocity = [&](int body) -> Vector3d {
      const WorldBody& b = moving_.world().bodies[body];
      if (b.immovable()) return prescribed_velocity(b, moving_.target());
      return b.inertia.inverse_mass * ends[body].momentum_world + omega_of(ends[body], b.inertia).cross(point - at[body].com_world);
    };
    return velocity(pair.first) - velocity(pair.second);
  };
  std::vector<Touch> result;
  std::size_t from = 0;
  for (const Pair& pair : group.pairs) {
    std::size_t to = from;
    while (to < touches.size() && touches[to].pair == pair) ++to;
    double farthest = 0.0;   // no point of the contact can be farther off by the step's end
    for (std::size_t i = from; i < to; ++i) farthest = std::max({farthest, touches[i].start_gap, touches[i].point.gap});
    for (const int body : {pair.first, pair.second})
      farthest += (ends[body].com_world - starts[body].com_world).norm() +
                  (moving_.shape(body).is_half_space() ? 0.0 : moving_.shape(body).bounding_radius() * starts[body].world_from_body.angularDistance(ends[body].world_from_body));
    const double near = same_within(pair), reach = are_balls(pair) ? size_of(pair) : std::min(near, farthest + shell(pair));
    const Points at_middle = points_at(pair, middle, reach), at_end = points_at(pair, ends, reach);
    for (std::size_t i = from; i < to; ++i) {
      Touch touch = touches[i];
      const collision::NearPoint* mid = same_point(pair, touch.point, starts, at_middle, middle, near);
      const collision::NearPoint* end = mid ? same_point(pair, *mid, middle, at_end, ends, near) : nullptr;
      if (mid && end) {
        touch.point = *mid;
        const Vector3d at_end_point = slip(pair, ends, *end), at_mid_point = slip(pair, middle, *mid);
        touch.target -= end->normal_b_to_a_world.dot(at_end_point) - mid->normal_b_to_a_world.dot(at_mid_point);
        touch.slip_target_world = at_mid_point - at_end_point;
      }
      result.push_back(touch);
    }
    from = to;
  }
  return result;
}

// @return whether no overlap was left
bool LastingContacts::give_paths(const Group& group, const std::vector<Touch>& touches, const std::vector<RigidBodyState>& touches_at, const ContactProblem& problem,
                                 const ContactSolution& solution, double h, bool landing, const std::vector<RigidBodyState>* at) {
  std::vector<RigidBodyState> ends = ends_of(group, problem, solution, h, landing, at);
  std::vector<Held> held;   // where nothing turns, points stay as near as they are
  if (&touches_at != &moving_.states() && !landing && touches.size() <= kPile)
    for (std::size_t i = 0; i < touches.size(); ++i)
      if (touches[i].start_gap < kNotYet * shell(touches[i].pair) && solution.impulses_world[i].squaredNorm() > 0.0) held.push_back({touches[i].pair, touches[i].point, &touches_at});
  // Pairs that are not in contact may meet within the step: that is for the finding of impacts.
  const bool apart = keep_apart(group, group.pairs, ends, moving_.target(), held);
  // The path goes where a shift has taken its end, however short the step: velocities along it are no momenta. What rods and joints hold is put
  // right where a step ends within it (MovingWorld::commit).
  for (const int body : group.bodies) {
    if (landing) set_straight_path(body, ends[body]);
    else moving_.set_path(body, moving_.state(body), ends[body], SmoothPath::Momenta::kEven);
    moving_.refuse_whirl(body);
  }
  return apart;
}

// From place to place, as x' = x + h v' says: a bent path would dip below the surface on its way.
void LastingContacts::set_straight_path(int body, const RigidBodyState& end) {
  const Inertia& inertia = moving_.world().bodies[body].inertia;
  RigidBodyState start = moving_.state(body);
  start.momentum_world = end.momentum_world;
  start.angular_momentum_world = angular_momentum_of(omega_of(end, inertia), start.world_from_body, inertia);
  moving_.set_path(body, start, end, SmoothPath::Momenta::kEven);
}

// A contact of a problem of shifts: bodies of other groups stay where they are.
void LastingContacts::place_for_shift(const Group& group, Pair pair, const collision::NearPoint& point, const std::vector<RigidBodyState>& states, double t, double room,
                                      std::map<int, int>& places, ContactProblem& problem, PushingContact& contact) {
  contact.body_a = place(pair.first, t, places, states, nullptr, problem);
  contact.body_b = place(pair.second, t, places, states, nullptr, problem);
  for (const int index : {contact.body_a, contact.body_b})
    if (index >= static_cast<int>(group.bodies.size())) {
      problem.bodies[index].inverse_mass = 0.0;
      problem.bodies[index].inverse_inertia_world.setZero();
    }
  contact.point_world = point_of(pair, point);
  contact.normal_b_to_a_world = point.normal_b_to_a_world;
  contact.target = room - point.gap;
}

// Momenta follow: the velocities stay. @return whether the body has moved
bool LastingContacts::apply_shift(int body, const Velocity& shift, std::vector<RigidBodyState>& states) const {
  if (shift.linear_world.isZero(0.0) && shift.angular_world.isZero(0.0)) return false;
  RigidBodyState& state = states[body];
  const Inertia& inertia = moving_.world().bodies[body].inertia;
  const Vector3d omega = omega_of(state, inertia);
  state.com_world += shift.linear_world;
  state.world_from_body = turned(state.world_from_body, shift.angular_world);
  state.angular_momentum_world = angular_momentum_of(omega, state.world_from_body, inertia);
  return true;
}

// The group's contacts as they are in these places: what each has to move by. Points farther apart than `reach` are no concern.
// @return the farthest that any too near, or held too far, has to move; 0 where none is
double LastingContacts::add_shifts(const Group& group, const std::vector<Pair>& pairs, const std::vector<RigidBodyState>& states, double t, const std::vector<Held>& held, double reach,
                                   std::map<int, int>& places, ContactProblem& problem) {
  double wrong = 0.0;
  for (const Pair& pair : pairs) {
    const double room = shell(pair), size = size_of(pair);
    const bool holds = std::any_of(held.begin(), held.end(), [&](const Held& h) { return h.pair == pair; });
    const Points points = points_at(pair, states, std::max({1e3 * room, reach, holds ? (are_balls(pair) ? 1.0 : kHeldReach) * size : 0.0}));
    std::vector<const collision::NearPoint*> at_shell;
    for (const Held& h : held)
      if (h.pair == pair) at_shell.push_back(same_point(pair, h.point, *h.at, points, states, same_within(pair)));
    for (const collision::NearPoint& point : points) {
      const bool is_held = std::find(at_shell.begin(), at_shell.end(), &point) != at_shell.end();
      if (point.gap < 0.5 * room || (is_held && point.gap > 2 * room)) wrong = std::max(wrong, std::abs(room - point.gap));
      PushingContact contact;
      place_for_shift(group, pair, point, states, t, room, places, problem, contact);
      if (is_held) {
        Constraint row;
        row.body_a = contact.body_a;
        row.body_b = contact.body_b;
        const Vector3d& n = contact.normal_b_to_a_world;
        row.row.jacobian_a << n, (contact.point_world - problem.bodies[contact.body_a].com_world).cross(n);
        row.row.jacobian_b << -n, -(contact.point_world - problem.bodies[contact.body_b].com_world).cross(n);
        row.row.value = -contact.target;
        problem.rows.push_back(row);
      } else {
        problem.contacts.push_back(contact);
      }
    }
  }
  return wrong;
}

// The smallest shift (in the measure of the masses) that leaves no gap of these pairs below its shell, and no rod or joint open; held
// points come to lie at their shell.
// @return whether it was found
bool LastingContacts::keep_apart(const Group& group, const std::vector<Pair>& pairs, std::vector<RigidBodyState>& states, double t, const std::vector<Held>& held) {
  for (int i = 0; i < moving_.size(); ++i)
    if (moving_.world().bodies[i].immovable()) states[i].com_world = prescribed_position(moving_.world().bodies[i], t);
  double reach = 0.0;
  for (int round = 0; round < kMostShifts; ++round) {
    ContactProblem problem;
    std::map<int, int> places;
    for (const int body : group.bodies) place(body, t, places, states, nullptr, problem);
    limit_ratios(problem);
    const double wrong = add_shifts(group, pairs, states, t, round < kHeldRounds ? held : std::vector<Held>{}, reach, places, problem);
    if (kShiftReach * wrong > reach) {   // what a shift this long may bring together has to be in it
      reach = 2 * kShiftReach * wrong;
      if (round == 0) continue;
    }
    add_rows(group, states, t, places, true, problem);
    double size = 0.0;
    for (const int body : group.bodies) size = std::max(size, states[body].com_world.cwiseAbs().maxCoeff());
    const bool open = problem.row_targets.size() > 0 && problem.row_targets.cwiseAbs().maxCoeff() > 1e-13 * size;
    if (wrong == 0.0 && !open) return true;
    ++counters_.nudges;
    // The solver measures its answers by the farthest point, which need not move at all. Held points, rods and joints are drawn together by what
    // is of another size.
    double part = 1.0;
    if (problem.rows.empty()) {
      double largest = wrong;
      for (const PushingContact& contact : problem.contacts) largest = std::max(largest, std::abs(contact.target));
      part = wrong / largest;
    }
    ContactOptions options;   // the next round takes the rest
    options.tolerance = std::max(kSolverRounding, kMissed * part);
    options.enough = std::max(kSolverRounding, kMissedAtMost * part);
    const ContactSolution shift = solve_contacts(problem, options);
    sweeps_ += static_cast<std::uint64_t>(shift.sweeps);
    for (std::size_t k = 0; k < group.bodies.size(); ++k) apply_shift(group.bodies[k], shift.velocities[k], states);
  }
  return false;
}

}  // namespace tumble::engines
