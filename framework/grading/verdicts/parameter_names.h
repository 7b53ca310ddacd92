/// Names of the parameters of a module's functions, and where their hints are, read from its header
/// when a story needs them: no other file has them.
#pragma once

#include <string>
#include <vector>

namespace tumble::grading {

/// The names of a function's parameters, in their order: {"f", "t", "y", "h"}.
/// @param header  the text of a header
/// @return nothing where it does not declare the function, or a parameter has no name
std::vector<std::string> names_in_declaration(const std::string& header,
                                              const std::string& function);

/// The same, from the header of an assignment of the course's tree.
/// @param id  of the module, "a1"
/// @return nothing where there is no such header: a story goes without names
std::vector<std::string> parameter_names(const std::string& id, const std::string& function);

/// Where the comment of a function says that its hints are: "handouts/a1_impulse.md#hint-ray".
/// @return empty where the header does not declare the function, or its comment has no hints
std::string hints_in_declaration(const std::string& header, const std::string& function);

/// What a header says of a function, for somebody who is to write or mend it.
struct FunctionInHeader {
  std::string purpose;                 // its first lines, to the first @ or Source
  std::string formula;                 // of these, those of formulas; empty: they are sentences
  std::string returns;                 // behind @return
  std::string hints;                   // "handouts/a1_impulse.md#hint-ray"
  std::vector<std::string> equations;  // "handouts/a1_impulse.md#eq-a1-9": of the numbers at the
                                       // ends of its lines, where the hints have a file
};

/// @return empty where the header does not declare the function
FunctionInHeader told_in_declaration(const std::string& header, const std::string& function);

/// The same, from the header of an assignment of the course's tree; empty where there is none.
FunctionInHeader told_of_function(const std::string& id, const std::string& function);

/// "\n  read:     handouts/a1_impulse.md#hint-ray", for the end of a story.
/// @param id  of the module, "a1"
/// @return empty where there is no such header, or it says nothing
std::string hints_to_read(const std::string& id, const std::string& function);

/// "t = 0, h = 0.01"; without names, "0, 0.01", where there are not as many names as values.
std::string with_names(const std::vector<std::string>& values,
                       const std::vector<std::string>& names);

}  // namespace tumble::grading
