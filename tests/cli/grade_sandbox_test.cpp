// Which sandbox protects grades: it is named on everything that is written, one below the policy is
// refused, and all give the same verdicts. And what tumble doctor says of a machine.
#include <regex>

#include "tests/support/places.h"
#include "framework/grading/sandbox/landlock.h"
#include "tests/cli/grading_fixture.h"
#include "tests/support/whole.h"

namespace tumble::grading {
namespace {

class GradeSandbox : public Grading {
 protected:
  void SetUp() override {
    if (landlock_abi() == 0) GTEST_SKIP() << "this kernel has no Landlock";
    put("alice/a1_impulse.cpp", text_of(kStub));
  }
  void TearDown() override { ::unsetenv("TUMBLE_SANDBOX"); }
};

TEST_F(GradeSandbox, EveryOutputNamesIt) {
  const ProgramOutcome outcome = grade("out", {"--no-media", "--sandbox", "landlock"});
  ASSERT_EQ(outcome.code, 0) << outcome.printed;
  EXPECT_TRUE(says(outcome, "sandbox: landlock (ABI ")) << outcome.printed;
  const auto about = results("alice")["extra_data"];
  EXPECT_EQ(about["sandbox"].get<std::string>().substr(0, 14), "landlock (ABI ");
  EXPECT_EQ(about["official"], true);
  EXPECT_EQ(ledger().at(0)["sandbox"], about["sandbox"]);
  for (const char* page : {"out/index.html", "out/alice/index.html"})
    EXPECT_NE(text_of(root / page).find("sandbox landlock (ABI "), std::string::npos) << page;
}

TEST_F(GradeSandbox, OneBelowThePolicyIsRefusedBeforeAnythingIsWritten) {
  ::setenv("TUMBLE_SANDBOX", "bare", 1);
  const ProgramOutcome outcome = grade("out");
  EXPECT_EQ(outcome.code, 2) << outcome.printed;
  EXPECT_TRUE(says(outcome, "less than the policy") && says(outcome, "--accept-sandbox bare"))
      << outcome.printed;
  EXPECT_FALSE(fs::exists(root / "out"));
  EXPECT_EQ(grade("out", {"--no-media", "--accept-sandbox", "landlock"}).code, 2)
      << "another kind was accepted";
}

TEST_F(GradeSandbox, ForcedGradesSayOnEveryOutputThatTheyAreNotOfficial) {
  const ProgramOutcome outcome =
      grade("out", {"--no-media", "--sandbox", "bare", "--accept-sandbox", "bare"});
  ASSERT_EQ(outcome.code, 0) << outcome.printed;
  EXPECT_TRUE(says(outcome, "not an official grade")) << outcome.printed;
  EXPECT_NE(results("alice")["output"].get<std::string>().find("not an official grade"),
            std::string::npos);
  EXPECT_EQ(results("alice")["extra_data"]["official"], false);
  for (const char* file : {"out/index.html", "out/alice/index.html", "out/alice/record.json"})
    EXPECT_NE(text_of(root / file).find("not an official grade"), std::string::npos) << file;
  EXPECT_NE(text_of(root / "out/gradebook.csv").find("not official"), std::string::npos);
  EXPECT_EQ(ledger().at(0)["official"], false);
  // A later official run does not take such a result over.
  const ProgramOutcome official = grade("out", {"--no-media", "--sandbox", "landlock"});
  EXPECT_FALSE(says(official, "unchanged since the last run")) << official.printed;
  EXPECT_EQ(results("alice")["extra_data"]["official"], true);
}

// Where nothing protects the reader of debug information, a crash has no line.
std::string without_lines(const nlohmann::json& tests) {
  return std::regex_replace(tests.dump(), std::regex(", a1_impulse\\.cpp:[0-9]+"), "");
}

TEST_F(GradeSandbox, AllKindsGiveTheSameVerdicts) {
  TUMBLE_ONLY_WHOLE();
  put("bob/a1_impulse.cpp", text_of(kReference));
  put("carol/a1_impulse.cpp", stub_that("int* nothing = nullptr; *nothing = 1;"));
  put("dave/a1_impulse.cpp", text_of(kStub) + "\nint x = ;\n");
  put("erin/a1_impulse.cpp", text_of(kReference) + "\nint main() { return 0; }\n");
  std::map<std::string, nlohmann::json> first;
  for (const std::string kind : {"namespaces", "landlock", "bare"}) {
    const ProgramOutcome outcome =
        grade(kind, {"--no-media", "--sandbox", kind, "--accept-sandbox", kind});
    if (outcome.code == 2 && says(outcome, "does not work on this machine")) continue;
    ASSERT_EQ(outcome.code, 0) << kind << outcome.printed;
    for (const char* name : {"alice", "bob", "carol", "dave", "erin"}) {
      const nlohmann::json found = results(name, kind);
      if (!first.contains(name)) first[name] = found;
      EXPECT_EQ(without_lines(found["tests"]), without_lines(first[name]["tests"]))
          << kind << ", " << name;
      if (kind != "bare") {
        EXPECT_EQ(found["tests"], first[name]["tests"]) << kind << ", " << name;
      }
      EXPECT_EQ(found["score"], first[name]["score"]) << kind << ", " << name;
    }
  }
  EXPECT_EQ(first["bob"]["score"], 100.0);
  EXPECT_EQ(first["erin"]["score"], 100.0) << "a main() of the submission's own replaces nothing";
}

// ---- tumble doctor ----

ProgramOutcome doctor(std::vector<std::string> before = {}) {
  before.insert(before.end(), {kProgram.string(), "doctor", "--json"});
  return run_program(before, Output::kCaptured, 300.0);
}

TEST_F(GradeSandbox, DoctorsExitCodeIsItsVerdict) {
  const ProgramOutcome here = doctor();
  const auto report = nlohmann::json::parse(here.printed);
  EXPECT_EQ(here.code, report["official_grades"] == true ? 0 : 1) << here.printed;
  ASSERT_EQ(report["sandboxes"].size(), 3u);
  for (const auto& sandbox : report["sandboxes"])
    EXPECT_EQ(sandbox["works"], sandbox["why_not"] == "") << sandbox;
  for (const auto& finding : report["findings"])
    EXPECT_TRUE(finding["state"] != "missing" || !finding["remedy"].get<std::string>().empty())
        << "what is missing has a remedy: " << finding;
}

TEST_F(GradeSandbox, DoctorFindsTheStrongestThatAContainerPermits) {
  const std::string launcher = (fs::path(test::binary_dir()) / "bin/like_docker").string();
  const auto docker = nlohmann::json::parse(doctor({launcher}).printed);
  EXPECT_EQ(docker["sandbox"]["kind"], "landlock");
  EXPECT_EQ(docker["sandboxes"][0]["works"], false);
  EXPECT_NE(docker["sandboxes"][0]["why_not"].get<std::string>().find("namespace"),
            std::string::npos)
      << docker["sandboxes"][0];
  const ProgramOutcome older = doctor({launcher, "--no-landlock"});
  EXPECT_EQ(nlohmann::json::parse(older.printed)["sandbox"]["kind"], "bare");
  EXPECT_EQ(older.code, 1) << "no official grades there";
}

TEST_F(GradeSandbox, UnknownKindsAreRefusedWithTheKnownOnes) {
  const ProgramOutcome outcome = grade("out", {"--no-media", "--sandbox", "docker"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_TRUE(says(outcome, "namespaces, landlock, bare")) << outcome.printed;
}

}  // namespace
}  // namespace tumble::grading
