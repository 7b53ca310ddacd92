#include "framework/grading/grades/stages.h"

#include <exception>

namespace tumble::grading {

void note_failed_stage(Grade& grade, const std::string& what, const std::string& why) {
  grade.notes.push_back("the grader failed behind the verdicts, at " + what +
                        ": that is missing here; verdicts and points stand");
  grade.faults.push_back(what + ": " + why);
}

bool run_stage(Grade& grade, const std::string& what, const std::function<void()>& stage) {
  try {
    stage();
    return true;
  } catch (const std::exception& error) {
    note_failed_stage(grade, what, error.what());
    return false;
  }
}

}  // namespace tumble::grading
