/// What a machine has for grading, what follows, and how to mend what is missing.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "framework/grading/sandbox/sandbox_kind.h"

namespace tumble::grading {

struct Finding {
  enum class State {
    kGood,
    kNote,     // works, with less protection or speed
    kMissing,  // official grades need it
  };
  State state = State::kGood;
  std::string what;    // "Landlock"
  std::string found;   // "ABI 7"
  std::string remedy;  // empty where nothing is to mend
};

struct SandboxFinding {
  SandboxTraits traits;
  std::optional<std::string> why_not;  // empty: it works here
};

struct MachineReport {
  std::vector<Finding> findings;
  std::vector<SandboxFinding> sandboxes;  // the strongest first
  // the strongest that works, or the one that TUMBLE_SANDBOX names
  std::optional<SandboxKind> chosen;
  bool allows_official_grades() const;
};

/// @param root   of the source tree, for packages.txt
/// @param build  of the build tree, for its disk
MachineReport examine_machine(const std::filesystem::path& root,
                              const std::filesystem::path& build);

/// Packages of packages.txt that dpkg does not list as installed; nothing on a system without dpkg.
std::vector<std::string> missing_packages(const std::filesystem::path& list);

}  // namespace tumble::grading
