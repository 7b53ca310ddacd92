// A chain survives being written and read, bit for bit; what is torn is refused.
#include "framework/sampling/kept_chain.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "framework/core/error.h"

namespace tumble::sampling {
namespace {

Chain two_steps() {
  Chain chain;
  chain.number = 4;
  chain.accepted = 1;
  chain.simulations = 7;
  chain.broken = 2;
  chain.x = MatrixXd(2, 3);
  // 0.1 + 0.2 needs 17 digits, 2^-1074 is the least double.
  chain.x << 0.1 + 0.2, -0.0, 0x1p-1074, 1.0 / 3.0, -1e300, 5.0;
  chain.log_target = Eigen::Vector2d(-std::numeric_limits<double>::infinity(), -1.5);
  chain.violation = Eigen::Vector2d(std::numeric_limits<double>::quiet_NaN(), 0.0);
  chain.cpu_s = Eigen::Vector2d(0.25, 0.75);
  return chain;
}

TEST(KeptChain, IsTheChain) {
  const Chain chain = two_steps(), read = chain_of(text_of(chain));
  EXPECT_EQ(read.number, 4);
  EXPECT_EQ(read.accepted, 1);
  EXPECT_EQ(read.simulations, 7);
  EXPECT_EQ(read.broken, 2);
  EXPECT_EQ(read.x, chain.x);
  EXPECT_TRUE(std::signbit(read.x(0, 1)));
  EXPECT_EQ(read.log_target, chain.log_target);
  EXPECT_TRUE(std::isnan(read.violation[0]));
  EXPECT_EQ(read.violation[1], 0.0);
  EXPECT_EQ(read.cpu_s, chain.cpu_s);
}

TEST(KeptChain, ThatEndsInTheMiddleIsRefused) {
  const std::string text = text_of(two_steps());
  for (const std::size_t length : {std::size_t{0}, std::size_t{9}, text.size() - 6})
    EXPECT_THROW(chain_of(text.substr(0, length)), UserError) << length;
}

TEST(KeptChain, GivesATableOfItsSamplesWithoutTimes) {
  const std::string table = csv_of({"a, \"b\"", "c", "d"}, {two_steps()});
  EXPECT_EQ(table.substr(0, table.find('\n')),
            "chain,step,\"a, \"\"b\"\"\",\"c\",\"d\",log_target,violation");
  Chain slower = two_steps();
  slower.cpu_s *= 2.0;
  EXPECT_EQ(csv_of({"a, \"b\"", "c", "d"}, {slower}), table);
}

}  // namespace
}  // namespace tumble::sampling
