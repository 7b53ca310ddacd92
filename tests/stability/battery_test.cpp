// The short battery: every hard case holds its thresholds, or is a known shortfall; every method
// known not to hold is seen failing.
#include <filesystem>

#include <gtest/gtest.h>

#include "tests/support/places.h"
#include "framework/cli/battery.h"
#include "framework/cli/read_truth.h"
#include "framework/modules/load.h"
#include "framework/modules/registry.h"

namespace tumble::testing {
namespace {

namespace fs = std::filesystem;

truths::Case truth(const std::string& id) {
  std::string name = id;
  name.replace(name.find('/'), 1, "__");
  return cli::read_truth(fs::path(test::source_dir()) / "tests" / "truths" / (name + ".json"));
}

// The reference's laws where this tree has it; else the library's integration only, and what needs
// more says so.
battery::Given available_laws() {
  modules::Registry registry;
  register_assignments(registry);
  battery::Given given{library_laws(), false, truth};
  for (const modules::ModuleKind* kind : registry.all()) {
    const fs::path file = fs::path(test::binary_dir()) / "modules" / (kind->id + "_reference.so");
    if (!fs::exists(file)) continue;
    given.modules[kind->id] = modules::load_module(*kind, file);
    kind->bind(given.modules[kind->id], given.laws);
  }
  return given;
}

class Stability : public ::testing::TestWithParam<battery::Case> {};

TEST_P(Stability, HoldsItsThresholds) {
  if (!GetParam().run) GTEST_SKIP() << GetParam().not_part;
  static const battery::Given given = available_laws();
  const report::BatteryRow row = battery::run(GetParam(), given);
  for (const report::Measure& m : row.measures) {
    const report::Outcome outcome = report::outcome_of(m);
    EXPECT_TRUE(outcome != report::Outcome::kBroken && outcome != report::Outcome::kTooGood)
        << m.what << ": " << report::shown(m.value, m.unit) << ", wanted "
        << report::shown_threshold(m) << " (" << report::word_of(outcome) << "). " << m.why << ' '
        << m.error;
  }
}

std::string name_of(const ::testing::TestParamInfo<battery::Case>& info) {
  std::string name = "Row" + std::to_string(info.param.row) + "_";
  for (const char c : info.param.name)
    if (std::isalnum(static_cast<unsigned char>(c))) name += c;
  return name;
}

INSTANTIATE_TEST_SUITE_P(Battery, Stability, ::testing::ValuesIn(battery::cases()), name_of);

TEST(Battery, HoldsEveryRowOfTheTableOnce) {
  const auto all = battery::cases();
  ASSERT_EQ(all.size(), 35u);
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].row, static_cast<int>(i) + 1);
    EXPECT_NE(static_cast<bool>(all[i].run), !all[i].not_part.empty()) << all[i].name;
    EXPECT_GT(all[i].about.size(), 60u) << all[i].name << ": say what it is";
  }
}

TEST(Battery, TellsBrokenFromShortAndShowsAMethodThatHoldsAndMustNot) {
  report::Measure m;
  m.value = 2.0;
  m.threshold = 1.0;
  EXPECT_EQ(report::outcome_of(m), report::Outcome::kBroken);
  m.shortfall = "known";
  EXPECT_EQ(report::outcome_of(m), report::Outcome::kShort);
  m.must_fail = true;
  EXPECT_EQ(report::outcome_of(m), report::Outcome::kFailsAsItMust);
  m.value = 0.5;
  EXPECT_EQ(report::outcome_of(m), report::Outcome::kTooGood);
  m.value = std::nan("");
  EXPECT_EQ(report::outcome_of(m), report::Outcome::kFailsAsItMust);
  m.must_fail = false;
  m.shortfall = "";
  EXPECT_EQ(report::outcome_of(m), report::Outcome::kBroken);
}

}  // namespace
}  // namespace tumble::testing
