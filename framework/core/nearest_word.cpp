#include "framework/core/nearest_word.h"

#include <algorithm>

namespace tumble {

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t corner = row[0];  // of the row above, one to the left
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, corner + (a[i - 1] == b[j - 1] ? 0 : 1)});
      corner = above;
    }
  }
  return row[b.size()];
}

namespace {

// "a" of "body_a", "mass" of "mass_kg"
bool is_part_of(const std::string& word, const std::string& candidate) {
  return ('_' + candidate + '_').find('_' + word + '_') != std::string::npos;
}

}  // namespace

std::string nearest_word(const std::string& word, const std::vector<std::string>& candidates) {
  if (word.empty()) return "";
  std::string nearest;
  std::size_t least = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const bool is_cut = candidate.starts_with(word);
    const bool unit_differs = word.starts_with(candidate.substr(0, candidate.find('_')) + '_');
    const std::size_t letters = edit_distance(word, candidate);
    // "--output" for "--out"; behind what is nearer, since "pong_2000" is rather "pong_200"
    const bool is_longer = candidate.size() >= 3 && word.starts_with(candidate);
    const std::size_t distance = is_part_of(word, candidate) ? 0
                                 : is_cut || unit_differs    ? std::min<std::size_t>(letters, 1)
                                 : is_longer                 ? std::min<std::size_t>(letters, 2)
                                                             : letters;
    // nothing in common: not a typing error
    if (distance >= least || letters >= std::max(word.size(), candidate.size())) continue;
    least = distance;
    nearest = candidate;
  }
  return nearest;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates) {
  const std::string nearest = nearest_word(word, candidates);
  return nearest.empty() ? "" : " Did you mean '" + nearest + "'?";
}

}  // namespace tumble
