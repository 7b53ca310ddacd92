// The processes that simulate: begun, listened to, replaced, lost.
#include "framework/live/session_parts.h"

#include <sstream>

#include <fmt/format.h>

namespace tumble::live {
namespace {

constexpr std::size_t kTalkKept = 1u << 14;  // bytes of what a process said

// Without the lines for the locator, and without the program's name.
std::string for_people(const std::string& talk) {
  std::istringstream lines(talk);
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("tumble: ")) line.erase(0, 8);
    const bool is_ours = line.starts_with("frame ") || line.starts_with("compiling ");
    if (!is_ours && !(text.empty() && line.empty())) text += line + "\n";
  }
  return text;
}

}  // namespace

void Session::begin(const std::string& reason, double from_s, const Recipe& recipe) {
  // The recipe may be the one of the run that is starting, which ends with the assignment.
  starting_ = std::make_unique<Simulator>(scene_.simulator, from_s, reason, recipe);
  starting_->child.say(dumped({{"recipe", as_text(starting_->recipe)},
                               {"from_s", from_s},
                               {"speed", speed_},
                               {"paused", true}}));
  tell({{"kind", "starting"}, {"reason", reason}});
  look_for_unsaved();
}

// Nobody looks: nothing is held, and nothing moves.
void Session::set_pace() {
  const bool is_watched = std::any_of(pages_.begin(), pages_.end(),
                                      [](const auto& page) { return !page->is_closed(); });
  if (!is_watched) forward(dumped({{"do", "release"}}));
  forward(dumped({{"do", "pace"}, {"speed", speed_}, {"paused", is_paused_ || !is_watched}}));
}

// The run that has started takes the place of the one before.
void Session::adopt(const std::string& head) {
  running_ = std::move(starting_);
  recipe_ = running_->recipe;
  reason_ = running_->reason;
  if (running_->from_s > 0) {
    current_.cut(running_->from_s);
  } else {
    if (current_.frames().size() > 1) {
      former_ = std::move(current_);
      former_has_ended_ = !end_.empty();
    }
    current_ = History(head);
    compared_until_ = 0.0;
  }
  compared_until_ = std::min(compared_until_, current_.end_s());
  has_difference_ = false;
  asked_.clear();
  difference_.clear();
  times_.clear();
  end_.clear();
  trouble_.clear();
  Json words = run_words();
  words["head"] = Json::parse(head);
  tell(words);
  set_pace();
  if (reason_ == "code") tell(scenes_words());  // a module may be written now
  judge_next();
}

void Session::listen_to(std::unique_ptr<Simulator>& simulator) {
  std::string bytes;
  const bool is_open = Child::read_some(simulator->child.output(), bytes);
  simulator->child.read_talk(simulator->talk);
  if (simulator->talk.size() > kTalkKept)
    simulator->talk.erase(0, simulator->talk.size() - kTalkKept);
  simulator->records.feed(bytes);
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
    if (!is_open && simulator && simulator.get() == before) {
      lost(*simulator);
      simulator.reset();
    }
  } catch (const std::exception& error) {
    trouble({{"title", "The process with your code is out of step"}, {"text", error.what()}});
    simulator.reset();
  }
}

void Session::hear_starting(Record record) {
  if (record.kind == RecordKind::kHead) {
    adopt(record.bytes);
    // what has come behind the head
    if (running_) listen_to(running_);
    return;
  }
  if (record.kind == RecordKind::kEnd) {  // before its first frame
    const std::string why = Json::parse(record.bytes).value("stopped_by", "");
    starting_->has_ended = true;
    trouble({{"title", "The run stopped"},
             {"text", why.empty() ? "it ended before its first frame" : why}});
    if (!why.empty()) locate(why);
    look_for_unsaved();
    judge_next();
    return;
  }
  if (record.kind != RecordKind::kRefused) return;
  Json refused = Json::parse(record.bytes);
  const std::string problem = refused.at("problem");
  const bool compiles = !problem.starts_with("does not compile");
  refused["title"] = !compiles                               ? "Does not compile"
                     : refused.value("not_attempted", false) ? "Not attempted"
                                                             : "The scene cannot begin";
  refused["text"] = problem;
  if (!compiles) refused["remedy"] = "";  // for the command line
  starting_->has_ended = true;
  trouble(refused);
  look_for_unsaved();
  if (compiles) judge_next();
}

