#include "framework/core/utf8.h"

namespace tumble {

Character character_at(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i]));
  };
  const std::uint32_t first = byte(at);
  if (first < 0x80) return {first, 1, true};
  const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || at + length > text.size()) return {first, 1, false};
  std::uint32_t code = first & (0xffu >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(at + i) & 0xc0) != 0x80) return {first, 1, false};
    code = (code << 6) | (byte(at + i) & 0x3f);
  }
  const bool overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
  if (overlong || (code >= 0xd800 && code <= 0xdfff) || code > 0x10ffff) return {first, 1, false};
  return {code, length, true};
}

std::optional<std::size_t> first_that_is_no_utf8(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const Character c = character_at(text, at);
    if (!c.is_valid) return at;
    at += c.length;
  }
  return std::nullopt;
}

std::optional<NoText> why_no_text(std::string_view text) {
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    return NoText{"is written in UTF-16, which is not read here",
                  "Save it as UTF-8 (in Visual Studio: Save As, Save with Encoding; in Notepad: "
                  "Encoding UTF-8)."};
  if (const std::size_t nul = text.find('\0'); nul != text.npos)
    return NoText{"contains bytes that are not text (a NUL at byte " + std::to_string(nul) + ")",
                  "Save it as UTF-8 text; a compiled file or an archive is not read."};
  return std::nullopt;
}

}  // namespace tumble
