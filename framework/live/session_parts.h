/// What a sitting keeps, and who does what in it. Included by session*.cpp only.
#pragma once

#include <unistd.h>
#include <sys/eventfd.h>

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "framework/core/save_watch.h"
#include "framework/live/child.h"
#include "framework/live/history.h"
#include "framework/live/mailbox.h"
#include "framework/live/records.h"
#include "framework/live/server.h"
#include "framework/live/sitting.h"

namespace tumble::live {

using Json = nlohmann::ordered_json;

/// In one line; bytes that are no UTF-8 are replaced.
std::string dumped(const Json& json);

/// A process that simulates, and what has come from it.
struct Simulator {
  Simulator(const std::vector<std::string>& words, double from, std::string why, Recipe what)
      : child(words), from_s(from), reason(std::move(why)), recipe(std::move(what)) {}
  Child child;
  RecordReader records;
  std::string talk;  // on its standard error
  double from_s;
  std::string reason;      // "begin", "code", "change", "back", "push"
  Recipe recipe;           // that it was begun with
  bool has_ended = false;  // it has said how
};

/// In parts: pages, runs, verdicts, and the loop, each in a file named session_*.cpp.
class Session {
 public:
  Session(const Sitting& sitting, SaveWatch& saves)
      : sitting_(sitting),
        saves_(saves),
        scene_(sitting),
        recipe_(sitting.recipe),
        saved_recipe_(as_text(recipe_)) {
    wake_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  }
  ~Session() { ::close(wake_); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  ServerHooks hooks();
  /// @param stop  a descriptor that becomes readable when all is to end
  void run(int stop);
  void close_pages();
  Left left() const;

 private:
  // From threads of the server.
  std::shared_ptr<Mailbox> open_stream();
  void post(const std::string& json);
  std::optional<Served> file(const std::string& path) const;

  // In the thread of run().
  void take_posts();
  void greet(Mailbox& page);
  void choose_scene(const std::string& name);
  Json scene_words() const;
  Json scenes_words() const;
  void look_for_unsaved();
  void tell_unsaved(bool is_unsaved);
  void tell(const Json& what) { send(event_of("say", dumped(what))); }
  void send(std::string text);
  void obey(const std::string& text);
  void forward(const std::string& line);
  void begin(const std::string& reason, double from_s, const Recipe& recipe);
  /// Of the run that is starting, else of the one that is shown: what a change adds to.
  const Recipe& wanted() const {
    return starting_ && !starting_->has_ended ? starting_->recipe : recipe_;
  }
  void adopt(const std::string& head);
  void set_pace();
  void listen_to(std::unique_ptr<Simulator>& simulator);
  void hear(Simulator& from, Record record);
  void hear_starting(Record record);
  void lost(Simulator& simulator);
  void hand_acted(const std::string& text);
  void asked(const std::string& modules);
  void trouble(Json what);
  void locate(const std::string& said);
  void listen_to_locator();
  void judge(const std::string& id);
  void judge_next();
  void listen_to_judge();
  void compare();
  void save();
  void check_saved();
  void code_saved(const std::set<std::filesystem::path>& files);
  Json run_words() const;

  const Sitting& sitting_;
  SaveWatch& saves_;
  int wake_;
  mutable std::mutex mutex_;  // guards the two below
  std::vector<std::string> posts_;
  std::vector<std::shared_ptr<Mailbox>> new_pages_;

  std::vector<std::shared_ptr<Mailbox>> pages_;
  SceneStart scene_;  // that is shown
  // What was done to scenes that were left for another one, by name.
  struct LeftScene {
    Recipe recipe;
    std::string saved_recipe;
  };
  std::map<std::string, LeftScene> left_scenes_;
  std::map<std::string, Json> asked_of_scenes_;  // ids and functions, as far as runs have shown
  bool is_unsaved_ = false;                      // as it was told last
  Recipe recipe_;                                // of the run that is shown, with what a hand did
  std::string saved_recipe_;                   // as it was when it was last saved, or at the start
  std::vector<std::filesystem::path> scenes_;  // saved
  std::vector<std::string> pushes_of_former_;
  double speed_ = 1.0;
  bool is_paused_ = false;
  std::unique_ptr<Simulator> running_, starting_;
  History current_, former_;
  bool former_has_ended_ = false;  // and has not been replaced while it went
  double compared_until_ = 0.0;
  bool has_difference_ = false;
  std::chrono::steady_clock::time_point compared_at_ = std::chrono::steady_clock::now();
  std::string reason_ = "begin";
  // Said again to pages that are opened later: JSON; empty: nothing.
  std::string trouble_, difference_, end_, saved_, asked_;
  std::map<std::string, std::string> verdicts_;  // by id
  std::vector<std::string> times_;
  std::unique_ptr<Child> judge_;
  std::string judging_, judge_text_, judge_talk_;
  std::set<std::string> to_judge_;  // ids
  std::unique_ptr<Child> locator_;
  std::string place_;                    // that it has found
  std::unique_ptr<Simulator> checking_;  // whether a saved scene runs again byte for byte
  std::vector<std::string> expected_;    // its frames, which may be begun anew meanwhile
  std::size_t frames_checked_ = 0;
  std::string checked_file_, first_wrong_;
};

}  // namespace tumble::live