void Session::hear(Simulator& from, Record record) {
  const bool was_full = current_.is_full();
  switch (record.kind) {
    case RecordKind::kHead: break;
    case RecordKind::kFrame:
      send(event_of(
          "f", frame_for_page(record.bytes,
                              current_.frames().empty() ? record.bytes : current_.frames().front(),
                              current_.origin_world())));
      current_.add_frame(std::move(record.bytes));
      break;
    case RecordKind::kEvent:
      send(event_of("e", event_for_page(record.bytes, current_.origin_world())));
      current_.add_event(std::move(record.bytes));
      break;
    case RecordKind::kAimed: {
      Json aimed = Json::parse(record.bytes);
      aimed["kind"] = "aimed";
      tell(aimed);
      break;
    }
    case RecordKind::kHand: hand_acted(record.bytes); break;
    case RecordKind::kTimes: {
      Json times = Json::parse(record.bytes);
      times["kind"] = "times";
      times_.push_back(dumped(times));
      send(event_of("say", times_.back()));
      break;
    }
    case RecordKind::kAsked: asked(record.bytes); break;
    case RecordKind::kEnd: {
      Json end = Json::parse(record.bytes);
      end["kind"] = "end";
      end_ = dumped(end);
      from.has_ended = true;
      send(event_of("say", end_));
      if (const std::string why = end.value("stopped_by", ""); !why.empty()) {
        trouble({{"title", "The run stopped"}, {"text", why}, {"ends_run", true}});
        locate(why);
      }
      break;
    }
    case RecordKind::kRefused: {
      Json refused = Json::parse(record.bytes);
      refused["title"] = refused.value("not_attempted", false) ? "Not attempted" : "Stopped";
      refused["text"] = refused.at("problem");
      refused["ends_run"] = true;
      from.has_ended = true;
      trouble(refused);
      break;
    }
  }
  if (current_.is_full() && !was_full)
    tell({{"kind", "limit"}, {"text", current_.limit_in_words()}});
}

// Its pipe has closed: it has said why, or something ended it.
void Session::lost(Simulator& simulator) {
  const int code = simulator.child.wait();
  simulator.child.read_talk(simulator.talk);
  if (simulator.has_ended) return;
  std::string said = for_people(simulator.talk);
  if (said.empty())
    said = code > 128 ? fmt::format("ended by signal {} ({})", code - 128, ::strsignal(code - 128))
                      : fmt::format("ended with code {}", code);
  trouble({{"title", said.find("out of time") != std::string::npos ? "Out of time" : "Crashed"},
           {"text", said},
           {"ends_run", &simulator == running_.get()}});
  locate(simulator.talk);
  if (&simulator == starting_.get()) judge_next();
}

// What the run has asked of the modules: said, and kept by scene.
void Session::asked(const std::string& modules) {
  const Json all = Json::parse(modules);
  asked_ = dumped({{"kind", "asked"}, {"scene", scene_.name}, {"modules", all}});
  send(event_of("say", asked_));
  Json& kept = asked_of_scenes_[scene_.name];
  for (const Json& module : all)
    for (const Json& function : module.at("functions"))
      if (function.at(1) > 0)
        kept[module.at("id").get<std::string>()][function.at(0).get<std::string>()] = true;
}

// In which line it was: comes when it has been found.
void Session::locate(const std::string& said) {
  if (scene_.locate.empty()) return;
  locator_ = std::make_unique<Child>(scene_.locate);
  locator_->say(said);
  locator_->close_input();
  place_.clear();
}

void Session::listen_to_locator() {
  std::string unused;
  locator_->read_talk(unused);
  if (Child::read_some(locator_->output(), place_)) return;
  locator_->wait();
  locator_.reset();
  while (place_.ends_with('\n')) place_.pop_back();
  if (place_.empty() || trouble_.empty()) return;
  Json what = Json::parse(trouble_);
  what["where"] = place_.substr(0, place_.find(": "));
  what["text"] = place_ + "\n" + what.value("text", "");
  trouble(what);
}

void Session::hand_acted(const std::string& text) {
  Json push = Json::parse(text);
  const bool runs_again = push.value("runs_again", false);
  push.erase("runs_again");
  if (!runs_again) {
    recipe_.pushes.push_back(dumped(push));
    tell({{"kind", "push"}, {"push", push}});
    if (!recipe_.document.empty()) tell_unsaved(true);
    return;
  }
  // The run that is shown goes on without the push: it belongs to the one that is begun. A second
  // push may come before that one has started.
  const bool is_starting = starting_ && !starting_->has_ended;
  if (is_starting && starting_->reason != "push") {
    tell({{"kind", "notice"}, {"text", "a new run is starting: push again when it goes"}});
    return;
  }
  Recipe pushed = wanted();
  pushed.pushes.push_back(dumped(push));
  const double start_s = push.at("start_s");
  tell({{"kind", "push"}, {"push", push}});
  begin("push", is_starting ? std::min(start_s, starting_->from_s) : start_s, pushed);
}

void Session::trouble(Json what) {
  what["kind"] = "trouble";
  trouble_ = dumped(what);
  send(event_of("say", trouble_));
}

}  // namespace tumble::live
