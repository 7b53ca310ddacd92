/// Where bodies of a world stand in a problem that holds some of them. Kept from problem to
/// problem: to begin anew costs what the last one held, however many bodies the world has.
#pragma once

#include <vector>

#include "framework/core/error.h"

namespace tumble::engines {

class BodyPlaces {
 public:
  /// Forgets all places. @param bodies  of the world
  void begin(int bodies) {
    for (const int body : placed_) places_[static_cast<std::size_t>(body)] = kNone;
    placed_.clear();
    places_.resize(static_cast<std::size_t>(bodies), kNone);
  }
  /// Gives a body the place `next`, unless it has one.
  /// @return its place
  int enter(int body, int next) {
    int& place = places_[static_cast<std::size_t>(body)];
    if (place != kNone) return place;
    placed_.push_back(body);
    return place = next;
  }
  /// @pre the body has a place
  int at(int body) const {
    const int place = places_[static_cast<std::size_t>(body)];
    require(place != kNone, "a body of a problem's rows has a place in it");
    return place;
  }

 private:
  static constexpr int kNone = -1;
  std::vector<int> places_;  // by body
  std::vector<int> placed_;  // bodies
};

}  // namespace tumble::engines
