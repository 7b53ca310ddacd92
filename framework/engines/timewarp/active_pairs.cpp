#include "framework/engines/timewarp/active_pairs.h"

#include <cmath>

namespace tumble::engines {

Box box_around(const collision::CollisionShape& shape, const Quaterniond& world_from_body) {
  if (shape.is_half_space()) return {Vector3d::Constant(-std::numeric_limits<double>::infinity()), Vector3d::Constant(std::numeric_limits<double>::infinity())};
  Box box;
  for (const Vector3d& vertex : shape.vertices()) {
    const Vector3d arm_world = world_from_body * vertex;
    box.take_in({arm_world, arm_world});
  }
  const Vector3d margin = Vector3d::Constant(shape.radius());
  return {box.low - margin, box.high + margin};
}

ActivePairs::ActivePairs(int bodies, double cell) : cell_(cell), entries_(static_cast<std::size_t>(bodies)) {
  std::uint32_t heads = 64;
  while (heads < 4u * static_cast<std::uint32_t>(bodies)) heads *= 2;   // a box touches a few cells
  mask_ = heads - 1;
  buckets_.resize(heads);
}

// Two cells of a box may share a bucket: a body stands in each bucket once.
void ActivePairs::enter(int body, std::size_t bucket) {
  std::size_t at = bucket;
  for (;; at = static_cast<std::size_t>(buckets_[at].next)) {
    const Bucket& b = buckets_[at];
    for (std::int32_t place = 0; place < b.count; ++place)
      if (b.bodies[static_cast<std::size_t>(place)] == body) return;
    if (b.next < 0) break;
  }
  while (buckets_[at].count == kInABucket) {
    if (buckets_[at].next < 0) {
      if (free_.empty()) {
        free_.push_back(static_cast<std::int32_t>(buckets_.size()));
        buckets_.emplace_back();
      }
      buckets_[at].next = free_.back();
      free_.pop_back();
    }
    at = static_cast<std::size_t>(buckets_[at].next);
  }
  buckets_[at].bodies[static_cast<std::size_t>(buckets_[at].count++)] = body;
}

// The last of the chain takes the place that becomes free.
void ActivePairs::leave(int body, std::size_t bucket) {
  std::size_t at = bucket, before = bucket;
  std::int32_t place = 0;
  for (;; at = static_cast<std::size_t>(buckets_[at].next)) {
    const Bucket& b = buckets_[at];
    for (place = 0; place < b.count && b.bodies[static_cast<std::size_t>(place)] != body; ++place) {}
    if (place < b.count) break;
    if (b.next < 0) return;   // gone with another cell
  }
  std::size_t last = bucket;
  while (buckets_[last].next >= 0) {
    before = last;
    last = static_cast<std::size_t>(buckets_[last].next);
  }
  buckets_[at].bodies[static_cast<std::size_t>(place)] = buckets_[last].bodies[static_cast<std::size_t>(buckets_[last].count - 1)];
  if (--buckets_[last].count == 0 && last != bucket) {
    buckets_[before].next = -1;
    free_.push_back(static_cast<std::int32_t>(last));
  }
}

void ActivePairs::take_out(int body) {
  Entry& entry = entries_[static_cast<std::size_t>(body)];
  if (entry.is_in_grid) for_each_cell(entry, [&](std::size_t bucket) { leave(body, bucket); });
  if (entry.is_wide) wide_.erase(std::find(wide_.begin(), wide_.end(), body));
  entry.is_in_grid = entry.is_wide = false;
}

void ActivePairs::set_box(int body, const Box& box) {
  Entry& entry = entries_[static_cast<std::size_t>(body)];
  Entry next;
  next.box = box;
  double cells = 1;
  constexpr double kFarthest = 1e9;   // cells beyond are not counted out in 32 bits
  for (int axis = 0; axis < 3; ++axis) {
    const double low = std::floor(box.low[axis] / cell_), high = std::floor(box.high[axis] / cell_);
    cells *= high - low + 1;
    if (!(std::abs(low) < kFarthest && std::abs(high) < kFarthest)) cells = std::numeric_limits<double>::infinity();
    if (!(cells <= kMostCells)) break;
    next.low[static_cast<std::size_t>(axis)] = static_cast<std::int32_t>(low);
    next.high[static_cast<std::size_t>(axis)] = static_cast<std::int32_t>(high);
  }
  if (!(cells <= kMostCells)) {
    take_out(body);
    entry = next;
    entry.is_wide = true;
    wide_.insert(std::lower_bound(wide_.begin(), wide_.end(), body), body);
    return;
  }
  if (entry.is_in_grid && entry.low == next.low && entry.high == next.high) {
    entry.box = box;
    return;
  }
  for_each_cell(next, [&](std::size_t bucket) { __builtin_prefetch(&buckets_[bucket]); });
  take_out(body);
  entry = next;
  entry.is_in_grid = true;
  for_each_cell(entry, [&](std::size_t bucket) { enter(body, bucket); });
}

}  // namespace tumble::engines
