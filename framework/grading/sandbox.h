/// Runs a program that nobody trusts: no network, no files but those given, limits on everything, nothing left running.
///
/// bubblewrap builds the namespaces. A keeper process of ours stands between: it owns the limits on wall time and output,
/// kills and reaps all, and outlives neither its owner nor its sandbox. As root the program runs under an unprivileged uid.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tumble::grading {

/// Whom the sandboxed program is to the rest of the machine. As root: a uid of its own, one a concurrent job, leased until
/// destruction. As an ordinary user: that user.
class SandboxUser {
 public:
  /// @throws UserError when all uids are in use
  static SandboxUser lease();
  SandboxUser(SandboxUser&& other) noexcept;
  SandboxUser& operator=(SandboxUser&&) = delete;
  ~SandboxUser();

  /// Empty where we are an ordinary user: nothing is dropped then.
  std::optional<uid_t> uid() const { return uid_; }

 private:
  SandboxUser() = default;
  std::optional<uid_t> uid_;
  int lock_ = -1;
};

/// A folder that the sandbox's user can read wherever the checkout lies; removed at destruction.
class Stage {
 public:
  /// @param user  who may read it; null: anybody, for what is no secret
  explicit Stage(const SandboxUser* user);
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;
  ~Stage();

  const std::filesystem::path& path() const { return path_; }
  /// @return where the copy lies
  std::filesystem::path add_file(const std::filesystem::path& from, const std::string& name, bool executable = false);
  std::filesystem::path add_text(const std::string& text, const std::string& name);

 private:
  void hand_over(const std::filesystem::path& file, unsigned mode) const;

  std::filesystem::path path_;
  int alive_ = -1;   // hold_folder
  std::optional<uid_t> owner_;
};

/// Removes the stages of processes that are gone without having removed them: killed ones.
void sweep_stages_of_the_dead();

struct SandboxLimits {
  double wall_s = 10.0;
  double stall_s = 0.0;                          // of wall time in which nothing inside computes or waits for a core; 0: not limited
  std::uint64_t cpu_s = 10;                      // per process; the wall limit bounds the sum
  std::uint64_t memory_bytes = 1ull << 30;       // of address space, per process
  std::uint64_t file_bytes = 64ull << 20;        // per file
  std::uint64_t tmp_bytes = 64ull << 20;         // of /tmp; /dev/shm has a sixteenth of it
  std::uint64_t processes = 12;                  // threads count; 0: not limited, for programs that are ours
  std::uint64_t open_files = 64;
  std::uint64_t output_bytes = 256ull << 10;     // printed; above it the program is killed
};

/// A file or folder outside, shown read-only inside.
struct Bind {
  std::filesystem::path from;   // the sandbox's user must be able to reach it: see Stage
  std::string to;
};

struct SandboxJob {
  std::vector<std::string> command;   // absolute path inside, arguments
  std::vector<Bind> binds;            // beside /usr
  SandboxLimits limits;
  int channel = -1;                   // becomes descriptor 3 inside, where given; the caller keeps its own copy
  std::filesystem::path init;         // the program sandbox_init, reachable as a Bind is
  std::optional<uid_t> uid;           // of SandboxUser
};

struct SandboxOutcome {
  enum class Ending {
    kExited,        // code: of exit
    kSignal,        // code: the signal; the limit on CPU time shows as SIGXCPU or SIGKILL
    kWallLimit,
    kStalled,       // slept past the limit
    kOutputLimit,
    kStopped,       // its owner asked for it
    kNotStarted,    // a fault of ours; `printed` says why
  };
  Ending ending = Ending::kNotStarted;
  int code = 0;
  std::string printed;         // stdout and stderr, at most output_bytes
  long peak_memory_kb = 0;
  double cpu_s = 0.0;
};

/// A running sandbox. Destruction stops it.
class Sandbox {
 public:
  /// Returns at once; what fails later shows in the outcome. @throws std::runtime_error when no process can be made
  static Sandbox start(const SandboxJob& job);
  Sandbox(Sandbox&& other) noexcept;
  Sandbox& operator=(Sandbox&& other) = delete;
  ~Sandbox();

  /// The program inside, as the machine numbers it; -1 while it has not begun. Cost: some 30 us
  pid_t program() const;
  /// Waits for the end.
  SandboxOutcome wait();
  /// Gives it `grace_s` to end by itself, then ends it.
  SandboxOutcome stop(double grace_s = 0.0);

 private:
  Sandbox() = default;
  pid_t keeper_ = -1;
  int hang_up_ = -1;   // closing it ends the sandbox
  int result_ = -1;
};

/// Whether this machine lets us: the reason where it does not.
std::optional<std::string> why_no_sandbox(const std::filesystem::path& init);

}  // namespace tumble::grading
