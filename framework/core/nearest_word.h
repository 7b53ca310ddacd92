/// What a person meant who mistyped a word.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace tumble {

/// Letters to insert, remove or change to make one word of the other (Levenshtein 1966).
/// Cost: O(letters of a times letters of b)
std::size_t edit_distance(const std::string& a, const std::string& b);

/// The candidate that a mistyped word most likely meant: fewest letters off, at most 2 or a third of the word; the first of
/// equals. A word cut short ("mass" for "mass_kg", "insp" for "inspect") or with another unit ("mass_lb") counts as one slip.
/// @return "" when none is near
std::string nearest_word(const std::string& word, const std::vector<std::string>& candidates);

/// " Did you mean 'x'?" for the nearest candidate, or "".
std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace tumble
