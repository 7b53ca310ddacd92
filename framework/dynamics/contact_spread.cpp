#include "framework/dynamics/contact_spread.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "framework/dynamics/contact_sweeps.h"

namespace tumble::contacts {
namespace {

// of the approach between two bodies without impulses: errors of a step are of third order in it,
// an approach of first. Larger: contacts that open slowly share a load for some steps. Smaller:
// long steps leave it to these errors.
constexpr double kNearlyClosed = 0.1;
// of what a normal's row is by itself, its square: beyond others it says nothing of its own
constexpr double kDependent = 1e-9;
// of the mean inverse effective mass. Larger: more is left to take out. Smaller: the modes hang on
// the last digits.
constexpr double kCompliance = 1e-5;
// times the compliance: the problems that lead to it, and how soft one may be for what its surfaces
// have yielded to be taken out again
constexpr double kSofter[] = {1e4, 1e3, 100, 10, 1};
constexpr double kHardEnough = 100;
// once, and then twice about its own answer: each leaves some kCompliance of what was left before
constexpr int kRounds = 3;
// the softest problem is begun from nothing, each other one from the answer of a softer one
constexpr int kSteps = 6, kFirstSweeps = 300, kSweeps = 30;
// of what surfaces yield under the largest impulse: how evenly the load is asked to be spread; and
// of the problem's speed: what will do where rounding leaves no better
constexpr double kSolved = 1e-5, kSolvedEnough = 1e-10;
// of the largest normal impulse: an answer that is as even as this stays, to the bit
constexpr double kEven = 1e-9;

Progress nothing(const System& system) {
  Progress progress;
  progress.impulses.contacts.assign(system.contacts.size(), Vector3d::Zero());
  progress.impulses.rows.assign(system.rows.size(), 0.0);
  sum_impulses(system, progress.impulses);
  return progress;
}

/// Rows as vectors over all bodies, orthogonal to those before.
class Span {
 public:
  explicit Span(std::size_t bodies) : size_(6 * static_cast<Eigen::Index>(bodies)) {}
  /// @return whether the row says what others have not said
  bool add(int body_a, const Vector6d& g_a, int body_b, const Vector6d& g_b) {
    VectorXd row = VectorXd::Zero(size_);
    if (body_a != kFixed) row.segment<6>(6 * body_a) += g_a;
    if (body_b != kFixed) row.segment<6>(6 * body_b) += g_b;
    const double whole = row.squaredNorm();
    for (int pass = 0; pass < 2; ++pass)  // the second takes the rounding of the first
      for (const VectorXd& known : basis_) row -= known.dot(row) * known;
    const double left = row.squaredNorm();
    if (!(left > kDependent * whole)) return false;
    basis_.push_back(row / std::sqrt(left));
    return true;
  }

 private:
  Eigen::Index size_;
  std::vector<VectorXd> basis_;
};

/// Whether rods and joints let normals of these contacts move the bodies as others do, beyond the
/// points of two surfaces: four corners of a free box share its weight, too, but no lever of a link
/// makes the shares of some of them large.
bool is_left_open_by_links(const System& system, const std::vector<std::size_t>& closed) {
  constexpr std::size_t kOfPlane = 3;  // points of a plane that say something of their own
  Span span(system.root_inverse_mass.size());
  for (const RowBlock& row : system.rows) span.add(row.body_a, row.g_a, row.body_b, row.g_b);
  constexpr double kParallel = 1 - 1e-6;  // cosine: surfaces are flat to a part of their size
  std::map<std::pair<int, int>, std::vector<Vector3d>> normals;  // of a plane, by bodies
  int repeated = 0;
  for (const std::size_t i : closed) {
    const ContactBlock& c = system.contacts[i];
    if (!span.add(c.body_a, c.g_a.row(0).transpose(), c.body_b, c.g_b.row(0).transpose()))
      ++repeated;
    const Vector3d normal = c.contact_from_world.row(0).transpose();
    std::vector<Vector3d>& plane = normals[{c.body_a, c.body_b}];
    if (!plane.empty() && plane.front().dot(normal) < kParallel) continue;  // of another surface
    plane.push_back(normal);
    if (plane.size() > kOfPlane) --repeated;
  }
  return repeated > 0;
}

std::vector<std::size_t> closed_contacts(const System& system, const Impulses& impulses,
                                         double indistinct) {
  std::map<std::pair<int, int>, double> approach;  // by bodies, without impulses
  for (const ContactBlock& c : system.contacts) {
    double& largest = approach[{c.body_a, c.body_b}];
    largest = std::max(largest, -c.base[0]);
  }
  std::vector<std::size_t> closed;
  for (std::size_t i = 0; i < system.contacts.size(); ++i) {
    const ContactBlock& c = system.contacts[i];
    if (c.inverse_effective_mass > 0 &&
        std::abs(contact_velocity(c, impulses.y)[0]) <=
            std::max(indistinct, kNearlyClosed * approach[{c.body_a, c.body_b}]))
      closed.push_back(i);
  }
  return closed;
}

/// The problem with closed contacts that yield, and whose targets fit each other and those of rows:
/// as far as an answer has them.
class YieldingContacts {
 public:
  YieldingContacts(const System& system, const std::vector<std::size_t>& closed,
                   const Impulses& impulses)
      : system_(system), matrix_(system_), closed_(closed) {
    double mean = 0, largest = 0;
    for (const std::size_t i : closed_) {
      ContactBlock& c = system_.contacts[i];
      c.base[0] -= contact_velocity(c, impulses.y)[0];
      bases_.push_back(c.base[0]);
      mean += c.inverse_effective_mass / static_cast<double>(closed_.size());
      largest = std::max(largest, impulses.contacts[i][0]);
    }
    for (RowBlock& row : system_.rows) row.base -= row_velocity(row, impulses.y);
    compliance_ = kCompliance * mean;
    goal_.violation = kSolved * compliance_ * largest;
  }
  YieldingContacts(const YieldingContacts&) = delete;
  YieldingContacts& operator=(const YieldingContacts&) = delete;

