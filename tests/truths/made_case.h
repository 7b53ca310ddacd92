/// Cases made in memory in the format of files: other cases of a family, with values from closed
/// forms.
#pragma once

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "framework/truths/truth_case.h"

namespace tumble::testing {

/// {value, unit, floor} as in a file.
inline truths::Value entry(const std::string& name, const truths::Value::Content& value,
                           const std::string& floor = "") {
  truths::Value::Members members{{"value", {name + "/value", value}}};
  if (!floor.empty())
    members.emplace_back("tolerance_floor", truths::Value(name + "/tolerance_floor", floor));
  return {name, members};
}

inline std::string exact_text(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}

inline truths::Value::Content list_of(const std::vector<double>& numbers) {
  truths::Value::List list;
  for (const double number : numbers) list.emplace_back("item", exact_text(number));
  return list;
}

inline truths::Value::Content vector_of(const Vector3d& v) {
  return list_of({v.x(), v.y(), v.z()});
}

/// A case that is filled number by number.
class MadeCase {
 public:
  explicit MadeCase(const std::string& family) : family_(family) {}

  MadeCase& input(const std::string& name, double value) {
    return input(name, truths::Value::Content(exact_text(value)));
  }
  MadeCase& input(const std::string& name, const truths::Value::Content& value) {
    inputs_.emplace_back(name, entry(name, value));
    return *this;
  }
  MadeCase& output(const std::string& name, double value, double floor) {
    return output(name, truths::Value::Content(exact_text(value)), floor);
  }
  MadeCase& output(const std::string& name, const truths::Value::Content& value, double floor) {
    outputs_.emplace_back(name, entry(name, value, exact_text(floor)));
    return *this;
  }
  truths::Case truth() const {
    return {"made/" + family_, family_, "", {"inputs", inputs_}, {"outputs", outputs_}};
  }

 private:
  std::string family_;
  truths::Value::Members inputs_, outputs_;
};

}  // namespace tumble::testing
