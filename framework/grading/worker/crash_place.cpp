#include "framework/grading/worker/crash_place.h"

#include <algorithm>
#include <cctype>
#include <sstream>

#include "framework/grading/sandbox/sandbox.h"
#include "framework/grading/sandbox/sandbox_wire.h"
#include "framework/grading/worker/dying_words.h"

namespace tumble::grading {
namespace {

constexpr const char* kLookUp = "/usr/bin/addr2line";
constexpr const char* kSources = "/submission/";  // the compiler's folder (compiler/compile.cpp)
constexpr std::size_t kMostFrames = 32, kLongestName = 80, kMostDigits = 7;

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

}  // namespace

std::vector<std::string> frames_in(const std::string& printed) {
  constexpr std::size_t kOffsetDigits = 16;
  std::vector<std::string> frames;
  std::istringstream lines(printed);
  for (std::string line; std::getline(lines, line) && frames.size() < kMostFrames;) {
    if (!line.starts_with(kFrameWord)) continue;
    const std::string offset = line.substr(std::string_view(kFrameWord).size());
    if (offset.size() == kOffsetDigits && std::all_of(offset.begin(), offset.end(), [](char c) {
          return std::isxdigit(static_cast<unsigned char>(c)) != 0;
        }))
      frames.push_back("0x" + offset);
  }
  return frames;
}

std::string own_line(const std::string& told) {
  std::istringstream lines(told);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(kSources)) continue;
    line.erase(0, std::string_view(kSources).size());
    if (line.starts_with("./")) line.erase(0, 2);
    const std::size_t colon = line.find(':');
    if (colon == line.npos || colon == 0 || colon > kLongestName) continue;
    const std::string name = line.substr(0, colon);
    const bool is_plain = std::all_of(name.begin(), name.end(), [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.' || c == '-';
    });
    std::size_t end = colon + 1;
    while (end < line.size() && is_digit(line[end])) ++end;
    if (is_plain && end > colon + 1 && end - colon - 1 <= kMostDigits && line[colon + 1] != '0')
      return line.substr(0, end);
  }
  return "";
}

std::string crash_place(const SandboxJob& worker, const std::string& object,
                        const std::string& printed) {
  const std::vector<std::string> frames = frames_in(printed);
  if (frames.empty()) return "";
  SandboxJob job = worker;
  job.channel = -1;
  job.command = {kLookUp, "-i", "-e", object};
  job.command.insert(job.command.end(), frames.begin(), frames.end());
  job.limits.cpu_s = 5;
  job.limits.wall_s = 60.0;
  job.limits.output_bytes = 64u << 10;
  const SandboxOutcome outcome = Sandbox::start(job).wait();
  return outcome.ending == SandboxOutcome::Ending::kExited ? own_line(outcome.printed) : "";
}

}  // namespace tumble::grading
