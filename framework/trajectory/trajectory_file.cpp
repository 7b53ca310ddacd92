// The file format of a run. Little-endian; IEEE 754 doubles, so that a run is restored bit for bit:
//
//   "TUMBLE\r\n"                8 bytes: a transfer that converts line ends damages them, and is
//       detected
//   version                     u32, 4
//   info                        strings command, version, scene_name, scene_digest, engine,
//       impulse_source, integrator_source; f64 step_s, frame_rate_hz; seeds: u64 count, u64 each;
//       string constraint_source
//   bodies                      u64 count; each: string name, u8 immovable
//   frames                      u64 count; each: f64 time; a body: com (3), quaternion x y z w,
//       velocity (3), omega (3); f64 kinetic, potential; momentum (3), angular momentum (3); f64
//       smallest gap; spring forces, rod tensions, joint forces: u64 count, f64 each; contacts: u64
//       count; each: i32 body_a, body_b; point (3), normal (3), force (3)
//   events                      u64 count; each: f64 time; u8 kind; i32 body_a, body_b; point (3),
//       normal (3); f64 impulse, normal velocity before, after
//   counts                      u64 count; each: string name, u64 value; in order of name
//   faults                      u64 count; each: strings kind, subject; f64 worst, allowed; string
//       unit; f64 first_s, worst_s; u64 count; strings meaning, remedy
//   notices                     u64 count, string each
//   stopped_by                  string
//   "end\n"                     4 bytes, and nothing after them
//
// A string is its u64 length and its bytes. Times of stages are not in the file: they differ from
// run to run.
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/trajectory/trajectory.h"

