/// Pairs of bodies that can meet: boxes that bodies sweep from global virtual time to their local
/// virtual times, in a hashed grid.
///
/// A box is entered in every cell that it intersects. Two boxes that overlap share a cell; the pair
/// is reported once, in the lowest of its shared cells. A box that intersects very many cells is
/// kept in a list of its own instead, which is tested against every box.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "framework/collision/collision_shape.h"
#include "framework/core/large_pages.h"

namespace tumble::engines {

/// Axis-aligned. World frame. [m]
struct Box {
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity());
  Vector3d high = Vector3d::Constant(-std::numeric_limits<double>::infinity());

  void take_in(const Box& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
  bool overlaps(const Box& other) const {
    // All six comparisons without a branch: which one separates two boxes is unpredictable.
    return (low.x() <= other.high.x()) & (other.low.x() <= high.x()) & (low.y() <= other.high.y()) &
           (other.low.y() <= high.y()) & (low.z() <= other.high.z()) & (other.low.z() <= high.z());
  }
};

/// Box around a shape in this orientation, relative to its centre of mass; infinite for a
/// half-space.
Box box_around(const collision::CollisionShape& shape, const Quaterniond& world_from_body);

class ActivePairs {
 public:
  struct Entry {
    Box box;
    std::array<std::int32_t, 3> low{0, 0, 0}, high{-1, -1, -1};  // cells
    std::int16_t grid = -1;                                      // the grid that holds it; -1: none
    bool is_wide = false;
  };
  using Entries = std::vector<Entry, LargePages<Entry>>;

  /// @param bodies  indices in use are below this
  /// @param cell    edge of a cell [m], > 0: about the size of most boxes
  ActivePairs(int bodies, double cell);
  /// One of several grids that divide the bodies among them: each body is in at most one of them,
  /// and no grid reads another's entries.
  /// @param entries  by body; outlives the grid
  /// @param number   of this grid, >= 0, unique
  /// @param held     expected number of bodies in it
  ActivePairs(Entries& entries, int number, int held, double cell);
  ActivePairs(const ActivePairs&) = delete;
  ActivePairs& operator=(const ActivePairs&) = delete;
  ActivePairs(ActivePairs&&) = default;

  /// Enters a body's box, in place of its previous one.
  void set_box(int body, const Box& box);
  /// Removes a body, if it is in this grid.
  void remove(int body) { take_out(body); }
  bool holds(int body) const { return entry(body).grid == number_; }
  /// The contents of the grid, independent of the order of entries: the box and cells of each body,
  /// then the bodies and boxes of each bucket.
  /// @param row  is called with each (kind, bucket, body, numbers): bodies ascending, then buckets
  ///   with their bodies in any order
  template <class Row>
  void for_each_row(const Row& row) const {
    for (std::size_t body = 0; body < entries_->size(); ++body) {
      const Entry& e = (*entries_)[body];
      if (e.grid != number_) continue;
      row(e.is_wide ? 'w' : 'b', 0, static_cast<int>(body),
          std::array<double, 12>{e.box.low.x(), e.box.low.y(), e.box.low.z(), e.box.high.x(),
                                 e.box.high.y(), e.box.high.z(), double(e.low[0]), double(e.low[1]),
                                 double(e.low[2]), double(e.high[0]), double(e.high[1]),
                                 double(e.high[2])});
    }
    for (std::size_t head = 0; head <= mask_; ++head)
      for (std::int32_t at = static_cast<std::int32_t>(head); at >= 0;
           at = buckets_[static_cast<std::size_t>(at)].next)
        for (std::int32_t place = 0; place < buckets_[static_cast<std::size_t>(at)].count;
             ++place) {
          const Slot& slot =
              buckets_[static_cast<std::size_t>(at)].slots[static_cast<std::size_t>(place)];
          row('c', head, slot.body,
              std::array<double, 12>{slot.box.low[0], slot.box.low[1], slot.box.low[2],
                                     slot.box.high[0], slot.box.high[1], slot.box.high[2]});
        }
  }
  const Box& box(int body) const { return entry(body).box; }

  /// Prefetches the entry of a body.
  void fetch(int body) const {
    __builtin_prefetch(&entry(body));
    __builtin_prefetch(reinterpret_cast<const char*>(&entry(body)) + 64);
  }

  /// Calls `found(other)` once for each body whose box overlaps this body's.
  template <class Found>
  void for_each_partner(int body, const Found& found) const {
    for_each_overlapping(entry(body), body, found);
  }

  /// Calls `found(other)` once for each body whose box overlaps this box, which need not be in the
  /// grid.
  template <class Found>
  void for_each_in(const Box& box, const Found& found) const {
    for_each_overlapping(entry_of(box), -1, found);
  }

