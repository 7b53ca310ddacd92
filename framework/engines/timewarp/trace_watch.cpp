#include "framework/engines/timewarp/trace_watch.h"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "framework/engines/base/guarded_laws.h"

namespace tumble::engines {
namespace {

bool same_bits(double x, double y) {
  return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
}
bool same_event(const Event& x, const Event& y) {
  return same_bits(x.time, y.time) && x.kind == y.kind && x.body_a == y.body_a &&
         x.body_b == y.body_b && same_bits(x.impulse, y.impulse);
}
// Switching times are known in advance and committed with the next item: a scheduler cannot lose
// them.
bool is_switch(const Event& event) {
  return event.kind == EventKind::kForceOn || event.kind == EventKind::kForceOff;
}
bool same_pair(const Event& x, const Event& y) {
  return x.body_a == y.body_a && x.body_b == y.body_b;
}

}  // namespace

std::string TraceWatch::in_words(const Event& event) const {
  const auto name = [&](int body) {
    return body < 0 ? std::string("-")
                    : "'" + reference_.bodies[static_cast<std::size_t>(body)].name + "'";
  };
  return fmt::format("{} and {} at t = {:.9g} s, impulse {:.6g} N s", name(event.body_a),
                     name(event.body_b), event.time, event.impulse);
}

std::string TraceWatch::likely(const Event& expected, const Event& found) const {
  const auto from = reference_.events.begin() + static_cast<std::ptrdiff_t>(events_);
  if (std::any_of(reference_.events.begin(), from,
                  [&](const Event& event) { return same_event(event, found); }))
    return "it was committed before: an impact was executed twice";
  if (std::any_of(from, reference_.events.end(),
                  [&](const Event& event) { return same_event(event, found); }))
    return same_bits(expected.time, found.time)
               ? "it is expected, but later: of two events at one instant the wrong one came first "
                 "(comes_before)"
               : "it is expected, but later: an earlier impact was lost or not yet found (the "
                 "interval of a check, or the check after a rollback), or events are committed out "
                 "of order";
  if (same_pair(expected, found) && same_bits(expected.time, found.time))
    return "the same impact with other velocities: one of the two bodies had a state that should "
           "have been rolled back";
  if (found.time < expected.time)
    return "no such impact belongs there: an earlier event was rolled back without it "
           "(anti-messages), or an earlier impact was lost";
  return "an impact was lost: the interval that contains it was never checked, or the check that "
         "had found it was dropped";
}

void TraceWatch::event(const Event& event) {
  const bool is_judged = events_ < reference_.events.size() || reference_.stopped_by.empty();
  if (is_judged && events_ >= reference_.events.size())
    throw StoppedRun(
        fmt::format("committed event {} is not the ordered reference's: expected nothing more; "
                    "found {}. Likely: the rollback that takes it back was left out",
                    events_ + 1, in_words(event)));
  if (is_judged && !same_event(reference_.events[events_], event)) {
    const Event& expected = reference_.events[events_];
    throw StoppedRun(fmt::format(
        "committed event {} is not the ordered reference's: expected {}; found {}. Likely: {}",
        events_ + 1, in_words(expected), in_words(event), likely(expected, event)));
  }
  ++events_;
  sink_.event(event);
}

void TraceWatch::frame(const Frame& frame) {
  const auto is_due = [&](const Event& event) {
    return event.time < frame.time || (event.time == frame.time && !is_switch(event));
  };
  if (events_ < reference_.events.size() && is_due(reference_.events[events_]))
    throw StoppedRun(fmt::format(
        "committed event {} is missing: expected {}; found the frame at t = {:.9g} s. Likely: {}",
        events_ + 1, in_words(reference_.events[events_]), frame.time,
        "an impact was lost (the interval that contains it was never checked, or the check that "
        "had found it was dropped), or the frame was committed before it was certain "
        "(global_virtual_time, may_commit)"));
  if (frames_ < reference_.frames.size()) {
    const Frame& expected = reference_.frames[frames_];
    for (std::size_t i = 0; i < frame.poses.size(); ++i) {
      if (frame.poses[i].com_world == expected.poses[i].com_world &&
          frame.poses[i].world_from_body.coeffs() == expected.poses[i].world_from_body.coeffs())
        continue;
      const Vector3d &e = expected.poses[i].com_world, &f = frame.poses[i].com_world;
      throw StoppedRun(fmt::format(
          "the frame at t = {:.9g} s is not the ordered reference's: '{}' is expected at ({:.6g}, "
          "{:.6g}, {:.6g}) m; found at ({:.6g}, {:.6g}, {:.6g}) m. Likely: it was committed before "
          "it was certain (global_virtual_time, may_commit), or after an "
          "impact that is lost",
          frame.time, reference_.bodies[i].name, e.x(), e.y(), e.z(), f.x(), f.y(), f.z()));
    }
  }
  ++frames_;
  sink_.frame(frame);
}

std::string TraceWatch::missing() const {
  if (!reference_.stopped_by.empty() ||
      std::all_of(reference_.events.begin() + static_cast<std::ptrdiff_t>(events_),
                  reference_.events.end(), is_switch))
    return "";
  return fmt::format(
      "committed event {} is missing: expected {}; found nothing more. Likely: an impact was lost: "
      "the interval that contains it was never checked, or the check that had found it was dropped",
      events_ + 1, in_words(reference_.events[events_]));
}

}  // namespace tumble::engines
