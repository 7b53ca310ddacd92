/// Small helpers for strings.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace tumble {

/// ASCII letters in lower case; other bytes stay.
std::string lowercase(std::string text);

/// "1 test", "3 tests".
std::string counted(std::size_t n, const std::string& noun);

/// A text as a sentence: a capital letter at its beginning, a full stop at its end. Where it begins
/// with a symbol or a name of the program ("e = 1: ..."), that stays as it is, behind "Here". An
/// empty text stays empty.
std::string sentence(std::string text);
/// Both, with a blank between them where neither is empty.
std::string sentences(const std::string& first, const std::string& second);

/// A number in so many digits as a sentence has it: 0.08, 120, 6.2e-5; powers of ten below 1e-4 and
/// from 1e6 on, and no zeros that say nothing, never "-0".
std::string few_digits(double x, int digits = 2);

/// The same with three digits.
std::string three_digits(double x);

/// A step [s] as people read it: "1/60" where it is such a part of a second, else in three digits.
std::string step_in_words(double step_s);

/// The text with a capital letter at its beginning where that is a word of more than two letters:
/// "Midpoint", and not the name of an engine ("ca"), a function ("rk4_step") or a method ("RK4").
std::string capitalised(std::string text);

/// At most `width` bytes: a longer text loses its middle, "begin..end".
std::string without_middle(const std::string& text, std::size_t width);

/// "int a, std::map<int, int> b" -> two parts: commas inside brackets divide nothing.
std::vector<std::string> at_commas(const std::string& text);

}  // namespace tumble
