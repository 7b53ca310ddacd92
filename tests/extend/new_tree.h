/// A small tree in which new parts of a course are made, with this tree's templates.
#pragma once

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>

#include "tests/support/places.h"
#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/extend/new_assignment.h"

namespace tumble::testing {

namespace fs = std::filesystem;

inline constexpr const char* kTwoFunctions =
    "// The mean of two numbers.\n"
    "// eq: m = (a + b) / 2\n"
    "double mean_of(double a, double b);\n"
    "\n"
    "// The larger part of a vector.\n"
    "Vector3d larger_part(const Vector3d& arm_world);\n";

class NewTree {
 public:
  NewTree() {
    fs::create_directories(root() / "framework/extend");
    fs::copy(fs::path(test::source_dir()) / "framework/extend/templates",
             root() / "framework/extend/templates", fs::copy_options::recursive);
    // what is written is formatted where clang-format is there: as in a whole tree
    fs::copy_file(fs::path(test::source_dir()) / ".clang-format", root() / ".clang-format");
    for (const char* room : {"assignments", "solutions_private", "tests/effects", "handouts",
                             "framework/effects/water"})
      fs::create_directories(root() / room);
  }
  const fs::path& root() const { return folder_.path(); }

  fs::path functions(const std::string& text = kTwoFunctions) const {
    write_whole(root() / "functions.h", text);
    return root() / "functions.h";
  }
  void make_a5() const { extend::new_assignment(root(), "a5", "trial", functions()); }

  /// Every file but the templates, with its text.
  std::map<std::string, std::string> files() const {
    std::map<std::string, std::string> found;
    for (const auto& entry : fs::recursive_directory_iterator(root())) {
      const std::string name = entry.path().lexically_relative(root()).string();
      if (entry.is_regular_file() && !name.starts_with("framework/extend"))
        found[name] = text_of(entry.path());
    }
    return found;
  }
  void replace(const std::string& file, const std::string& from, const std::string& to) const {
    std::string text = text_of(root() / file);
    const std::size_t at = text.find(from);
    require(at != std::string::npos, file + " does not hold: " + from);
    write_whole(root() / file, text.replace(at, from.size(), to));
  }

 private:
  PrivateFolder folder_;
};

/// "file:line" of the first line that holds these words.
inline std::string place_of(const NewTree& tree, const std::string& file,
                            const std::string& words) {
  const std::string text = text_of(tree.root() / file);
  const std::size_t at = text.find(words);
  require(at != std::string::npos, file + " does not hold: " + words);
  return file + ":" +
         std::to_string(
             1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

/// What a call throws: "file:line: problem. remedy"; empty where it throws nothing.
template <class Call>
std::string refusal_of(const Call& call) {
  try {
    call();
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

}  // namespace tumble::testing
