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

TEST(WholeFiles, ALinkStaysAndWhatItPointsToIsWritten) {
  const PrivateFolder folder;
  const fs::path inner = folder.path() / "inner";
  fs::create_directory(inner);
  write_whole(inner / "old.txt", "old");
  for (const char* name : {"old.txt", "new.txt"}) {  // the second link points to nothing yet
    const fs::path link = folder.path() / (std::string("link_") + name);
    fs::create_symlink(fs::path("inner") / name, link);
    expect_writable(link);
    write_whole(link, "bytes");
    EXPECT_TRUE(fs::is_symlink(link)) << name;
    EXPECT_EQ(text_of(inner / name), "bytes");
  }
  fs::create_symlink("loop", folder.path() / "loop");
  EXPECT_NE(refusal([&] { write_whole(folder.path() / "loop", "bytes"); }), "");
}

TEST(WholeFiles, APipeWithANameStaysAndGetsTheBytes) {
  const PrivateFolder folder;
  const fs::path pipe = folder.path() / "pipe.txt";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  expect_writable(pipe);
  std::string got;
  std::thread reader([&] { got = text_of(pipe); });
  write_whole(pipe, "bytes");
  reader.join();
  EXPECT_EQ(got, "bytes");
  EXPECT_TRUE(fs::is_fifo(pipe));
}

TEST(WholeFiles, ADescriptorOfAPipeGetsTheBytes) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  write_whole("/dev/fd/" + std::to_string(ends[1]), "bytes");
  ::close(ends[1]);
  std::string got(10, '\0');
  got.resize(static_cast<std::size_t>(std::max<ssize_t>(0, ::read(ends[0], got.data(), 10))));
  ::close(ends[0]);
  EXPECT_EQ(got, "bytes");
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
