// What an audit says of its tests.
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/grading/grades/audit.h"

namespace tumble::grading {
namespace {

AuditResult result(const std::string& name, bool is_right,
                   const std::vector<std::string>& caught_by) {
  AuditResult result;
  result.candidate.name = name;
  result.candidate.file = name + ".cpp";
  result.candidate.is_right = is_right;
  for (const std::string& test : caught_by) {
    TestResult wrong;
    wrong.test = test;
    wrong.verdict = Verdict::kWrong;
    result.caught_by.push_back(wrong);
  }
  return result;
}

TEST(Audit, ARightSolutionThatATestAccusesIsNoCatch) {
  const auto catches = catches_of(
      {result("slip", false, {"S.One"}), result("another way", true, {"S.One", "S.Two"})});
  EXPECT_EQ(catches.at("S.One").count, 1u);
  EXPECT_FALSE(catches.contains("S.Two"));
}

TEST(Audit, NamesTheSlipsThatOneTestAloneCatches) {
  const auto catches =
      catches_of({result("alone", false, {"S.One"}), result("twice", false, {"S.One", "S.Two"}),
                  result("survives", false, {})});
  EXPECT_EQ(catches.at("S.One").count, 2u);
  EXPECT_EQ(catches.at("S.One").alone, std::vector<std::string>{"alone"});
  EXPECT_TRUE(catches.at("S.Two").alone.empty());
}

TEST(Audit, OnlyTheNamedAreJudgedAndAnUnknownNameIsAnsweredWithTheNearest) {
  const std::vector<Candidate> all = {result("e_squared", false, {}).candidate,
                                      result("float", false, {}).candidate,
                                      result("reference", true, {}).candidate};
  EXPECT_EQ(only(all, {}).size(), 3u);
  ASSERT_EQ(only(all, {"float", "reference"}).size(), 2u);
  EXPECT_EQ(only(all, {"float", "reference"})[0].name, "float");
  try {
    only(all, {"e_sqared"});
    FAIL() << "an unknown name was taken";
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("Did you mean 'e_squared'?"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace tumble::grading
