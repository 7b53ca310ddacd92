// The nearest known word to a mistyped one.
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/nearest_word.h"

namespace tumble {
namespace {

TEST(NearestWord, DistancesCountLetters) {
  EXPECT_EQ(edit_distance("--no-meda", "--no-media"), 1u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
}

TEST(NearestWord, FewTypingErrorsAreCorrected) {
  const std::vector<std::string> verbs = {"run", "watch", "check", "inspect"};
  EXPECT_EQ(nearest_word("chek", verbs), "check");
  EXPECT_EQ(nearest_word("wacht", verbs), "watch");
  EXPECT_EQ(nearest_word("insp", verbs), "inspect");
  EXPECT_EQ(nearest_word("rn", verbs), "run");
}

TEST(NearestWord, AnotherUnitIsOneError) {
  const std::vector<std::string> keys = {"radius_m", "mass_kg", "velocity_m_s"};
  EXPECT_EQ(nearest_word("mass", keys), "mass_kg");
  EXPECT_EQ(nearest_word("mass_pounds", keys), "mass_kg");
  EXPECT_EQ(nearest_word("--output-folder", {"--on", "--out"}), "--out");
}

TEST(NearestWord, APartOfANameIsNearerThanABeginning) {
  EXPECT_EQ(nearest_word("a", {"axis", "body_a", "body_b"}), "body_a");
  EXPECT_EQ(nearest_word("body", {"bodily", "body_a"}), "body_a");
}

TEST(NearestWord, FarOrEmptyWordHasNoSuggestion) {
  EXPECT_EQ(nearest_word("simulate", {"run", "check"}), "");
  EXPECT_EQ(nearest_word("xy", {"ab", "cd"}), "") << "no letter in common";
  EXPECT_EQ(nearest_word("", {"a"}), "");
  EXPECT_EQ(nearest_word("word", {}), "");
}

TEST(NearestWord, QuestionIsAppendedToASentence) {
  EXPECT_EQ(did_you_mean("chek", {"check"}), " Did you mean 'check'?");
  EXPECT_EQ(did_you_mean("chek", {"run"}), "");
  EXPECT_STREQ(
      UserError("chek", "no verb." + did_you_mean("chek", {"check"}), "Known: check.").what(),
      "chek: no verb. Did you mean 'check'? Known: check.");
}

}  // namespace
}  // namespace tumble
