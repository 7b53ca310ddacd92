#include "framework/cli/help_format.h"

#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "framework/core/terminal.h"
#include "framework/core/text.h"

namespace tumble::cli {
namespace {

constexpr const char* kNoGroup = "Subcommands";  // what the parser calls it
constexpr std::size_t kColumns = 78;             // 80 where --help-all indents by two
constexpr std::size_t kExplanations = 28;        // the column where they begin

// "name  explanation", the explanation in a column of its own.
std::string entry(const std::string& name, const std::string& explanation) {
  const std::string margin(kExplanations, ' ');
  std::string left = "  " + name;
  if (left.size() + 2 > kExplanations)
    left += "\n" + margin;
  else
    left.resize(kExplanations, ' ');
  return wrapped(left + explanation, kColumns, kExplanations) + "\n";
}

/// A type as the parser names it, such as "INT:INT in [1 - 256]", in two parts.
struct Type {
  std::string name;   // INTEGER
  std::string range;  // "1 to 256", or empty
};

Type type_of(const CLI::Option& option) {
  const std::string told = option.get_type_name();
  const std::size_t colon = told.find(':');
  Type type{told.substr(0, colon), ""};
  if (type.name == "FLOAT") type.name = "NUMBER";
  if (type.name == "INT" || type.name == "UINT") type.name = "INTEGER";
  if (colon == std::string::npos) return type;
  const std::string checked = told.substr(colon + 1);
  const std::size_t begin = checked.find('['), end = checked.find(']'), dash = checked.find(" - ");
  if (begin < dash && dash < end && end != std::string::npos)
    type.range = checked.substr(begin + 1, dash - begin - 1) + " to " +
                 checked.substr(dash + 3, end - dash - 3);
  else if (checked == "POSITIVE")
    type.range = "above 0";
  return type;
}

class Layout : public CLI::Formatter {
 public:
  std::string make_usage(const CLI::App* app, std::string name) const override {
    if (app->get_parent() != nullptr)
      return wrapped(CLI::Formatter::make_usage(app, name), kColumns, 2);
    return "Usage: " + name + " VERB ...     " + name + " VERB --help says what may follow it\n";
  }
  std::string make_description(const CLI::App* app) const override {
    return wrapped(app->get_description(), kColumns, 0) + "\n";
  }
  std::string make_footer(const CLI::App* app) const override {
    return wrapped(CLI::Formatter::make_footer(app), kColumns, 4);
  }
  // Scripts find the verbs below this heading: two spaces, then the verb. A group has one space.
  std::string make_subcommands(const CLI::App* app, CLI::AppFormatMode mode) const override {
    std::string text, group;
    for (const CLI::App* verb : app->get_subcommands({})) {
      if (text.empty()) text = "\nVerbs:\n";
      if (verb->get_group() != group) {
        group = verb->get_group();
        if (group != kNoGroup) text += " " + group + "\n";
      }
      text += mode == CLI::AppFormatMode::All
                  ? verb->help(verb->get_name(), CLI::AppFormatMode::Sub) + "\n"
                  : make_subcommand(verb);
    }
    return text;
  }
  std::string make_subcommand(const CLI::App* verb) const override {
    return entry(verb->get_name(), verb->get_description());
  }
  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    const std::string name = make_option_name(option, is_positional);
    if (option->get_type_size() == 0) return entry(name, option->get_description() + added(option));
    const Type type = type_of(*option);
    const bool is_list = option->get_expected_max() == CLI::detail::expected_max_vector_size;
    // "scene SCENE" says it twice.
    const bool is_said = lowercase(type.name) == name;
    return entry(name + (is_said ? "" : " " + type.name) + (is_list ? " ..." : ""),
                 option->get_description() + added(option));
  }

 private:
  // Range, default and other conditions, behind the explanation.
  static std::string added(const CLI::Option* option) {
    std::string text;
    const auto add = [&](const std::string& words) { text += (text.empty() ? "" : "; ") + words; };
    if (option->get_type_size() != 0) {
      const std::string range = type_of(*option).range;
      if (!range.empty()) add(range);
      if (!option->get_default_str().empty()) add("default " + option->get_default_str());
    }
    for (const CLI::Option* needed : option->get_needs()) add("with " + needed->get_name());
    for (const CLI::Option* other : option->get_excludes()) add("not with " + other->get_name());
    return text.empty() ? "" : " (" + text + ")";
  }
};

}  // namespace

void lay_out_help(CLI::App& app) { app.formatter(std::make_shared<Layout>()); }

// A verb inherits the group that the program has when it is declared.
void begin_group(CLI::App& app, const std::string& heading) { app.group(heading); }

}  // namespace tumble::cli
