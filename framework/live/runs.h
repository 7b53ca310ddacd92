/// The processes that simulate: the one whose run is shown, and the one that is to take its place;
/// begun, paced, acted on, listened to, replaced, lost.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "framework/live/former_run.h"
#include "framework/live/pages.h"
#include "framework/live/question.h"
#include "framework/live/scenes.h"
#include "framework/live/shown_run.h"
#include "framework/live/simulator.h"

namespace tumble::live {

class Runs {
 public:
  /// @param settled  called when a run has begun or cannot begin, and its code has been built
  Runs(Pages& pages, Scenes& scenes, ShownRun& shown, FormerRun& former,
       std::function<void()> settled)
      : pages_(pages),
        scenes_(scenes),
        shown_(shown),
        former_(former),
        settled_(std::move(settled)) {}

  /// Begins a run of the shown scene, which is shown from its first record on.
  void begin(const std::string& reason, double from_s, const Recipe& recipe);
  /// Ends all; what begins next is not paused.
  void stop();
  bool is_starting() const { return starting_ && !starting_->has_ended; }
  /// Why a run is starting, "code" also while code is compiled for another reason; empty: none is.
  std::string starting_reason() const {
    return !is_starting() ? "" : starting_->is_told_to_compile ? "code" : starting_->reason;
  }
  /// Of the run that is starting, else of the one that is shown: what a change adds to.
  const Recipe& wanted() const { return is_starting() ? starting_->recipe : shown_.recipe(); }

  double speed() const { return speed_; }
  bool is_paused() const { return is_paused_; }
  /// @throws UserError for a speed that there is not
  void set_pace(double speed, bool is_paused);
  /// Tells the run its pace. Nobody looks: nothing is held, and nothing moves.
  void keep_pace();
  /// @param command  of simulate.h
  void act(const Json& command);

  std::vector<const Child*> children() const;
  void listen();

 private:
  void listen_to(std::unique_ptr<Simulator>& simulator);
  void hear(Simulator& from, Record record);
  void hear_starting(Record record);
  void adopt(const std::string& head);
  void end_former(Json& trouble);
  void add_push(const std::string& text);
  void find_place(const std::string& said);

  Pages& pages_;
  Scenes& scenes_;
  ShownRun& shown_;
  FormerRun& former_;
  std::function<void()> settled_;
  std::unique_ptr<Simulator> running_, starting_;
  std::vector<std::string> missed_;  // pushes since code was saved whose run has not begun yet
  Question place_;                   // of a bad end in the user's file
  double speed_ = 1.0;
  bool is_paused_ = false;
};

}  // namespace tumble::live
