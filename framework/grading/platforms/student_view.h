/// What a student may see of a grade. Every format of a platform is made from this and from nothing
/// else: what is not in it reaches no platform.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "framework/grading/grades/grade.h"

namespace tumble::grading {

/// A public test.
struct ShownTest {
  std::string test, title, level;  // "Suite.Name"; both may hold any characters
  double score = 0.0, possible = 0.0;
  Verdict verdict = Verdict::kGraderFault;
  std::string text;  // the verdict, then its story
};

/// A hidden test: neither name, title, level nor story. Its number is its place in the rubric.
struct HiddenTest {
  double score = 0.0, possible = 0.0;
};

struct StudentView {
  std::string assignment;  // "a1"
  std::string title;       // of the assignment
  GradeState state = GradeState::kJudged;
  std::string said;  // about the whole submission: the compiler's errors, notes; plain text
  std::vector<ShownTest> tests;
  std::vector<HiddenTest> hidden;
  double score = 0.0, possible = 0.0;
  std::string sandbox;
  bool is_official = true;
};

/// A submission without a file gets 0 points here, with the reason: on a platform its author sees
/// that at once and hands in again.
/// @pre  grade.is_final(): a fault of the grader has no view, because its words may hold anything
StudentView student_view(const std::string& assignment, const std::string& title,
                         const Grade& grade);

/// Of the hidden tests together: points, and how many are passed.
struct HiddenSum {
  std::size_t count = 0, passed = 0;
  double score = 0.0, possible = 0.0;
  std::string text;  // "8 of 12 passed. Names and details of hidden tests are not shown."
};
HiddenSum sum_of_hidden(const StudentView& view);

/// The whole grade in words, with every story, also of hidden tests: for the instructor alone.
std::string instructors_story(const Grade& grade);

}  // namespace tumble::grading
