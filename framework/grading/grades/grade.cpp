#include "framework/grading/grades/grade.h"

#include <algorithm>

namespace tumble::grading {

bool Grade::is_final() const {
  return state != GradeState::kGraderFault &&
         std::none_of(tests.begin(), tests.end(),
                      [](const ScoredTest& t) { return !is_final_verdict(t.result.verdict); });
}

}  // namespace tumble::grading
