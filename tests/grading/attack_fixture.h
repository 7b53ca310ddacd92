/// Submissions that attack: compiled and run as a grader does, and what the judge makes of them.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>

#include "framework/grading/verdicts/call_log.h"
#include "framework/grading/compiler/compile.h"
#include "framework/grading/worker/worker_connection.h"
#include "tests/modules/waist.h"

namespace tumble::grading {

/// A source compiled in the sandbox against the test module's header. One that does not compile fails the test.
Compiled compile_source(const std::string& text, const std::filesystem::path& object, const CompileLimits& limits = {});
/// The file of this folder's attacks/, its text preceded by `defines`; compiled once a program.
std::filesystem::path attack_object(const std::string& file, const std::string& defines = "");
/// Processes below this one, however they came there, after those that are ending have had a second to end.
int descendants_left();

/// A worker with an attack in it, with limits small enough for a test.
class Victim {
 public:
  explicit Victim(const std::filesystem::path& object);
  /// What the function said. Empty where it did not answer; then verdict() and story() tell.
  std::string attack(const std::string& what);

  Verdict verdict() const { return call_log().noted ? call_log().verdict : Verdict::kRight; }
  std::string story() const { return call_log().story; }
  const waist::Module& module() const { return module_; }
  WorkerConnection& connection() { return connection_; }

 private:
  WorkerConnection connection_;
  waist::Module module_;
};

/// Skips where the machine has no sandbox; makes orphans our own, so that descendants_left sees them.
class Attack : public ::testing::Test {
 protected:
  void SetUp() override;
};

}  // namespace tumble::grading
