#include "framework/live/session.h"

#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <map>
#include <set>

#include "framework/core/error.h"
#include "framework/core/save_watch.h"
#include "framework/live/runs.h"
#include "framework/live/save_check.h"
#include "framework/live/served_files.h"
#include "framework/live/verdicts.h"
#include "framework/report/player_parts.h"

namespace tumble::live {
namespace {

using Clock = std::chrono::steady_clock;

/// The loop of a sitting: what has come from pages, processes and the watch over sources is taken
/// to the part that it is for.
class Session {
 public:
  Session(const Sitting& sitting, SaveWatch& saves)
      : sitting_(sitting),
        saves_(saves),
        scenes_(sitting, pages_),
        former_(pages_),
        shown_(sitting.recipe, pages_),
        verdicts_(sitting.judge, pages_),
        save_check_(pages_),
        runs_(pages_, scenes_, shown_, former_, [this] { verdicts_.go_on(); }) {}

  ServerHooks hooks();
  /// @param stop  a descriptor that becomes readable when all is to end
  void run(int stop);
  void close_pages() { pages_.close(); }
  Left left() const { return scenes_.left(runs_.wanted()); }

 private:
  void take_news();
  void greet(Mailbox& page) const;
  void obey(const std::string& text);
  void choose_scene(const std::string& name);
  void save();
  void code_saved(const std::set<std::filesystem::path>& files);
  void look_for_files();
  std::vector<const Child*> children() const;

