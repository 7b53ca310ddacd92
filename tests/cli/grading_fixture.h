/// The grader on the command line: folders of submissions made by the test, and the grader's
/// output.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/places.h"
#include "framework/core/files.h"
#include "framework/core/run_program.h"

namespace tumble::grading {

namespace fs = std::filesystem;

inline const fs::path kProgram = fs::path(test::binary_dir()) / "bin/tumble";
inline const fs::path kStub =
    fs::path(test::source_dir()) / "assignments/a1_impulse/a1_impulse.cpp";
inline const fs::path kReference =
    fs::path(test::source_dir()) / "solutions_private/a1_impulse/a1_impulse.cpp";

inline std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A stub whose ray test has a body instead of the throw.
inline std::string stub_that(const std::string& does) {
  std::string text = text_of(kStub);
  const auto at = text.find("throw NotImplemented(");
  return text.insert(at, does + "\n  ");
}

inline bool says(const ProgramOutcome& outcome, const std::string& words) {
  return outcome.printed.find(words) != std::string::npos;
}

/// Begins a program whose words go to no terminal.
inline pid_t start_words(const std::vector<std::string>& words) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  const int nothing = ::open("/dev/null", O_RDWR);
  ::dup2(nothing, 1);
  ::dup2(nothing, 2);
  ::execv(argv[0], argv.data());
  ::_exit(127);
}

/// Submissions in, in/NAME/..., and results in out. The test has a machine key of its own.
class Grading : public ::testing::Test {
 protected:
  Grading() {
    ::setenv("TUMBLE_ROOT", test::source_dir().c_str(), 1);
    ::setenv("TUMBLE_GRADER_KEY", (root / "grader.key").c_str(), 1);
  }
  void put(const std::string& file, const std::string& text) const {
    write_whole(root / "in" / file, text);
  }
  std::vector<std::string> words_for(const std::string& out,
                                     const std::vector<std::string>& more) const {
    std::vector<std::string> words = {kProgram.string(),      "grade", id,
                                      (root / "in").string(), "--out", (root / out).string()};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  ProgramOutcome grade(const std::string& out,
                       const std::vector<std::string>& more = {"--no-media"}) const {
    return run_program(words_for(out, more), Output::kCaptured, 580.0);
  }
  nlohmann::json results(const std::string& name, const std::string& out = "out") const {
    return nlohmann::json::parse(text_of(root / out / name / "results.json"));
  }
  /// The entries of the ledger.
  std::vector<nlohmann::json> ledger(const std::string& out = "out") const {
    std::vector<nlohmann::json> entries;
    std::ifstream in(root / out / "ledger.jsonl");
    for (std::string line; std::getline(in, line);) entries.push_back(nlohmann::json::parse(line));
    return entries;
  }
  ProgramOutcome tumble(std::vector<std::string> words) const {
    words.insert(words.begin(), kProgram.string());
    return run_program(words, Output::kCaptured, 580.0);
  }
  /// Every file except times, by its path below root.
  std::map<std::string, std::string> files(const std::string& out) const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(root / out))
      if (entry.is_regular_file() && entry.path().filename() != "times.json")
        all[entry.path().lexically_relative(root / out).string()] = text_of(entry.path());
    return all;
  }
  PrivateFolder scratch_;
  fs::path root = scratch_.path();
  std::string id = "a1";
};

// The assignment's rubrics and headers, to be changed; everything else is the tree's.
class OtherRubric : public Grading {
 protected:
  OtherRubric() {
    fs::create_directories(course);
    fs::copy(fs::path(test::source_dir()) / "assignments", course / "assignments",
             fs::copy_options::recursive);
    fs::create_directory_symlink(fs::path(test::source_dir()) / "framework", course / "framework");
    fs::create_directories(course / "tests");
    fs::create_directory_symlink(fs::path(test::source_dir()) / "tests/truths",
                                 course / "tests/truths");
    const fs::path hidden = "solutions_private/a1_impulse/rubric_hidden.json";
    fs::create_directories((course / hidden).parent_path());
    fs::copy_file(fs::path(test::source_dir()) / hidden, course / hidden);
    ::setenv("TUMBLE_ROOT", course.c_str(), 1);
  }
  fs::path rubric() const { return course / "assignments/a1_impulse/rubric.json"; }
  nlohmann::ordered_json read() const { return nlohmann::ordered_json::parse(text_of(rubric())); }
  void write(const nlohmann::ordered_json& json) const { write_whole(rubric(), json.dump(1)); }
  const fs::path course = root / "course";
};

}  // namespace tumble::grading
