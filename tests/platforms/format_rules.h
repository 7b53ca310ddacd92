/// The rules of the formats that platforms read, as far as a file can be checked against them. Used
/// by unit tests, and by validate_platforms on what an autograder wrote in a container.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace tumble::grading {

/// What breaks a rule, a sentence each; empty: nothing does.
using Faults = std::vector<std::string>;

/// results.json: gradescope/autograder_samples, docs/specs.md (May 2023).
Faults faults_of_gradescope(const std::string& text);
/// Gradescope shows no total as soon as one test is hidden from the student.
bool student_sees_total(const std::string& text);

/// JUnit's XML as testmoapp/junitxml lists it and Artemis reads it: well-formed XML 1.0, known
/// elements in their places, names, unique test cases, counts that are those of the elements.
Faults faults_of_junit(const std::string& text);
/// customFeedbacks/*.json: ls1intum/Artemis, docs/user/exercises/programming.rst.
Faults faults_of_custom_feedback(const std::map<std::string, std::string>& files);

/// base64 of version 1: classroom-resources/autograding-io-grader, src/main.js.
Faults faults_of_github_classroom(const std::string& text);

/// autolab/Autolab, docs/lab.md; and that no line but the last has scores.
Faults faults_of_autolab(const std::string& text);

std::string decoded(const std::string& base64);
std::string last_line(const std::string& text);

}  // namespace tumble::grading
