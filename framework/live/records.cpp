#include "framework/live/records.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <vector>

namespace tumble::live {
namespace {

constexpr std::size_t kHeadBytes = 5;                // a kind, and a length of four bytes
constexpr std::uint32_t kMostOfRecord = 256u << 20;  // longer is no record: the pipe is out of step

// Numbers of a record, one after the other.
class Numbers {
 public:
  void add(double x) { values_.push_back(x); }
  void add(const Vector3d& v) {
    for (int i = 0; i < 3; ++i) add(v[i]);
  }
  void add(const std::vector<double>& list) {
    for (const double x : list) add(x);
  }
  std::string bytes() const {
    return {reinterpret_cast<const char*>(values_.data()), values_.size() * sizeof(double)};
  }

 private:
  std::vector<double> values_;
};

class NumberReader {
 public:
  explicit NumberReader(std::string_view bytes) : bytes_(bytes) {}
  double next() {
    if (at_ + sizeof(double) > bytes_.size())
      throw std::runtime_error("live: a record is shorter than it says");
    double x = 0.0;
    std::memcpy(&x, bytes_.data() + at_, sizeof x);
    at_ += sizeof x;
    return x;
  }
  Vector3d vector() {
    Vector3d v;
    for (int i = 0; i < 3; ++i) v[i] = next();
    return v;
  }
  /// @throws std::runtime_error where so many numbers are not there
  std::size_t count() {
    const double x = next();
    if (!(x >= 0 && x <= static_cast<double>(bytes_.size())))
      throw std::runtime_error("live: a record says how many numbers it has, and has not");
    return static_cast<std::size_t>(x);
  }
  std::vector<double> list(std::size_t size) {
    std::vector<double> values;
    for (std::size_t i = 0; i < size; ++i) values.push_back(next());
    return values;
  }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
};

}  // namespace

bool write_record(int fd, RecordKind kind, std::string_view bytes) {
  const auto length = static_cast<std::uint32_t>(bytes.size());
  std::string all(kHeadBytes, '\0');
  all[0] = static_cast<char>(kind);
  std::memcpy(all.data() + 1, &length, sizeof length);
  all.append(bytes);
  for (std::size_t sent = 0; sent < all.size();) {
    const ssize_t n = ::write(fd, all.data() + sent, all.size() - sent);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    sent += static_cast<std::size_t>(n);
  }
  return true;
}

std::optional<Record> RecordReader::next() {
  if (waiting_.size() - at_ < kHeadBytes) return std::nullopt;
  std::uint32_t length = 0;
  std::memcpy(&length, waiting_.data() + at_ + 1, sizeof length);
  if (length > kMostOfRecord) throw std::runtime_error("live: the bytes of a pipe are no record");
  if (waiting_.size() - at_ < kHeadBytes + length) return std::nullopt;
  Record record{static_cast<RecordKind>(waiting_[at_]), waiting_.substr(at_ + kHeadBytes, length)};
  at_ += kHeadBytes + length;
  if (at_ == waiting_.size() || at_ > (1u << 20)) {
    waiting_.erase(0, at_);
    at_ = 0;
  }
  return record;
}

std::string pack(const Frame& frame) {
  Numbers numbers;
  numbers.add(frame.time);
  numbers.add(frame.kinetic_energy);
  numbers.add(frame.potential_energy);
  numbers.add(frame.momentum_world);
  numbers.add(frame.angular_momentum_world);
  numbers.add(frame.smallest_gap);
  for (const std::size_t count :
       {frame.poses.size(), frame.spring_forces.size(), frame.rod_tensions.size(),
        frame.joint_forces.size(), frame.contacts.size()})
    numbers.add(static_cast<double>(count));
  for (const BodyPose& pose : frame.poses) {
    numbers.add(pose.com_world);
    for (int i = 0; i < 4; ++i) numbers.add(pose.world_from_body.coeffs()[i]);  // x y z w
    numbers.add(pose.velocity_world);
    numbers.add(pose.omega_world);
  }
  numbers.add(frame.spring_forces);
  numbers.add(frame.rod_tensions);
  numbers.add(frame.joint_forces);
  for (const ContactPoint& contact : frame.contacts) {
    numbers.add(contact.body_a);
    numbers.add(contact.body_b);
    numbers.add(contact.point_world);
    numbers.add(contact.normal_b_to_a_world);
    numbers.add(contact.force_on_a_world);
  }
  return numbers.bytes();
}

Frame unpack_frame(std::string_view bytes) {
  NumberReader reader(bytes);
  Frame frame;
  frame.time = reader.next();
  frame.kinetic_energy = reader.next();
  frame.potential_energy = reader.next();
  frame.momentum_world = reader.vector();
  frame.angular_momentum_world = reader.vector();
  frame.smallest_gap = reader.next();
  std::size_t counts[5];
  for (std::size_t& count : counts) count = reader.count();
  for (std::size_t i = 0; i < counts[0]; ++i) {
    BodyPose pose;
    pose.com_world = reader.vector();
    for (int k = 0; k < 4; ++k) pose.world_from_body.coeffs()[k] = reader.next();
    pose.velocity_world = reader.vector();
    pose.omega_world = reader.vector();
    frame.poses.push_back(pose);
  }
  frame.spring_forces = reader.list(counts[1]);
  frame.rod_tensions = reader.list(counts[2]);
  frame.joint_forces = reader.list(counts[3]);
  for (std::size_t i = 0; i < counts[4]; ++i) {
    const int a = static_cast<int>(reader.next()), b = static_cast<int>(reader.next());
    const Vector3d point = reader.vector(), normal = reader.vector();
    frame.contacts.push_back({a, b, point, normal, reader.vector()});
  }
  return frame;
}

std::string pack(const Event& event) {
  Numbers numbers;
  numbers.add(event.time);
  numbers.add(static_cast<double>(event.kind));
  numbers.add(event.body_a);
  numbers.add(event.body_b);
  numbers.add(event.point_world);
  numbers.add(event.normal_b_to_a_world);
  numbers.add(event.impulse);
  numbers.add(event.normal_velocity_before);
  numbers.add(event.normal_velocity_after);
  return numbers.bytes();
}

Event unpack_event(std::string_view bytes) {
  NumberReader reader(bytes);
  Event event;
  event.time = reader.next();
  event.kind = static_cast<EventKind>(static_cast<int>(reader.next()));
  event.body_a = static_cast<int>(reader.next());
  event.body_b = static_cast<int>(reader.next());
  event.point_world = reader.vector();
  event.normal_b_to_a_world = reader.vector();
  event.impulse = reader.next();
  event.normal_velocity_before = reader.next();
  event.normal_velocity_after = reader.next();
  return event;
}

}  // namespace tumble::live
