// Files that are written whole: what may stand at their place.
#include "framework/core/files.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "framework/core/error.h"

namespace tumble {
namespace {

namespace fs = std::filesystem;

std::string refusal(const std::function<void()>& work) {
  try {
    work();
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

TEST(WholeFiles, ALinkIsReplacedAndAFileBehindOneIsFoundForWhoNamesIt) {
  const PrivateFolder folder;
  const fs::path inner = folder.path() / "inner";
  fs::create_directory(inner);
  write_whole(inner / "old.txt", "old");
  for (const char* name : {"old.txt", "new.txt"}) {  // the second link points to nothing yet
    const fs::path link = folder.path() / (std::string("link_") + name);
    fs::create_symlink(fs::path("inner") / name, link);
    EXPECT_EQ(behind_links(link), folder.path() / "inner" / name);
    write_whole(behind_links(link), "bytes");
    EXPECT_TRUE(fs::is_symlink(link)) << name;
    EXPECT_EQ(text_of(inner / name), "bytes");
    write_whole(link, "others");
    EXPECT_FALSE(fs::is_symlink(link)) << name;
    EXPECT_EQ(text_of(inner / name), "bytes") << "what it pointed to may be another's";
  }
  fs::create_symlink("loop", folder.path() / "loop");
  EXPECT_NE(refusal([&] { behind_links(folder.path() / "loop"); }), "");
}

TEST(WholeFiles, APipeStaysAndIsRefused) {
  const PrivateFolder folder;
  const fs::path pipe = folder.path() / "pipe.txt", link = folder.path() / "link.txt";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  fs::create_symlink("pipe.txt", link);
  for (const fs::path& place : {pipe, link, fs::path("/dev/null")}) {
    EXPECT_NE(refusal([&] { expect_writable(place); }), "") << place;
    EXPECT_NE(refusal([&] { write_whole(place, "bytes"); }), "") << place;
  }
  EXPECT_TRUE(fs::is_fifo(pipe));
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST(WholeFiles, WhatCannotBeWrittenIsRefusedBeforeTheWork) {
  const PrivateFolder folder;
  const fs::path plain = folder.path() / "plain.txt";
  write_whole(plain, "old");
  fs::create_directory(folder.path() / "inner");
  for (const auto& [file, reason] : {std::pair{folder.path() / "inner", "it is a folder"},
                                     {plain / "below.txt", "is no folder"},
                                     {plain / "deep" / "below.txt", "is no folder"}}) {
    const std::string refused = refusal([&, &place = file] { expect_writable(place); });
    EXPECT_NE(refused.find(reason), std::string::npos) << refused;
    bool has_worked = false;
    EXPECT_NE(refusal([&, &place = file] {
                make_whole(place, [&](const fs::path&) { has_worked = true; });
              }),
              "");
    EXPECT_FALSE(has_worked) << file;
  }
  EXPECT_EQ(refusal([&] { expect_writable(folder.path() / "new" / "deep" / "file.txt"); }), "");
  EXPECT_FALSE(fs::exists(folder.path() / "new")) << "nothing is made";
}

}  // namespace
}  // namespace tumble
