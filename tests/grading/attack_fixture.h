/// Submissions that attack the grader, compiled and run as by a grader, and the judge's verdicts on
/// them.
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

/// A source compiled in the sandbox against the test module's header. One that does not compile
/// fails the test.
Compiled compile_source(const std::string& text, const std::filesystem::path& object,
                        const CompileLimits& limits = {});
/// A file of solutions_private/attacks/calls, with `defines` before its text; compiled once per
/// program.
std::filesystem::path attack_object(const std::string& file, const std::string& defines = "");
/// Number of descendants of this process, after a second in which ending ones may end.
int descendants_left();

/// A worker that runs an attack, with limits small enough for a test.
class Victim {
 public:
  explicit Victim(const std::filesystem::path& object);
  /// The answer of the function. Empty if it did not answer; then see verdict() and story().
  std::string attack(const std::string& what);

  Verdict verdict() const { return call_log().noted ? call_log().verdict : Verdict::kRight; }
  std::string story() const { return call_log().story; }
  const waist::Module& module() const { return module_; }
  WorkerConnection& connection() { return connection_; }

 private:
  WorkerConnection connection_;
  waist::Module module_;
};

/// Skips on machines without a sandbox; adopts orphans, so that descendants_left counts them.
class Attack : public ::testing::Test {
 protected:
  void SetUp() override;
};

}  // namespace tumble::grading
