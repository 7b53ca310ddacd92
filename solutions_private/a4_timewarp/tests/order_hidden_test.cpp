#include <algorithm>

#include "framework/core/random.h"
#include "tests/a4_timewarp/a4_fixtures.h"

namespace tumble::a4_testing {
namespace {

Stamp random_stamp(Random& random) {
  const std::int32_t a = static_cast<std::int32_t>(random.below(3)),
                     b = a + 1 + static_cast<std::int32_t>(random.below(3));
  return {0.5 * static_cast<double>(random.below(3)), static_cast<std::uint32_t>(random.below(3)),
          static_cast<WorkKind>(1 + random.below(4)), a, b};
}

// By digits of one number, most significant first.
long rank_of(const Stamp& stamp) {
  return ((((static_cast<long>(2 * stamp.time) * 3 + stamp.microstep) * 5 +
            static_cast<long>(stamp.kind)) *
               10 +
           stamp.body_a) *
          10) +
         stamp.body_b;
}

TEST(ComesBefore, IsOneTotalOrder) {
  Random random(411);
  for (int i = 0; i < 500; ++i) {
    const Stamp x = random_stamp(random), y = random_stamp(random);
    const bool expected = rank_of(x) < rank_of(y);
    expect_true(a4_module().comes_before(x, y) == expected,
                expected ? "x before y" : "not x before y",
                expected ? "not x before y" : "x before y",
                {.scene = "x: " + show(x) + "; y: " + show(y),
                 .slip = "time, microstep, kind, body_a, body_b: the first in which they differ "
                         "decides, and nothing after it",
                 .handout = equation(1)});
  }
}

TEST(ContactGroups, AreThoseOfRandomContacts) {
  Random random(412);
  for (int i = 0; i < 60; ++i) {
    const std::int32_t n = 1 + static_cast<std::int32_t>(random.below(12));
    std::vector<std::int32_t> bodies;
    for (std::int32_t k = 0; k < n; ++k) bodies.push_back(3 * k + 2);
    std::vector<GroupContact> contacts;
    for (std::uint64_t k = random.below(12); k > 0; --k) {
      const auto member = [&] { return bodies[random.below(bodies.size())]; };
      const std::int32_t a = member(), b = random.below(4) == 0 ? 100 : member();
      if (a != b) contacts.push_back({std::min(a, b), std::max(a, b), kInfinity});
    }
    // Labels that spread until nothing changes.
    std::vector<std::int32_t> label = bodies;
    for (bool changes = true; changes;) {
      changes = false;
      for (const GroupContact& contact : contacts) {
        const auto a = std::find(bodies.begin(), bodies.end(), contact.body_a) - bodies.begin(),
                   b = std::find(bodies.begin(), bodies.end(), contact.body_b) - bodies.begin();
        if (b == static_cast<std::ptrdiff_t>(bodies.size()) ||
            label[static_cast<std::size_t>(a)] == label[static_cast<std::size_t>(b)])
          continue;
        label[static_cast<std::size_t>(a)] = label[static_cast<std::size_t>(b)] =
            std::min(label[static_cast<std::size_t>(a)], label[static_cast<std::size_t>(b)]);
        changes = true;
      }
    }
    std::vector<std::vector<std::int32_t>> expected;
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      if (label[k] == bodies[k]) expected.push_back({});
      for (auto& group : expected)
        if (group.empty() || group.front() == label[k]) {
          group.push_back(bodies[k]);
          break;
        }
    }
    const auto found = a4_module().contact_groups(bodies, contacts);
    expect_true(found == expected, show(expected), show(found),
                {.scene = std::to_string(n) + " bodies, " + std::to_string(contacts.size()) +
                          " contacts drawn by lot",
                 .slip = "connected components: each body once, each group ascending, groups by "
                         "their lowest member",
                 .handout = equation(4)});
  }
}

}  // namespace
}  // namespace tumble::a4_testing
