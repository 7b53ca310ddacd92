/// The first test of a function, before its author has worked out what is right: it calls the
/// function with some values, and no answer passes.
#pragma once

#include <string>

#include "framework/extend/declarations.h"

namespace tumble::extend {

/// The names that the test's file has for things.
struct FirstTest {
  std::string module;     // "student()"
  std::string expected;   // a constant that nothing is near
  std::string tolerance;  // "kRoundoff"
  std::string handout;    // "equation(1)"
  std::string scene;      // what the author is to write of it
};

/// The body of the test, one statement or two.
std::string first_test(const Function& function, const FirstTest& test);

/// Arguments to begin with: "1.0, Vector3d(1, 2, 3)".
std::string first_arguments(const Function& function);

/// An answer that is nothing, for slips: "0", "Vector3d::Zero()", "{}".
std::string zero_of(const std::string& type);

}  // namespace tumble::extend
