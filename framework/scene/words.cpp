#include "framework/scene/words.h"

namespace tumble::scene {

const Words* words_of(const std::string& key) {
  for (const Words* words : all_words())
    if (words->key() == key) return words;
  return nullptr;
}

}  // namespace tumble::scene
