/// Text in UTF-8, and what is none.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace tumble {

struct Character {
  std::uint32_t code = 0;  // of Unicode; where the bytes are no UTF-8, the first of them
  std::size_t length = 1;  // bytes
  bool is_valid = false;
};

/// The character that begins at a byte, by Unicode 15, table 3-7: no overlong forms, no surrogates,
/// nothing above U+10FFFF.
/// @pre at < text.size()
Character character_at(std::string_view text, std::size_t at);

/// @return the place of the first byte that is no UTF-8
std::optional<std::size_t> first_that_is_no_utf8(std::string_view text);

/// What speaks against a file's being text, as the end of a sentence ("the file is ..."), and how
/// to save it as text.
struct NoText {
  std::string problem;
  std::string remedy;
};
/// Whether a file is in UTF-16, as editors on Windows may write it, or holds bytes that no text
/// has.
std::optional<NoText> why_no_text(std::string_view text);

}  // namespace tumble
