// A list of declarations, as an instructor writes it.
#include <gtest/gtest.h>

#include "framework/extend/declarations.h"
#include "tests/extend/new_tree.h"

namespace tumble::testing {
namespace {

using extend::Declarations;
using extend::read_declarations;

TEST(Declarations, AreReadWithTheirCommentsAndEquations) {
  const Declarations read = read_declarations(kTwoFunctions, "f.h");
  ASSERT_EQ(read.functions.size(), 2u);
  EXPECT_EQ(read.functions[0].name, "mean_of");
  EXPECT_EQ(read.functions[0].returns, "double");
  EXPECT_EQ(read.functions[0].equation, "m = (a + b) / 2");
  EXPECT_EQ(read.functions[0].about, std::vector<std::string>{"The mean of two numbers."});
  EXPECT_EQ(read.functions[1].returns, "Vector3d");
  ASSERT_EQ(read.functions[1].parameters.size(), 1u);
  EXPECT_EQ(read.functions[1].parameters[0].type, "const Vector3d&");
  EXPECT_EQ(read.functions[1].parameters[0].name, "arm_world");
  EXPECT_EQ(read.functions[1].line, 6);
}

TEST(Declarations, MayHaveTypesOfSeveralLinesAndCommasInThem) {
  const Declarations read = read_declarations(
      "#include <map>\n"
      "// What came.\n"
      "struct Outcome {\n  int count = 0;\n  double mean;\n};\n"
      "// Counts.\n"
      "std::map<int, Outcome> outcomes_of(\n"
      "    const std::function<double(double, int)>& f,\n"
      "    int most);\n",
      "f.h");
  ASSERT_EQ(read.functions.size(), 1u);
  EXPECT_EQ(read.functions[0].returns, "std::map<int, Outcome>");
  ASSERT_EQ(read.functions[0].parameters.size(), 2u);
  EXPECT_EQ(read.functions[0].parameters[0].type, "const std::function<double(double, int)>&");
  EXPECT_EQ(read.includes, std::vector<std::string>{"#include <map>"});
  EXPECT_NE(read.types.find("/// What came.\nstruct Outcome {"), std::string::npos) << read.types;
}

// Each fault is said with its line and what to do about it.
TEST(Declarations, SayWhatIsWrongAndWhere) {
  const std::vector<std::pair<std::string, std::string>> faults = {
      {"\ndouble f(double x);\n", "f.h:2: f has no comment"},
      {"// A.\nvoid f(double x);\n", "f.h:2: f returns nothing"},
      {"// A.\ndouble f(double);\n", "f.h:2: the parameter 'double' has no name"},
      {"// A.\ndouble f(const Body);\n", "f.h:2: the parameter 'const Body' has no name"},
      {"// A.\ndouble f(Body& body);\n", "is changed by the function"},
      {"// A.\ndouble f(double x) { return x; };\n", "is more than a declaration"},
      {"// A.\ndouble f(double x = 1);\n", "is more than a declaration"},
      {"// A.\ndouble f(double x)\n", "f.h:2: does not end with ';'"},
      {"// A.\ndouble f(double x);\n// B.\ndouble f(int x);\n", "f.h:4: f is declared in line 2"},
      {"// A.\ndouble Mean(double x);\n", "'Mean' is not named like a function"},
      {"// A.\ndouble x;\n", "is no declaration of a function"},
      {"namespace tumble {\n", "cannot stand in a list of declarations"},
      {"// A.\n", "belongs to no declaration"},
      {"\n", "declares no function"}};
  for (const auto& [text, words] : faults) {
    const std::string said = refusal_of([&] { read_declarations(text, "f.h"); });
    EXPECT_NE(said.find(words), std::string::npos) << text << "said: " << said;
  }
}

}  // namespace
}  // namespace tumble::testing
