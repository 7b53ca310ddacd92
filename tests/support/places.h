#pragma once

#include <string>

// Where the tree that a test runs in lies. Functions, not macros of every compilation: a test's
// object is then the same in every tree, so that the released tree takes over what the main build
// has made (tests/release/shared_object.sh).
namespace tumble::test {

std::string source_dir();  // the tree's root
std::string binary_dir();  // its build folder

}  // namespace tumble::test
