/// Verdicts on assignments: processes that judge, one after the other, and what they have found.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "framework/live/pages.h"
#include "framework/live/question.h"

namespace tumble::live {

class Verdicts {
 public:
  using Judge = std::function<std::vector<std::string>(const std::string& id)>;
  /// @param judge  the program for an assignment; empty: nothing is judged
  Verdicts(const Judge& judge, Pages& pages) : judge_of_(judge), pages_(pages) {}

  /// Judges at once, in place of what is being judged.
  void judge(const std::string& id);
  /// It is judged when its turn comes.
  void wait(const std::string& id) { waiting_.insert(id); }
  /// Its code was saved: what is being judged is of the code before, and waits, too.
  void judge_anew(const std::string& id);
  /// Begins the next one that waits, where none is being judged: two builds at once would be in
  /// each other's way.
  void go_on();
  const Child* child() const { return judgement_.child(); }
  /// @return whether a verdict has come
  bool listen();
  /// What was told of verdicts, for a page that opens: JSON.
  std::vector<std::string> told() const;

 private:
  const Judge& judge_of_;
  Pages& pages_;
  Question judgement_;
  std::string judging_;                      // id
  std::set<std::string> waiting_;            // ids
  std::map<std::string, std::string> told_;  // by id
};

}  // namespace tumble::live
