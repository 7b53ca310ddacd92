// A process that simulates, for tests of the session: it does what a file says, whose name is its
// first word. "right": frames until nobody reads; "crash": three, then the message of a guarded
// call and exit code 1; "crash_first": the message alone; "die": three, then a signal; "refuse": a
// compiler's error; "stop": an end before the first frame; "talk": as "right", with more on
// standard error than a pipe holds; "slow": as "right", after half a second and the words that it
// compiles; "hand": as "right", with a push as soon as the file says something else. After its head
// it says that it has asked function f of module a1, and in a crash that it has called g, too.
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
    std::cerr << "frame /somewhere/a1_student.so 0x1234\ncalled a1 f 13\ncalled a1 g 1\n"
                 "\ntumble: a1_impulse.cpp: crashed, in collision_impulse\n";
    return 1;
  };
  if (what == "crash_first") return crash();
  if (what == "talk") std::cerr << std::string(1 << 20, '.') << std::flush;
  if (what == "slow") {
    std::cerr << "compiling code.txt\n" << std::flush;
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
  }
  live::write_record(1, RecordKind::kHead,
                     R"({"from_s": 0, "scene": {"camera": {"eye": [0, -5, 0],)"
                     R"( "target": [0, 0, 0]}, "bodies": [{"name": "box",)"
                     R"( "immovable": false, "radius": 1}]}})");
  live::write_record(
      1, RecordKind::kAsked,
      R"([{"id": "a1", "source": "student", "laws": ["f", "g"], "functions": [["f", )"
      R"(12], ["g", 0], ["h", 0]]}])");
  bool is_hand = what == "hand";
  const bool is_right = what == "right" || what == "talk" || what == "slow" || is_hand;
  Frame frame{};
  frame.poses.push_back(
      {Vector3d::Zero(), Quaterniond::Identity(), Vector3d::Zero(), Vector3d::Zero()});
  for (int k = 0;; ++k) {
    frame.time = k / 60.0;
    frame.poses[0].com_world.x() = (is_right ? 1.0 : 2.0) * frame.time;
    if (!live::write_record(1, RecordKind::kFrame, live::pack(frame))) return 0;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    std::string now;
    if (is_hand && std::ifstream(argv[1]) >> now && now != what) {
      is_hand = false;
      std::this_thread::sleep_for(std::chrono::milliseconds(200));  // the save has been seen
      live::write_record(1, RecordKind::kHand,
                         R"({"body": "box", "force_n": [7, 0, 0], "point_m": [0, 0, 0],)"
                         R"( "start_s": 1, "duration_s": 0.1, "runs_again": false})");
    }
    if (k < 3 || is_right) continue;
    if (what == "die") std::raise(SIGKILL);
    return crash();
  }
}
