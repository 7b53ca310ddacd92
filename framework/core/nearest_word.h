/// The known word that a mistyped word most likely meant.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace tumble {

/// Number of letters to insert, remove or change to turn one word into the other (Levenshtein
/// 1966).
/// Cost: O(|a| |b|)
std::size_t edit_distance(const std::string& a, const std::string& b);

/// The candidate at the smallest edit distance, which is at most 2 or a third of the word; the
/// first of equals. A word cut short ("mass" for "mass_kg", "insp" for "inspect") or with another
/// unit ("mass_lb") counts as one error, one written out ("output" for "out") as two.
/// @return "" when no candidate is near
std::string nearest_word(const std::string& word, const std::vector<std::string>& candidates);

/// " Did you mean 'x'?" for the nearest candidate, or "".
std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace tumble