 private:
  static constexpr std::int32_t kInABucket = 4;  // two cache lines
  static constexpr double kMostCells = 1000;  // of a box in the grid; a box of more cells is wide

  // A box in single precision, rounded outwards: it separates most boxes that share a cell without
  // further memory access.
  struct SmallBox {
    float low[3], high[3];
    bool overlaps(const SmallBox& other) const {
      return (low[0] <= other.high[0]) & (other.low[0] <= high[0]) & (low[1] <= other.high[1]) &
             (other.low[1] <= high[1]) & (low[2] <= other.high[2]) & (other.low[2] <= high[2]);
    }
  };
  static SmallBox small_of(const Box& box);
  struct Slot {
    std::int32_t body;
    SmallBox box;
  };
  struct Bucket {
    std::int32_t count = 0, next = -1;
    std::array<Slot, kInABucket> slots;
  };

  const Entry& entry(int body) const { return (*entries_)[static_cast<std::size_t>(body)]; }
  Entry& entry(int body) { return (*entries_)[static_cast<std::size_t>(body)]; }
  std::size_t bucket_of(std::int32_t i, std::int32_t j, std::int32_t k) const {
    const auto u = [](std::int32_t v) { return static_cast<std::uint32_t>(v); };
    // Primes of M. Teschner et al., "Optimized spatial hashing for collision detection of
    // deformable objects", VMV 2003.
    return (u(i) * 73856093u ^ u(j) * 19349663u ^ u(k) * 83492791u) & mask_;
  }
  template <class Found>
  void for_each_overlapping(const Entry& own, int body, const Found& found) const {
    for (const int other : wide_)
      if (other != body && own.box.overlaps(entry(other).box)) found(other);
    // every body in cells, once: at its lowest cell. Reads the buckets, because entries of other
    // grids belong to other threads
    if (own.is_wide) {
      for (std::size_t head = 0; head <= mask_; ++head)
        for (std::int32_t at = static_cast<std::int32_t>(head); at >= 0;
             at = buckets_[static_cast<std::size_t>(at)].next)
          for (std::int32_t place = 0; place < buckets_[static_cast<std::size_t>(at)].count;
               ++place) {
            const int other =
                buckets_[static_cast<std::size_t>(at)].slots[static_cast<std::size_t>(place)].body;
            const Entry& its = entry(other);
            if (other != body && head == bucket_of(its.low[0], its.low[1], its.low[2]) &&
                own.box.overlaps(its.box))
              found(other);
          }
      return;
    }
    const SmallBox small = small_of(own.box);
    for (std::int32_t i = own.low[0]; i <= own.high[0]; ++i)
      for (std::int32_t j = own.low[1]; j <= own.high[1]; ++j)
        for (std::int32_t k = own.low[2]; k <= own.high[2]; ++k)
          for (std::int32_t at = static_cast<std::int32_t>(bucket_of(i, j, k)); at >= 0;
               at = buckets_[static_cast<std::size_t>(at)].next) {
            const Bucket& bucket = buckets_[static_cast<std::size_t>(at)];
            for (std::int32_t place = 0; place < bucket.count; ++place) {
              const Slot& slot = bucket.slots[static_cast<std::size_t>(place)];
              if (!small.overlaps(slot.box) || slot.body == body) continue;
              const Entry& other = entry(slot.body);
              // The lowest cell that both intersect; this also separates cells that share a bucket.
              const bool here = (i == std::max(own.low[0], other.low[0])) &
                                (j == std::max(own.low[1], other.low[1])) &
                                (k == std::max(own.low[2], other.low[2]));
              if (here && own.box.overlaps(other.box)) found(slot.body);
            }
          }
  }
  Entry entry_of(const Box& box) const;
  void enter(int body, const SmallBox& box, std::size_t bucket);
  void leave(int body, std::size_t bucket);
  template <class Work>
  void for_each_cell(const Entry& entry, const Work& work) const {
    for (std::int32_t i = entry.low[0]; i <= entry.high[0]; ++i)
      for (std::int32_t j = entry.low[1]; j <= entry.high[1]; ++j)
        for (std::int32_t k = entry.low[2]; k <= entry.high[2]; ++k) work(bucket_of(i, j, k));
  }
  void take_out(int body);
  void make_buckets(int held, double cell);

  double cell_;
  std::uint32_t mask_;
  // the first mask_ + 1 are heads of chains, the others continue a chain
  std::vector<Bucket, LargePages<Bucket>> buckets_;
  std::vector<std::int32_t> free_;        // unused continuations
  std::unique_ptr<Entries> own_entries_;  // of a grid that has all bodies
  Entries* entries_;                      // by body
  std::int16_t number_;
  std::vector<int> wide_;  // ascending
};

}  // namespace tumble::engines
