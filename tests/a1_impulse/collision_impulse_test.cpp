#include <gtest/gtest.h>

#include "assignments/a1_impulse/a1_impulse.h"
#include "framework/modules/under_test.h"
#include "tests/support/story.h"

namespace tumble::testing {
namespace {

const a1::Module& a1_() { return modules::under_test<a1::Module>(); }

TEST(Placeholder, IsReplaced) { EXPECT_TRUE(a1_().collision_impulse); }

}  // namespace
}  // namespace tumble::testing
