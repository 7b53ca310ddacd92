#include "framework/live/shown_run.h"

namespace tumble::live {
namespace {

// Of a run's frames and of its events, as they are kept, for a page that is opened later [bytes].
// In the stream they take less, and both together fit into its mailbox with room for what comes
// meanwhile. A page thins a long run, too.
constexpr std::size_t kMostOfFrames = 80u << 20, kMostOfEvents = 32u << 20;

std::size_t bytes_of(const std::vector<std::string>& records) {
  std::size_t bytes = 0;
  for (const std::string& record : records) bytes += record.size();
  return bytes;
}

Json of_kind(const char* kind, const std::string& bytes) {
  Json words = Json::parse(bytes);
  words["kind"] = kind;
  return words;
}

}  // namespace

void ShownRun::forget_told() {
  for (std::string* told : {&trouble_, &asked_, &end_}) told->clear();
  times_.clear();
}

void ShownRun::clear(const Recipe& recipe) {
  recipe_ = recipe;
  history_ = History();
  forget_told();
}

void ShownRun::begin(const Simulator& run, const std::string& head, FormerRun& former) {
  recipe_ = run.recipe;
  reason_ = run.reason;
  if (run.from_s > 0) {
    history_.cut(run.from_s);
  } else {
    former.keep(history_, has_ended());
    history_ = History(head);
  }
  former.compare_anew(history_.end_s());
  forget_told();
  Json told = words(former);
  told["head"] = Json::parse(head);
  pages_.tell(told);
}

Json ShownRun::words(const FormerRun& former) const {
  Json words{{"kind", "run"},
             {"reason", reason_},
             {"head", Json::parse(history_.head())},
             {"has_former", former.is_there()}};
  const Changes& changes = recipe_.changes;
  words["changes"] = {{"engine", changes.engine}, {"method", changes.method}};
  if (!changes.coordinates.empty()) words["changes"]["coordinates"] = changes.coordinates;
  if (changes.restitution) words["changes"]["restitution"] = *changes.restitution;
  if (changes.friction) words["changes"]["friction"] = *changes.friction;
  words["pushes"] = Json::array();
  for (const std::string& push : recipe_.pushes) words["pushes"].push_back(Json::parse(push));
  return words;
}

std::string ShownRun::hear(Record record) {
  const bool was_full = history_.is_full();
  std::string stopped_by;
  switch (record.kind) {
    case RecordKind::kFrame: {
      const std::string& first =
          history_.frames().empty() ? record.bytes : history_.frames().front();
      pages_.send("f", frame_for_page(record.bytes, first, history_.origin_world()));
      history_.add_frame(std::move(record.bytes));
      break;
    }
    case RecordKind::kEvent:
      pages_.send("e", event_for_page(record.bytes, history_.origin_world()));
      history_.add_event(std::move(record.bytes));
      break;
    case RecordKind::kAimed: pages_.tell(of_kind("aimed", record.bytes)); break;
    case RecordKind::kTimes: times_.push_back(pages_.tell(of_kind("times", record.bytes))); break;
    case RecordKind::kEnd: {
      const Json end = of_kind("end", record.bytes);
      end_ = pages_.tell(end);
      stopped_by = end.value("stopped_by", "");
      if (!stopped_by.empty())
        tell_trouble({{"title", "The run stopped"}, {"text", stopped_by}, {"ends_run", true}});
      break;
    }
    case RecordKind::kRefused: {
      Json refused = Json::parse(record.bytes);
      refused["title"] = refused.value("not_attempted", false) ? "Not attempted" : "Stopped";
      refused["text"] = refused.at("problem");
      refused["ends_run"] = true;
      tell_trouble(refused);
      break;
    }
    case RecordKind::kHead:
    case RecordKind::kHand:
    case RecordKind::kAsked: break;
  }
  if (history_.is_full() && !was_full)
    pages_.tell({{"kind", "limit"}, {"text", history_.limit_in_words()}});
  return stopped_by;
}

void ShownRun::tell_trouble(Json what) {
  what["kind"] = "trouble";
  trouble_ = pages_.tell(what);
}

void ShownRun::tell_place(std::string place) {
  while (place.ends_with('\n')) place.pop_back();
  if (place.empty() || trouble_.empty()) return;
  Json what = Json::parse(trouble_);
  what["where"] = place.substr(0, place.find(": "));
  const bool is_line = !place.starts_with("in ");  // else no more than a function's first line
  const std::size_t colon = place.find(": ");
  if (is_line && colon != std::string::npos)
    what["text"] = place.substr(colon + 2) + "\n" + what.value("text", "");
  tell_trouble(what);
}

void ShownRun::greet(Mailbox& page, const FormerRun& former) const {
  if (!history_.head().empty()) {
    Json told = words(former);
    told["head"]["from_s"] = 0.0;
    page.put("say", dumped(told));
    // Of a long run some of its frames, the last among them, and the latest events.
    const std::vector<std::string>&frames = history_.frames(), &events = history_.events();
    const std::size_t stride = 1 + bytes_of(frames) / kMostOfFrames;
    for (std::size_t k = 0; k < frames.size(); ++k)
      if (k % stride == 0 || k + 1 == frames.size())
        page.put("f", frame_for_page(frames[k], frames.front(), history_.origin_world()));
    std::size_t first = events.size();
    for (std::size_t bytes = 0; first > 0; --first) {
      bytes += events[first - 1].size();
      if (bytes > kMostOfEvents) break;
    }
    for (std::size_t k = first; k < events.size(); ++k)
      page.put("e", event_for_page(events[k], history_.origin_world()));
  }
  if (history_.is_full())
    page.put("say", dumped({{"kind", "limit"}, {"text", history_.limit_in_words()}}));
  for (const std::string& text : times_) page.put("say", text);
}

}  // namespace tumble::live
