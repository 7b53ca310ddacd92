#include "framework/farm/parts.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <system_error>
#include <vector>

#include "framework/core/digest.h"
#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/not_implemented.h"

namespace tumble::farm {
namespace {

namespace fs = std::filesystem;

constexpr char kBetween = '\x1f';  // of the parts of an error: in no message

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == kBetween)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

}  // namespace

void KeptParts::hold(const std::string& shard) {
  // a command that was killed may have left processes that take a moment to end
  constexpr int kTries = 100, kPauseUs = 20'000;
  std::error_code failed;
  fs::create_directories(folder_, failed);
  std::string name = shard.empty() ? ".whole.lock" : ".shard-" + shard + ".lock";
  std::replace(name.begin(), name.end(), '/', '-');
  const fs::path file = folder_ / name;
  const int lock = ::open(file.c_str(), O_CREAT | O_RDWR | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (lock < 0)
    throw UserError(file.string(), "cannot be written",
                    "Give --out a folder that you may write to.");
  held_ = std::shared_ptr<const int>(new int(lock), [](const int* descriptor) {
    ::close(*descriptor);
    delete descriptor;
  });
  for (int i = 0; ::flock(lock, LOCK_EX | LOCK_NB) != 0; ++i) {
    if (i == kTries)
      throw UserError(folder_.parent_path().string(), "another command works there now",
                      "Wait for its end, or give --out another folder.");
    ::usleep(kPauseUs);
  }
}

std::optional<std::string> KeptParts::read(const fs::path& file) const {
  const std::string text = text_of(file), head = "tumble part " + key_ + ' ';
  const std::size_t end = text.find('\n');
  if (end == std::string::npos || !text.starts_with(head)) return std::nullopt;
  std::string bytes = text.substr(end + 1);
  if (text.substr(head.size(), end - head.size()) != digest(bytes)) return std::nullopt;
  return bytes;
}

void KeptParts::write(const fs::path& file, std::string_view bytes) const {
  write_whole(file, "tumble part " + key_ + ' ' + digest(bytes) + '\n' + std::string(bytes));
}

std::optional<std::string> KeptParts::result(const std::string& name) const {
  return read(folder_ / (name + ".part"));
}

void KeptParts::put(const std::string& name, std::string_view bytes) const {
  write(folder_ / (name + ".part"), bytes);
}

void KeptParts::forget(const std::string& name) const {
  std::error_code ignored;
  for (const char* ending : {".part", ".error"}) fs::remove(folder_ / (name + ending), ignored);
}

void KeptParts::put_error(const std::string& name, std::exception_ptr error) const {
  std::string text;
  const auto say = [&](const std::vector<std::string>& parts) {
    for (const std::string& part : parts)
      text += (text.empty() ? "" : std::string(1, kBetween)) + part;
  };
  try {
    std::rethrow_exception(error);
  } catch (const UserError& told) {
    say({"user", told.where(), told.problem(), told.remedy()});
  } catch (const NotImplemented& told) {
    say({"stub", told.function(), told.handout()});
  } catch (const std::exception& told) {
    say({"bug", told.what()});
  }
  write(folder_ / (name + ".error"), text);
}

void KeptParts::rethrow_error(const std::string& name) const {
  const auto text = read(folder_ / (name + ".error"));
  if (!text) return;
  const std::vector<std::string> parts = split(*text);
  if (parts[0] == "user" && parts.size() == 4) throw UserError(parts[1], parts[2], parts[3]);
  if (parts[0] == "stub" && parts.size() == 3) throw NotImplemented(parts[1], parts[2]);
  throw std::runtime_error(parts.size() == 2 ? parts[1] : *text);
}

}  // namespace tumble::farm
