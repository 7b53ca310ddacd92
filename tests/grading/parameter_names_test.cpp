// Names of parameters, read from the headers that students have; and the story of a call that
// failed, with these names.
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <thread>
#include <stdexcept>

#include "assignments/a1_impulse/a1_impulse.h"
#include "assignments/a2_integration/a2_integration.h"
#include "assignments/a3_constraints/a3_constraints.h"
#include "assignments/a4_timewarp/a4_timewarp.h"
#include "assignments/a5_plausible/a5_plausible.h"
#include "framework/grading/verdicts/call_log.h"
#include "framework/grading/verdicts/parameter_names.h"
#include "tests/support/places.h"

namespace tumble::grading {
namespace {

using Names = std::vector<std::string>;

class ParameterNames : public ::testing::Test {
 protected:
  void SetUp() override {
    ::setenv("TUMBLE_ROOT", test::source_dir().c_str(), 1);
    call_log() = CallLog{};
  }
  void TearDown() override { call_log() = CallLog{}; }
};

template <class R, class... A>
std::size_t count_of_parameters(const std::function<R(A...)>&) {
  return sizeof...(A);
}

template <class Module>
void expect_names() {
  Module module;
  Module::visit(module, [](const char* function, const auto& field) {
    const Names names = parameter_names(Module::kId, function);
    EXPECT_EQ(names.size(), count_of_parameters(field)) << Module::kId << ", " << function;
    EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size())
        << Module::kId << ", " << function;
  });
}

TEST_F(ParameterNames, EveryFunctionOfEveryAssignmentHasAsManyAsArguments) {
  expect_names<a1::Module>();
  expect_names<a2::Module>();
  expect_names<a3::Module>();
  expect_names<a4::Module>();
  expect_names<a5::Module>();
}

TEST_F(ParameterNames, AreThoseOfTheHeader) {
  EXPECT_EQ(parameter_names("a1", "collision_impulse"),
            (Names{"contact", "a", "b", "restitution"}));
  EXPECT_EQ(parameter_names("a2", "impact_time_newton"),
            (Names{"gap", "gap_rate", "t_low", "t_high", "tolerance"}));
  EXPECT_EQ(parameter_names("a3", "contact_forces"), (Names{"A", "b"}));
  EXPECT_EQ(parameter_names("a1", "no_such_function"), Names{});
  EXPECT_EQ(parameter_names("a99", "collision_impulse"), Names{});
}

TEST(NamesInDeclaration, TypesMayHaveCommasCommentsAndDefaults) {
  const std::string header = R"(
// double f(int commented_out);
/* double f(int so_is_this); */
double f_of(int other);
inline int g() { return f(1, 2); }
std::map<int, Vector3d> f(const std::map<int, int>& table,  // a comment, with a comma
                          std::function<double(double, int)> gap, double h = g(1, 2),
                          std::vector<double> list = {1, 2});
TABLE(f, g);
)";
  EXPECT_EQ(names_in_declaration(header, "f"), (Names{"table", "gap", "h", "list"}));
  EXPECT_EQ(names_in_declaration(header, "f_of"), Names{"other"});
}

TEST(NamesInDeclaration, AreNoneWhereAParameterHasNoName) {
  for (const std::string parameters : {"double", "const Vector3d&", "std::size_t", "unsigned int",
                                       "double t, const Vector3d&", "", "double t, "})
    EXPECT_EQ(names_in_declaration("double f(" + parameters + ");", "f"), Names{}) << parameters;
  EXPECT_EQ(names_in_declaration("double f(double t", "f"), Names{}) << "cut short";
}

TEST_F(ParameterNames, AndHintsAreInTheCommentOfTheFunctionItself) {
  const std::string header =
      "/// Hints: handouts/x.md#one\ndouble f(int a);\n/// No hint.\ndouble g(int a);\n";
  EXPECT_EQ(hints_in_declaration(header, "f"), "handouts/x.md#one");
  EXPECT_EQ(hints_in_declaration(header, "g"), "") << "of the function before";
  EXPECT_EQ(hints_in_declaration(header, "h"), "");
  EXPECT_EQ(hints_to_read("a1", "intersect_ray_triangle"),
            "\n  read:     handouts/a1_impulse.md#hint-ray");
  EXPECT_EQ(hints_to_read("a1", "contact_normal_vertex_vertex"),
            "\n  read:     handouts/a1_impulse.md#hint-normals");
}

