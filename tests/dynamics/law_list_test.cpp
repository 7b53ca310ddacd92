// Laws by their types: which function is asked, whose it is, and what its guard refuses.
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "framework/dynamics/laws.h"

namespace tumble {
namespace {

struct Load {
  double force = kUnset;  // [N]
};
bool is_number(const Load& load) { return std::isfinite(load.force); }

/// Answers with a number.
struct Stretch {
  using Function = double(double force);
  static constexpr LawWords kWords{.function = "stretch",
                                   .effect = "bands",
                                   .what = "the stretch of a band",
                                   .assignment = "a7"};
};
/// Answers with a type of its own, which has a size to keep besides.
struct Share {
  using Function = Load(double force, int parts);
  static constexpr LawWords kWords{
      .function = "share", .effect = "bundles", .what = "the share of a band", .assignment = "a7"};
  static std::string fault(const Load& share, double force, int) {
    return share.force > force ? "more than there is" : "";
  }
};

std::string stopped_by(const std::function<void()>& call) {
  try {
    call();
  } catch (const StoppedRun& stop) {
    return stop.what();
  }
  return "";
}

Laws guarded(Laws laws) {
  laws.guard_listed();
  return laws;
}

/// Laws of module a7, as bind_laws takes them.
Laws laws_with(LawFunction<Stretch> stretch, LawFunction<Share> share = nullptr) {
  Laws alone, laws;
  alone.set<Stretch>(std::move(stretch));
  alone.set<Share>(std::move(share));
  laws.take_listed(alone, "a7 student");
  return laws;
}

TEST(ListedLaws, AreAskedByTheirTypes) {
  const Laws laws = laws_with([](double force) { return 2 * force; },
                              [](double force, int parts) { return Load{force / parts}; });
  EXPECT_EQ(laws.of<Stretch>()(3.0), 6.0);
  EXPECT_EQ(laws.of<Share>()(6.0, 4).force, 1.5);
  EXPECT_EQ(laws.source_of<Share>(), "a7 student");
}

// An effect keeps the reference through a run.
TEST(ListedLaws, StayWhereTheyAreWhileTheyAreAsked) {
  const Laws laws = laws_with([](double force) { return force; });
  const LawFunction<Stretch>* first = &laws.of<Stretch>();
  EXPECT_EQ(first, &laws.of<Stretch>());
  const Laws copy = laws;
  EXPECT_NE(first, &copy.of<Stretch>());
}

TEST(ListedLaws, OneThatNoModuleProvidesSaysSoWhereItIsAsked) {
  Laws laws = laws_with([](double force) { return force; });
  laws.set<Stretch>(nullptr);
  EXPECT_FALSE(laws.has<Stretch>());
  EXPECT_EQ(laws.source_of<Stretch>(), "none");
  try {
    guarded(laws).of<Stretch>()(1.0);
    ADD_FAILURE() << "an absent law has an answer";
  } catch (const UserError& error) {
    EXPECT_EQ(error.problem(), "needs the stretch of a band, and no module provides it");
    EXPECT_NE(error.remedy().find("--modules a7=PATH"), std::string::npos) << error.remedy();
  }
}

// A test, or a stand-in, replaces a function: whose law it is stays.
TEST(ListedLaws, KeepTheirSourceWhereTheFunctionIsReplaced) {
  Laws laws = laws_with([](double force) { return force; });
  laws.set<Stretch>([right = laws.of<Stretch>()](double force) { return -right(force); });
  EXPECT_EQ(laws.of<Stretch>()(1.0), -1.0);
  EXPECT_EQ(laws.source_of<Stretch>(), "a7 student");
}

TEST(ListedLaws, OfALaterModuleStandOverThoseOfAnEarlierOne) {
  Laws laws = laws_with([](double force) { return force; });
  const Laws later = laws_with([](double force) { return 5 * force; });
  laws.take_listed(later, "a8 reference");
  EXPECT_EQ(laws.of<Stretch>()(1.0), 5.0);
  EXPECT_EQ(laws.source_of<Stretch>(), "a8 reference");
}

TEST(ListedLaws, AnAnswerThatIsNoNumberStopsTheRunByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Laws laws =
      guarded(laws_with([&](double) { return nan; }, [&](double, int) { return Load{nan}; }));
  EXPECT_EQ(stopped_by([&] { laws.of<Stretch>()(1.0); }),
            "bands (stretch of a7 student) returned a value that is not a number");
  EXPECT_EQ(stopped_by([&] { laws.of<Share>()(1.0, 2); }),
            "bundles (share of a7 student) returned a value that is not a number");
}

TEST(ListedLaws, AFaultOfTheLawsOwnStopsTheRunByName) {
  const Laws laws = guarded(laws_with(nullptr, [](double force, int) { return Load{2 * force}; }));
  EXPECT_EQ(stopped_by([&] { laws.of<Share>()(1.0, 2); }),
            "bundles (share of a7 student) returned more than there is");
  EXPECT_EQ(stopped_by([&] { laws.of<Share>()(-1.0, 2); }), "");
}

TEST(ListedLaws, AnExceptionStopsTheRunByNameUnlessItIsTheUsers) {
  const Laws failing =
      guarded(laws_with([](double) -> double { throw std::runtime_error("no such band"); }));
  EXPECT_EQ(stopped_by([&] { failing.of<Stretch>()(1.0); }),
            "bands (stretch of a7 student) failed: no such band");
  const Laws unwritten =
      guarded(laws_with([](double) -> double { throw NotImplemented("stretch", "a handout"); }));
  EXPECT_THROW(unwritten.of<Stretch>()(1.0), NotImplemented);
}

}  // namespace
}  // namespace tumble
