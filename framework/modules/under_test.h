/// How a test reaches its module, without knowing which of the three implementations it has.
///
/// The same object file of a test is linked into the student's program (the table is the student's
/// linked functions) and into the judge (the table is a proxy to a sandboxed worker).
#pragma once

#include "framework/core/error.h"

namespace tumble::modules {

template <class Module>
struct UnderTest {
  inline static const Module* table = nullptr;
};

/// The module under test. For use inside a test: the program sets it before the first test runs.
template <class Module>
const Module& under_test() {
  require(UnderTest<Module>::table != nullptr,
          "no module is under test: the program's main must set one");
  return *UnderTest<Module>::table;
}

}  // namespace tumble::modules
