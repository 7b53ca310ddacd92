/// What a student's own tests earned, as plain data.
#pragma once

#include <string>

namespace tumble::grading {

inline constexpr const char* kOwnTestsTitle = "Your own tests (extra points)";

struct OwnTestsGrade {
  bool is_there = false;  // the submission has such a file and the rubric a rule
  bool is_final = true;   // false: the grader failed, or the machine was too busy
  double score = 0.0, possible = 0.0;
  std::string story;  // for the student: of each test whether it caught a slip
  std::string names;  // for the grader only: each slip, and which tests caught it
};

}  // namespace tumble::grading
