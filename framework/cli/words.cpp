#include "framework/cli/words.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

namespace tumble::cli {
namespace {

// The parser's ranges let NaN pass, which is neither below nor above anything.
std::string refuse_not_finite(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (end == text.c_str() || std::isfinite(value)) return "";  // no number: the parser refuses it
  return "Value " + text + " is not a finite number";
}

// The parser reads them as octal: 010 would be 8.
std::string refuse_leading_zero(const std::string& text) {
  const std::size_t first = text.find_first_not_of("+-");
  if (first > 1 || text.size() - first < 2 || text[first] != '0') return "";
  const std::string digits = text.substr(first);
  if (!std::all_of(digits.begin(), digits.end(),
                   [](unsigned char letter) { return std::isdigit(letter) != 0; }))
    return "";
  const std::size_t begin = std::min(digits.find_first_not_of('0'), digits.size() - 1);
  return "Value " + text + ": write " + (text[0] == '-' ? "-" : "") + digits.substr(begin) +
         ", without the leading 0";
}

template <class Value>
struct ValueOf {
  using Type = Value;
};
template <class Value>
struct ValueOf<std::optional<Value>> {
  using Type = Value;
};
template <class Value>
struct ValueOf<std::vector<Value>> {
  using Type = Value;
};

}  // namespace

Word& Word::required() {
  option_->required();
  return *this;
}

Word& Word::type_name(const std::string& name) {
  option_->type_name(name);
  return *this;
}

Word& Word::file() {
  option_->check([](const std::string& text) {
    return text.empty() ? std::string("the name of the file is empty") : std::string();
  });
  return type_name("FILE");
}

Word& Word::positive() {
  option_->check(CLI::PositiveNumber);
  return *this;
}

Word& Word::not_negative() {
  option_->check(CLI::NonNegativeNumber);
  return *this;
}

Word& Word::between(int least, int most) {
  option_->check(CLI::Range(least, most));
  return *this;
}

Word& Word::between(double least, double most) {
  option_->check(CLI::Range(least, most));
  return *this;
}

Word& Word::separated_by(char separator) {
  option_->delimiter(separator);
  return *this;
}

Word& Word::shows_default() {
  option_->capture_default_str();
  return *this;
}

Word& Word::default_text(const std::string& text) {
  option_->default_str(text);
  return *this;
}

Word& Word::excludes(const std::string& name) {
  option_->excludes(name);
  return *this;
}

Word& Word::needs(const Word& other) {
  option_->needs(other.option_);
  return *this;
}

Word& Word::one_each() {
  option_->allow_extra_args(false);
  return *this;
}

Word& Word::hidden() {
  option_->group("");
  return *this;
}

Verb::Verb(CLI::App& app, const std::string& name, const std::string& help)
    : app_(app.add_subcommand(name, help)) {}

template <class Value>
Word Verb::option(const std::string& name, Value& value, const std::string& help) {
  using Type = typename ValueOf<Value>::Type;
  CLI::Option* option = app_->add_option(name, value, help);
  // A check without a description leaves help as it is.
  if constexpr (std::is_floating_point_v<Type>) option->check(refuse_not_finite);
  if constexpr (std::is_integral_v<Type>) option->check(refuse_leading_zero);
  return Word(option);
}

template Word Verb::option(const std::string&, std::string&, const std::string&);
template Word Verb::option(const std::string&, int&, const std::string&);
template Word Verb::option(const std::string&, double&, const std::string&);
template Word Verb::option(const std::string&, std::optional<int>&, const std::string&);
template Word Verb::option(const std::string&, std::optional<double>&, const std::string&);
template Word Verb::option(const std::string&, std::optional<std::string>&, const std::string&);
template Word Verb::option(const std::string&, std::vector<std::string>&, const std::string&);
template Word Verb::option(const std::string&, std::vector<int>&, const std::string&);
template Word Verb::option(const std::string&, std::vector<double>&, const std::string&);
template Word Verb::option(const std::string&, std::vector<std::size_t>&, const std::string&);
template Word Verb::option(const std::string&, std::filesystem::path&, const std::string&);

Word Verb::flag(const std::string& name, bool& value, const std::string& help) {
  return Word(app_->add_flag(name, value, help));
}

void Verb::footer(const std::string& text) { app_->footer(text); }

void Verb::runs(std::function<void()> run) { app_->callback(std::move(run)); }

}  // namespace tumble::cli
