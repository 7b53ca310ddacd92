/// The words of a verb: positional words, options with a value, flags. The command line's parser is behind it, seen by
/// words.cpp and main.cpp only: it is expensive to compile, and forty files need nothing of it but this.
#pragma once

#include <functional>
#include <string>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace tumble::cli {

/// One word, as it was declared; each function says one more thing of it.
class Word {
 public:
  explicit Word(CLI::Option* option) : option_(option) {}

  Word& required();
  Word& type_name(const std::string& name);   // what help writes for the value, e.g. FILE
  Word& positive();                            // a value that is not above 0 is refused
  Word& not_negative();
  Word& between(int least, int most);          // both ends allowed
  Word& between(double least, double most);
  Word& separated_by(char separator);          // of lists: 1,2,3
  Word& shows_default();                       // help tells the value that the variable has now
  Word& default_text(const std::string& text); // help tells this instead
  Word& excludes(const std::string& name);     // refused beside that word
  Word& needs(const Word& other);              // refused without it

 private:
  CLI::Option* option_;
};

class Verb {
 public:
  Verb(CLI::App& app, const std::string& name, const std::string& help);

  /// `name` is "--step-s" of an option, "scene" of a positional word. `value` must outlive the parsing and keeps what it
  /// has where the word is not given. For strings, paths, numbers, optionals and lists of them (words.cpp has the list).
  template <class Value>
  Word option(const std::string& name, Value& value, const std::string& help);

  /// "!--no-pdf" makes the value false.
  Word flag(const std::string& name, bool& value, const std::string& help);

  void footer(const std::string& text);
  void runs(std::function<void()> run);   // called once all words are read and right

 private:
  CLI::App* app_;
};

}  // namespace tumble::cli
