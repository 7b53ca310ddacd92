// The pages of a sitting: what threads of the server hand over, and what pages are told.
#include "framework/live/session_parts.h"

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/live/page_files.h"
#include "framework/report/player_parts.h"

namespace tumble::live {
namespace {

constexpr std::size_t kMostPages = 8;
// Of a run's frames and of its events, as they are kept, for a page that is opened later [bytes].
// In the stream they take less, and both together fit into its mailbox with room for what comes
// meanwhile. A page thins a long run, too.
constexpr std::size_t kMostOfFrames = 80u << 20, kMostOfEvents = 32u << 20;

std::size_t bytes_of(const std::vector<std::string>& records) {
  std::size_t bytes = 0;
  for (const std::string& record : records) bytes += record.size();
  return bytes;
}

}  // namespace

std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

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
    for (const char* part : {"live_run.js", "live_stage.js", "live_curves.js", "live_scenes.js",
                             "live_verdicts.js", "live_panes.js", "live_said.js", "live_main.js"})
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
  bool was_left = false;
  {
    const std::lock_guard lock(mutex_);
    posts.swap(posts_);
    pages.swap(new_pages_);
    const bool had = !pages_.empty();
    std::erase_if(pages_, [](const auto& page) { return page->is_closed(); });
    was_left = had && pages_.empty();
    pages_.insert(pages_.end(), pages.begin(), pages.end());
  }
  if (was_left) forward(dumped({{"do", "release"}}));  // a page that comes anew holds nothing
  for (const auto& page : pages) greet(*page);
  if (was_left || !pages.empty()) set_pace();
  for (const std::string& text : posts) {
    try {
      obey(text);
    } catch (const UserError& error) {
      Json notice{{"kind", "notice"}, {"text", error.what()}};
      if (const Json command = Json::parse(text, nullptr, false); command.is_object())
        notice["about"] = command.value("do", "");
      tell(notice);
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
  if (!changes.coordinates.empty()) words["changes"]["coordinates"] = changes.coordinates;
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
  Json hello = scene_words();
  hello["kind"] = "hello";
  hello["speed"] = speed_;
  hello["paused"] = is_paused_;
  hello["is_unsaved"] = is_unsaved_;
  put(event_of("say", dumped(hello)));
  if (sitting_.offered) put(event_of("say", dumped(scenes_words())));
  if (!current_.head().empty()) {
    Json words = run_words();
    words["head"]["from_s"] = 0.0;
    put(event_of("say", dumped(words)));
    // Of a long run some of its frames, the last among them, and the latest events.
    const std::vector<std::string>&frames = current_.frames(), &events = current_.events();
    const std::size_t stride = 1 + bytes_of(frames) / kMostOfFrames;
    for (std::size_t k = 0; k < frames.size(); ++k)
      if (k % stride == 0 || k + 1 == frames.size())
        put(event_of("f", frame_for_page(frames[k], frames.front(), current_.origin_world())));
    std::size_t first = events.size();
    for (std::size_t bytes = 0; first > 0; --first) {
      bytes += events[first - 1].size();
      if (bytes > kMostOfEvents) break;
    }
    for (std::size_t k = first; k < events.size(); ++k)
      put(event_of("e", event_for_page(events[k], current_.origin_world())));
  }
  if (current_.is_full())
    put(event_of("say", dumped({{"kind", "limit"}, {"text", current_.limit_in_words()}})));
  for (const std::string& text : times_) put(event_of("say", text));
  for (const auto& [id, text] : verdicts_) put(event_of("say", text));
  if (judge_) put(event_of("say", dumped({{"kind", "judging"}, {"id", judging_}})));
  for (const std::string* text : {&trouble_, &asked_, &difference_, &end_, &saved_})
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
    const bool is_over = running_ ? running_->has_ended : !starting_;
    if (is_over && (what == "aim" || what == "push"))
      tell({{"kind", "notice"},
            {"text", "the run has ended: start over, or go back to an earlier instant"}});
    forward(dumped(command));
  } else if (what == "begin") {  // over again, with the pushes or without them
    Recipe anew = wanted();
    if (!command.value("keep", false)) anew.pushes.clear();
    begin("begin", 0.0, anew);
  } else if (what == "back") {  // goes on from an instant that was
    const double time_s = command.at("time_s");
    if (!(time_s >= 0)) throw UserError("time", "must not be negative", "");
    Recipe cut = recipe_;
    cut.pushes = before(cut.pushes, time_s);
    begin("back", time_s, cut);
  } else if (what == "change") {
    Recipe changed = wanted();
    change(changed.changes, dumped(command.at("changes")));
    if (!command.value("keep", false)) changed.pushes.clear();
    if (!changed.document.empty()) document_of(changed);  // throws where it cannot be done
    begin("change", 0.0, changed);
  } else if (what == "scene") {
    choose_scene(command.at("name"));
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

}  // namespace tumble::live