namespace tumble {
namespace {

static_assert(std::endian::native == std::endian::little,
              "the format is little-endian, a copy of memory");

constexpr std::string_view kMagic = "TUMBLE\r\n", kEnd = "end\n";
constexpr std::uint32_t kVersion = 4;

class Writer {
 public:
  template <class T>
  requires(std::is_arithmetic_v<T>) void operator()(const T& value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void operator()(const bool& value) { (*this)(static_cast<std::uint8_t>(value)); }
  void operator()(const EventKind& kind) { (*this)(static_cast<std::uint8_t>(kind)); }
  void operator()(const Vector3d& v) {
    for (int i = 0; i < 3; ++i) (*this)(v[i]);
  }
  void operator()(const Quaterniond& q) {
    for (int i = 0; i < 4; ++i) (*this)(q.coeffs()[i]);
  }
  void operator()(const std::string& text) {
    size(text.size(), 1);
    bytes_ += text;
  }
  void word(std::string_view word) { bytes_ += word; }
  std::uint64_t size(std::uint64_t count, std::size_t) {
    (*this)(count);
    return count;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

class Reader {
 public:
  Reader(std::string where, std::vector<char> bytes)
      : where_(std::move(where)), bytes_(std::move(bytes)) {}

  template <class T>
  requires(std::is_arithmetic_v<T>) void operator()(T& value) {
    std::memcpy(&value, take(sizeof value), sizeof value);
  }
  void operator()(bool& value) {
    std::uint8_t byte = 0;
    (*this)(byte);
    if (byte > 1) fail(1, "a boolean of " + std::to_string(byte) + ", expected 0 or 1");
    value = byte == 1;
  }
  void operator()(EventKind& kind) {
    std::uint8_t byte = 0;
    (*this)(byte);
    constexpr auto kLast = static_cast<std::uint8_t>(EventKind::kControl);
    if (byte < 1 || byte > kLast)
      fail(1,
           "an event of kind " + std::to_string(byte) + ", expected 1 to " + std::to_string(kLast));
    kind = static_cast<EventKind>(byte);
  }
  void operator()(Vector3d& v) {
    for (int i = 0; i < 3; ++i) (*this)(v[i]);
  }
  void operator()(Quaterniond& q) {
    for (int i = 0; i < 4; ++i) (*this)(q.coeffs()[i]);
  }
  void operator()(std::string& text) {
    const std::uint64_t length = size(0, 1);
    text.assign(take(length), length);
  }
  void word(std::string_view word) {
    if (std::string_view(take(word.size()), word.size()) != word)
      fail(word.size(), at_ == word.size() ? "not a recorded run: its first bytes differ"
                                           : "expected the end of the run");
  }
  /// Number of items that follow, each of at least `least_bytes`: a count that the file cannot hold
  /// is refused before memory is allocated.
  std::uint64_t size(std::uint64_t, std::size_t least_bytes) {
    std::uint64_t count = 0;
    (*this)(count);
    if (count > (bytes_.size() - at_) / least_bytes)
      fail(8, "a count of " + std::to_string(count) + ", but only " +
                  std::to_string(bytes_.size() - at_) + " bytes follow");
    return count;
  }
  /// Refuses what a reader of the run would index an array by, and what it would search by halves:
  /// @param what  "a frame", "an event", "a contact": the item of which this was read last
  void expect_time(const char* what, double time_s) const {
    if (!std::isfinite(time_s)) fail(sizeof time_s, fmt::format("{} at {} s", what, time_s));
  }
  void expect_bodies(const char* what, int body_a, int body_b, std::size_t bodies) const {
    const auto is_one = [&](int body) {
      return body >= 0 && static_cast<std::size_t>(body) < bodies;
    };
    if (is_one(body_a) && (body_b == -1 || is_one(body_b))) return;
    fail(sizeof body_a + sizeof body_b,
         fmt::format("{} of the bodies {} and {}, in a run of {}", what, body_a, body_b, bodies));
  }
  bool is_at_end() const { return at_ == bytes_.size(); }
  [[noreturn]] void fail(std::size_t back, const std::string& problem) const {
    throw UserError(where_ + ", byte " + std::to_string(at_ - back), problem,
                    "Record the run again.");
  }

 private:
  const char* take(std::uint64_t count) {
    if (count > bytes_.size() - at_) {
      const std::string left = std::to_string(bytes_.size() - at_);
      fail(0, "the file is cut short: " + std::to_string(count) + " bytes expected here, " + left +
                  " left");
    }
    const char* from = bytes_.data() + at_;
    at_ += count;
    return from;
  }

  std::string where_;
  std::vector<char> bytes_;
  std::size_t at_ = 0;
};

// One traversal for writing and reading, so that both always agree.
template <class Archive, class... Fields>
void pass(Archive& archive, Fields&... fields) {
  (archive(fields), ...);
}

template <class Archive, class List, class Item>
void pass_list(Archive& archive, List& list, std::size_t least_bytes, const Item& item) {
  const std::uint64_t count = archive.size(list.size(), least_bytes);
  if constexpr (std::is_same_v<Archive, Reader>) list.resize(count);
  for (auto& each : list) item(each);
}

template <class Archive, class Run>
void pass_frames(Archive& archive, Run& run) {
  constexpr std::size_t kPoseBytes = 13 * sizeof(double),
                        kFrameBytes = 10 * sizeof(double) + 4 * sizeof(std::uint64_t);
  constexpr std::size_t kContactBytes = 2 * sizeof(std::int32_t) + 9 * sizeof(double);
  const std::size_t bodies = run.bodies.size();
  [[maybe_unused]] double before_s = 0.0;
  pass_list(archive, run.frames, kFrameBytes + bodies * kPoseBytes, [&](auto& frame) {
    archive(frame.time);
    if constexpr (std::is_same_v<Archive, Reader>) {
      archive.expect_time("a frame", frame.time);
      if (frame.time < before_s)
        archive.fail(sizeof frame.time,
                     fmt::format("a frame at {} s, before {} s", frame.time, before_s));
      before_s = frame.time;
      frame.poses.resize(bodies);
    }
    for (auto& pose : frame.poses)
      pass(archive, pose.com_world, pose.world_from_body, pose.velocity_world, pose.omega_world);
    pass(archive, frame.kinetic_energy, frame.potential_energy, frame.momentum_world,
         frame.angular_momentum_world, frame.smallest_gap);
    for (auto* forces : {&frame.spring_forces, &frame.rod_tensions, &frame.joint_forces})
      pass_list(archive, *forces, sizeof(double), [&](auto& force) { archive(force); });
    pass_list(archive, frame.contacts, kContactBytes, [&](auto& contact) {
      pass(archive, contact.body_a, contact.body_b);
      if constexpr (std::is_same_v<Archive, Reader>)
        archive.expect_bodies("a contact", contact.body_a, contact.body_b, bodies);
      pass(archive, contact.point_world, contact.normal_b_to_a_world, contact.force_on_a_world);
    });
  });
}

template <class Archive, class Run>
void pass_run(Archive& archive, Run& run) {
  auto& info = run.info;
  pass(archive, info.command, info.version, info.scene_name, info.scene_digest, info.engine,
       info.impulse_source, info.integrator_source, info.step_s, info.frame_rate_hz);
  pass_list(archive, info.seeds, sizeof(std::uint64_t), [&](auto& seed) { archive(seed); });
  archive(info.constraint_source);
  pass_list(archive, run.bodies, 9, [&](auto& body) { pass(archive, body.name, body.immovable); });
  pass_frames(archive, run);
  pass_list(archive, run.events, 9 + 10 * sizeof(double), [&](auto& event) {
    archive(event.time);
    if constexpr (std::is_same_v<Archive, Reader>) archive.expect_time("an event", event.time);
    pass(archive, event.kind, event.body_a, event.body_b);
    if constexpr (std::is_same_v<Archive, Reader>)
      archive.expect_bodies("an event", event.body_a, event.body_b, run.bodies.size());
    pass(archive, event.point_world, event.normal_b_to_a_world, event.impulse,
         event.normal_velocity_before, event.normal_velocity_after);
  });
}

// Why the run is not to be trusted, and what it says of itself.
template <class Archive, class Counted>
void pass_warnings(Archive& archive, Counted& counters) {
  constexpr std::size_t kFaultBytes = 5 * sizeof(std::uint64_t) + 4 * sizeof(double) + 8;
  pass_list(archive, counters.faults, kFaultBytes, [&](auto& fault) {
    pass(archive, fault.kind, fault.subject, fault.worst, fault.allowed, fault.unit, fault.first_s,
         fault.worst_s, fault.count, fault.meaning, fault.remedy);
  });
  pass_list(archive, counters.notices, sizeof(std::uint64_t),
            [&](auto& notice) { archive(notice); });
}

}  // namespace

void write_trajectory(const std::filesystem::path& file, const Trajectory& trajectory) {
  for (const Frame& frame : trajectory.frames)
    require(frame.poses.size() == trajectory.bodies.size(),
            "write_trajectory: a frame must have a pose for each body");
  Writer writer;
  writer.word(kMagic);
  writer(kVersion);
  pass_run(writer, trajectory);
  writer.size(trajectory.counters.counts.size(), 16);
  for (const auto& [name, value] : trajectory.counters.counts) pass(writer, name, value);
  pass_warnings(writer, trajectory.counters);
  writer(trajectory.stopped_by);
  writer.word(kEnd);
  write_whole(file, writer.bytes());
}

Trajectory read_trajectory(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in || std::filesystem::is_directory(file))
    throw UserError(file.string(), "cannot be read", "Name a recorded run.");
  Reader reader(file.string(), std::vector<char>(std::istreambuf_iterator<char>(in), {}));
  reader.word(kMagic);
  std::uint32_t version = 0;
  reader(version);
  if (version != kVersion)
    reader.fail(4, std::string(version < kVersion
                                   ? "recorded by an older version of this program"
                                   : "recorded by a newer version of this program, or damaged") +
                       ": format version " + std::to_string(version) + ", this program reads " +
                       std::to_string(kVersion));
  Trajectory run;
  pass_run(reader, run);
  for (std::uint64_t left = reader.size(0, 16); left > 0; --left) {
    std::string name;
    reader(name);
    reader(run.counters.counts[name]);
  }
  pass_warnings(reader, run.counters);
  reader(run.stopped_by);
  reader.word(kEnd);
  if (!reader.is_at_end()) reader.fail(0, "bytes follow the end of the run");
  return run;
}

}  // namespace tumble
