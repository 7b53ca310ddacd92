/// Runs a student's own tests against a module: two sandboxes and this process between them.
///
///   tests (sandbox)  <- channel ->  relay (this process)  <- channel ->  module (sandbox)
///
/// The relay reads each call from the tests with the checks of the wire format (modules/wire.h) and
/// asks it of the module as a judge does. Neither side sees the other's memory, files or bytes.
/// What leaks to the tests, by design: the module's answers, and the time that they take.
#pragma once

#include <functional>
#include <string>

#include "framework/grading/own_tests/tester.h"
#include "framework/grading/worker/worker_connection.h"
#include "framework/modules/serve.h"

namespace tumble::grading {

/// Takes a report from its bytes.
using TakeReport = std::function<void(modules::Reader&)>;

/// Answers calls from `tests` by the module behind `connection`, until the tests close the channel.
using Relay = std::function<void(modules::Connection& connection, modules::Channel& tests,
                                 const TakeReport& report)>;

/// Command line of a relay:
///   own_tests_a1 --tests PROGRAM --submission FILE.so [--json FILE] [--quick]
/// PROGRAM is what compile_submission made of a file of tests. --quick: a student waits, so calls
/// have the short limits of `check`.
/// @return exit code: as that of a check program
int run_relay_program(const char* id, const Relay& relay, int argc, char** argv);

template <class Module>
void relay_calls(modules::Connection& connection, modules::Channel& tests,
                 const TakeReport& report) {
  const Module module = modules::make_proxy<Module>(connection);
  modules::detail::Server server{tests, {}};
  Module::visit(module, [&](const char*, const auto& field) {
    server.functions.push_back(modules::detail::served(server, field));
  });
  server.functions.push_back([&](modules::Reader& reader) {
    report(reader);
    return modules::Bytes{};
  });
  try {
    for (;;) server.answer(tests.receive());
  } catch (const modules::ChannelClosed&) {
    return;
  } catch (const modules::WireError&) {
    return;  // no message of a tester: its test does not end, and so does not pass
  }
}

template <class Module>
int run_relay(int argc, char** argv) {
  return run_relay_program(Module::kId, relay_calls<Module>, argc, argv);
}

}  // namespace tumble::grading
