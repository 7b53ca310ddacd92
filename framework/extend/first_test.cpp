#include "framework/extend/first_test.h"

#include <map>
#include <regex>
#include <set>

namespace tumble::extend {
namespace {

// "const Vector3d&" -> "Vector3d"
std::string plain_type(std::string type) {
  if (type.starts_with("const ")) type.erase(0, 6);
  while (type.ends_with("&") || type.ends_with(" ")) type.pop_back();
  return type;
}

bool is_number(const std::string& type) {
  static const std::set<std::string> numbers = {"double",        "float",        "int",
                                                "long",          "unsigned",     "std::size_t",
                                                "std::uint64_t", "std::int64_t", "std::uint32_t"};
  return numbers.contains(type);
}

bool has_fixed_size(const std::string& type) {
  return type == "Vector2d" || type == "Vector3d" || type == "Matrix3d";
}

// A value to begin a test with.
std::string first_value(const std::string& type) {
  static const std::map<std::string, std::string> values = {
      {"double", "1.0"},
      {"bool", "true"},
      {"Vector2d", "Vector2d(1, 2)"},
      {"Vector3d", "Vector3d(1, 2, 3)"},
      {"VectorXd", "VectorXd::Ones(3)"},
      {"Matrix3d", "Matrix3d::Identity()"},
      {"MatrixXd", "MatrixXd::Identity(3, 3)"},
      {"Quaterniond", "Quaterniond::Identity()"},
      {"OdeFunction", "[](double, const VectorXd& y) -> VectorXd { return y; }"}};
  if (const auto found = values.find(type); found != values.end()) return found->second;
  if (is_number(type)) return "1";
  static const std::regex callable(R"(^std::function<(.+?)\(.*\)>$)");
  if (std::smatch match; std::regex_match(type, match, callable)) {
    const std::string returns = plain_type(match[1]);
    return "[](auto&&...) -> " + returns + " { return " + first_value(returns) + "; }";
  }
  return type + "{}";
}

}  // namespace

std::string zero_of(const std::string& returns) {
  const std::string type = plain_type(returns);
  if (is_number(type)) return "0";
  if (has_fixed_size(type)) return type + "::Zero()";
  if (type == "VectorXd") return "VectorXd::Zero(1)";
  if (type == "MatrixXd") return "MatrixXd::Zero(1, 1)";
  if (type == "Quaterniond") return "Quaterniond::Identity()";
  return "{}";
}

std::string first_arguments(const Function& function) {
  std::string arguments;
  for (const Parameter& parameter : function.parameters)
    arguments += (arguments.empty() ? "" : ", ") + first_value(plain_type(parameter.type));
  return arguments;
}

std::string first_test(const Function& function, const FirstTest& test) {
  const std::string type = plain_type(function.returns),
                    call =
                        test.module + "." + function.name + "(" + first_arguments(function) + ")",
                    story = "{.scene = \"(to be written: " + test.scene +
                            ")\",\n.slip = \"(to be written: the mistake that gives such an answer "
                            "most often)\",\n.handout = " +
                            test.handout + "}";
  const auto near = [&](const std::string& expected) {
    return "  expect_near(" + call + ", " + expected + ", " + test.tolerance + ", \"-\",\n" +
           story + ");";
  };
  if (is_number(type)) return near(test.expected);
  if (has_fixed_size(type)) return near(type + "::Constant(" + test.expected + ")");
  return "  [[maybe_unused]] const auto found = " + call + ";\n  expect_true(false, " +
         "\"(to be written: what is expected)\", \"an answer that is not looked at yet\",\n" +
         story + ");";
}

}  // namespace tumble::extend
