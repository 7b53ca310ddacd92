/// The only place where text becomes HTML.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace tumble::report {

/// Text as HTML: markup escaped; terminal colour codes, control characters and characters that
/// reverse the writing direction dropped; bytes that are not UTF-8 replaced by U+FFFD. Newline and
/// tab stay.
std::string html_escape(std::string_view text);

/// The same for a sentence: a number such as 9.4e-15 is not broken at its hyphen.
std::string html_sentence(std::string_view text);

/// The same for a heading: a name too long for the line of a phone breaks behind an underscore.
std::string html_heading(std::string_view text);

/// A formula in letters, for a narrow page: it breaks before an operator, and not within short
/// brackets. "j = -(1 + e) u_n": the blanks that stay are no-break spaces (U+00A0), and a hyphen
/// before one of them is a minus sign (U+2212).
std::string formula_in_parts(std::string_view formula);

/// A file's path, relative to the page, as a link: every byte outside [A-Za-z0-9._~/-] as %XX.
std::string link_to(const std::filesystem::path& relative);

}  // namespace tumble::report
