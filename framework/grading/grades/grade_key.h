/// What a grade depends on, as digests.
#pragma once

#include "framework/grading/grades/grade.h"
#include "framework/grading/verdicts/rubric.h"

namespace tumble::grading {

/// Digest of what decides a verdict: the judge with its tests, the worker, the module's headers, the compiler.
std::string judging_digest(const Course& course, const std::string& id);
/// The same, with this program and the time that a submission may take.
std::string grader_digest(const Course& course, const std::string& id, double budget_s);
/// Digest of what a test is worth, and how it is named.
std::string rubric_digest(const Rubric& rubric);
/// Digest of the scenes and of how they are drawn; empty where no pictures are wanted.
std::string pictures_digest(const Course& course, const std::string& id, const GradeOptions& options);
std::string submission_digest(const Submission& submission);

/// A name for a folder below OUT: the submission's own where it is plain, else made plain with a digest that keeps it its own.
std::string folder_of(const std::string& name);

}  // namespace tumble::grading
