/// One file of reference values as plain data: computed elsewhere, at high precision, for one case
/// of a family.
///
/// A case has inputs (the problem, in SI units) and outputs (the expected values, each with
/// `tolerance_floor`: the error that double precision itself forces). Numbers are decimal strings,
/// read with correct rounding. The JSON reader fills these types; the code of a family reads every
/// parameter from `inputs` and assumes no number of rows.
#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "framework/core/math.h"

namespace tumble::truths {

/// A value in such a file with its position, so that a missing or wrong one is reported with its
/// position.
class Value {
 public:
  using List = std::vector<Value>;
  using Members = std::vector<std::pair<std::string, Value>>;  // in the file's order
  using Content = std::variant<std::monostate, bool, std::string, List, Members>;

  Value() = default;
  /// @param place  for messages, file and JSON pointer:
  ///   "tests/truths/impulse_random__random20.json: /outputs/rows/value/3"
  Value(std::string place, Content content)
      : place_(std::move(place)), content_(std::move(content)) {}

  const std::string& place() const { return place_; }
  bool is_null() const { return std::holds_alternative<std::monostate>(content_); }
  bool is_list() const { return std::holds_alternative<List>(content_); }

  // Each throws UserError with the position when the value is of another kind.
  bool boolean() const;
  const std::string& text() const;
  double number() const;  // decimal string, correctly rounded; finite
  int integer() const;
  const List& list() const;
  const Members& members() const;
  VectorXd vector() const;  // (n) from a list of numbers
  Vector3d vector3() const;
  Matrix3d matrix3() const;  // rows

  /// Item of a list. @throws UserError when there is none
  const Value& at(std::size_t index) const;
  /// Member of this name. @throws UserError when there is none
  const Value& at(const std::string& name) const;
  /// Member of this name, or null.
  const Value* find(const std::string& name) const;

 private:
  std::string place_;
  Content content_;
};

struct Case {
  std::string id;      // "free_top_needle/needle_1e-6"
  std::string family;  // "free_top_needle"
  std::string title;
  Value inputs;   // members NAME = {value, unit, ...}
  Value outputs;  // members NAME = {value, unit, tolerance_floor, ...}

  const Value& input(const std::string& name) const { return inputs.at(name).at("value"); }
  const Value& output(const std::string& name) const { return outputs.at(name).at("value"); }
  bool has_output(const std::string& name) const { return outputs.find(name) != nullptr; }
  /// Floor of a whole output. @throws UserError when the file gives it per row
  double floor(const std::string& name) const {
    return outputs.at(name).at("tolerance_floor").number();
  }
};

}  // namespace tumble::truths
