// A recorded run comes back bit for bit; a file that is not one is refused with the byte where it
// stops being one.
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/trajectory/fault_words.h"
#include "framework/trajectory/trajectory.h"

namespace tumble {
namespace {

std::filesystem::path scratch(const std::string& name) {
  return std::filesystem::temp_directory_path() /
         ("tumble_run_" + std::to_string(getpid()) + "_" + name);
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

Trajectory small_run() {
  Trajectory run;
  run.info = {"tumble run x", "1",       "x",        "ab12", "rd",
              "reference",    "library", 1.0 / 60.0, 60.0,   {7, 8}};
  run.bodies = {{"ball", false}, {"floor", true}};
  const BodyPose pose{{0.1, -0.0, 1e-310}, Quaterniond(0.5, -0.5, 0.5, 0.5), {1, 2, 3}, {4, 5, 6}};
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double time : {0.0, 1.0 / 3.0})
    run.frames.push_back({time, {pose, pose}, 0.1, 0.2, {1, 2, 3}, {4, 5, 6}, infinity});
  run.info.constraint_source = "student";
  run.frames[1].spring_forces = {-2.5, 1e-310};
  run.frames[1].rod_tensions = {9.81};
  run.frames[1].joint_forces = {1, 2, 3};
  run.frames[1].contacts.push_back({0, 1, {1, 2, 3}, {0, 0, 1}, {0.5, 0, 9.81}});
  run.events.push_back({0.3, EventKind::kCollision, 0, 1, {1, 2, 3}, {0, 0, 1}, 2.5, -1.25, 0.625});
  run.events.push_back({0.4, EventKind::kControl, 0, -1, {0, 0, 0}, {0, 0, 1}, 0, 0, 0});
  run.counters.counts = {{"integrations", 12}, {"rollbacks", 1}};
  run.stopped_by = "ball flew off";
  return run;
}

std::string problem_of(const std::string& bytes) {
  const auto file = scratch("spoilt");
  write_whole(file, bytes);
  std::string said = "no error";
  try {
    read_trajectory(file);
  } catch (const UserError& error) {
    said = error.where() + ": " + error.problem();
  }
  std::filesystem::remove(file);
  return said;
}

std::string good_bytes() {
  const auto file = scratch("good");
  write_trajectory(file, small_run());
  const std::string bytes = bytes_of(file);
  std::filesystem::remove(file);
  return bytes;
}

TEST(TrajectoryFile, ComesBackBitForBit) {
  const auto first = scratch("first"), second = scratch("second");
  write_trajectory(first, small_run());
  const Trajectory read = read_trajectory(first);
  write_trajectory(second, read);
  EXPECT_EQ(bytes_of(first), bytes_of(second));
  ASSERT_EQ(read.frames.size(), 2u);
  EXPECT_EQ(read.frames[1].time, 1.0 / 3.0);
  EXPECT_TRUE(std::signbit(read.frames[1].poses[0].com_world.y()));
  EXPECT_EQ(read.frames[1].poses[1].world_from_body.coeffs(),
            small_run().frames[1].poses[1].world_from_body.coeffs());
  EXPECT_EQ(read.events[0].normal_velocity_after, 0.625);
  EXPECT_EQ(read.events[1].kind, EventKind::kControl);
  EXPECT_TRUE(read.frames[0].spring_forces.empty());
  EXPECT_EQ(read.frames[1].spring_forces, small_run().frames[1].spring_forces);
  EXPECT_EQ(read.frames[1].rod_tensions, small_run().frames[1].rod_tensions);
  EXPECT_EQ(read.frames[1].joint_forces, small_run().frames[1].joint_forces);
  ASSERT_EQ(read.frames[1].contacts.size(), 1u);
  EXPECT_EQ(read.frames[1].contacts[0].body_b, 1);
  EXPECT_EQ(read.frames[1].contacts[0].force_on_a_world, Vector3d(0.5, 0, 9.81));
  EXPECT_EQ(read.info.constraint_source, "student");
  EXPECT_EQ(read.info.seeds, (std::vector<std::uint64_t>{7, 8}));
  EXPECT_EQ(read.counters.counts, small_run().counters.counts);
  EXPECT_EQ(read.stopped_by, "ball flew off");
  std::filesystem::remove(first);
  std::filesystem::remove(second);
}

// A run that is not to be trusted is not to be trusted as a recording either.
TEST(TrajectoryFile, KeepsFaultsAndNotices) {
  const auto file = scratch("faulty");
  Trajectory run = small_run();
  RunFault fault;
  fault.kind = "link_open";
  fault.subject = "'wire'";
  fault.worst = 161.0;
  fault.allowed = 1e-6;
  fault.unit = "m";
  fault.first_s = 0.25;
  fault.count = 12;
  fault.meaning = "a link has come apart";
  fault.remedy = "smaller steps";
  run.counters.faults = {fault, RunFault{}};
  run.counters.notices = {"steps were shortened", ""};
  write_trajectory(file, run);
  const Trajectory read = read_trajectory(file);
  std::filesystem::remove(file);
  ASSERT_EQ(read.counters.faults.size(), 2u);
  const RunFault& kept = read.counters.faults[0];
  EXPECT_EQ(in_words(kept), in_words(fault));
  EXPECT_EQ(kept.unit, "m");
  EXPECT_TRUE(std::isnan(kept.worst_s));  // as it was
  EXPECT_EQ(kept.meaning, fault.meaning);
  EXPECT_EQ(kept.remedy, fault.remedy);
  EXPECT_EQ(read.counters.faults[1].kind, "");
  EXPECT_EQ(read.counters.notices, run.counters.notices);
  EXPECT_EQ(read.counters.counts, run.counters.counts);
  EXPECT_EQ(read.stopped_by, run.stopped_by);
}

TEST(TrajectoryFile, SameRunOtherStageTimesSameBytes) {
  const auto file = scratch("timed");
  Trajectory run = small_run();
  run.counters.stage_seconds["integration"] = 0.123;
  write_trajectory(file, run);
  EXPECT_EQ(bytes_of(file), good_bytes());
  std::filesystem::remove(file);
}

TEST(TrajectoryFile, CutAnywhereIsRefusedWithThePlace) {
  const std::string good = good_bytes();
  for (std::size_t length = 0; length < good.size(); ++length)
    EXPECT_NE(problem_of(good.substr(0, length)).find(", byte "), std::string::npos)
        << "cut to " << length << " bytes";
}

TEST(TrajectoryFile, ForeignFileIsNamedAsSuch) {
  EXPECT_NE(problem_of("{\"name\": \"a scene, not a run\"}").find("byte 0: not a recorded run"),
            std::string::npos);
}

TEST(TrajectoryFile, OtherVersionIsNamedAsOlderOrNewer) {
  std::string bytes = good_bytes();
  bytes[8] = 1;
  EXPECT_NE(problem_of(bytes).find("byte 8: recorded by an older version of this program: format "
                                   "version 1, this program reads 4"),
            std::string::npos);
  bytes[8] = 9;
  EXPECT_NE(problem_of(bytes).find("byte 8: recorded by a newer version"), std::string::npos);
}

TEST(TrajectoryFile, AnyByteChangedIsReadOrRefusedAndNothingElse) {
  const std::string good = good_bytes();
  int refused = 0;
  for (std::size_t at = 0; at < good.size(); ++at)
    for (const int flip : {0x01, 0x80, 0xff}) {
      std::string bytes = good;
      bytes[at] = static_cast<char>(bytes[at] ^ flip);
      const std::string said = problem_of(bytes);  // any exception but a UserError fails the test
      if (said != "no error") ++refused;
    }
  // Counts and lengths, of which there are about 30 of 8 bytes, magic, version and end are noticed;
  // a changed number cannot be.
  EXPECT_GT(refused, 500);
}

TEST(TrajectoryFile, AnEventOfAnUnknownKindIsNamed) {
  const std::string good = good_bytes();
  // Seen from the end: "end\n", stopped_by (8 + 13), no faults and no notices (8 + 8), counts (8 + 8
  // + 12 + 8 + 8 + 9 + 8), and the last event but its time.
  const std::size_t kind_at = good.size() - 4 - (8 + small_run().stopped_by.size()) - (8 + 8) -
                              (8 + (8 + 12 + 8) + (8 + 9 + 8)) - (1 + 8 + 9 * 8);
  std::string bytes = good;
  ASSERT_EQ(bytes[kind_at], static_cast<char>(EventKind::kControl));
  bytes[kind_at] = 12;
  EXPECT_NE(problem_of(bytes).find("an event of kind 12, expected 1 to 11"), std::string::npos);
}

// Bytes of a value of a plain type.
template <class T>
std::string as_bytes(const T& value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

// What is said of the small run, where the first place that holds `had` holds `has` instead.
std::string problem_with(const std::string& had, const std::string& has) {
  std::string bytes = good_bytes();
  const std::size_t at = bytes.find(had);
  EXPECT_NE(at, std::string::npos);
  if (at != std::string::npos) bytes.replace(at, had.size(), has);
  return problem_of(bytes);
}

// Who reads a run finds its bodies by these numbers.
TEST(TrajectoryFile, BodiesOfEventsAndContactsThatTheRunDoesNotHaveAreRefused) {
  const double time = 0.3;
  const std::string event = as_bytes(time) + as_bytes(EventKind::kCollision),
                    contact = as_bytes(std::uint64_t{1});  // one contact, of the bodies 0 and 1
  const auto bodies = [](std::int32_t a, std::int32_t b) { return as_bytes(a) + as_bytes(b); };
  for (const auto& [a, b] : {std::pair{0, 2}, {2, 1}, {-1, 1}, {0, -2}, {0, 1 << 30}}) {
    const std::string numbers = std::to_string(a) + " and " + std::to_string(b);
    EXPECT_NE(problem_with(event + bodies(0, 1), event + bodies(a, b))
                  .find("an event of the bodies " + numbers + ", in a run of 2"),
              std::string::npos);
    EXPECT_NE(problem_with(contact + bodies(0, 1), contact + bodies(a, b))
                  .find("a contact of the bodies " + numbers + ", in a run of 2"),
              std::string::npos);
  }
  EXPECT_EQ(problem_with(event + bodies(0, 1), event + bodies(0, -1)), "no error");
}

TEST(TrajectoryFile, TimesThatAreNoNumbersOrGoBackAreRefused) {
  const double kNan = std::numeric_limits<double>::quiet_NaN(),
               kInfinity = std::numeric_limits<double>::infinity();
  const std::string frame = as_bytes(1.0 / 3.0), event = as_bytes(0.4);
  for (const double time : {kNan, kInfinity, -kInfinity}) {
    EXPECT_NE(problem_with(frame, as_bytes(time)).find(", byte "), std::string::npos) << time;
    EXPECT_NE(problem_with(event, as_bytes(time)).find("an event at "), std::string::npos) << time;
  }
  EXPECT_NE(problem_with(frame, as_bytes(-1.0)).find("a frame at -1 s, before 0 s"),
            std::string::npos);
}

TEST(TrajectoryFile, CountBeyondTheFileIsRefusedBeforeMemoryIsTaken) {
  std::string bytes = good_bytes();
  // the length of the first string
  for (int i = 12; i < 20; ++i) bytes[static_cast<std::size_t>(i)] = '\x7f';
  EXPECT_NE(problem_of(bytes).find("bytes follow"), std::string::npos);
}

TEST(TrajectoryFile, BytesAfterTheEndAreRefused) {
  EXPECT_NE(problem_of(good_bytes() + "x").find("bytes follow the end of the run"),
            std::string::npos);
}

}  // namespace
}  // namespace tumble
