/// A process that simulates one run, and what has come from it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/live/child.h"
#include "framework/live/pages.h"
#include "framework/live/recipe.h"
#include "framework/live/records.h"

namespace tumble::live {

struct Simulator {
  /// @param words  of the program
  Simulator(const std::vector<std::string>& words, double from, std::string why, Recipe what)
      : child(words), from_s(from), reason(std::move(why)), recipe(std::move(what)) {}
  /// Hands over what it simulates.
  void start(double speed, bool is_paused);
  /// Reads what has come, into `records` and `talk`. @return false at its end
  bool read();
  /// Its pipe has closed: what ended it, for people; nothing where it has said so itself.
  std::optional<Json> loss();
  /// After a loss: what it had asked of the modules, to its last call.
  /// @param asked  JSON of simulate.h, as it was told last
  /// @return the same with the counts of the end
  Json asked_at_loss(Json asked) const;

  Child child;
  RecordReader records;
  std::string talk;  // on its standard error: the end of it
  double from_s;
  std::string reason;      // "begin", "code", "change", "back", "push", "scene", "check"
  Recipe recipe;           // that it was begun with
  bool has_ended = false;  // it has said how
  bool is_told_to_compile = false;
};

}  // namespace tumble::live
