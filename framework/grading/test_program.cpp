#include "framework/grading/test_program.h"

#include <gtest/gtest.h>

namespace tumble::grading {

int run_tests(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}

}  // namespace tumble::grading
