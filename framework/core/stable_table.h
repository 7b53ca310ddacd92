/// Things with numbers, for threads that share them: a number stays valid and its thing stays in place until it is given back.
///
/// Things lie in blocks that never move, each twice as long as the one before it. Taking a number and giving it back need the owner's lock;
/// looking at a thing whose number one has does not.
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
  /// @return a number nobody has. Not by two threads at once
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
  /// Not by two threads at once, nor beside take().
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
  /// Numbers that somebody has.
  std::size_t taken() const { return count_ - free_.size(); }

 private:
  static constexpr std::size_t kFirst = 64;   // a power of two
  struct Where {
    std::size_t block, place;
  };
  // Block b holds kFirst 2^b things, from kFirst (2^b - 1) on.
  static Where where(std::size_t number) {
    const std::size_t shifted = number + kFirst, block = static_cast<std::size_t>(std::bit_width(shifted) - std::bit_width(kFirst));
    return {block, shifted - (kFirst << block)};
  }

  std::array<std::unique_ptr<Thing[]>, 26> blocks_;   // more than an int can number
  std::vector<int> free_;
  std::size_t count_ = 0;
};

}  // namespace tumble
