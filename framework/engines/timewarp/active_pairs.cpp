#include "framework/engines/timewarp/active_pairs.h"

#include <cmath>

#include "framework/core/error.h"

namespace tumble::engines {

Box box_around(const collision::CollisionShape& shape, const Quaterniond& world_from_body) {
  if (shape.is_half_space())
    return {Vector3d::Constant(-std::numeric_limits<double>::infinity()),
            Vector3d::Constant(std::numeric_limits<double>::infinity())};
  Box box;
  for (const Vector3d& vertex : shape.vertices()) {
    const Vector3d arm_world = world_from_body * vertex;
    box.take_in({arm_world, arm_world});
  }
  const Vector3d margin = Vector3d::Constant(shape.radius());
  return {box.low - margin, box.high + margin};
}

ActivePairs::ActivePairs(int bodies, double cell)
    : own_entries_(std::make_unique<Entries>(static_cast<std::size_t>(bodies))),
      entries_(own_entries_.get()),
      number_(0) {
  make_buckets(bodies, cell);
}

ActivePairs::ActivePairs(Entries& entries, int number, int held, double cell)
    : entries_(&entries), number_(static_cast<std::int16_t>(number)) {
  require(number >= 0 && number <= std::numeric_limits<std::int16_t>::max(),
          "grids that share bodies have numbers");
  make_buckets(held, cell);
}

void ActivePairs::make_buckets(int held, double cell) {
  cell_ = cell;
  std::uint32_t heads = 64;
  while (heads < static_cast<std::uint32_t>(held)) heads *= 2;  // a cell holds a few bodies
  mask_ = heads - 1;
  buckets_.resize(heads);
}

ActivePairs::SmallBox ActivePairs::small_of(const Box& box) {
  SmallBox small;
  constexpr float kEnd = std::numeric_limits<float>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    small.low[axis] = static_cast<float>(box.low[axis]);
    small.high[axis] = static_cast<float>(box.high[axis]);
    if (small.low[axis] > box.low[axis]) small.low[axis] = std::nextafter(small.low[axis], -kEnd);
    if (small.high[axis] < box.high[axis])
      small.high[axis] = std::nextafter(small.high[axis], kEnd);
  }
  return small;
}

// Two cells of a box may share a bucket: a body is in each bucket once. One that is there already
// gets its new box.
void ActivePairs::enter(int body, const SmallBox& box, std::size_t bucket) {
  std::size_t at = bucket;
  // A body that is already in the bucket gets its new box.
  for (;; at = static_cast<std::size_t>(buckets_[at].next)) {
    Bucket& b = buckets_[at];
    for (std::int32_t place = 0; place < b.count; ++place)
      if (b.slots[static_cast<std::size_t>(place)].body == body) {
        b.slots[static_cast<std::size_t>(place)].box = box;
        return;
      }
    if (b.next < 0) break;
  }
  // A full chain is continued by an unused or a new bucket.
  if (buckets_[at].count == kInABucket) {
    if (free_.empty()) {
      free_.push_back(static_cast<std::int32_t>(buckets_.size()));
      buckets_.emplace_back();
    }
    buckets_[at].next = free_.back();
    free_.pop_back();
    at = static_cast<std::size_t>(buckets_[at].next);
    buckets_[at].count = 0;
    buckets_[at].next = -1;
  }
  buckets_[at].slots[static_cast<std::size_t>(buckets_[at].count++)] = {body, box};
}

// The last slot of the chain moves into the free place.
void ActivePairs::leave(int body, std::size_t bucket) {
  std::size_t at = bucket, before = bucket;
  std::int32_t place = 0;
  for (;; at = static_cast<std::size_t>(buckets_[at].next)) {
    const Bucket& b = buckets_[at];
    for (place = 0; place < b.count && b.slots[static_cast<std::size_t>(place)].body != body;
         ++place) {
    }
    if (place < b.count) break;
    if (b.next < 0) return;  // already removed with another cell of its box
  }
  std::size_t last = at;
  while (buckets_[last].next >= 0) {
    before = last;
    last = static_cast<std::size_t>(buckets_[last].next);
  }
  if (last == at && last != bucket)
    for (before = bucket; buckets_[before].next != static_cast<std::int32_t>(last);)
      before = static_cast<std::size_t>(buckets_[before].next);
  buckets_[at].slots[static_cast<std::size_t>(place)] =
      buckets_[last].slots[static_cast<std::size_t>(buckets_[last].count - 1)];
  if (--buckets_[last].count == 0 && last != bucket) {
    buckets_[before].next = -1;
    free_.push_back(static_cast<std::int32_t>(last));
  }
}

void ActivePairs::take_out(int body) {
  Entry& its = entry(body);
  if (its.grid != number_) return;
  if (its.is_wide)
    wide_.erase(std::find(wide_.begin(), wide_.end(), body));
  else
    for_each_cell(its, [&](std::size_t bucket) { leave(body, bucket); });
  its.grid = -1;
  its.is_wide = false;
}

// A box of very many cells, or of cell numbers beyond 32 bits, is wide.
ActivePairs::Entry ActivePairs::entry_of(const Box& box) const {
  Entry entry;
  entry.box = box;
  double cells = 1;
  constexpr auto kFarthest = std::numeric_limits<std::int32_t>::max();
  for (int axis = 0; axis < 3; ++axis) {
    const double low = std::floor(box.low[axis] / cell_), high = std::floor(box.high[axis] / cell_);
    cells *= high - low + 1;
    if (!(std::abs(low) < kFarthest && std::abs(high) < kFarthest))
      cells = std::numeric_limits<double>::infinity();
    if (!(cells <= kMostCells)) break;
    entry.low[static_cast<std::size_t>(axis)] = static_cast<std::int32_t>(low);
    entry.high[static_cast<std::size_t>(axis)] = static_cast<std::int32_t>(high);
  }
  entry.is_wide = !(cells <= kMostCells);
  return entry;
}

void ActivePairs::set_box(int body, const Box& box) {
  Entry& its = entry(body);
  Entry next = entry_of(box);
  next.grid = number_;
  if (next.is_wide) {
    take_out(body);
    its = next;
    wide_.insert(std::lower_bound(wide_.begin(), wide_.end(), body), body);
    return;
  }
  for_each_cell(next, [&](std::size_t bucket) {
    __builtin_prefetch(&buckets_[bucket]);
    __builtin_prefetch(reinterpret_cast<const char*>(&buckets_[bucket]) + 64);
  });
  if (its.is_wide || its.grid != number_ || its.low != next.low || its.high != next.high)
    take_out(body);
  its = next;
  const SmallBox small = small_of(box);
  for_each_cell(next, [&](std::size_t bucket) { enter(body, small, bucket); });
}

}  // namespace tumble::engines
