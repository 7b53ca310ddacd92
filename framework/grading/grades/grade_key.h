/// Digests of everything that a grade depends on.
#pragma once

#include "framework/grading/grades/grade.h"
#include "framework/grading/verdicts/rubric.h"

namespace tumble::grading {

/// Digest of everything that decides a verdict: the judge with its tests, the worker, the module's
/// headers, the compiler, its flags, and what is compiled once for all submissions.
std::string judging_digest(const Course& course, const std::string& id);
/// The same with this program and a submission's time budget.
std::string grader_digest(const Course& course, const std::string& id, double budget_s);
/// Digest of the points and titles of the tests.
std::string rubric_digest(const Rubric& rubric);
/// Digest of the scenes and of the options of their pictures; empty without pictures.
std::string pictures_digest(const Course& course, const std::string& id,
                            const GradeOptions& options);
std::string submission_digest(const Submission& submission);

/// Name of a submission's folder below OUT: its own name if that is plain, else a plain form with a
/// digest that makes it unique.
std::string folder_of(const std::string& name);

}  // namespace tumble::grading
