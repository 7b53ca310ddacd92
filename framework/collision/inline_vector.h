/// A small vector: the first N items need no heap memory. For hot loops that collect a few items.
/// Internal to collision.
#pragma once

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace tumble::collision {

template <class T, int N>
class InlineVector {
 public:
  InlineVector() = default;
  InlineVector(const InlineVector& other) : size_(other.size_), many_(other.many_) {
    copy_few(other);
  }
  InlineVector(InlineVector&& other) : size_(other.size_), many_(std::move(other.many_)) {
    copy_few(other);
    other.size_ = 0;
  }
  InlineVector& operator=(const InlineVector& other) {
    size_ = other.size_;
    many_ = other.many_;
    copy_few(other);
    return *this;
  }
  InlineVector& operator=(InlineVector&& other) {
    size_ = other.size_;
    many_ = std::move(other.many_);
    copy_few(other);
    other.size_ = 0;
    return *this;
  }

  void push_back(const T& item) {
    if (size_ < N) {
      few_[size_] = item;
    } else {
      if (size_ == N) many_.assign(few_.begin(), few_.end());
      many_.push_back(item);
    }
    ++size_;
  }
  void clear() {
    size_ = 0;
    many_.clear();
  }
  /// Keeps the first n items.
  void shrink(int n) {
    if (size_ > N && n <= N) std::copy(many_.begin(), many_.begin() + n, few_.begin());
    if (n > N) many_.resize(static_cast<std::size_t>(n));
    size_ = n;
  }
  bool empty() const { return size_ == 0; }
  int size() const { return size_; }
  T* begin() { return size_ > N ? many_.data() : few_.data(); }
  T* end() { return begin() + size_; }
  const T* begin() const { return size_ > N ? many_.data() : few_.data(); }
  const T* end() const { return begin() + size_; }
  T& operator[](int i) { return begin()[i]; }
  const T& operator[](int i) const { return begin()[i]; }
  T& back() { return begin()[size_ - 1]; }

 private:
  // most vectors are nearly empty
  void copy_few(const InlineVector& other) {
    if (size_ <= N) std::copy(other.few_.begin(), other.few_.begin() + size_, few_.begin());
  }

  int size_ = 0;
  std::array<T, N> few_;
  std::vector<T> many_;
};

}  // namespace tumble::collision
