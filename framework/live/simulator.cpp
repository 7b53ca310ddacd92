#include "framework/live/simulator.h"

#include <cstdint>
#include <cstring>
#include <sstream>

#include <fmt/format.h>

namespace tumble::live {
namespace {

constexpr std::size_t kTalkKept = 1u << 14;  // bytes of what a process said

// Without the lines for the search of the place, and without the program's name.
std::string for_people(const std::string& talk) {
  std::istringstream lines(talk);
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("tumble: ")) line.erase(0, 8);
    const bool is_ours =
        line.starts_with("frame ") || line.starts_with("called ") || line.starts_with("compiling ");
    if (!is_ours && !(text.empty() && line.empty())) text += line + "\n";
  }
  return text;
}

}  // namespace

void Simulator::start(double speed, bool is_paused) {
  child.say(dumped(
      {{"recipe", as_text(recipe)}, {"from_s", from_s}, {"speed", speed}, {"paused", is_paused}}));
}

bool Simulator::read() {
  std::string bytes;
  const bool is_open = Child::read_some(child.output(), bytes);
  child.read_talk(talk);
  if (talk.size() > kTalkKept) talk.erase(0, talk.size() - kTalkKept);
  records.feed(bytes);
  return is_open;
}

std::optional<Json> Simulator::loss() {
  const int code = child.wait();
  child.read_talk(talk);
  if (has_ended) return std::nullopt;
  std::string said = for_people(talk);
  if (said.empty())
    said = code > 128 ? fmt::format("ended by signal {} ({})", code - 128, ::strsignal(code - 128))
                      : fmt::format("ended with code {}", code);
  return Json{{"title", said.find("out of time") != std::string::npos ? "Out of time" : "Crashed"},
              {"text", said}};
}

Json Simulator::asked_at_loss(Json asked) const {
  std::istringstream lines(talk);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string called, id, function;
    std::uint64_t count = 0;
    if (!(words >> called >> id >> function >> count) || called != "called") continue;
    for (Json& module : asked)
      if (module.at("id") == id)
        for (Json& one : module.at("functions"))
          if (one.at(0) == function) one.at(1) = count;
  }
  return asked;
}

}  // namespace tumble::live
