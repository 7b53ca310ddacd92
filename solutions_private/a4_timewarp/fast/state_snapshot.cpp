#include "solutions_private/a4_timewarp/fast/state_snapshot.h"

#include <algorithm>
#include <string>
#include <type_traits>

namespace tumble::a4 {
namespace {

/// Writes numbers and containers of numbers in sequence, with their lengths.
class Bytes {
 public:
  template <class T>
  Bytes& operator<<(const T& value) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>)
      text_.append(reinterpret_cast<const char*>(&value), sizeof value);
    else if constexpr (requires { value.coeffs(); })
      *this << value.coeffs();
    else if constexpr (requires { value.allFinite(); })
      for (Eigen::Index k = 0; k < value.size(); ++k) *this << value.data()[k];
    else if constexpr (requires { value.first; })
      *this << value.first << value.second;
    else {
      *this << std::uint64_t{value.size()};
      for (const auto& element : value) *this << element;
    }
    return *this;
  }
  Bytes& operator<<(const RigidBodyState& s) {
    return *this << s.com_world << s.world_from_body << s.momentum_world
                 << s.angular_momentum_world;
  }
  Bytes& operator<<(const EventStamp& key) {
    return *this << key.time << key.microstep << key.kind << key.body_a << key.body_b;
  }
  Bytes& operator<<(const Event& e) {
    return *this << e.time << e.kind << e.body_a << e.body_b << e.point_world
                 << e.normal_b_to_a_world << e.impulse << e.normal_velocity_before
                 << e.normal_velocity_after;
  }
  Bytes& operator<<(const ContactPoint& p) {
    return *this << p.body_a << p.body_b << p.point_world << p.normal_b_to_a_world
                 << p.force_on_a_world;
  }
  Bytes& operator<<(const engines::ProcessState& s) {
    return *this << s.time << s.members << s.states << s.remembered << s.met << s.lasting << s.near;
  }
  Bytes& operator<<(const Flight& f) {
    return *this << f.begin << f.com_world << f.velocity_world << f.world_from_body << f.omega_body
                 << f.partner << f.partner_version << f.microstep << f.version << f.is_resting;
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

std::string states(const Shared& all) {
  Bytes bytes;
  for (const int body : all.world().movers()) {
    bytes << all.processes[static_cast<std::size_t>(body)].horizon
          << std::uint64_t{all.histories[body].size()};
    for (std::size_t k = 0; k < all.histories[body].size(); ++k) bytes << all.histories[body][k];
  }
  return bytes.take();
}

// The steps of a segment determine the motion of its members: sampled at their ends and in the
// middle.
void write_segment(Bytes& bytes, const Shared& all, int number, double t) {
  engines::IslandSegments& segments = all.world().all_processes().segments();
  bytes << segments.start(number);
  segments.for_each_step(number, all.committed, t, [&](const engines::ProcessStep& step) {
    bytes << step.from << step.end << step.forces;
    for (std::size_t member = 0; member < step.paths.size(); ++member)
      bytes << step.state_at(member, 0.5 * (step.from.time + step.end));
  });
}

std::string groups(const Shared& all, double t) {
  Bytes bytes;
  for (const int body : all.world().movers())
    for (std::size_t k = 0; k < all.histories[body].size(); ++k) {
      const Flight& flight = all.histories[body][k];
      if (flight.change >= 0) {
        std::vector<std::pair<int, std::uint32_t>> began = all.changes.began(flight.change);
        std::sort(began.begin(), began.end());
        bytes << all.changes.key(flight.change) << began;
      }
      if (flight.segment >= 0) write_segment(bytes, all, flight.segment, t);
    }
  // nothing leaked
  bytes << std::uint64_t{all.world().all_processes().segments().alive()}
        << std::uint64_t{all.changes.alive()};
  return bytes.take();
}

std::string events(Shared& all, std::vector<std::unique_ptr<Worker>>& workers) {
  std::vector<Due> waiting;
  for (const Domain& domain : all.domains)
    domain.queue.for_each([&](const Due& due) {
      if (workers.front()->is_to_come(due)) waiting.push_back(due);
    });
  std::sort(waiting.begin(), waiting.end(),
            [](const Due& x, const Due& y) { return x.key < y.key; });
  Bytes bytes;
  for (const Due& due : waiting) {
    bytes << due.key;
    // otherwise the version of an advance
    if (!is_advance(due)) bytes << due.version_a << due.version_b;
  }
  const auto stands = [&](int body, std::uint32_t version) {
    return body < 0 || !all.world().can_move(body) ||
           all.histories[body].find(version) < all.histories[body].size();
  };
  std::vector<const Executed*> executed;
  for (const auto& worker : workers)
    for (const Executed& event : worker->executed)
      if (stands(event.key.body_a, event.version_a) && stands(event.key.body_b, event.version_b))
        executed.push_back(&event);
  std::sort(executed.begin(), executed.end(),
            [](const Executed* x, const Executed* y) { return x->key < y->key; });
  for (const Executed* event : executed)
    bytes << event->key << event->version_a << event->version_b << event->first << event->more
          << event->is_silent;
  for (const bool called : all.called) bytes << called;
  return bytes.take();
}

// Sites are no part of the state.
std::string cells(const Shared& all) {
  std::vector<std::string> rows;
  for (const Domain& domain : all.domains)
    domain.pairs.for_each_row([&](char what, std::size_t place, int body, const auto& numbers) {
      Bytes row;
      row << what << place << body << numbers;
      rows.push_back(row.take());
    });
  for (const int body : all.world().movers())
    for (const Domain& domain : all.domains)
      domain.pairs.for_each_in(domain.pairs.box(body), [&](int other) {
        Bytes row;
        row << 'p' << body << other;
        rows.push_back(row.take());
      });
  std::sort(rows.begin(), rows.end());
  Bytes bytes;
  bytes << rows;
  return bytes.take();
}

}  // namespace

engines::StateSnapshot snapshot_of(Shared& all, std::vector<std::unique_ptr<Worker>>& workers,
                                   double t) {
  return {states(all), groups(all, t), events(all, workers), cells(all)};
}

}  // namespace tumble::a4
