// The borders of UTF-8 are those of Unicode 15, table 3-7.
#include "framework/core/utf8.h"

#include <string>

#include <gtest/gtest.h>

namespace tumble::utf8_test {
namespace {

TEST(Utf8, EachLengthBeginsAndEndsWhereTheTableSays) {
  const struct {
    const char* bytes;
    std::uint32_t code;
  } known[] = {{"\x7f", 0x7f},
               {"\xc2\x80", 0x80},
               {"\xdf\xbf", 0x7ff},
               {"\xe0\xa0\x80", 0x800},
               {"\xed\x9f\xbf", 0xd7ff},
               {"\xee\x80\x80", 0xe000},
               {"\xef\xbf\xbf", 0xffff},
               {"\xf0\x90\x80\x80", 0x10000},
               {"\xf4\x8f\xbf\xbf", 0x10ffff}};
  for (const auto& [bytes, code] : known) {
    const std::string text = std::string("a") + bytes + "b";
    const Character c = character_at(text, 1);
    EXPECT_TRUE(c.is_valid) << std::hex << code;
    EXPECT_EQ(c.code, code);
    EXPECT_EQ(c.length, text.size() - 2) << std::hex << code;
    EXPECT_FALSE(first_that_is_no_utf8(text)) << std::hex << code;
  }
}

TEST(Utf8, WhatIsNoneIsOneByteLong) {
  for (const char* bytes : {
           "\x80",              // goes on with nothing
           "\xc3",              // ends within a character
           "\xc0\xaf",          // overlong: '/' in two bytes
           "\xe0\x9f\xbf",      // overlong in three
           "\xf0\x8f\xbf\xbf",  // overlong in four
           "\xed\xa0\x80",      // a surrogate
           "\xf4\x90\x80\x80",  // above U+10FFFF
           "\xe9t\xe9",         // Latin-1
           "\xff",
       }) {
    const std::string text = std::string("ab") + bytes;
    const Character c = character_at(text, 2);
    EXPECT_FALSE(c.is_valid) << bytes;
    EXPECT_EQ(c.length, 1u) << bytes;
    EXPECT_EQ(first_that_is_no_utf8(text), 2u) << bytes;
  }
}

TEST(Utf8, BytesThatNoTextHasAreNamed) {
  EXPECT_FALSE(why_no_text("plain \xc3\xa9\n"));
  const auto archive = why_no_text(std::string_view("PK\x03\x04\x00", 5));
  ASSERT_TRUE(archive);
  EXPECT_NE(archive->problem.find("NUL at byte 4"), std::string::npos) << archive->problem;
  EXPECT_TRUE(why_no_text("\xfe\xff"));
}

}  // namespace
}  // namespace tumble::utf8_test
