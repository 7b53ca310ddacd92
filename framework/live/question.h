/// A process that is asked once, and answers by what it has printed when it ends.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/live/child.h"

namespace tumble::live {

class Question {
 public:
  struct Answer {
    std::string text, talk;  // standard output and error
  };
  /// Begins, in place of what was asked before. @param words  of the program
  void ask(const std::vector<std::string>& words, const std::string& about = "");
  void drop() { child_.reset(); }
  /// That has not answered; null: there is none.
  const Child* child() const { return child_.get(); }
  /// Reads what has come. @return the answer, once
  std::optional<Answer> listen();

 private:
  std::unique_ptr<Child> child_;
  Answer answer_;
};

}  // namespace tumble::live
