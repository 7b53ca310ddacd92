/// The submissions of one grading, each with what is known of it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "framework/grading/grades/grade_files.h"

namespace tumble::grading {

struct GradedWork {
  const Submission* submission = nullptr;
  std::string folder;
  GradeKey key;
  EarlierRun earlier;
  GradeRecord record;        // the final one
  bool is_settled = false;   // `record` is final and lies in place
  bool is_left_out = false;  // not asked for, and without an earlier result
  std::vector<std::string> remarks;
  double seconds = 0.0;  // that it took, now
};

using Notice = std::function<void(const std::string& sentence)>;

/// By submission, the name of its folder of results. Names are unique, but a student may have two
/// flat files: each gets its own folder.
std::vector<std::string> folders_for(const std::vector<Submission>& submissions);

/// Identical files under two names get a remark, which students do not see because it names others.
void remark_equal_files(std::vector<GradedWork>& all);

/// Two submissions of one name, for example a folder and a flat file: two rows of one student, of
/// which a gradebook keeps the last. They get a remark and a notice.
void report_doubles(std::vector<GradedWork>& all, const Notice& notice);

/// A notice for each of the first earlier results that are not reused, with the reason.
void report_distrusted(const std::vector<GradedWork>& all, const Notice& notice);

}  // namespace tumble::grading
