// Text to HTML. All untrusted text passes here.
#include "framework/report/html_text.h"

#include <cstdint>
#include <regex>

#include "framework/core/utf8.h"

namespace tumble::report {
namespace {

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
    const Character character = character_at(text, at);
    if (!character.is_valid)
      html += "\xef\xbf\xbd";
    else if (!is_dropped(character.code))
      append_escaped(html, text.substr(at, character.length));
    at += character.length;
  }
  return html;
}

std::string formula_in_parts(std::string_view formula) {
  // behind a hyphen a line may break even before a no-break space, behind a minus sign it may not
  constexpr std::string_view kNoBreak = "\u00a0", kMinus = "\u2212";
  constexpr std::size_t kShort = 20;  // letters between brackets: half a line of a phone
  std::vector<bool> stays(formula.size(), false);
  std::size_t open = formula.npos;  // of the innermost bracket
  for (std::size_t i = 0; i < formula.size(); ++i) {
    if (formula[i] == '(' || formula[i] == '[') open = i;
    if (formula[i] != ')' && formula[i] != ']') continue;
    if (open != formula.npos && i - open <= kShort)
      std::fill_n(stays.begin() + static_cast<long>(open), i - open, true);
    open = formula.npos;
  }
  // between an operator and what follows it
  for (std::size_t i = 1; i + 1 < formula.size(); ++i)
    if (formula[i] == ' ' &&
        std::string_view("+-=/x.").find(formula[i - 1]) != std::string_view::npos && i > 1 &&
        formula[i - 2] == ' ')
      stays[i] = true;
  std::string text;
  for (std::size_t i = 0; i < formula.size(); ++i)
    if (formula[i] == ' ' && stays[i])
      text += kNoBreak;
    else if (formula[i] == '-' && i + 1 < formula.size() && formula[i + 1] == ' ' && stays[i + 1])
      text += kMinus;
    else
      text += formula[i];
  return text;
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
