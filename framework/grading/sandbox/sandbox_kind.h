/// The three kinds of sandbox, from the weakest to the strongest.
#pragma once

#include <string>
#include <vector>

namespace tumble::grading {

enum class SandboxKind {
  kBare,        // a system call filter and limits; a submission is linked into its worker
  kLandlock,    // the same, and Landlock: files outside the job cannot be read or written
  kNamespaces,  // bubblewrap: files, processes, network and IPC objects of its own
};

/// What a kind needs and gives, where the three differ.
struct SandboxTraits {
  SandboxKind kind;
  const char* name;       // as in --sandbox and TUMBLE_SANDBOX
  int generations;        // from the keeper down to the program inside: 1 means its own child
  bool needs_init;        // SandboxJob::init starts the program
  bool links_worker;      // a submission is compiled to a program that opens no file
  bool hides_names;       // a program inside cannot learn that a file outside exists
  bool is_official;       // the policy for grades that count
  const char* withholds;  // what a submission cannot do, for people
  const char* permits;    // what it still can
};
const SandboxTraits& traits_of(SandboxKind kind);

/// All three, the strongest first.
const std::vector<SandboxTraits>& all_sandboxes();

/// @throws UserError naming the three, when it is none of them
SandboxKind sandbox_from_name(const std::string& name);

}  // namespace tumble::grading
