/// How help is laid out: 80 columns, broken at words; verbs grouped by who uses them; plain words
/// for the type and the range of a value.
#pragma once

#include <string>

namespace CLI {
class App;
}  // namespace CLI

namespace tumble::cli {

/// Help of the program and of its verbs, in this layout; call it before verbs are declared.
void lay_out_help(CLI::App& app);

/// Verbs declared from here on stand under this heading in help.
void begin_group(CLI::App& app, const std::string& heading);

}  // namespace tumble::cli
