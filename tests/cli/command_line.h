/// The program on the command line: a command in an empty folder, and its output.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/places.h"

#include <gtest/gtest.h>

namespace tumble::testing {

namespace fs = std::filesystem;

inline std::string contents_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

struct Said {
  int code;
  std::string out, err;
};

/// Runs commands in an empty folder, which is deleted after the test.
class CommandLine : public ::testing::Test {
 protected:
  CommandLine()
      : folder_(fs::temp_directory_path() / ("tumble words " + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~CommandLine() override { fs::remove_all(folder_); }

  Said type(const std::string& words) const {
    const fs::path out = folder_.string() + ".out", err = folder_.string() + ".err";
    const int status =
        std::system(("cd '" + folder_.string() + "' && TUMBLE_ROOT='" + test::source_dir() + "' '" +
                     test::binary_dir() + "/bin/tumble' " + words + " >'" + out.string() + "' 2>'" +
                     err.string() + "'")
                        .c_str());
    Said said{WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents_of(out), contents_of(err)};
    fs::remove(out);
    fs::remove(err);
    return said;
  }
  bool left_nothing() const { return fs::is_empty(folder_); }

  fs::path folder_;
};

inline bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace tumble::testing
