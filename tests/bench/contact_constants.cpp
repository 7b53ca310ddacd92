// The sensitivity to each tolerance of contacts: every constant of
// framework/engines/contact/contact_constants.h times ten and divided by ten, and the scenes that
// change. A constant without effect is a candidate for removal.
//
//   bench_contact_constants                 all constants
//   bench_contact_constants margin reach    these
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <regex>
#include <string>
#include <vector>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <boost/pfr/core.hpp>
#include <fmt/format.h>

#include "tests/support/places.h"
#include "framework/core/cpu_time.h"
#include "framework/engines/contact/contact_constants.h"
#include "framework/engines/judging/judge.h"
#include "framework/engines/run.h"
#include "framework/scene/load_scene.h"
#include "tests/engines/reference_laws.h"

namespace tumble::engines {
ContactConstants kContact;
}

namespace tumble::testing {
namespace {

namespace fs = std::filesystem;

constexpr double kLongest = 1.5;    // s of CPU: scenes with longer runs are left out
constexpr double kMoreTime = 10.0;  // times the usual: then the run is stopped and counts as slow
constexpr double kLeastTime = 3.0;  // s
constexpr double kSeen = 1e-9;      // m: a change of positions that is reported

/// One scene, run with changed constants.
struct Looked {
  bool is_right = false;
  // from the usual run, of any position at any frame [m]; infinite where the frames differ
  double farthest = 0.0;
  double cpu_s = 0.0;
};

struct Usual {
  scene::Scene scene;
  Trajectory run;
  double cpu_s;
};

Trajectory run_of(const scene::Scene& scene) {
  static const Laws laws = reference_laws();
  TrajectoryRecorder recorder;
  engines::run_scene(scene, laws, {}, recorder);
  return recorder.trajectory();
}

bool is_right(const scene::Scene& scene, const Trajectory& run) {
  const auto checks = engines::judge_run(scene, run);
  return run.stopped_by.empty() &&
         std::all_of(checks.begin(), checks.end(), [](const auto& check) { return check.passed; });
}

double farthest_of(const Trajectory& a, const Trajectory& b) {
  if (a.frames.size() != b.frames.size()) return INFINITY;
  double farthest = 0.0;
  for (std::size_t k = 0; k < a.frames.size(); ++k)
    for (std::size_t i = 0; i < a.frames[k].poses.size(); ++i)
      farthest = std::max(farthest,
                          (a.frames[k].poses[i].com_world - b.frames[k].poses[i].com_world).norm());
  return farthest;
}

/// In a process of its own, which is ended if it hangs. @return nothing where it took too long, or
/// crashed
std::optional<Looked> look(const Usual& usual) {
  int ends[2];
  if (::pipe(ends) != 0) return std::nullopt;
  const pid_t child = ::fork();
  if (child == 0) {
    const auto limit = static_cast<rlim_t>(std::ceil(kLeastTime + kMoreTime * usual.cpu_s));
    const rlimit cpu{limit, limit};
    ::setrlimit(RLIMIT_CPU, &cpu);
    Looked looked;
    const double before = cpu_seconds();
    try {
      const Trajectory run = run_of(usual.scene);
      looked = {is_right(usual.scene, run), farthest_of(usual.run, run), 0.0};
    } catch (const std::exception&) {
    }
    looked.cpu_s = cpu_seconds() - before;
    ::_exit(::write(ends[1], &looked, sizeof looked) == sizeof looked ? 0 : 1);
  }
  ::close(ends[1]);
  Looked looked;
  const bool is_whole =
      ::read(ends[0], &looked, sizeof looked) == static_cast<ssize_t>(sizeof looked);
  ::close(ends[0]);
  ::waitpid(child, nullptr, 0);
  return is_whole ? std::optional(looked) : std::nullopt;
}

/// The names of the struct's members, in order, from its header.
std::vector<std::string> names_of_constants() {
  std::ifstream in(fs::path(test::source_dir()) / "framework/engines/contact/contact_constants.h");
  static const std::regex member(R"(^  [\w:]+ (\w+) = [^;]+;$)");
  std::vector<std::string> names;
  std::smatch match;
  for (std::string line; std::getline(in, line);)
    if (std::regex_match(line, match, member)) names.push_back(match[1]);
  return names;
}

void scale(engines::ContactConstants& constants, std::size_t which, double factor) {
  boost::pfr::for_each_field(constants, [&](auto& value, std::size_t index) {
    using Value = std::remove_reference_t<decltype(value)>;
    if (index != which) return;
    if constexpr (std::is_floating_point_v<Value>)
      value *= factor;
    else
      value =
          std::max<Value>(1, static_cast<Value>(std::lround(factor * static_cast<double>(value))));
  });
}

std::vector<Usual> usual_runs() {
  std::vector<fs::path> files;
  for (const char* folder : {"assignments/a3_constraints/scenes", "tests/engines/broken_scenes"})
    for (const auto& entry : fs::directory_iterator(fs::path(test::source_dir()) / folder))
      if (entry.path().extension() == ".json") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<Usual> usual;
  for (const fs::path& file : files) try {
      const scene::Scene scene = scene::load_scene(file);
      if (!scene.contact) continue;
      const double before = cpu_seconds();
      Trajectory run = run_of(scene);
      const double cpu_s = cpu_seconds() - before;
      if (cpu_s <= kLongest && is_right(scene, run))
        usual.push_back({scene, std::move(run), cpu_s});
    } catch (const std::exception&) {  // a broken scene that is refused is left out
    }
  return usual;
}

/// "2 wrong (arch, drop_a_gear), 3e-06 m, CPU 1.8": nothing where no scene changes.
std::string noticed(const std::vector<Usual>& all) {
  std::vector<std::string> wrong, slow;
  double farthest = 0.0, cpu = 0.0, usual_cpu = 0.0;
  for (const Usual& usual : all) {
    const auto looked = look(usual);
    if (!looked) {
      slow.push_back(usual.scene.name);
      continue;
    }
    if (!looked->is_right) wrong.push_back(usual.scene.name);
    farthest = std::max(farthest, looked->farthest);
    cpu += looked->cpu_s;
    usual_cpu += usual.cpu_s;
  }
  std::string words;
  const auto add = [&](const std::string& more) { words += (words.empty() ? "" : "; ") + more; };
  const auto list = [&](const char* what, const std::vector<std::string>& names) {
    if (names.empty()) return;
    std::string some;
    for (std::size_t i = 0; i < names.size() && i < 3; ++i) some += (i > 0 ? ", " : "") + names[i];
    add(fmt::format("{} {} ({}{})", names.size(), what, some, names.size() > 3 ? ", ..." : ""));
  };
  list("wrong", wrong);
  list("slow or crashed", slow);
  if (farthest > kSeen) add(fmt::format("{:.0e} m", farthest));
  if (std::abs(cpu - usual_cpu) > 0.1 * usual_cpu) add(fmt::format("CPU {:.1f}", cpu / usual_cpu));
  return words;
}

int measure(const std::vector<std::string>& asked) {
  const std::vector<std::string> names = names_of_constants();
  if (names.size() != boost::pfr::tuple_size_v<engines::ContactConstants>) {
    std::fprintf(stderr,
                 "contact_constants.h: %zu names are read, and the struct has %zu members: keep "
                 "one member a line\n",
                 names.size(), boost::pfr::tuple_size_v<engines::ContactConstants>);
    return 2;
  }
  const std::vector<Usual> all = usual_runs();
  fmt::print(
      "{} scenes, each right and with contacts, by rd\n\n| constant | times 10 | over 10 "
      "|\n|---|---|---|\n",
      all.size());
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (!asked.empty() && std::find(asked.begin(), asked.end(), names[k]) == asked.end()) continue;
    std::string cells[2];
    for (int which = 0; which < 2; ++which) {
      engines::kContact = {};
      scale(engines::kContact, k, which == 0 ? 10.0 : 0.1);
      cells[which] = noticed(all);
    }
    engines::kContact = {};
    fmt::print("| `{}` | {} | {} |\n", names[k], cells[0].empty() ? "nobody" : cells[0],
               cells[1].empty() ? "nobody" : cells[1]);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace tumble::testing

int main(int argc, char** argv) { return tumble::testing::measure({argv + 1, argv + argc}); }
