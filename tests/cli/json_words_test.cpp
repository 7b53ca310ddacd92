// --json: the table of a verb for other programs, alone on stdout, with the same exit code.
#include <nlohmann/json.hpp>

#include "tests/cli/command_line.h"

namespace tumble::testing {
namespace {

nlohmann::json parsed(const Said& said) {
  const auto page = nlohmann::json::parse(said.out, nullptr, false);
  EXPECT_FALSE(page.is_discarded()) << said.out << said.err;
  return page.is_discarded() ? nlohmann::json::object() : page;
}

TEST_F(CommandLine, JsonOfCostHasEveryPointOfACurve) {
  const nlohmann::json page =
      parsed(type("cost t_handle --modules library --methods rk4 --engines none --steps 1/60,1/120 "
                  "--duration-s 0.5 --json"));
  ASSERT_EQ(page.value("curves", nlohmann::json::array()).size(), 1u);
  const auto& points = page["curves"][0]["points"];
  ASSERT_EQ(points.size(), 2u);
  EXPECT_DOUBLE_EQ(points[1]["step"], 1.0 / 120);
  // RK4 has order 4: half the step leaves a sixteenth of the error, here at most an eighth
  EXPECT_LT(points[1]["error"].get<double>(), points[0]["error"].get<double>() / 8);
  EXPECT_TRUE(fs::exists(folder_ / page["page"].get<std::string>()));
}

TEST_F(CommandLine, JsonOfALedgerSaysWhatDoesNotFitAndKeepsTheExitCode) {
  std::ofstream(folder_ / "ledger.jsonl") << "{\"entry\":1,\"name\":\"ada\"}\n";
  const Said said = type("ledger verify ledger.jsonl --json");
  EXPECT_EQ(said.code, 1);
  EXPECT_EQ(parsed(said).at("faults").size(), 1u);
}

// A file's name is bytes; JSON is UTF-8.
TEST_F(CommandLine, JsonOfANameThatIsNoTextIsStillJson) {
  fs::copy_file(fs::path(test::source_dir()) / "models/box.3ds", folder_ / "\xff.3ds");
  const Said said = type("inspect './\xff.3ds' --json");
  EXPECT_EQ(said.code, 0) << said.err;
  EXPECT_EQ(parsed(said).at("objects").size(), 1u);
}

#ifdef TUMBLE_HAS_REFERENCE
TEST_F(CommandLine, JsonOfTheBatteryHasEveryMeasure) {
  const Said said = type("battery --only 1 --json");
  const nlohmann::json page = parsed(said);
  ASSERT_EQ(page.value("rows", nlohmann::json::array()).size(), 1u);
  EXPECT_EQ(said.code, 0);
  EXPECT_EQ(page["rows"][0]["outcome"], "holds");
  std::size_t must_fail = 0;
  for (const auto& measure : page["rows"][0]["measures"]) must_fail += measure["must_fail"] == true;
  EXPECT_EQ(must_fail, 1u) << "explicit Euler on a stiff spring";
}

TEST_F(CommandLine, JsonOfEnginesHasARowForEach) {
  const nlohmann::json page =
      parsed(type("engines gas --n 4 --modules reference --duration-s 0.5 --engines rd,tw --json"));
  ASSERT_EQ(page.value("engines", nlohmann::json::array()).size(), 2u);
  for (const auto& row : page["engines"]) {
    EXPECT_EQ(row["bodies"], 4);
    EXPECT_GT(row["counts"]["integrations"].get<int>(), 0);
    EXPECT_EQ(row["stopped_by"], "");
  }
}
#endif

}  // namespace
}  // namespace tumble::testing
