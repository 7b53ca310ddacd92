#include "framework/truths/truth_case.h"

#include <cmath>
#include <cstdlib>

#include "framework/core/error.h"

namespace tumble::truths {
namespace {

[[noreturn]] void not_a(const Value& value, const std::string& wanted) {
  throw UserError(value.place(), "expected " + wanted,
                  "A truth file has numbers as decimal strings; see tests/truths.");
}

std::string found_in(const Value::Content& content) {
  static const char* const kinds[] = {"null", "true or false", "a string", "a list", "an object"};
  return std::string(", found ") + kinds[content.index()];
}

}  // namespace

bool Value::boolean() const {
  if (const bool* b = std::get_if<bool>(&content_)) return *b;
  not_a(*this, "true or false" + found_in(content_));
}

const std::string& Value::text() const {
  if (const auto* s = std::get_if<std::string>(&content_)) return *s;
  not_a(*this, "a string" + found_in(content_));
}

double Value::number() const {
  const auto* s = std::get_if<std::string>(&content_);
  if (s == nullptr || s->empty()) not_a(*this, "a number" + found_in(content_));
  char* end = nullptr;
  const double x = std::strtod(s->c_str(), &end);
  if (*end != '\0' || !std::isfinite(x)) not_a(*this, "a finite number, found '" + *s + "'");
  return x;
}

int Value::integer() const {
  const double x = number();
  if (std::abs(x) > 1e9 || x != std::floor(x))
    not_a(*this, "a whole number, found '" + text() + "'");
  return static_cast<int>(x);
}

const Value::List& Value::list() const {
  if (const auto* items = std::get_if<List>(&content_)) return *items;
  not_a(*this, "a list" + found_in(content_));
}

const Value::Members& Value::members() const {
  if (const auto* members = std::get_if<Members>(&content_)) return *members;
  not_a(*this, "an object with named members" + found_in(content_));
}

VectorXd Value::vector() const {
  const List& items = list();
  VectorXd v(static_cast<Eigen::Index>(items.size()));
  for (std::size_t i = 0; i < items.size(); ++i)
    v[static_cast<Eigen::Index>(i)] = items[i].number();
  return v;
}

Vector3d Value::vector3() const {
  const VectorXd v = vector();
  if (v.size() != 3) not_a(*this, "three numbers, found " + std::to_string(v.size()));
  return v;
}

Matrix3d Value::matrix3() const {
  const List& rows = list();
  if (rows.size() != 3) not_a(*this, "three rows, found " + std::to_string(rows.size()));
  Matrix3d m;
  for (int i = 0; i < 3; ++i) m.row(i) = rows[static_cast<std::size_t>(i)].vector3();
  return m;
}

const Value& Value::at(std::size_t index) const {
  const List& items = list();
  if (index < items.size()) return items[index];
  throw UserError(place_, "has " + std::to_string(items.size()) + " items, which is too few",
                  "Compare it with a case of that family in tests/truths.");
}

const Value& Value::at(const std::string& name) const {
  if (const Value* value = find(name)) return *value;
  throw UserError(place_, "has no '" + name + "', which its family needs",
                  "Compare it with a case of that family in tests/truths.");
}

const Value* Value::find(const std::string& name) const {
  for (const auto& [key, value] : members()) {
    if (key == name) return &value;
  }
  return nullptr;
}

}  // namespace tumble::truths
