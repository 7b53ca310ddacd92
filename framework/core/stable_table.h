/// A table of numbered entries that threads share: a number stays valid, and its entry keeps its
/// address, until the number is given back.
///
/// Entries are stored in blocks that never move; each block is twice as long as the one before it.
/// Taking a number and giving it back need the owner's lock; access to an entry by its number does
/// not.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace tumble {

template <class Thing>
class StableTable {
 public:
  /// @return a free number. Not to be called by two threads at once
  int take() {
    if (free_.empty()) {
      const auto [block, place] = where(count_);
      if (place == 0) blocks_[block] = std::make_unique<Thing[]>(kFirst << block);
      free_.push_back(static_cast<int>(count_++));
    }
    const int number = free_.back();
    free_.pop_back();
    return number;
  }
  /// Not to be called by two threads at once, nor at the same time as take().
  void give_back(int number) {
    (*this)[number] = Thing{};
    free_.push_back(number);
  }

  Thing& operator[](int number) {
    const auto [block, place] = where(static_cast<std::size_t>(number));
    return blocks_[block][place];
  }
  const Thing& operator[](int number) const {
    const auto [block, place] = where(static_cast<std::size_t>(number));
    return blocks_[block][place];
  }
  /// How many numbers are in use.
  std::size_t taken() const { return count_ - free_.size(); }

 private:
  static constexpr std::size_t kFirst = 64;  // a power of two
  struct Where {
    std::size_t block, place;
  };
  // Block b holds kFirst 2^b entries, from number kFirst (2^b - 1) on.
  static Where where(std::size_t number) {
    const std::size_t shifted = number + kFirst,
                      block = static_cast<std::size_t>(std::bit_width(shifted) -
                                                       std::bit_width(kFirst));
    return {block, shifted - (kFirst << block)};
  }

  std::array<std::unique_ptr<Thing[]>, 26> blocks_;  // enough for every int
  std::vector<int> free_;
  std::size_t count_ = 0;
};

}  // namespace tumble
