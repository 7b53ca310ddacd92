// Text to HTML. All untrusted text passes here.
#include "framework/report/html_text.h"

#include <cstdint>
#include <regex>

namespace tumble::report {
namespace {

struct Decoded {
  std::uint32_t code;  // kInvalid for bytes that are not UTF-8
  std::size_t length;  // bytes consumed, at least 1
};
constexpr std::uint32_t kInvalid = 0xffffffff;

// One character. Overlong forms, surrogates and codes past U+10FFFF are invalid (Unicode 15, table
// 3-7).
Decoded decode(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(at);
  if (first < 0x80) return {first, 1};
  const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || at + length > text.size()) return {kInvalid, 1};
  std::uint32_t code = first & (0xff >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(at + i) & 0xc0) != 0x80) return {kInvalid, 1};
    code = (code << 6) | (byte(at + i) & 0x3f);
  }
  constexpr std::uint32_t kSmallest[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xd800 && code <= 0xdfff;
  if (code < kSmallest[length] || surrogate || code > 0x10ffff) return {kInvalid, 1};
  return {code, length};
}

// Characters that hide or reorder their neighbours (the "Trojan source" set), and the C0 and C1
// controls.
bool is_dropped(std::uint32_t code) {
  if (code == '\n' || code == '\t') return false;
  if (code < 0x20 || (code >= 0x7f && code <= 0x9f)) return true;
  const bool bidi = code == 0x061c || code == 0x200e || code == 0x200f ||
                    (code >= 0x202a && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
  const bool invisible =
      code == 0x200b || code == 0x2060 || code == 0xfeff || (code >= 0xe0000 && code <= 0xe007f);
  return bidi || invisible;
}

// Length of a terminal control sequence (ECMA-48: ESC [ parameters final) at `at`, 0 where there is
// none.
std::size_t control_sequence(std::string_view text, std::size_t at) {
  if (text[at] != '\x1b' || at + 1 >= text.size() || text[at + 1] != '[') return 0;
  std::size_t end = at + 2;
  while (end < text.size() && text[end] >= 0x20 && text[end] <= 0x3f) ++end;
  return end < text.size() && text[end] >= 0x40 && text[end] <= 0x7e ? end + 1 - at : 2;
}

void append_escaped(std::string& html, std::string_view character) {
  switch (character[0]) {
    case '&': html += "&amp;"; break;
    case '<': html += "&lt;"; break;
    case '>': html += "&gt;"; break;
    case '"': html += "&quot;"; break;
    case '\'': html += "&#39;"; break;
    default: html += character;
  }
}

}  // namespace

std::string html_sentence(std::string_view text) {
  static const std::regex with_exponent("[0-9.]+e-[0-9]+");
  std::string html = html_escape(text);
  if (html.find("e-") == html.npos) return html;  // most cells of a table: a search takes longer
  return std::regex_replace(html, with_exponent, "<span class=\"unbroken\">$&</span>");
}

std::string html_heading(std::string_view text) {
  constexpr std::size_t kLetters = 24;  // of a heading on a phone
  std::string html, word;
  for (const char letter : html_escape(text) + ' ') {
    word += letter;
    if (letter != ' ') continue;
    if (word.size() > kLetters) word = std::regex_replace(word, std::regex("_"), "_<wbr>");
    html += word;
    word.clear();
  }
  return html.substr(0, html.size() - 1);
}

std::string html_escape(std::string_view text) {
  std::string html;
  html.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    if (const std::size_t skipped = control_sequence(text, at); skipped > 0) {
      at += skipped;
      continue;
    }
    const Decoded character = decode(text, at);
    if (character.code == kInvalid)
      html += "\xef\xbf\xbd";
    else if (!is_dropped(character.code))
      append_escaped(html, text.substr(at, character.length));
    at += character.length;
  }
  return html;
}

std::string link_to(const std::filesystem::path& relative) {
  constexpr char kHex[] = "0123456789ABCDEF";
  std::string link;
  for (const char c : relative.generic_string()) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       std::string_view("._~/-").find(c) != std::string_view::npos;
    if (plain)
      link += c;
    else
      link += {'%', kHex[byte >> 4], kHex[byte & 15]};
  }
  return link;
}

}  // namespace tumble::report
