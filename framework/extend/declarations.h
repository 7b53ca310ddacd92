/// The functions of a new assignment, read from a list of C++ declarations.
///
///   #include "framework/dynamics/body.h"
///
///   // Total energy of a body under gravity.
///   // eq: E = m v^2 / 2 + w . (I w) / 2 + m g z
///   double energy_of(const Body& body, double gravity_m_s2);
///
/// Above each declaration stands at least one line of comment, which becomes the first sentence of
/// its documentation; a line `eq:` is its equation, in ASCII. Lines of #include, and definitions of
/// struct and enum, go into the header as they are. Functions return a value and take parameters
/// with names; no two have the same name, because a module is a table by name (modules/module.h).
#pragma once

#include <string>
#include <vector>

namespace tumble::extend {

struct Parameter {
  std::string type;  // "const Vector3d&"
  std::string name;
};

struct Function {
  std::string name;
  std::string returns;  // "std::optional<double>"
  std::vector<Parameter> parameters;
  std::vector<std::string> about;  // lines of its comment, without marks
  std::string equation;            // empty: none was given
  int line = 0;                    // of its name, from 1
};

struct Declarations {
  std::vector<std::string> includes;  // whole lines
  std::string types;                  // struct and enum with their comments; ends with a line break
  std::vector<Function> functions;
};

/// @param file  where the text is from, for messages
/// @throws UserError with file and line for what is not written as above, and for a file without a
///   function
Declarations read_declarations(const std::string& text, const std::string& file);

/// One function as an assignment's header declares it, without its comment.
/// @throws UserError where the header declares none of this name
Function read_function(const std::string& header, const std::string& name, const std::string& file);

}  // namespace tumble::extend
