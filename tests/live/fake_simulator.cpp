// A process that simulates, for tests of the session: it does what a file says, whose name is its
// first word. "right": frames until nobody reads; "crash": three, then the message of a guarded
// call and exit code 1; "crash_first": the message alone; "die": three, then a signal; "refuse": a
// compiler's error; "stop": an end before the first frame; "talk": as "right", with more on standard
// error than a pipe holds. After its head it says that it has asked function f of module a1.
#include <csignal>
#include <fstream>
#include <iostream>
#include <thread>

#include "framework/live/records.h"

int main(int argc, char** argv) {
  using namespace tumble;
  using live::RecordKind;
  std::signal(SIGPIPE, SIG_IGN);
  std::string line, what;
  std::getline(std::cin, line);
  std::ifstream(argc > 1 ? argv[1] : "") >> what;
  if (what == "refuse") {
    live::write_record(1, RecordKind::kRefused,
                       R"({"where": "a1_impulse.cpp", "problem": "does not compile:\nline 7", )"
                       R"("remedy": "Correct it."})");
    return 2;
  }
  if (what == "stop") {
    live::write_record(1, RecordKind::kEnd, R"({"stopped_by": "box: two bodies overlap"})");
    return 0;
  }
  const auto crash = [] {
    std::cerr << "frame /somewhere/a1_student.so 0x1234\n\ntumble: a1_impulse.cpp: crashed, in "
                 "collision_impulse\n";
    return 1;
  };
  if (what == "crash_first") return crash();
  if (what == "talk") std::cerr << std::string(1 << 20, '.') << std::flush;
  live::write_record(1, RecordKind::kHead,
                     R"({"from_s": 0, "scene": {"camera": {"eye": [0, -5, 0],)"
                     R"( "target": [0, 0, 0]}, "bodies": [{"name": "box",)"
                     R"( "immovable": false, "radius": 1}]}})");
  live::write_record(
      1, RecordKind::kAsked,
      R"([{"id": "a1", "source": "student", "laws": ["f", "g"], "functions": [["f", )"
      R"(12], ["g", 0], ["h", 0]]}])");
  const bool is_right = what == "right" || what == "talk";
  Frame frame{};
  frame.poses.push_back(
      {Vector3d::Zero(), Quaterniond::Identity(), Vector3d::Zero(), Vector3d::Zero()});
  for (int k = 0;; ++k) {
    frame.time = k / 60.0;
    frame.poses[0].com_world.x() = (is_right ? 1.0 : 2.0) * frame.time;
    if (!live::write_record(1, RecordKind::kFrame, live::pack(frame))) return 0;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (k < 3 || is_right) continue;
    if (what == "die") std::raise(SIGKILL);
    return crash();
  }
}
