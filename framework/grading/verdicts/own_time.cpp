#include "framework/grading/verdicts/own_time.h"

#include <fcntl.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>

namespace tumble::grading {
namespace {

// A small file of /proc; empty where it does not exist.
std::string proc_file(pid_t process, const char* name) {
  char path[64], text[1024];
  std::snprintf(path, sizeof path, "/proc/%d/%s", static_cast<int>(process), name);
  const int fd = ::open(path, O_RDONLY | O_CLOEXEC);
  if (fd < 0) return "";
  const ssize_t n = ::read(fd, text, sizeof text - 1);
  ::close(fd);
  return n > 0 ? std::string(text, static_cast<std::size_t>(n)) : "";
}

double since_boot_s() {
  timespec now{};
  ::clock_gettime(CLOCK_BOOTTIME, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

ProcessTimes process_times(pid_t process) {
  ProcessTimes times;
  if (process <= 0) return times;
  // proc(5): the fields after the name, which is in brackets and may contain anything; utime, stime
  // and starttime are 14, 15 and 22.
  const std::string stat = proc_file(process, "stat");
  const auto name_end = stat.rfind(')');
  unsigned long user = 0, system = 0;
  unsigned long long start = 0;
  if (name_end == std::string::npos ||
      std::sscanf(
          stat.c_str() + name_end + 1,
          " %*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lu %lu %*d %*d %*d %*d %*d %*d %llu",
          &user, &system, &start) != 3)
    return times;
  static const double tick_s = 1.0 / static_cast<double>(::sysconf(_SC_CLK_TCK));
  times.cpu_s = static_cast<double>(user + system) * tick_s;
  times.age_s = std::max(0.0, since_boot_s() - static_cast<double>(start) * tick_s);
  unsigned long long run_ns = 0, delay_ns = 0;
  if (std::sscanf(proc_file(process, "schedstat").c_str(), "%llu %llu", &run_ns, &delay_ns) == 2)
    times.delay_s = 1e-9 * static_cast<double>(delay_ns);
  times.is_known = true;
  return times;
}

double own_time(const ProcessTimes& from, const ProcessTimes& to, double wall_s) {
  if (!to.is_known) return wall_s;
  const double delay_s = to.delay_s - (from.is_known ? from.delay_s : 0.0),
               cpu_s = to.cpu_s - (from.is_known ? from.cpu_s : 0.0);
  return std::max(cpu_s, std::min(wall_s, to.age_s) - delay_s);
}

std::vector<pid_t> children_of(pid_t process) {
  std::vector<pid_t> all;
  if (shows_children()) {
    std::istringstream children(
        proc_file(process, ("task/" + std::to_string(process) + "/children").c_str()));
    for (pid_t child; children >> child;) all.push_back(child);
    return all;
  }
  std::error_code failed;
  for (std::filesystem::directory_iterator it("/proc", failed), end; !failed && it != end;
       it.increment(failed)) {
    const pid_t other = std::atoi(it->path().filename().c_str());
    if (other <= 0) continue;
    const std::string stat = proc_file(other, "stat");
    const auto name_end = stat.rfind(')');
    int parent = 0;
    if (name_end != std::string::npos &&
        std::sscanf(stat.c_str() + name_end + 1, " %*c %d", &parent) == 1 && parent == process)
      all.push_back(other);
  }
  return all;
}

double activity_below(pid_t process) {
  const ProcessTimes times = process_times(process);
  double sum = times.cpu_s + times.delay_s;
  for (const pid_t child : children_of(process)) sum += activity_below(child);
  return sum;
}

bool shows_children() {
  static const bool shows =
      ::access(("/proc/self/task/" + std::to_string(::getpid()) + "/children").c_str(), R_OK) == 0;
  return shows;
}

pid_t first_descendant(pid_t process, int depth) {
  for (int i = 0; i < depth; ++i) {
    const std::string children =
        proc_file(process, ("task/" + std::to_string(process) + "/children").c_str());
    int child = -1;
    if (std::sscanf(children.c_str(), "%d", &child) != 1) return -1;
    process = child;
  }
  return process;
}

}  // namespace tumble::grading
