/// Slips that nobody thought of: the reference with one operator, sign, index or frame changed
/// (mutation testing). A test suite that lets one of them pass asks too little, or the change makes
/// no difference.
/// Source: DeMillo, Lipton, Sayward, "Hints on test data selection", Computer 11(4), 1978.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/extend/templates.h"

namespace tumble::extend {

struct Mutation {
  int line;            // in the reference, from 1
  std::string before;  // the line
  std::string after;   // the line, changed in one place
  std::string what;    // "plus_to_minus"
};

/// Every change of one place in the code of a text: comments, preprocessor lines, text between
/// quotes and lines that hold no expression stay.
std::vector<Mutation> mutations_of(const std::string& text);

/// Writes one slip a change of an assignment's reference into a folder, for
/// `tumble audit aN --mutants FOLDER`.
/// @return the files, below `folder`
/// @throws UserError where the folder holds such files already
std::vector<NewFile> new_mutations(const std::filesystem::path& root, const std::string& id,
                                   const std::filesystem::path& folder);

}  // namespace tumble::extend
