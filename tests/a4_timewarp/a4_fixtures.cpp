#include "tests/a4_timewarp/a4_fixtures.h"

namespace tumble::a4_testing {

ScheduledEvent collision_check(std::int32_t a, std::int32_t b, double safe_time, double time,
                               std::vector<std::int32_t> receivers) {
  if (receivers.empty()) receivers = {a, b};
  return {impact(time, a, b), safe_time, receivers};
}

ScheduledEvent group_check(std::vector<std::int32_t> members, double safe_time, double time) {
  const std::int32_t lowest = members.front();
  return {{time, 0, WorkKind::kGroup, lowest, -1}, safe_time, std::move(members)};
}

ScheduledEvent callback(std::int32_t body, double time) {
  return {{time, 0, WorkKind::kCallback, body, -1}, time, {body}};
}

ScheduledEvent redraw(double time) {
  return {{time, kLastMicrostep, WorkKind::kRedraw, -1, -1}, kInfinity, {}};
}

Effect effect(double time, std::int32_t a, std::int32_t b, std::vector<std::int32_t> processes) {
  if (processes.empty()) processes = {a, b};
  return {impact(time, a, b), processes};
}

bool same(const Stamp& x, const Stamp& y) {
  return x.time == y.time && x.microstep == y.microstep && x.kind == y.kind &&
         x.body_a == y.body_a && x.body_b == y.body_b;
}
bool same(const Rollback& x, const Rollback& y) {
  return x.body == y.body && same(x.stamp, y.stamp);
}

std::string name_of(std::int32_t body) {
  return body == kWall            ? "the wall"
         : body >= A && body <= E ? std::string(1, static_cast<char>('A' + body))
                                  : "body " + std::to_string(body);
}

namespace {

const char* word_of(WorkKind kind) {
  switch (kind) {
    case WorkKind::kCallback: return "callback";
    case WorkKind::kCollision: return "collision";
    case WorkKind::kGroup: return "group check";
    case WorkKind::kRedraw: return "redraw";
  }
  return "something of no kind";
}

constexpr std::size_t kReadable = 8;  // of a list

}  // namespace

std::string show(const Stamp& stamp) {
  std::string text = word_of(stamp.kind);
  if (stamp.body_a >= 0) text += " of " + name_of(stamp.body_a);
  if (stamp.body_b >= 0) text += " and " + name_of(stamp.body_b);
  text += " at " + show(stamp.time) + " s";
  if (stamp.microstep == kLastMicrostep) return text + " (last microstep)";
  return stamp.microstep == 0 ? text
                              : text + " (microstep " + std::to_string(stamp.microstep) + ")";
}

std::string show(const ScheduledEvent& event) {
  return show(event.stamp) + ", safe time " + show(event.safe_time) + " s";
}

std::string show(const std::vector<Rollback>& rollbacks) {
  if (rollbacks.empty()) return "nobody goes back";
  std::string text;
  for (std::size_t i = 0; i < std::min(kReadable, rollbacks.size()); ++i)
    text +=
        (i > 0 ? "; " : "") + name_of(rollbacks[i].body) + " to the " + show(rollbacks[i].stamp);
  return rollbacks.size() > kReadable
             ? text + "; and " + std::to_string(rollbacks.size() - kReadable) + " more"
             : text;
}

std::string show(const std::vector<std::vector<std::int32_t>>& groups) {
  std::string text;
  for (std::size_t i = 0; i < std::min(kReadable, groups.size()); ++i) {
    text += i > 0 ? " {" : "{";
    for (std::size_t k = 0; k < groups[i].size(); ++k)
      text += (k > 0 ? ", " : "") + name_of(groups[i][k]);
    text += "}";
  }
  return text.empty() ? "no group" : text;
}

void expect_rollbacks(const std::vector<Rollback>& found, const std::vector<Rollback>& expected,
                      const Story& story) {
  const bool is_same = found.size() == expected.size() &&
                       std::equal(found.begin(), found.end(), expected.begin(),
                                  [](const Rollback& x, const Rollback& y) { return same(x, y); });
  expect_true(is_same, show(expected), show(found), story);
}

void expect_times(const ScheduledEvent& found, const ScheduledEvent& before, double safe_time,
                  double time, const Story& story) {
  ScheduledEvent expected = before;
  expected.safe_time = safe_time;
  expected.stamp.time = time;
  const bool is_same = same(found.stamp, expected.stamp) && found.safe_time == safe_time &&
                       found.receivers == before.receivers;
  expect_true(is_same, show(expected),
              show(found) + (found.receivers == before.receivers ? "" : ", other receivers"),
              story);
}

}  // namespace tumble::a4_testing
