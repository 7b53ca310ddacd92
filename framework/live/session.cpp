#include "framework/live/session.h"

#include <poll.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/save_watch.h"
#include "framework/live/child.h"
#include "framework/live/history.h"
#include "framework/live/mailbox.h"
#include "framework/live/page_files.h"
#include "framework/live/records.h"
#include "framework/live/server.h"
#include "framework/report/player_parts.h"

namespace tumble::live {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostPages = 8;
constexpr double kComparesEvery = 0.4;       // s
constexpr std::size_t kTalkKept = 1u << 14;  // bytes of what a process said

std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

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

/// A process that simulates, and what has come from it.
struct Simulator {
  Simulator(const std::vector<std::string>& words, double from, std::string why)
      : child(words), from_s(from), reason(std::move(why)) {}
  Child child;
  RecordReader records;
  std::string talk;  // on its standard error
  double from_s;
  std::string reason;      // "begin", "code", "change", "back", "push"
  bool has_ended = false;  // it has said how
};

class Session {
 public:
  Session(const Sitting& sitting, SaveWatch& saves)
      : sitting_(sitting), saves_(saves), recipe_(sitting.recipe) {
    wake_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  }
  ~Session() { ::close(wake_); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  ServerHooks hooks();
  /// @param stop  a descriptor that becomes readable when all is to end
  void run(int stop);
  void close_pages();

 private:
  // From threads of the server.
  std::shared_ptr<Mailbox> open_stream();
  void post(const std::string& json);
  std::optional<Served> file(const std::string& path) const;

  // In the thread of run().
  void take_posts();
  void greet(Mailbox& page);
  void tell(const Json& what) { send(event_of("say", dumped(what))); }
  void send(std::string text);
  void obey(const std::string& text);
  void forward(const std::string& line);
  void begin(const std::string& reason, double from_s);
  void adopt(const std::string& head);
  void set_pace();
  void listen_to(std::unique_ptr<Simulator>& simulator);
  void hear(Simulator& from, Record record);
  void hear_starting(Record record);
  void lost(Simulator& simulator);
  void hand_acted(const std::string& text);
  void trouble(Json what);
  void locate(const std::string& said);
  void listen_to_locator();
  void judge(const std::string& id);
  void listen_to_judge();
  void compare();
  void save();
  void check_saved();
  void code_saved(const std::set<fs::path>& files);
  Json run_words() const;

  const Sitting& sitting_;
  SaveWatch& saves_;
  int wake_;
  mutable std::mutex mutex_;  // guards the two below
  std::vector<std::string> posts_;
  std::vector<std::shared_ptr<Mailbox>> new_pages_;

  std::vector<std::shared_ptr<Mailbox>> pages_;
  Recipe recipe_;
  std::vector<std::string> pushes_of_former_;
  double speed_ = 1.0;
  bool is_paused_ = false;
  std::unique_ptr<Simulator> running_, starting_;
  History current_, former_;
  double compared_until_ = 0.0;
  bool has_difference_ = false;
  Clock::time_point compared_at_ = Clock::now();
  std::string reason_ = "begin";
  // Said again to pages that are opened later: JSON; empty: nothing.
  std::string trouble_, verdicts_, difference_, end_, saved_;
  std::vector<std::string> times_;
  std::unique_ptr<Child> judge_;
  std::string judging_, judge_text_, judge_talk_, to_judge_;
  std::unique_ptr<Child> locator_;
  std::string place_;                    // that it has found
  std::unique_ptr<Simulator> checking_;  // whether a saved scene runs again byte for byte
  std::size_t frames_checked_ = 0, frames_to_check_ = 0;
  std::string checked_file_, first_wrong_;
};

// ---- From threads of the server ----------------------------------------------------------------

ServerHooks Session::hooks() {
  return {[this] { return open_stream(); }, [this](const std::string& json) { post(json); },
          [this](const std::string& path) { return file(path); }};
}

std::shared_ptr<Mailbox> Session::open_stream() {
  const std::lock_guard lock(mutex_);
  const auto open = [](const auto& pages) {
    return static_cast<std::size_t>(std::count_if(
        pages.begin(), pages.end(), [](const auto& page) { return !page->is_closed(); }));
  };
  if (open(pages_) + open(new_pages_) >= kMostPages) return nullptr;
  new_pages_.push_back(std::make_shared<Mailbox>());
  ::eventfd_write(wake_, 1);
  return new_pages_.back();
}

void Session::post(const std::string& json) {
  const std::lock_guard lock(mutex_);
  posts_.push_back(json);
  ::eventfd_write(wake_, 1);
}

std::optional<Served> Session::file(const std::string& path) const {
  if (path.empty()) return Served{"text/html; charset=utf-8", std::string(page_file("live.html"))};
  if (path == "three.js") return Served{"text/javascript", report::three_js()};
  if (path == "live.css") return Served{"text/css", std::string(page_file("live.css"))};
  if (path == "live.js") {
    // One script: parts of the player's page, then those of this page.
    std::string text = "'use strict';\n(() => {\n";
    for (const char* part : {"model.js", "shapes.js", "marks.js", "pick.js", "stage.js", "plot.js"})
      text += std::string(report::player_source(part)) + "\n";
    for (const char* part :
         {"live_run.js", "live_stage.js", "live_curves.js", "live_panes.js", "live_main.js"})
      text += std::string(page_file(part)) + "\n";
    return Served{"text/javascript; charset=utf-8", text + "})();\n"};
  }
  if (path.starts_with("handouts/") && sitting_.handout)
    if (const std::string text = sitting_.handout(path.substr(9)); !text.empty())
      return Served{
          path.ends_with(".html") ? "text/html; charset=utf-8" : "text/plain; charset=utf-8", text,
          "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri "
          "'none'; form-action 'none'; frame-ancestors 'none'"};
  return std::nullopt;
}

// ---- Pages -------------------------------------------------------------------------------------

void Session::take_posts() {
  eventfd_t unused = 0;
  ::eventfd_read(wake_, &unused);
  std::vector<std::string> posts;
  std::vector<std::shared_ptr<Mailbox>> pages;
  {
    const std::lock_guard lock(mutex_);
    posts.swap(posts_);
    pages.swap(new_pages_);
    std::erase_if(pages_, [](const auto& page) { return page->is_closed(); });
    pages_.insert(pages_.end(), pages.begin(), pages.end());
  }
  for (const auto& page : pages) greet(*page);
  if (!pages.empty()) set_pace();
  for (const std::string& text : posts) {
    try {
      obey(text);
    } catch (const UserError& error) {
      tell({{"kind", "notice"}, {"text", error.what()}});
    } catch (const nlohmann::json::exception&) {
      tell({{"kind", "notice"}, {"text", "the page asked for something that is not understood"}});
    }
  }
}

Json Session::run_words() const {
  Json words{{"kind", "run"},
             {"reason", reason_},
             {"head", Json::parse(current_.head())},
             {"has_former", !former_.frames().empty()}};
  const Changes& changes = recipe_.changes;
  words["changes"] = {{"engine", changes.engine}, {"method", changes.method}};
  if (changes.restitution) words["changes"]["restitution"] = *changes.restitution;
  if (changes.friction) words["changes"]["friction"] = *changes.friction;
  words["pushes"] = Json::array();
  for (const std::string& push : recipe_.pushes) words["pushes"].push_back(Json::parse(push));
  return words;
}

void Session::greet(Mailbox& page) {
  const auto put = [&](std::string text) {
    page.put(std::make_shared<const std::string>(std::move(text)));
  };
  put(event_of("say", dumped({{"kind", "hello"},
                              {"name", sitting_.name},
                              {"can_save", !sitting_.recipe.document.empty()},
                              {"speed", speed_},
                              {"paused", is_paused_}})));
  if (!current_.head().empty()) {
    Json words = run_words();
    words["head"]["from_s"] = 0.0;
    put(event_of("say", dumped(words)));
    for (const std::string& frame : current_.frames())
      put(event_of("f", numbers_for_page(frame, current_.frames().front())));
    for (const std::string& event : current_.events())
      put(event_of("e", numbers_for_page(event, "")));
  }
  for (const std::string& text : times_) put(event_of("say", text));
  for (const std::string* text : {&trouble_, &verdicts_, &difference_, &end_, &saved_})
    if (!text->empty()) put(event_of("say", *text));
}

void Session::send(std::string text) {
  const auto shared = std::make_shared<const std::string>(std::move(text));
  const std::lock_guard lock(mutex_);
  for (const auto& page : pages_) page->put(shared);
}

void Session::close_pages() {
  const std::lock_guard lock(mutex_);
  for (const auto* list : {&pages_, &new_pages_})
    for (const auto& page : *list) page->close();
}

void Session::obey(const std::string& text) {
  const Json command = Json::parse(text);
  const std::string what = command.at("do");
  if (what == "pace") {
    const double speed = command.at("speed");
    if (!(speed > 0 && speed <= 1000)) throw UserError("speed", "must be from 0 to 1000", "");
    speed_ = speed;
    is_paused_ = command.at("paused");
    set_pace();
    tell({{"kind", "pace"}, {"speed", speed_}, {"paused", is_paused_}});
  } else if (what == "step" || what == "aim" || what == "push" || what == "pull" ||
             what == "release") {
    forward(dumped(command));
  } else if (what == "begin") {  // over again, with the pushes or without them
    if (!command.value("keep", false)) recipe_.pushes.clear();
    begin("begin", 0.0);
  } else if (what == "back") {  // goes on from an instant that was
    const double time_s = command.at("time_s");
    if (!(time_s >= 0)) throw UserError("time", "must not be negative", "");
    recipe_.pushes = before(recipe_.pushes, time_s);
    begin("back", time_s);
  } else if (what == "change") {
    Recipe changed = recipe_;
    change(changed.changes, dumped(command.at("changes")));
    if (!command.value("keep", false)) changed.pushes.clear();
    if (!changed.document.empty()) document_of(changed);  // throws where it cannot be done
    recipe_ = changed;
    begin("change", 0.0);
  } else if (what == "judge") {
    judge(command.value("id", sitting_.first_judged));
  } else if (what == "save") {
    save();
  } else {
    throw UserError(what, "is nothing that the page can ask for", "");
  }
}

void Session::forward(const std::string& line) {
  if (running_ && !running_->has_ended) running_->child.say(line);
}

// ---- The process that simulates ----------------------------------------------------------------

void Session::begin(const std::string& reason, double from_s) {
  starting_ = std::make_unique<Simulator>(sitting_.simulator, from_s, reason);
  starting_->child.say(dumped(
      {{"recipe", as_text(recipe_)}, {"from_s", from_s}, {"speed", speed_}, {"paused", true}}));
  tell({{"kind", "starting"}, {"reason", reason}});
}

// Nobody looks: nothing moves.
void Session::set_pace() {
  const bool is_watched = std::any_of(pages_.begin(), pages_.end(),
                                      [](const auto& page) { return !page->is_closed(); });
  forward(dumped({{"do", "pace"}, {"speed", speed_}, {"paused", is_paused_ || !is_watched}}));
}

// The run that has started takes the place of the one before.
void Session::adopt(const std::string& head) {
  running_ = std::move(starting_);
  reason_ = running_->reason;
  if (running_->from_s > 0) {
    current_.cut(running_->from_s);
  } else {
    if (current_.frames().size() > 1) former_ = std::move(current_);
    current_ = History(head);
    compared_until_ = 0.0;
  }
  compared_until_ = std::min(compared_until_, current_.end_s());
  has_difference_ = false;
  difference_.clear();
  times_.clear();
  end_.clear();
  trouble_.clear();
  Json words = run_words();
  words["head"] = Json::parse(head);
  tell(words);
  set_pace();
  if (!to_judge_.empty()) judge(std::exchange(to_judge_, ""));
}

void Session::listen_to(std::unique_ptr<Simulator>& simulator) {
  std::string bytes;
  const bool is_open = Child::read_some(simulator->child.output(), bytes);
  Child::read_some(simulator->child.talk(), simulator->talk);
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
  if (record.kind != RecordKind::kRefused) return;
  Json refused = Json::parse(record.bytes);
  const std::string problem = refused.at("problem");
  refused["title"] = problem.starts_with("does not compile") ? "Does not compile"
                     : refused.value("not_attempted", false) ? "Not attempted"
                                                             : "The scene cannot begin";
  refused["text"] = problem;
  starting_->has_ended = true;
  trouble(refused);
}

void Session::hear(Simulator& from, Record record) {
  switch (record.kind) {
    case RecordKind::kHead: break;
    case RecordKind::kFrame:
      send(event_of("f", numbers_for_page(record.bytes, current_.frames().empty()
                                                            ? record.bytes
                                                            : current_.frames().front())));
      current_.add_frame(std::move(record.bytes));
      break;
    case RecordKind::kEvent:
      send(event_of("e", numbers_for_page(record.bytes, "")));
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
    case RecordKind::kEnd: {
      Json end = Json::parse(record.bytes);
      end["kind"] = "end";
      end_ = dumped(end);
      from.has_ended = true;
      send(event_of("say", end_));
      if (const std::string why = end.value("stopped_by", ""); !why.empty()) {
        trouble({{"title", "The run stopped"}, {"text", why}});
        locate(why);
      }
      break;
    }
    case RecordKind::kRefused: {
      Json refused = Json::parse(record.bytes);
      refused["title"] = refused.value("not_attempted", false) ? "Not attempted" : "Stopped";
      refused["text"] = refused.at("problem");
      from.has_ended = true;
      trouble(refused);
      break;
    }
  }
}

// Its pipe has closed: it has said why, or something ended it.
void Session::lost(Simulator& simulator) {
  const int code = simulator.child.wait();
  Child::read_some(simulator.child.talk(), simulator.talk);
  if (simulator.has_ended) return;
  std::string said = for_people(simulator.talk);
  if (said.empty())
    said = code > 128 ? fmt::format("ended by signal {} ({})", code - 128, ::strsignal(code - 128))
                      : fmt::format("ended with code {}", code);
  trouble({{"title", said.find("out of time") != std::string::npos ? "Out of time" : "Crashed"},
           {"text", said}});
  locate(simulator.talk);
}

// In which line it was: comes when it has been found.
void Session::locate(const std::string& said) {
  if (sitting_.locate.empty()) return;
  locator_ = std::make_unique<Child>(sitting_.locate);
  locator_->say(said);
  locator_->close_input();
  place_.clear();
}

void Session::listen_to_locator() {
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
  recipe_.pushes.push_back(dumped(push));
  tell({{"kind", "push"}, {"push", push}});
  if (runs_again) begin("push", push.at("start_s"));
}

void Session::trouble(Json what) {
  what["kind"] = "trouble";
  trouble_ = dumped(what);
  send(event_of("say", trouble_));
}

// ---- Verdicts, differences, saved scenes -------------------------------------------------------

void Session::judge(const std::string& id) {
  if (!sitting_.judge || id.empty()) return;
  judge_ = std::make_unique<Child>(sitting_.judge(id));
  judge_->close_input();
  judging_ = id;
  judge_text_.clear();
  judge_talk_.clear();
  tell({{"kind", "judging"}, {"id", id}});
}

void Session::listen_to_judge() {
  const bool is_open = Child::read_some(judge_->output(), judge_text_);
  Child::read_some(judge_->talk(), judge_talk_);
  if (is_open) return;
  judge_->wait();
  judge_.reset();
  Json verdicts = Json::parse(judge_text_, nullptr, false);
  if (verdicts.is_discarded())
    verdicts = {{"id", judging_}, {"said", judge_talk_}, {"tests", Json::array()}};
  verdicts["kind"] = "verdicts";
  verdicts_ = dumped(verdicts);
  send(event_of("say", verdicts_));
}

// The run against the one before it, as far as both have come since the last look.
void Session::compare() {
  const auto now = Clock::now();
  if (has_difference_ || former_.frames().empty() ||
      now - compared_at_ < std::chrono::duration<double>(kComparesEvery))
    return;
  compared_at_ = now;
  const double until = std::min(former_.end_s(), current_.end_s());
  if (!(until > compared_until_) || former_.radii_m().size() != current_.radii_m().size()) return;
  const Trajectory a = former_.part(compared_until_, until),
                   b = current_.part(compared_until_, until);
  if (a.frames.empty() || b.frames.empty()) return;
  const auto found =
      report::compare(current_.outline(), current_.radii_m(), a, "the run before", b, "this run");
  compared_until_ = until;
  Json words{{"kind", "difference"}, {"same_until_s", until}};
  if (found.first) {
    has_difference_ = true;
    words["time_s"] = found.first->time_s;
    words["what"] = found.first->what;
    words["body"] = found.first->body;
  }
  difference_ = dumped(words);
  send(event_of("say", difference_));
}

void Session::save() {
  if (sitting_.recipe.document.empty())
    throw UserError(sitting_.name, "is made by code and has no scene file to add pushes to",
                    "Begin with a scene file.");
  if (current_.frames().empty()) throw UserError(sitting_.name, "has not moved yet", "");
  fs::path file;
  for (int number = 1; file.empty() || fs::exists(file); ++number)
    file = sitting_.saves / fmt::format("{}_{}.json", sitting_.name, number);
  const Json head = Json::parse(current_.head());
  const std::string again =
      sitting_.again ? sitting_.again(file, recipe_.changes, head.value("modules", "")) : "";
  write_whole(file, saved_document(recipe_, current_.end_s(), again));
  // The same code runs what stands in the file.
  Recipe written;
  written.document = tumble::text_of(file);
  written.file = sitting_.recipe.file;
  written.changes.method = recipe_.changes.method;
  checking_ = std::make_unique<Simulator>(sitting_.simulator, 0.0, "check");
  checking_->child.say(
      dumped({{"recipe", as_text(written)}, {"from_s", 0.0}, {"speed", 1e30}, {"paused", false}}));
  frames_checked_ = 0;
  frames_to_check_ = current_.frames().size();
  first_wrong_.clear();
  checked_file_ = file.string();
  saved_ = dumped({{"kind", "saved"}, {"file", checked_file_}, {"again", again}});
  send(event_of("say", saved_));
}

void Session::check_saved() {
  std::string bytes;
  const bool is_open = Child::read_some(checking_->child.output(), bytes);
  Child::read_some(checking_->child.talk(), checking_->talk);
  checking_->records.feed(bytes);
  while (auto record = checking_->records.next()) {
    if (record->kind == RecordKind::kRefused && first_wrong_.empty())
      first_wrong_ = Json::parse(record->bytes).value("problem", "refused");
    if (record->kind != RecordKind::kFrame || frames_checked_ == frames_to_check_) continue;
    const bool is_there = frames_checked_ < current_.frames().size();  // else it was begun anew
    if (first_wrong_.empty() && !(is_there && record->bytes == current_.frames()[frames_checked_]))
      first_wrong_ = fmt::format("the frame at {:.6g} s differs", History::time_of(record->bytes));
    ++frames_checked_;
  }
  if (is_open) return;
  if (frames_checked_ < frames_to_check_ && first_wrong_.empty())
    first_wrong_ = "it ended before its last frame";
  Json words = Json::parse(saved_);
  words["checked"] = true;
  words["frames"] = frames_checked_;
  words["wrong"] = first_wrong_;
  saved_ = dumped(words);
  send(event_of("say", saved_));
  checking_.reset();
}

void Session::code_saved(const std::set<fs::path>& files) {
  for (const Watched& one : sitting_.watched)
    if (files.contains(fs::absolute(one.file).lexically_normal())) {
      judge_.reset();  // of the code before; and two builds at once would be in each other's way
      to_judge_ = one.id;
      tell({{"kind", "code_saved"}, {"file", one.file.filename().string()}});
      return begin("code", 0.0);
    }
}

// ---- The loop ----------------------------------------------------------------------------------

void Session::run(int stop) {
  to_judge_ = sitting_.first_judged;
  begin("begin", 0.0);
  for (;;) {
    std::vector<pollfd> waiting = {
        {stop, POLLIN, 0}, {wake_, POLLIN, 0}, {saves_.descriptor(), POLLIN, 0}};
    const auto wait_for = [&](const Simulator* simulator) {
      if (simulator != nullptr) waiting.push_back({simulator->child.output(), POLLIN, 0});
    };
    wait_for(running_.get());
    wait_for(starting_.get());
    wait_for(checking_.get());
    if (judge_) waiting.push_back({judge_->output(), POLLIN, 0});
    if (locator_) waiting.push_back({locator_->output(), POLLIN, 0});
    constexpr int kTickMs = 500;
    if (::poll(waiting.data(), waiting.size(), kTickMs) < 0 && errno != EINTR) return;
    if (waiting[0].revents != 0) return;
    if (waiting[1].revents != 0) take_posts();
    if (waiting[2].revents != 0) code_saved(saves_.wait(0));
    if (running_) listen_to(running_);
    if (starting_) listen_to(starting_);
    if (checking_) check_saved();
    if (judge_) listen_to_judge();
    if (locator_) listen_to_locator();
    compare();
    // A page that is closed lets the run stand.
    const bool had = !pages_.empty();
    {
      const std::lock_guard lock(mutex_);
      std::erase_if(pages_, [](const auto& page) { return page->is_closed(); });
    }
    if (had && pages_.empty()) set_pace();
  }
}

/// Signals that end the program, as a descriptor; blocked for all threads that are started later.
class StopSignals {
 public:
  StopSignals() {
    ::sigemptyset(&signals_);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::sigaddset(&signals_, signal);
    ::pthread_sigmask(SIG_BLOCK, &signals_, &before_);
    ::signal(SIGPIPE, SIG_IGN);
    fd_ = ::signalfd(-1, &signals_, SFD_CLOEXEC | SFD_NONBLOCK);
  }
  ~StopSignals() {
    // What has come is taken, so that it ends nobody when it is let through again.
    signalfd_siginfo one;
    while (::read(fd_, &one, sizeof one) == sizeof one) {
    }
    ::close(fd_);
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
  int descriptor() const { return fd_; }

 private:
  sigset_t signals_, before_;
  int fd_;
};

}  // namespace

void serve(const Sitting& sitting, const std::function<void(const std::string& address)>& ready) {
  report::three_js();  // missing: said before anything is started
  const StopSignals stop;
  std::vector<fs::path> files;
  for (const Watched& one : sitting.watched) files.push_back(one.file);
  SaveWatch saves(files);
  Session session(sitting, saves);
  const Server server(session.hooks(), sitting.port);
  ready(server.address());
  session.run(stop.descriptor());
  session.close_pages();
}

}  // namespace tumble::live
