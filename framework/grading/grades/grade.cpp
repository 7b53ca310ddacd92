#include "framework/grading/grades/grade.h"

namespace tumble::grading {

void Grade::each_verdict(const std::function<void(const RubricItem&, Verdict)>& see) const {
  for (const ScoredTest& test : tests) see(test.item, test.result.verdict);
  for (std::size_t i = 0; i < marks.verdicts.size(); ++i)
    see(marks.items->at(i), marks.verdicts[i]);
}

std::size_t Grade::count(Verdict verdict) const {
  std::size_t n = 0;
  each_verdict([&](const RubricItem&, Verdict of_test) { n += of_test == verdict; });
  return n;
}

bool Grade::is_final() const {
  bool all_final = state != GradeState::kGraderFault && own_tests.is_final;
  each_verdict([&](const RubricItem&, Verdict verdict) {
    all_final = all_final && is_final_verdict(verdict);
  });
  return all_final;
}

}  // namespace tumble::grading
