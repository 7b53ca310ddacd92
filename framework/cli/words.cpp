#include "framework/cli/words.h"

#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

namespace tumble::cli {

Word& Word::required() {
  option_->required();
  return *this;
}

Word& Word::type_name(const std::string& name) {
  option_->type_name(name);
  return *this;
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
  return Word(app_->add_option(name, value, help));
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