TEST(InHeader, FormulaPurposeAndPlacesAreReadOffTheComment) {
  const std::string header =
      "/// Of another.\n///   y = 1                 (A9.1)\n/// Hints: handouts/x.md#one\n"
      "double f(double x);\n\n"
      "/// Twice a number, as (A9.1) has it.\n"
      "///   y = 2 x,\n"
      "///       where x is any                                        (A9.2b)\n"
      "/// @param x  a number\n"
      "/// @return y, above 0\n"
      "///         where x is\n"
      "/// Source: none.   Hints: handouts/x.md#two\n"
      "double g(double x);\n"
      "double h(double x);\n";
  const FunctionInHeader told = told_in_declaration(header, "g");
  EXPECT_EQ(told.purpose, "Twice a number, as (A9.1) has it.\ny = 2 x,\nwhere x is any   (A9.2b)");
  EXPECT_EQ(told.formula, "y = 2 x,\nwhere x is any   (A9.2b)");
  EXPECT_EQ(told.returns, "y, above 0 where x is");
  EXPECT_EQ(told.equations, std::vector<std::string>{"handouts/x.md#eq-a9-2"});
  EXPECT_EQ(told.hints, "handouts/x.md#two");
  EXPECT_EQ(told_in_declaration(header, "h").purpose, "");
  EXPECT_EQ(told_in_declaration(header, "k").purpose, "");
}

// Every function of every assignment has something to act on.
TEST(InHeader, EveryFunctionHasAnEquationAndHints) {
  for (const auto& [id, function] : std::initializer_list<std::pair<const char*, const char*>>{
           {"a1", "resolve_collision"},
           {"a1", "contact_normal_vertex_edge"},
           {"a2", "euler_angles_from_rotation"},
           {"a2", "impact_time_bisection"},
           {"a3", "rod_row"},
           {"a4", "global_virtual_time"},
           {"a5", "log_target"}}) {
    const FunctionInHeader told = told_of_function(id, function);
    EXPECT_FALSE(told.equations.empty()) << function;
    EXPECT_FALSE(told.hints.empty()) << function;
    EXPECT_FALSE(told.returns.empty()) << function;
  }
}

TEST(WithNames, ValuesStandAloneWhereNamesDoNotFit) {
  EXPECT_EQ(with_names({"(0, 0, 5)", "\"a, b\""}, {"x", "what"}), "x = (0, 0, 5), what = \"a, b\"");
  EXPECT_EQ(with_names({"1", "{a: 2, b: 3}"}, {"x"}), "1, {a: 2, b: 3}");
  EXPECT_EQ(with_names({"1", "2"}, {}), "1, 2");
}

a2::Module failing_step() {
  a2::Module module;
  module.rigid_body_derivative = [](const RigidBodyState&, const Inertia&, const Wrench&) {
    return VectorXd(VectorXd::Zero(kStateSize));
  };
  module.rk4_step = [](const OdeFunction& f, double t, const VectorXd& y, double h) -> VectorXd {
    f(t, y + h * y);
    throw std::runtime_error("no such element");
  };
  return observed(module);
}

TEST_F(ParameterNames, StandInTheStoryOfAFailedCall) {
  const a2::Module module = failing_step();
  const OdeFunction decay = [](double, const VectorXd& y) { return VectorXd(-y); };
  EXPECT_THROW(module.rk4_step(decay, 0.0, Eigen::Vector2d(1.0, -2.0), 0.01), std::runtime_error);
  EXPECT_EQ(std::string(call_log().story),
            "rk4_step threw an exception: no such element\n"
            "  called with: f = a function, t = 0, y = (1, -2), h = 0.01\n"
            "  read:     handouts/a2_integration.md#hint-rk4");
}

// Its derivative is a function of the same module: the story is about the step.
TEST_F(ParameterNames, AreOfTheOuterCallWhenTheInnerOneHasReturned) {
  const a2::Module module = failing_step();
  const OdeFunction derivative = [&](double, const VectorXd& y) {
    return VectorXd(module.rigid_body_derivative({}, {}, {}).head(y.size()));
  };
  EXPECT_THROW(module.rk4_step(derivative, 2.0, Eigen::Vector2d(1.0, 0.0), 0.5),
               std::runtime_error);
  EXPECT_STREQ(call_log().last_call, "rk4_step");
  EXPECT_EQ(call_log().calls, 2);
  EXPECT_EQ(call_log().asked(),
            "f = a function, t = 2, y = (1, 0), h = 0.5\n"
            "  read:     handouts/a2_integration.md#hint-rk4");
}

// Scenes that run at the same time: what fails in one ends and names nothing in the other.
TEST_F(ParameterNames, AreOfTheThreadThatHasALogOfItsOwn) {
  const OdeFunction decay = [](double, const VectorXd& y) { return VectorXd(-y); };
  call_log().begin("euler_step");
  std::thread([&] {
    const OwnCallLog own;
    EXPECT_THROW(failing_step().rk4_step(decay, 0.0, Eigen::Vector2d(1.0, -2.0), 0.01),
                 std::runtime_error);
    EXPECT_STREQ(call_log().last_call, "rk4_step");
    EXPECT_TRUE(call_log().noted);
  }).join();
  EXPECT_STREQ(call_log().last_call, "euler_step");
  EXPECT_FALSE(call_log().noted);
  {
    const OwnCallLog own;
    call_log().begin("rk4_step");
  }
  EXPECT_STREQ(call_log().last_call, "euler_step");
}

}  // namespace
}  // namespace tumble::grading
