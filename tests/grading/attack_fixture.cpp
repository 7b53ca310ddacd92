#include "tests/support/places.h"
#include "tests/grading/attack_fixture.h"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>

#include "framework/core/files.h"
#include "framework/grading/sandbox/protection.h"
#include "framework/modules/proxy.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

const fs::path& scratch() {
  static const PrivateFolder folder;  // removed at the end of the program
  static const fs::path path = folder.path();
  return path;
}

WorkerOptions options_for(const fs::path& object) {
  WorkerOptions options;
  options.id = "waist";
  options.module = object;
  options.call_own_s = 1.5;
  options.session_own_s = 6.0;
  options.callback_budget = 1000;
  options.memory_bytes = 256ull << 20;
  return options;
}

}  // namespace

Compiled compile_source(const std::string& text, const fs::path& object,
                        const CompileLimits& limits) {
  CompileJob job;
  job.root = test::source_dir();
  job.header = "tests/modules/waist.h";
  job.source = scratch() / "waist.cpp";
  job.object = object;
  job.limits = limits;
  job.id = "waist";
  std::ofstream(job.source) << text;
  return compile_submission(job);
}

fs::path attack_object(const std::string& file, const std::string& defines) {
  static std::map<std::string, fs::path> built;
  fs::path& object = built[file + defines];
  if (!object.empty()) return object;
  object = scratch() / ("attack" + std::to_string(built.size()) + ".so");
  const Compiled compiled = compile_source(
      defines + "\n#line 1\n" +
          text_of(fs::path(test::source_dir()) / "solutions_private/attacks/calls" / file),
      object);
  EXPECT_EQ(compiled.outcome, Compiled::Outcome::kBuilt) << compiled.said;
  return object;
}

int descendants_left() {
  for (int waited_ms = 0;; waited_ms += 10) {
    const pid_t gone = ::waitpid(-1, nullptr, WNOHANG);
    if (gone < 0) return 0;
    if (gone == 0 && waited_ms > 1000) break;
    if (gone == 0) ::usleep(10000);
  }
  std::istringstream children(
      text_of("/proc/self/task/" + std::to_string(::getpid()) + "/children"));
  int count = 0;
  for (pid_t child; children >> child;) ++count;
  return count;
}

Victim::Victim(const fs::path& object)
    : connection_(options_for(object)), module_(modules::make_proxy<waist::Module>(connection_)) {
  call_log() = CallLog{};
}

std::string Victim::attack(const std::string& what) {
  call_log() = CallLog{};
  try {
    return module_.attack(what);
  } catch (const CallEnded&) {
    return "";
  } catch (const NotImplemented&) {
    return "";
  }
}

void Attack::SetUp() {
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);
  static const int told =
      std::printf("sandbox: %s\n", protection_in_words(chosen_sandbox()).c_str());
  (void)told;
  if (const auto why = why_no_sandbox(chosen_sandbox()))
    GTEST_SKIP() << "no sandbox on this machine: " << *why;
}

}  // namespace tumble::grading