  const Sitting& sitting_;
  SaveWatch& saves_;
  Pages pages_;
  Scenes scenes_;
  FormerRun former_;
  ShownRun shown_;
  Verdicts verdicts_;
  SaveCheck save_check_;
  Runs runs_;
  std::map<std::filesystem::path, Clock::time_point> gone_;  // watched files, since when
};

ServerHooks Session::hooks() {
  return {[this] { return pages_.open(); }, [this](const std::string& json) { pages_.post(json); },
          [this](const std::string& path) { return served_file(path, sitting_.handout); }};
}

std::vector<const Child*> Session::children() const {
  std::vector<const Child*> children = runs_.children();
  for (const Child* child : {save_check_.child(), verdicts_.child()}) children.push_back(child);
  std::erase(children, nullptr);
  return children;
}

void Session::run(int stop) {
  if (!sitting_.first_judged.empty()) verdicts_.wait(sitting_.first_judged);
  runs_.begin("begin", 0.0, shown_.recipe());
  for (;;) {
    std::vector<pollfd> waiting = {
        {stop, POLLIN, 0}, {pages_.news(), POLLIN, 0}, {saves_.descriptor(), POLLIN, 0}};
    // What a process says is read, too: one that says much would stand still when its pipe is full.
    for (const Child* child : children()) {
      waiting.push_back({child->output(), POLLIN, 0});
      if (child->talk_is_open()) waiting.push_back({child->talk(), POLLIN, 0});
    }
    constexpr int kTickMs = 500;
    if (::poll(waiting.data(), waiting.size(), kTickMs) < 0 && errno != EINTR) return;
    if (waiting[0].revents != 0) return;
    if (waiting[1].revents != 0) take_news();
    if (waiting[2].revents != 0) code_saved(saves_.wait(0));
    runs_.listen();
    save_check_.listen();
    if (verdicts_.listen() && !runs_.is_starting()) verdicts_.go_on();
    former_.compare(shown_.history(), shown_.has_ended());
    look_for_files();
    // A page that is closed lets the run stand.
    if (pages_.forget_closed()) runs_.keep_pace();
  }
}

void Session::take_news() {
  const PagesNews news = pages_.take_news();
  if (news.was_left) runs_.act({{"do", "release"}});  // a page that comes anew holds nothing
  for (const auto& page : news.opened) greet(*page);
  if (news.was_left || !news.opened.empty()) runs_.keep_pace();
  for (const std::string& text : news.posts) {
    try {
      obey(text);
    } catch (const UserError& error) {
      Json notice{{"kind", "notice"}, {"text", error.what()}};
      if (const Json command = Json::parse(text, nullptr, false); command.is_object())
        notice["about"] = command.value("do", "");
      pages_.tell(notice);
    } catch (const nlohmann::json::exception&) {
      pages_.tell(
          {{"kind", "notice"}, {"text", "the page asked for something that is not understood"}});
    }
  }
}

void Session::greet(Mailbox& page) const {
  Json hello = scenes_.words();
  hello["kind"] = "hello";
  hello["speed"] = runs_.speed();
  hello["paused"] = runs_.is_paused();
  hello["unsaved"] = scenes_.unsaved();
  hello["starting"] = runs_.starting_reason();
  page.put("say", dumped(hello));
  if (scenes_.can_be_chosen()) page.put("say", dumped(scenes_.offered_words()));
  shown_.greet(page, former_);
  for (const std::string& text : verdicts_.told()) page.put("say", text);
  for (const std::string* text :
       {&shown_.trouble(), &shown_.asked(), &former_.told(), &shown_.end(), &save_check_.told()})
    if (!text->empty()) page.put("say", *text);
}

void Session::obey(const std::string& text) {
  const Json command = Json::parse(text);
  const std::string what = command.at("do");
  Recipe recipe;  // of the run that a command begins
  if (what == "pace") {
    runs_.set_pace(command.at("speed"), command.at("paused"));
  } else if (what == "step" || what == "aim" || what == "push" || what == "pull" ||
             what == "release") {
    runs_.act(command);
  } else if (what == "begin") {  // over again, with the pushes or without them
    recipe = runs_.wanted();
    if (!command.value("keep", false)) recipe.pushes.clear();
    runs_.begin("begin", 0.0, recipe);
  } else if (what == "back") {  // goes on from an instant that was
    const double time_s = command.at("time_s");
    if (!(time_s >= 0)) throw UserError("time", "must not be negative", "");
    recipe = shown_.recipe();
    recipe.pushes = before(recipe.pushes, time_s);
    runs_.begin("back", time_s, recipe);
  } else if (what == "change") {
    recipe = runs_.wanted();
    change(recipe.changes, dumped(command.at("changes")));
    if (!command.value("keep", false)) recipe.pushes.clear();
    if (!recipe.document.empty()) document_of(recipe);  // throws where it cannot be done
    runs_.begin("change", 0.0, recipe);
  } else if (what == "scene") {
    choose_scene(command.at("name"));
  } else if (what == "judge") {
    verdicts_.judge(command.value("id", sitting_.first_judged));
  } else if (what == "save") {
    save();
  } else {
    throw UserError(what, "is nothing that the page can ask for", "");
  }
}

// On the same code.
void Session::choose_scene(const std::string& name) {
  if (name == scenes_.shown().name) return;
  const Recipe recipe = scenes_.choose(name, runs_.wanted());
  runs_.stop();
  former_.clear();
  shown_.clear(recipe);
  pages_.tell(scenes_.words());
  if (scenes_.can_be_chosen()) pages_.tell(scenes_.offered_words());
  runs_.begin("scene", 0.0, recipe);
}

void Session::save() {
  const SavedScene saved = scenes_.save(shown_.recipe(), shown_.history());
  scenes_.look_for_unsaved(runs_.wanted());
  save_check_.begin(scenes_.shown().simulator, saved, shown_.history().frames());
}

void Session::code_saved(const std::set<std::filesystem::path>& files) {
  bool is_any = false;
  for (const Watched& one : sitting_.watched)
    if (files.contains(std::filesystem::absolute(one.file).lexically_normal())) {
      verdicts_.judge_anew(one.id);
      is_any = true;
      pages_.tell({{"kind", "code_saved"}, {"file", one.file.filename().string()}, {"id", one.id}});
    }
  if (is_any) runs_.begin("code", 0.0, runs_.wanted());
}

// An editor that puts a new file in the place of the old one leaves none for an instant.
void Session::look_for_files() {
  constexpr std::chrono::seconds kGone{1};
  for (const Watched& one : sitting_.watched) {
    std::error_code unknown;
    if (std::filesystem::exists(one.file, unknown)) {
      gone_.erase(one.file);
      continue;
    }
    const auto now = Clock::now();
    const auto [since, is_new] = gone_.emplace(one.file, now);
    // A run that begins takes the words away, and a file that is gone still needs them.
    if (is_new || now - since->second < kGone || !shown_.trouble().empty()) continue;
    shown_.tell_trouble(
        {{"title", "Your file is gone"},
         {"where", one.file.filename().string()},
         {"text", one.file.string() + " is not there any more. What runs is the code that was "
                                      "saved last."},
         {"remedy", "Put it back under this name: the scene begins anew by itself."}});
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

Left serve(const Sitting& sitting, const std::function<void(const std::string& address)>& ready) {
  report::three_js();  // missing: said before anything is started
  const StopSignals stop;
  std::vector<std::filesystem::path> files;
  for (const Watched& one : sitting.watched) files.push_back(one.file);
  SaveWatch saves(files);
  Session session(sitting, saves);
  const Server server(session.hooks(), sitting.port);
  ready(server.address());
  session.run(stop.descriptor());
  session.close_pages();
  return session.left();
}

}  // namespace tumble::live
