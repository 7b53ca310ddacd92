// Text broken to a width, and when colours are written.
#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>

#include <gtest/gtest.h>

#include "framework/core/terminal.h"

namespace tumble {
namespace {

TEST(Wrapped, BreaksAtSpacesAndIndentsWhatGoesOn) {
  EXPECT_EQ(wrapped("one two three four", 9, 2), "one two\n  three\n  four");
}

TEST(Wrapped, KeepsLinesThatFitToTheLetter) {
  const std::string text = "  a   b\n\nc  d\n";
  EXPECT_EQ(wrapped(text, 7, 4), text);
}

TEST(Wrapped, KeepsTheMarginOfTheFirstLine) {
  EXPECT_EQ(wrapped("    word and more", 10, 4), "    word\n    and\n    more");
}

// A path can be longer than a line: to be copied it must stay whole.
TEST(Wrapped, KeepsALongWordWhole) {
  EXPECT_EQ(wrapped("see /a/very/long/path/of/a/file now", 10, 2),
            "see\n  /a/very/long/path/of/a/file\n  now");
}

// "µ" has two bytes and one column: six words of two letters and five spaces fit 17 columns.
TEST(Wrapped, CountsLettersNotBytes) {
  const std::string text = "µµ µµ µµ µµ µµ µµ";
  EXPECT_EQ(wrapped(text, 17, 0), text);
}

TEST(Wrapped, LosesNoWordAtAnyWidth) {
  const std::string text = "the quick brown fox  jumps\nover\n\nthe lazy dog";
  const auto without_space = [](std::string t) {
    std::erase_if(t, [](char c) { return c == ' ' || c == '\n'; });
    return t;
  };
  for (std::size_t columns = 1; columns < 40; ++columns)
    EXPECT_EQ(without_space(wrapped(text, columns, 2)), without_space(text)) << columns;
}

TEST(Colours, AreNotWrittenToAPipe) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  EXPECT_FALSE(shows_colours(ends[1]));
  EXPECT_EQ(terminal_columns(ends[1]), 80U);
  ::close(ends[0]);
  ::close(ends[1]);
}

class Terminal : public ::testing::Test {
 protected:
  void SetUp() override {
    leader_ = ::posix_openpt(O_RDWR | O_NOCTTY);
    ASSERT_GE(leader_, 0);
    ASSERT_EQ(::grantpt(leader_), 0);
    ASSERT_EQ(::unlockpt(leader_), 0);
    ::setenv("TERM", "xterm", 1);
    ::unsetenv("NO_COLOR");
  }
  void TearDown() override { ::close(leader_); }
  int leader_ = -1;
};

TEST_F(Terminal, HasColoursUnlessTheUserRefusesThem) {
  EXPECT_TRUE(shows_colours(leader_));
  ::setenv("NO_COLOR", "", 1);  // no-color.org: present and not empty
  EXPECT_TRUE(shows_colours(leader_));
  ::setenv("NO_COLOR", "1", 1);
  EXPECT_FALSE(shows_colours(leader_));
  ::unsetenv("NO_COLOR");
  ::setenv("TERM", "dumb", 1);
  EXPECT_FALSE(shows_colours(leader_));
}

TEST_F(Terminal, SaysItsWidth) {
  winsize size{};
  size.ws_col = 123;
  ASSERT_EQ(::ioctl(leader_, TIOCSWINSZ, &size), 0);
  EXPECT_EQ(terminal_columns(leader_), 123U);
  size.ws_col = 0;  // not known
  ASSERT_EQ(::ioctl(leader_, TIOCSWINSZ, &size), 0);
  EXPECT_EQ(terminal_columns(leader_), 80U);
}

}  // namespace
}  // namespace tumble
