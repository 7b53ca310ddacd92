/// A JSON text with the lines of its values, checked against a schema. For the .cpp files of this
/// folder only.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include <nlohmann/json.hpp>

#include "framework/core/error.h"
#include "framework/core/nearest_word.h"

namespace tumble::scene {

struct Document {
  nlohmann::json json;
  std::map<std::string, int> lines;  // by JSON pointer: the line (from 1) of the value or its key
  std::filesystem::path file;

  /// Refuses the value at `pointer` ("" is the whole file); a pointer without a line of its own is
  /// reported at its parent's.
  [[noreturn]] void refuse(const std::string& pointer, const std::string& problem,
                           const std::string& remedy = "") const;
};

/// @throws UserError with line and column for text that is no JSON, a duplicate key, or a number
///   too large for a double
Document parse_document(const std::string& text, const std::filesystem::path& file);

/// @throws UserError for the innermost value that the schema does not allow
void check_against_schema(const Document& document, const nlohmann::json& schema);

/// A value for an error message: shortened to one line.
std::string show(const nlohmann::json& value);

}  // namespace tumble::scene
