#include "framework/grading/verdicts/plain_text.h"

#include <cstdint>
#include <cstdio>

#include "framework/core/utf8.h"

namespace tumble::grading {
namespace {

bool is_unseen(std::uint32_t code) {
  // controls, the no-break space
  if (code < 0x20 || (code >= 0x7f && code <= 0xa0)) return true;
  const bool turns = code == 0x061c || code == 0x200e || code == 0x200f ||
                     (code >= 0x202a && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
  // and unusual spaces
  const bool breaks = code == 0x2028 || code == 0x2029 || (code >= 0x2000 && code <= 0x200a) ||
                      code == 0x202f || code == 0x205f || code == 0x3000;
  // The joiners U+200C and U+200D stay: names in Persian and Hindi need them.
  const bool hides = code == 0x00ad || code == 0x034f || code == 0x115f || code == 0x1160 ||
                     code == 0x3164 || code == 0xffa0 || (code >= 0x180b && code <= 0x180f) ||
                     code == 0x200b || (code >= 0x2060 && code <= 0x2064) ||
                     (code >= 0x206a && code <= 0x206f) || (code >= 0xfe00 && code <= 0xfe0f) ||
                     code == 0xfeff || (code >= 0xfff9 && code <= 0xfffb) ||
                     (code >= 0xe0000 && code <= 0xe0fff);
  return turns || breaks || hides;
}

// Length of a terminal's control sequence (ECMA-48: ESC [ parameters, final byte) at `at`; 0 where
// there is none.
std::size_t colour_at(std::string_view text, std::size_t at) {
  if (text[at] != '\x1b' || at + 1 >= text.size() || text[at + 1] != '[') return 0;
  std::size_t end = at + 2;
  while (end < text.size() && text[end] >= 0x20 && text[end] <= 0x3f) ++end;
  return end < text.size() && text[end] >= 0x40 && text[end] <= 0x7e ? end + 1 - at : 0;
}

std::string written_out(const Character& c) {
  char text[16];
  std::snprintf(text, sizeof text, c.is_valid && c.code >= 0x80 ? "\\u{%04X}" : "\\x%02X",
                static_cast<unsigned>(c.code));
  return text;
}

std::string plain(std::string_view text, bool one_line) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    if (const std::size_t skipped = one_line ? 0 : colour_at(text, at); skipped > 0) {
      at += skipped;
      continue;
    }
    const Character c = character_at(text, at);
    const bool stays = !one_line && (c.code == '\n' || c.code == '\t');
    if (one_line && c.code == '\\')
      result += "\\\\";
    else if (c.is_valid && (stays || !is_unseen(c.code)))
      result += text.substr(at, c.length);
    else
      result += written_out(c);
    at += c.length;
  }
  return result;
}

}  // namespace

std::string shell_word(std::string_view text) {
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("_-./+,@%").find(c) != std::string_view::npos;
  };
  // Invisible characters are escaped as bytes in $'...' (bash and zsh); other text is put in single
  // quotes.
  std::string word;
  bool is_seen = true;
  for (std::size_t at = 0; at < text.size();) {
    const Character c = character_at(text, at);
    is_seen = is_seen && c.is_valid && !is_unseen(c.code);
    at += c.length;
  }
  for (const char c : text) {
    char byte[8];
    std::snprintf(byte, sizeof byte, "\\x%02x",
                  static_cast<unsigned>(static_cast<unsigned char>(c)));
    if (is_seen)
      word += c == '\'' ? "'\\''" : std::string(1, c);
    else
      word += is_plain(c) || c == ' ' ? std::string(1, c) : byte;
  }
  return (is_seen ? "'" : "$'") + word + "'";
}

std::string plain_name(std::string_view text) { return plain(text, true); }
std::string plain_text(std::string_view text) { return plain(text, false); }

}  // namespace tumble::grading
