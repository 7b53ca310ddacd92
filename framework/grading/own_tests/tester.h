/// main() of a program with a student's own tests: its module is at the other end of the channel.
///
/// The program is wholly the student's, and runs in the sandbox. It holds no solution: each call of
/// a function crosses to the relay (relay.h), and from there to another sandbox. So what it can
/// learn of a solution are the answers to its own questions. It reports each of its tests; a false
/// report says no more than a test that fails.
#pragma once

#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "framework/core/not_implemented.h"
#include "framework/grading/sandbox/sandbox_wire.h"
#include "framework/modules/connection.h"
#include "framework/modules/under_test.h"

namespace tumble::grading {

/// What is reported of a test, as it travels.
enum class TestReport : std::uint8_t { kBegins, kPassed, kFailed };

/// Calls that cross to the relay. Times and sizes are limited there.
class TesterConnection final : public modules::Connection {
 public:
  modules::Channel& begin_call(const char*) override { return channel_; }
  bool count_callback() override { return true; }
  modules::Channel::Clock::time_point deadline() const override {
    return modules::Channel::Clock::time_point::max();
  }
  [[noreturn]] void fail(const char*, std::exception_ptr) override { std::_Exit(1); }
  [[noreturn]] void refuse(const char* function, const std::string& what) override {
    throw std::runtime_error(std::string(function) + ' ' + what);
  }
  [[noreturn]] void not_implemented(const char* function, const std::string& handout) override {
    throw NotImplemented(function, handout);
  }
  [[noreturn]] void wrong_size(const char*, const std::string& story) override {
    throw modules::WrongSize(story);
  }
  /// @param number  of the call that carries reports: the one after the module's functions
  void report(std::uint32_t number, const std::string& test, TestReport what,
              const std::string& said) {
    modules::Writer writer;
    writer.value(number);
    writer.value(test);
    writer.value(what);
    writer.value(said);
    channel_.send(modules::MessageKind::kCall, writer.bytes);
    channel_.receive();
  }

 private:
  modules::Channel channel_{modules::Channel::End::kAsks, kChannelFd, kChannelFd};
};

/// Reports each test of this program.
class TestReporter : public ::testing::EmptyTestEventListener {
 public:
  TestReporter(TesterConnection& connection, std::uint32_t number)
      : connection_(connection), number_(number) {}
  void OnTestStart(const ::testing::TestInfo& test) override {
    connection_.report(number_, name_of(test), TestReport::kBegins, "");
  }
  void OnTestEnd(const ::testing::TestInfo& test) override {
    const ::testing::TestResult& result = *test.result();
    std::string said;
    for (int i = 0; i < result.total_part_count() && said.empty(); ++i) {
      const ::testing::TestPartResult& part = result.GetTestPartResult(i);
      if (!part.failed()) continue;
      const std::string file = part.file_name() == nullptr ? "" : part.file_name();
      said = file.substr(file.rfind('/') + 1) +
             (part.line_number() > 0 ? ":" + std::to_string(part.line_number()) + ": " : "") +
             part.message();
    }
    connection_.report(number_, name_of(test),
                       result.Failed() ? TestReport::kFailed : TestReport::kPassed,
                       said.substr(0, 4000));
  }

 private:
  static std::string name_of(const ::testing::TestInfo& test) {
    return std::string(test.test_suite_name()) + '.' + test.name();
  }
  TesterConnection& connection_;
  std::uint32_t number_;
};

/// Command line: PROGRAM FIRST. The tests before number FIRST have run already.
template <class Module>
int run_tester(int argc, char** argv) {
  const long first = argc > 1 ? std::stol(argv[1]) : 0;
  int none = 1;
  ::testing::InitGoogleTest(&none, argv);
  static TesterConnection connection;
  static Module module = modules::make_proxy<Module>(connection);
  modules::UnderTest<Module>::table = &module;
  std::uint32_t functions = 0;
  Module::visit(module, [&](const char*, const auto&) { ++functions; });
  const ::testing::UnitTest& all = *::testing::UnitTest::GetInstance();
  std::string chosen;
  long number = 0;
  for (int s = 0; s < all.total_test_suite_count(); ++s)
    for (int t = 0; t < all.GetTestSuite(s)->total_test_count(); ++t)
      if (number++ >= first)
        chosen += (chosen.empty() ? "" : ":") + std::string(all.GetTestSuite(s)->name()) + '.' +
                  all.GetTestSuite(s)->GetTestInfo(t)->name();
  if (chosen.empty()) return 0;
  ::testing::GTEST_FLAG(filter) = chosen;
  auto& listeners = ::testing::UnitTest::GetInstance()->listeners();
  delete listeners.Release(listeners.default_result_printer());
  listeners.Append(new TestReporter(connection, functions));
  return RUN_ALL_TESTS();
}

}  // namespace tumble::grading
