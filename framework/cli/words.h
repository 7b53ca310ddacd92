/// The words of a verb: positional words, options with a value, flags. The parser of the command
/// line is hidden behind it and seen by words.cpp and main.cpp only, because it is expensive to
/// compile and forty files need only this interface.
#pragma once

#include <functional>
#include <string>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace tumble::cli {

/// A declared word; each function adds one property.
class Word {
 public:
  explicit Word(CLI::Option* option) : option_(option) {}

  Word& required();
  Word& type_name(const std::string& name);  // the name of the value in help, e.g. FILE
  Word& file();                              // FILE in help; refuses an empty name
  Word& positive();                          // refuses a value that is not above 0
  Word& not_negative();
  Word& between(int least, int most);  // both ends allowed
  Word& between(double least, double most);
  Word& separated_by(char separator);           // of lists: 1,2,3
  Word& one_each();                             // of lists: each flag has one value; it is repeated
  Word& shows_default();                        // help shows the current value of the variable
  Word& default_text(const std::string& text);  // help shows this instead
  Word& excludes(const std::string& name);      // refused together with that word
  Word& needs(const Word& other);               // refused without it
  Word& hidden();                               // of no help: one program says it to another

 private:
  CLI::Option* option_;
};

class Verb {
 public:
  Verb(CLI::App& app, const std::string& name, const std::string& help);

  /// `name` is "--step-s" for an option, "scene" for a positional word. `value` must outlive the
  /// parse and keeps its value where the word is not given. For strings, paths, numbers, optionals
  /// and lists of them (words.cpp has the list). Numbers must be finite; whole ones are decimal.
  template <class Value>
  Word option(const std::string& name, Value& value, const std::string& help);

  /// "!--no-pdf" makes the value false.
  Word flag(const std::string& name, bool& value, const std::string& help);

  void footer(const std::string& text);
  void runs(std::function<void()> run);  // called after a successful parse

 private:
  CLI::App* app_;
};

}  // namespace tumble::cli
