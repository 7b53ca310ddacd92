#include "framework/live/runs.h"

#include <algorithm>

#include "framework/core/error.h"

namespace tumble::live {

void Runs::begin(const std::string& reason, double from_s, const Recipe& recipe) {
  // The recipe may be the one of the run that is starting, which ends with the assignment.
  missed_.clear();
  starting_ = std::make_unique<Simulator>(scenes_.shown().simulator, from_s, reason, recipe);
  starting_->start(speed_, true);
  pages_.tell({{"kind", "starting"}, {"reason", reason}});
  scenes_.look_for_unsaved(wanted());
}

void Runs::stop() {
  missed_.clear();
  running_.reset();
  starting_.reset();
  place_.drop();
  is_paused_ = false;
}

void Runs::set_pace(double speed, bool is_paused) {
  if (!(speed > 0 && speed <= 1000)) throw UserError("speed", "must be from 0 to 1000", "");
  speed_ = speed;
  is_paused_ = is_paused;
  keep_pace();
  pages_.tell({{"kind", "pace"}, {"speed", speed_}, {"paused", is_paused_}});
}

void Runs::keep_pace() {
  const bool is_watched = pages_.are_watched();
  if (!is_watched) act({{"do", "release"}});
  act({{"do", "pace"}, {"speed", speed_}, {"paused", is_paused_ || !is_watched}});
}

void Runs::act(const Json& command) {
  const bool is_over = running_ ? running_->has_ended : !starting_;
  if (is_over && (command.at("do") == "aim" || command.at("do") == "push"))
    pages_.tell({{"kind", "notice"},
                 {"text", "the run has ended: start over, or go back to an earlier instant"}});
  if (running_ && !running_->has_ended) running_->child.say(dumped(command));
}

std::vector<const Child*> Runs::children() const {
  std::vector<const Child*> children = {place_.child()};
  for (const Simulator* simulator : {running_.get(), starting_.get()})
    if (simulator != nullptr) children.push_back(&simulator->child);
  return children;
}

void Runs::listen() {
  if (running_) listen_to(running_);
  if (starting_) listen_to(starting_);
  if (const auto place = place_.listen()) shown_.tell_place(place->text);
}

void Runs::listen_to(std::unique_ptr<Simulator>& simulator) {
  const bool is_open = simulator->read();
  if (simulator == starting_ && !starting_->is_told_to_compile &&
      starting_->talk.find("compiling ") != std::string::npos) {
    starting_->is_told_to_compile = true;
    pages_.tell({{"kind", "starting"}, {"reason", "code"}});
  }
  try {
    // What a record leads to may put another process in this one's place.
    const Simulator* const before = simulator.get();
    while (simulator && simulator.get() == before) {
      auto record = simulator->records.next();
      if (!record) break;
      if (&simulator == &starting_)
        hear_starting(std::move(*record));
      else
        hear(*simulator, std::move(*record));
    }
    if (is_open || !simulator || simulator.get() != before) return;
    if (auto loss = simulator->loss()) {
      (*loss)["ends_run"] = true;
      if (simulator == starting_)
        end_former(*loss);
      else if (!shown_.asked().empty())
        shown_.tell_asked(scenes_.asked(
            dumped(simulator->asked_at_loss(Json::parse(shown_.asked()).at("modules")))));
      shown_.tell_trouble(*loss);
      find_place(simulator->talk);
      if (simulator == starting_) settled_();
    }
    simulator.reset();
  } catch (const std::exception& error) {
    Json trouble{{"title", "The process with your code is out of step"},
                 {"text", error.what()},
                 {"ends_run", true}};
    if (simulator == starting_) end_former(trouble);
    shown_.tell_trouble(trouble);
    simulator.reset();
  }
}

void Runs::hear_starting(Record record) {
  if (record.kind == RecordKind::kHead && !missed_.empty()) {
    // What a hand did while the code was compiled belongs to its run, too. The code is built: the
    // same run with all of it is there at once.
    Recipe recipe = starting_->recipe;
    recipe.pushes.insert(recipe.pushes.end(), missed_.begin(), missed_.end());
    begin("code", 0.0, recipe);
    return;
  }
  if (record.kind == RecordKind::kHead) {
    adopt(record.bytes);
    if (running_) listen_to(running_);  // what has come behind the head
    return;
  }
  if (record.kind != RecordKind::kEnd && record.kind != RecordKind::kRefused) return;
  starting_->has_ended = true;
  const bool is_of_save = starting_->reason == "code";
  Json said = Json::parse(record.bytes);
  bool compiles = true;
  if (record.kind == RecordKind::kEnd) {  // before its first frame
    const std::string why = said.value("stopped_by", "");
    Json trouble{{"title", "The run stopped"},
                 {"text", why.empty() ? "it ended before its first frame" : why}};
    if (is_of_save) end_former(trouble);
    shown_.tell_trouble(trouble);
    if (!why.empty()) find_place(why);
  } else {
    const std::string problem = said.at("problem");
    compiles = !problem.starts_with("does not compile");
    said["title"] = !compiles                            ? "Does not compile"
                    : said.value("not_attempted", false) ? "Not attempted"
                                                         : "The scene cannot begin";
    said["text"] = problem;
    if (!compiles) {
      said["text"] = problem.substr(std::min(problem.find('\n') + 1, problem.size()));
      said["remedy"] = "";  // for the command line
    }
    if (is_of_save && compiles) end_former(said);
    if (is_of_save) said["shows_former"] = true;
    shown_.tell_trouble(said);
  }
  scenes_.look_for_unsaved(wanted());
  if (compiles) settled_();
}

// The code of the run that is shown is no more: its clock must not go on under the words of what
// has become of the new one.
void Runs::end_former(Json& trouble) {
  running_.reset();
  trouble["ends_run"] = true;
  trouble["shows_former"] = true;
}

// The run that has started takes the place of the one before.
void Runs::adopt(const std::string& head) {
  running_ = std::move(starting_);
  shown_.begin(*running_, head, former_);
  keep_pace();
  if (running_->reason == "code") pages_.tell(scenes_.offered_words());  // may be written now
  settled_();
}

void Runs::hear(Simulator& from, Record record) {
  if (record.kind == RecordKind::kHand) return add_push(record.bytes);
  if (record.kind == RecordKind::kAsked) return shown_.tell_asked(scenes_.asked(record.bytes));
  if (record.kind == RecordKind::kEnd || record.kind == RecordKind::kRefused) from.has_ended = true;
  const std::string stopped_by = shown_.hear(std::move(record));
  if (!stopped_by.empty()) find_place(stopped_by);
}

void Runs::find_place(const std::string& said) {
  const std::vector<std::string>& words = scenes_.shown().locate;
  if (!words.empty()) place_.ask(words, said);
}

// A hand has acted: the run goes on with it, or runs again until then.
void Runs::add_push(const std::string& text) {
  Json push = Json::parse(text);
  const bool runs_again = push.value("runs_again", false);
  push.erase("runs_again");
  if (!runs_again) {
    shown_.add_push(dumped(push));
    pages_.tell({{"kind", "push"}, {"push", push}});
    scenes_.touched();
    if (is_starting() && starting_->reason == "code") missed_.push_back(dumped(push));
    return;
  }
  // The run that is shown goes on without the push: it belongs to the one that is begun. A second
  // push may come before that one has started.
  if (is_starting() && starting_->reason != "push") {
    pages_.tell({{"kind", "notice"}, {"text", "a new run is starting: push again when it goes"}});
    return;
  }
  Recipe pushed = wanted();
  pushed.pushes.push_back(dumped(push));
  const double start_s = push.at("start_s");
  pages_.tell({{"kind", "push"}, {"push", push}});
  begin("push", is_starting() ? std::min(start_s, starting_->from_s) : start_s, pushed);
}

}  // namespace tumble::live
