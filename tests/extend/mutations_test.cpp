// Changes of a reference in one place, as slips.
#include "framework/extend/mutations.h"

#include <gtest/gtest.h>

#include "tests/extend/new_tree.h"

namespace tumble::testing {
namespace {

constexpr const char* kReference =
    "// a + b\n"
    "double mean_of(double a, double b) {\n"
    "  if (a < b) throw std::logic_error(\"a + b\");\n"
    "  return 0.5 * (a + b);  // a - b\n"
    "}\n"
    "\n"
    "Vector3d larger_part(const Vector3d& arm_world) {\n"
    "  if (a < b) throw std::logic_error(\"a + b\");\n"
    "  return arm_world.cross(arm_world);\n"
    "}\n";

TEST(Mutations, AreChangesOfCodeInOnePlace) {
  std::vector<std::string> changed;
  for (const extend::Mutation& one : extend::mutations_of(kReference))
    changed.push_back(std::to_string(one.line) + " " + one.what + " " + one.after);
  EXPECT_EQ(changed, (std::vector<std::string>{
                         "3 below_to_at_most   if (a <= b) throw std::logic_error(\"a + b\");",
                         "4 plus_to_minus   return 0.5 * (a - b);  // a - b",
                         "4 times_to_divided   return 0.5 / (a + b);  // a - b",
                         "4 half_to_one   return 1.0 * (a + b);  // a - b",
                         "8 below_to_at_most   if (a <= b) throw std::logic_error(\"a + b\");",
                         "9 cross_product_reversed   return (-arm_world).cross(arm_world);"}));
}

// A slip's text must stand once in its base: a line that stands twice brings its neighbours.
TEST(Mutations, AreSlipsWhoseTextStandsOnce) {
  const NewTree tree;
  tree.make_a5();
  write_whole(tree.root() / "solutions_private/a5_trial/a5_trial.cpp", kReference);
  const auto files = extend::new_mutations(tree.root(), "a5", tree.root() / "proposed");
  ASSERT_EQ(files.size(), 6u);
  EXPECT_EQ(text_of(tree.root() / "proposed/line_3_below_to_at_most.slip"),
            "// mutant: line_3_below_to_at_most - below_to_at_most in line 3 of the reference\n"
            "// caught-by: likely\n"
            "// base: reference\n"
            "@@\n"
            " double mean_of(double a, double b) {\n"
            "-  if (a < b) throw std::logic_error(\"a + b\");\n"
            "+  if (a <= b) throw std::logic_error(\"a + b\");\n");
  EXPECT_NE(refusal_of([&] {
              extend::new_mutations(tree.root(), "a5", tree.root() / "proposed");
            }).find("is there already"),
            std::string::npos);
}

}  // namespace
}  // namespace tumble::testing
