/// The run that pages show: its frames and events, and what was said of it. Pages are told as it
/// comes, and a page that opens later is told all of it.
#pragma once

#include <string>
#include <vector>

#include "framework/live/former_run.h"
#include "framework/live/history.h"
#include "framework/live/pages.h"
#include "framework/live/simulator.h"

namespace tumble::live {

class ShownRun {
 public:
  ShownRun(const Recipe& recipe, Pages& pages) : pages_(pages), recipe_(recipe) {}

  const History& history() const { return history_; }
  const Recipe& recipe() const { return recipe_; }  // with what a hand has done in the run
  bool has_ended() const { return !end_.empty(); }

  /// Another scene is shown, whose run has not begun.
  void clear(const Recipe& recipe);
  /// A run that has begun takes the place of this one, which goes to `former`; or it goes on from
  /// an instant of this one.
  /// @param head  its first record
  void begin(const Simulator& run, const std::string& head, FormerRun& former);
  void add_push(const std::string& push) { recipe_.pushes.push_back(push); }
  /// Anything it says but of pushes and of modules. @return why it has stopped; empty: it goes on
  std::string hear(Record record);

  // Told, and told again to pages that are opened later.
  void tell_asked(const Json& modules) { asked_ = pages_.tell(modules); }
  void tell_trouble(Json what);
  /// @param place  "FILE:LINE: its text" of the trouble that was told last; empty: not found
  void tell_place(std::string place);

  /// To a page that opens: the run.
  void greet(Mailbox& page, const FormerRun& former) const;
  // What was told last: JSON; empty: nothing.
  const std::string& trouble() const { return trouble_; }
  const std::string& asked() const { return asked_; }
  const std::string& end() const { return end_; }

 private:
  void forget_told();
  Json words(const FormerRun& former) const;

  Pages& pages_;
  Recipe recipe_;
  std::string reason_ = "begin";
  History history_;
  std::string trouble_, asked_, end_;
  std::vector<std::string> times_;  // local virtual times, JSON
};

}  // namespace tumble::live