  /// From the answer itself, which is even already where the last step's was; else from zero, and
  /// else from what yields more, as far as that leads.
  Progress solve(const Impulses& impulses) {
    set_compliance(compliance_);
    Progress answer;
    answer.impulses = impulses;
    answer = settled(std::move(answer));
    if (answer.accepted) return answer;
    Progress afresh = nothing(system_);
    afresh.factorisations = answer.factorisations;
    answer = settled(std::move(afresh));
    if (answer.accepted) return answer;
    Progress softer = nothing(system_);
    softer.factorisations = answer.factorisations;
    return from_softer(std::move(softer));
  }

 private:
  void set_compliance(double compliance) {
    now_ = compliance;
    for (const std::size_t i : closed_) system_.contacts[i].compliance = compliance;
  }

  /// From nothing by problems that are harder each time, as far as that leads: the hardest of them
  /// whose answer settles.
  Progress from_softer(Progress progress) {
    std::vector<std::pair<double, Progress>> solved;  // with the compliance, softest first
    for (const double times : kSofter) {
      set_compliance(times * compliance_);
      harden(solved.empty() ? kFirstSweeps : kSweeps, progress);
      if (!progress.accepted) break;
      solved.emplace_back(times, progress);
    }
    progress.accepted = false;
    for (; !solved.empty() && solved.back().first <= kHardEnough; solved.pop_back()) {
      set_compliance(solved.back().first * compliance_);
      progress.impulses = std::move(solved.back().second.impulses);
      progress = settled(std::move(progress), true);
      if (progress.accepted) break;
    }
    return progress;
  }

  /// One problem of the way: sweeps find most modes, Newton's method the rest.
  void harden(int sweeps, Progress& progress) {
    Sweeper sweeper(system_);
    sweeper.begin();
    for (int k = 0; k < sweeps; ++k) sweeper.sweep(k % 2 == 0, progress.impulses);
    progress.sweeps += sweeps;
    sum_impulses(system_, progress.impulses);
    goal_.measure(progress);
    if (progress.accepted) return;
    Progress trial = progress;
    if (finish_yielding(goal_, kSteps, matrix_, trial))
      progress = std::move(trial);
    else
      finish(goal_, kSteps, matrix_, progress);
  }

  /// From these impulses, and then about what is found, v_n = -c (p_n - p_n before).
  /// @param thoroughly  with sweeps where Newton's method alone fails
  Progress settled(Progress progress, bool thoroughly = false) {
    for (int round = 0; round < kRounds; ++round) {
      goal_.measure(progress);
      Impulses begin = thoroughly ? progress.impulses : Impulses{};
      if (!finish_yielding(goal_, kSteps, matrix_, progress) && thoroughly) {
        progress.impulses = std::move(begin);
        harden(kSweeps, progress);
      }
      progress.accepted =
          progress.accepted || progress.violation.largest <= kSolvedEnough * system_.speed;
      if (!progress.accepted) break;
      for (std::size_t k = 0; k < closed_.size(); ++k)
        system_.contacts[closed_[k]].base[0] =
            bases_[k] - now_ * progress.impulses.contacts[closed_[k]][0];
    }
    for (std::size_t k = 0; k < closed_.size(); ++k)
      system_.contacts[closed_[k]].base[0] = bases_[k];
    return progress;
  }

  System system_;
  Goal goal_{system_};
  BodyMatrix matrix_;
  const std::vector<std::size_t>& closed_;
  std::vector<double> bases_;        // by closed contact: of its normal velocity
  double compliance_ = 0, now_ = 0;  // the hardest; that of the problem at hand
};

}  // namespace

LoadSharing spread(const Goal& goal, double indistinct, Progress& progress) {
  const System& system = goal.system;
  const std::vector<std::size_t> closed = closed_contacts(system, progress.impulses, indistinct);
  double largest = 0;
  for (const std::size_t i : closed) largest = std::max(largest, progress.impulses.contacts[i][0]);
  const bool has_friction = std::any_of(closed.begin(), closed.end(), [&](std::size_t i) {
    return system.contacts[i].is_frictional();
  });
  if (closed.size() < 2 || largest == 0 || !has_friction || !is_left_open_by_links(system, closed))
    return LoadSharing::kStatics;
  Progress even = YieldingContacts(system, closed, progress.impulses).solve(progress.impulses);
  progress.sweeps += even.sweeps;
  progress.factorisations += even.factorisations;
  if (!even.accepted) return LoadSharing::kUndecided;
  double change = 0;
  for (const std::size_t i : closed)
    change =
        std::max(change, std::abs(even.impulses.contacts[i][0] - progress.impulses.contacts[i][0]));
  if (change > kEven * largest) progress.impulses = std::move(even.impulses);
  return LoadSharing::kMostEven;
}

}  // namespace tumble::contacts
