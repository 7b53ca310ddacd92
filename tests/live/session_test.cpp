// A sitting at the page: what a page is told when code is saved, refused, or ends badly. The
// process that simulates is a small one of the test's own (fake_simulator.cpp).
#include <arpa/inet.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <future>
#include <thread>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/live/session.h"

namespace tumble::testing::live_session_test {
namespace {

namespace fs = std::filesystem;

class LiveSession : public ::testing::Test {
 protected:
  LiveSession() {
    // The session ends by a signal of the process, which no other thread may take.
    sigset_t signals;
    ::sigemptyset(&signals);
    ::sigaddset(&signals, SIGTERM);
    ::pthread_sigmask(SIG_BLOCK, &signals, &before_);
    code("right");
    std::ofstream(other_file()) << "right";
    sitting_.name = "box";
    sitting_.recipe.document = R"({"title": "A box", "duration_s": 1, "bodies": []})";
    sitting_.simulator = {TUMBLE_FAKE_SIMULATOR, file().string()};
    sitting_.judge = [this](const std::string& id) {
      return std::vector<std::string>{"/bin/sh", "-c",
                                      "echo '{\"id\": \"" + id +
                                          "\", \"tests\": [], \"said\": \"judged as " +
                                          text_of(file()) + "\"}'"};
    };
    sitting_.locate = {"/bin/sh", "-c",
                       "grep -q '^frame .*a1_student.so 0x1234' && "
                       "echo 'a1_impulse.cpp:26: return 1 / n;'"};
    sitting_.watched = {{file(), "a1"}, {other_file(), "a2"}};
    sitting_.offered = [] {
      return std::vector<live::OfferedScene>{{"box", "A box", "a1", {"a1"}, {}},
                                             {"ball", "A ball", "a2", {"a1", "a2"}, {"a2"}}};
    };
    sitting_.scene_named = [this](const std::string& name) {
      if (name == "box") return static_cast<live::SceneStart>(sitting_);
      if (name != "ball") throw UserError(name, "there is no such scene", "");
      live::SceneStart ball = sitting_;
      ball.name = "ball";
      ball.title = "A ball";
      return ball;
    };
    sitting_.saves = folder_.path() / "saves";
    std::promise<std::string> address;
    thread_ = std::thread([this, &address] {
      left_ = live::serve(sitting_, [&](const std::string& at) { address.set_value(at); });
    });
    const std::string at = address.get_future().get();
    const std::size_t colon = at.rfind(':'), slash = at.find('/', colon);
    host_ = at.substr(7, slash - 7);
    path_ = at.substr(slash);
    stream_ = connected(std::stoi(at.substr(colon + 1)));
    write("GET " + path_ + "stream HTTP/1.1\r\nHost: " + host_ + "\r\n\r\n", stream_);
  }
  ~LiveSession() override {
    stop();
    ::close(stream_);
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  void stop() {
    if (!thread_.joinable()) return;
    ::kill(::getpid(), SIGTERM);
    thread_.join();
  }

  fs::path file() const { return folder_.path() / "code.txt"; }
  fs::path other_file() const { return folder_.path() / "other.txt"; }
  void code(const std::string& what) const { std::ofstream(file()) << what; }

  static int connected(int port) {
    const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval patience{60, 0};
    ::setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    EXPECT_EQ(::connect(fd, reinterpret_cast<sockaddr*>(&to), sizeof to), 0);
    return fd;
  }
  static void write(const std::string& text, int fd) {
    ASSERT_EQ(::send(fd, text.data(), text.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(text.size()));
  }
  /// Reads the stream until a text has come, and forgets all until behind it.
  /// @return whether it came
  bool hears(const std::string& text) {
    for (;;) {
      if (const std::size_t at = heard_.find(text); at != std::string::npos) {
        before_it_ = heard_.substr(0, at);
        heard_.erase(0, at + text.size());
        return true;
      }
      char buffer[1 << 14];
      const ssize_t n = ::read(stream_, buffer, sizeof buffer);
      if (n <= 0) return false;
      heard_.append(buffer, static_cast<std::size_t>(n));
    }
  }
  void post(const std::string& json) const {
    const int fd = connected(std::stoi(host_.substr(host_.find(':') + 1)));
    write("POST " + path_ + "do HTTP/1.1\r\nHost: " + host_ + "\r\nOrigin: http://" + host_ +
              "\r\nContent-Type: application/json\r\nContent-Length: " +
              std::to_string(json.size()) + "\r\nConnection: close\r\n\r\n" + json,
          fd);
    char buffer[256];
    while (::read(fd, buffer, sizeof buffer) > 0) {
    }
    ::close(fd);
  }

  PrivateFolder folder_;
  live::Sitting sitting_;
  live::Left left_;
  std::thread thread_;
  std::string host_, path_, heard_, before_it_;
  int stream_ = -1;
  sigset_t before_;
};

TEST_F(LiveSession, RunsAndTellsThePageOfEveryFrame) {
  EXPECT_TRUE(hears("\"kind\":\"hello\""));
  EXPECT_TRUE(hears("\"kind\":\"run\""));
  for (int k = 0; k < 5; ++k) EXPECT_TRUE(hears("event: f\ndata: "));
}

TEST_F(LiveSession, SavedCodeBeginsAnewAndIsJudged) {
  ASSERT_TRUE(hears("event: f"));
  code("right");
  EXPECT_TRUE(hears("\"kind\":\"code_saved\""));
  EXPECT_TRUE(hears("\"reason\":\"code\""));
  EXPECT_TRUE(hears("\"said\":\"judged as right\""));
  EXPECT_TRUE(hears("event: f"));
}

TEST_F(LiveSession, CrashIsToldWithItsLineAndThePageLivesOn) {
  ASSERT_TRUE(hears("event: f"));
  code("crash");
  EXPECT_TRUE(hears("\"title\":\"Crashed\",\"text\":\"a1_impulse.cpp: crashed, in collision"));
  EXPECT_TRUE(hears("\"where\":\"a1_impulse.cpp:26\""));
  post(R"({"do": "pace", "speed": 0.5, "paused": false})");
  EXPECT_TRUE(hears("\"kind\":\"pace\",\"speed\":0.5"));
  code("die");
  EXPECT_TRUE(hears("ended by signal 9"));
  code("right");
  EXPECT_TRUE(hears("\"reason\":\"code\""));
  for (int k = 0; k < 10; ++k) EXPECT_TRUE(hears("event: f"));
}

TEST_F(LiveSession, EndBeforeTheFirstFrameIsToldWithItsReason) {
  ASSERT_TRUE(hears("event: f"));
  code("stop");
  EXPECT_TRUE(hears("\"title\":\"The run stopped\",\"text\":\"box: two bodies overlap\""));
  EXPECT_TRUE(hears("\"ends_run\":true,\"shows_former\":true"));
}

// Of code that is no more nothing moves under the words of what has become of the new one.
TEST_F(LiveSession, CrashBeforeTheFirstFrameEndsTheRunOfTheCodeBefore) {
  ASSERT_TRUE(hears("event: f"));
  code("crash_first");
  EXPECT_TRUE(hears("\"title\":\"Crashed\",\"text\":\"a1_impulse.cpp: crashed, in collision"));
  EXPECT_TRUE(hears("\"ends_run\":true,\"shows_former\":true"));
  EXPECT_TRUE(hears("\"where\":\"a1_impulse.cpp:26\""));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));  // twenty frames of the fake one
  post(R"({"do": "pace", "speed": 0.5, "paused": false})");
  EXPECT_TRUE(hears("\"kind\":\"pace\""));
  EXPECT_EQ(before_it_.find("event: f"), std::string::npos) << before_it_;
  post(R"({"do": "push", "force_n": [1, 0, 0], "duration_s": 0.1})");
  EXPECT_TRUE(hears("the run has ended: start over"));
  code("right");
  EXPECT_TRUE(hears("\"reason\":\"code\""));
  for (int k = 0; k < 10; ++k) EXPECT_TRUE(hears("event: f"));
}

TEST_F(LiveSession, CodeThatPrintsMuchRuns) {
  ASSERT_TRUE(hears("event: f"));
  code("talk");
  EXPECT_TRUE(hears("\"kind\":\"run\",\"reason\":\"code\""));
  for (int k = 0; k < 3; ++k) EXPECT_TRUE(hears("event: f"));
}

TEST_F(LiveSession, RefusedChangeStaysOutOfTheRunThatIsShown) {
  ASSERT_TRUE(hears("event: f"));
  code("refuse");
  ASSERT_TRUE(hears("\"title\":\"Does not compile\""));
  post(R"({"do": "change", "changes": {"restitution": 0.25}})");
  ASSERT_TRUE(hears("\"title\":\"Does not compile\""));
  code("right");
  ASSERT_TRUE(hears("\"kind\":\"run\",\"reason\":\"code\""));
  EXPECT_TRUE(hears("\"changes\":{\"engine\":\"\",\"method\":\"\"}"));
}

TEST_F(LiveSession, CompilersErrorLeavesTheRunGoing) {
  ASSERT_TRUE(hears("event: f"));
  code("refuse");
  EXPECT_TRUE(hears("\"shows_former\":true,\"kind\":\"trouble\""));
  EXPECT_NE(before_it_.find("\"title\":\"Does not compile\""), std::string::npos) << before_it_;
  EXPECT_TRUE(hears("event: f"));
  EXPECT_TRUE(hears("event: f"));
}

TEST_F(LiveSession, FirstDifferenceFromTheRunBeforeIsTold) {
  ASSERT_TRUE(hears("event: f"));
  for (int k = 0; k < 30; ++k) ASSERT_TRUE(hears("event: f"));
  code("crash");  // it moves twice as fast
  EXPECT_TRUE(hears("\"kind\":\"difference\""));
  EXPECT_TRUE(hears("from where it is in the run before"));
}

TEST_F(LiveSession, NonsenseFromThePageIsToldAndEndsNothing) {
  for (const char* text : {"", "{", "[]", "{}", R"({"do": "fly"})", R"({"do": "pace"})",
                           R"({"do": "change", "changes": {"restitution": 7}})",
                           R"({"do": "change", "changes": 3})"}) {
    post(text);
    EXPECT_TRUE(hears("\"kind\":\"notice\"")) << text;
  }
  EXPECT_TRUE(hears("event: f"));
}

TEST_F(LiveSession, SaysAtItsEndWhatIsKeptAndWhatIsNot) {
  ASSERT_TRUE(hears("event: f"));
  post(R"({"do": "change", "changes": {"gravity_m_s2": [0, 0, -1]}})");
  ASSERT_TRUE(hears("\"kind\":\"run\",\"reason\":\"change\""));
  ASSERT_TRUE(hears("event: f"));
  post(R"({"do": "save"})");
  ASSERT_TRUE(hears("\"kind\":\"saved\""));
  stop();
  ASSERT_EQ(left_.scenes.size(), 1u);
  EXPECT_TRUE(fs::exists(left_.scenes.front()));
  EXPECT_FALSE(left_.has_unsaved);
}

TEST_F(LiveSession, WhatIsDoneAfterTheLastSaveIsNotKept) {
  ASSERT_TRUE(hears("event: f"));
  post(R"({"do": "change", "changes": {"gravity_m_s2": [0, 0, -1]}})");
  ASSERT_TRUE(hears("\"reason\":\"change\""));
  stop();
  EXPECT_TRUE(left_.scenes.empty());
  EXPECT_TRUE(left_.has_unsaved);
}

TEST_F(LiveSession, TellsWhatARunAsksAndRemembersItByScene) {
  ASSERT_TRUE(hears("\"kind\":\"scenes\""));
  EXPECT_TRUE(hears("\"name\":\"ball\""));
  EXPECT_TRUE(hears("\"unwritten\":[\"a2\"]"));
  EXPECT_TRUE(hears("\"kind\":\"asked\",\"scene\":\"box\""));
  EXPECT_TRUE(hears("[\"f\",12]"));
  post(R"({"do": "scene", "name": "ball"})");
  ASSERT_TRUE(hears("\"kind\":\"scenes\""));
  EXPECT_TRUE(hears("\"asked\":{\"a1\":[\"f\"]}"));  // of the box, without g and h
}

TEST_F(LiveSession, ChosenSceneBeginsAndWhatWasDoneToTheOtherIsKept) {
  ASSERT_TRUE(hears("event: f"));
  post(R"({"do": "change", "changes": {"restitution": 0.25}})");
  ASSERT_TRUE(hears("\"reason\":\"change\""));
  post(R"({"do": "scene", "name": "ball"})");
  ASSERT_TRUE(hears("\"kind\":\"scene\",\"name\":\"ball\",\"title\":\"A ball\""));
  ASSERT_TRUE(hears("\"kind\":\"run\",\"reason\":\"scene\""));
  ASSERT_TRUE(hears("\"has_former\":false,\"changes\":{\"engine\":\"\",\"method\":\"\"}"));
  EXPECT_TRUE(hears("event: f"));
  post(R"({"do": "scene", "name": "box"})");
  ASSERT_TRUE(hears("\"kind\":\"run\",\"reason\":\"scene\""));
  EXPECT_TRUE(hears("\"restitution\":0.25"));
  post(R"({"do": "scene", "name": "cube"})");
  EXPECT_TRUE(hears("there is no such scene"));
  EXPECT_TRUE(hears("event: f"));
}

TEST_F(LiveSession, ChosenSceneThatCannotBeginBeginsWithTheNextSave) {
  ASSERT_TRUE(hears("event: f"));
  code("refuse");
  ASSERT_TRUE(hears("\"title\":\"Does not compile\""));
  post(R"({"do": "scene", "name": "ball"})");
  ASSERT_TRUE(hears("\"kind\":\"scene\",\"name\":\"ball\""));
  ASSERT_TRUE(hears("\"title\":\"Does not compile\""));
  code("right");
  ASSERT_TRUE(hears("\"kind\":\"run\",\"reason\":\"code\""));
  EXPECT_TRUE(hears("\"scene\":\"ball\""));
}

TEST_F(LiveSession, EachAssignmentKeepsItsVerdicts) {
  ASSERT_TRUE(hears("event: f"));
  code("right");
  ASSERT_TRUE(hears("\"id\":\"a1\",\"tests\""));
  std::ofstream(other_file()) << "right again";
  ASSERT_TRUE(hears("\"id\":\"a2\",\"tests\""));
  // A page that is opened now is told both.
  ::close(stream_);
  heard_.clear();
  stream_ = connected(std::stoi(host_.substr(host_.find(':') + 1)));
  write("GET " + path_ + "stream HTTP/1.1\r\nHost: " + host_ + "\r\n\r\n", stream_);
  EXPECT_TRUE(hears("\"id\":\"a1\",\"tests\""));
  EXPECT_TRUE(hears("\"id\":\"a2\",\"tests\""));
}

TEST_F(LiveSession, SaysWhetherAnythingIsUnsavedWhileThereIsTime) {
  ASSERT_TRUE(hears("\"unsaved\":{\"is\":false"));
  ASSERT_TRUE(hears("event: f"));
  post(R"({"do": "change", "changes": {"gravity_m_s2": [0, 0, -1]}})");
  ASSERT_TRUE(hears("\"kind\":\"unsaved\",\"is\":true"));
  ASSERT_TRUE(hears("\"kind\":\"run\",\"reason\":\"change\""));
  ASSERT_TRUE(hears("event: f"));
  post(R"({"do": "save"})");
  EXPECT_TRUE(hears("\"kind\":\"unsaved\",\"is\":false"));
}

// What was done to one scene is not what "not saved" means beside another.
TEST_F(LiveSession, NamesTheSceneOfWhichSomethingIsUnsaved) {
  ASSERT_TRUE(hears("event: f"));
  post(R"({"do": "change", "changes": {"gravity_m_s2": [0, 0, -1]}})");
  ASSERT_TRUE(hears("\"kind\":\"unsaved\",\"is\":true,\"others\":[]"));
  ASSERT_TRUE(hears("\"kind\":\"run\",\"reason\":\"change\""));
  post(R"({"do": "scene", "name": "ball"})");
  ASSERT_TRUE(hears("\"kind\":\"unsaved\",\"is\":false,\"others\":[\"box\"]"));
  ASSERT_TRUE(hears("\"kind\":\"run\",\"reason\":\"scene\""));
  post(R"({"do": "scene", "name": "box"})");
  EXPECT_TRUE(hears("\"kind\":\"unsaved\",\"is\":true,\"others\":[]"));
}

TEST_F(LiveSession, PushWhileCodeIsCompiledStaysInItsRun) {
  ASSERT_TRUE(hears("event: f"));
  code("hand");
  ASSERT_TRUE(hears("\"kind\":\"run\",\"reason\":\"code\""));
  ASSERT_TRUE(hears("event: f"));
  code("slow");
  ASSERT_TRUE(hears("\"kind\":\"push\""));
  ASSERT_TRUE(hears("\"kind\":\"run\",\"reason\":\"code\""));
  EXPECT_TRUE(hears("\"pushes\":["));
  EXPECT_TRUE(hears("event: f"));
  EXPECT_NE(before_it_.find("\"force_n\":[7"), std::string::npos) << before_it_;
}

TEST_F(LiveSession, SaysThatASceneWaitsForTheCompiler) {
  code("slow");
  ASSERT_TRUE(hears("\"kind\":\"run\",\"reason\":\"code\""));
  post(R"({"do": "scene", "name": "ball"})");
  ASSERT_TRUE(hears("\"kind\":\"starting\",\"reason\":\"scene\""));
  EXPECT_TRUE(hears("\"kind\":\"starting\",\"reason\":\"code\""));
  EXPECT_TRUE(hears("\"kind\":\"run\",\"reason\":\"scene\""));
}

TEST_F(LiveSession, FileThatIsGoneIsTold) {
  ASSERT_TRUE(hears("event: f"));
  const fs::path away = folder_.path() / "renamed.txt";
  fs::rename(file(), away);
  EXPECT_TRUE(hears("\"title\":\"Your file is gone\",\"where\":\"code.txt\""));
  EXPECT_TRUE(hears("event: f"));  // of the code before
  fs::rename(away, file());
  EXPECT_TRUE(hears("\"kind\":\"run\",\"reason\":\"code\""));
  // A run that begins meanwhile does not bring it back.
  fs::rename(other_file(), away);
  EXPECT_TRUE(hears("\"title\":\"Your file is gone\",\"where\":\"other.txt\""));
  code("right");
  EXPECT_TRUE(hears("\"kind\":\"run\",\"reason\":\"code\""));
  EXPECT_TRUE(hears("\"title\":\"Your file is gone\",\"where\":\"other.txt\""));
}

TEST_F(LiveSession, CallThatNeverReturnedIsAmongThoseThatTheRunAsked) {
  ASSERT_TRUE(hears("[\"f\",12],[\"g\",0]"));
  code("crash");
  ASSERT_TRUE(hears("[\"f\",12],[\"g\",0]"));
  EXPECT_TRUE(hears("[\"f\",13],[\"g\",1],[\"h\",0]"));
  EXPECT_TRUE(hears("\"text\":\"a1_impulse.cpp: crashed, in collision_impulse\\n\""));
}

TEST_F(LiveSession, RefusedChangeIsToldAsOne) {
  ASSERT_TRUE(hears("event: f"));
  post(R"({"do": "change", "changes": {"restitution": 7}})");
  EXPECT_TRUE(hears("\"about\":\"change\""));
}

TEST_F(LiveSession, EndsBySignalAndLeavesNoProcess) {
  ASSERT_TRUE(hears("event: f"));
  stop();
  EXPECT_FALSE(hears("never said"));  // the stream is closed
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
  EXPECT_EQ(errno, ECHILD);
}

}  // namespace
}  // namespace tumble::testing::live_session_test
