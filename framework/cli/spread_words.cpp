#include "framework/cli/spread_words.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <fmt/format.h>

#include "framework/cli/grading_run.h"
#include "framework/core/digest.h"
#include "framework/core/text.h"
#include "framework/scene/build_shape.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;

// In the environment of what --on starts.
constexpr const char* kTask = "TUMBLE_TASK";

std::string time_left(double seconds) {
  if (seconds < 1.0) return "less than 1 s left";
  if (seconds < 120.0) return fmt::format("about {:.0f} s left", seconds);
  if (seconds < 7200.0) return fmt::format("about {:.0f} min left", seconds / 60.0);
  return fmt::format("about {:.1f} h left", seconds / 3600.0);
}

std::string digest_of_word(const modules::ModuleKind& kind, const std::string& word) {
  const fs::path path = word;
  return digest_of_file(fs::is_directory(path) ? path / (kind.folder + ".cpp") : path);
}

}  // namespace

void add_spread_words(Verb& verb, SpreadWords& words, const std::string& pieces) {
  verb.option("--jobs", words.jobs, "Of these " + pieces + " at a time, each in its own process")
      .between(1, 1024)
      .default_text("number of cores");
  verb.option("--on", words.on,
              "Where they are made: local (this machine), " + farm::names_of_clusters() +
                  ". Course and results lie in a folder that all machines share")
      .type_name("WHAT")
      .shows_default();
  verb.option("--shards", words.shards,
              "With --on another than local: in how many tasks; default: one each, at most 1,000")
      .between(1, 1000000);
  verb.option(
          "--hosts", words.hosts,
          "With --on parallel its words for --sshlogin, with --on mpi for --host; default: this "
          "machine")
      .type_name("HOSTS");
  verb.option("--shard", words.shard,
              "Make only this part of the " + pieces +
                  ", e.g. 2/8; the same command without it takes over what is finished")
      .type_name("K/N");
  verb.flag("--again", words.again,
            "Make all of them, also those that an earlier start of this command has finished");
}

void check(const SpreadWords& words) {
  if (words.on != "local") farm::cluster_of(words.on);
  if (words.on != "local" && !words.shard.empty())
    throw UserError("--shard", "is one part, which --on makes itself", "Leave out one of them.");
  if (words.on == "local" && (!words.hosts.empty() || words.shards > 0))
    throw UserError(words.hosts.empty() ? "--shards" : "--hosts",
                    "means nothing on this machine alone", "Add --on slurm, parallel or mpi.");
  if (words.on == "slurm" && !words.hosts.empty())
    throw UserError("--hosts", "are chosen by Slurm",
                    "Leave it out; SBATCH_PARTITION and SBATCH_NODELIST choose machines.");
  if (words.on == "slurm" && words.jobs > 0)
    throw UserError("--jobs", "is for this machine: Slurm decides how many tasks run at a time",
                    "Leave it out.");
}

std::string key_of(const Context& context, const scene::Scene& scene, const ModuleWords& words,
                   const std::string& options) {
  std::string text = digest_of_file("/proc/self/exe") + '\n' + scene.name + ' ' + scene.digest +
                     '\n' + options + '\n';
  for (const fs::path& model : scene::model_files(scene, context.root))
    text += model.filename().string() + ' ' + digest_of_file(model) + '\n';
  for (const modules::ModuleKind* kind : context.registry.all()) {
    text += kind->id + ' ' + digest_of_file(own_file(context, kind->folder)) + ' ' +
            digest_of_file(context.build / "modules" / (kind->id + "_reference.so"));
    for (const auto& [id, word] : words)
      if (id.empty() || id == kind->id) text += ' ' + word + ' ' + digest_of_word(*kind, word);
    text += '\n';
  }
  return digest(text);
}

void hold(const SpreadWords& words, farm::KeptParts& parts) {
  // refused before anything is made
  if (!words.shard.empty()) farm::shard_of(words.shard);
  if (words.on != "local") farm::cluster_of(words.on);
  if (std::getenv(kTask) == nullptr) parts.hold(words.shard);
}

farm::Outcome spread(const Context& context, const SpreadWords& words, const farm::KeptParts& parts,
                     const farm::SplitWork& work, const std::vector<std::string>& command) {
  std::optional<farm::Shard> shard;
  if (!words.shard.empty()) shard = farm::shard_of(words.shard);
  if (words.again)
    for (std::size_t i = 0; i < work.names.size(); ++i)
      if (!shard || shard->holds(i)) parts.forget(work.names[i]);
  const auto progress = [&](std::size_t done, std::size_t all, double seconds_left) {
    fmt::print(stderr, "tumble: {} of {}{}\n", done, counted(all, work.unit),
               done < all && std::isfinite(seconds_left) && seconds_left >= 0.0
                   ? ", " + time_left(seconds_left)
                   : "");
  };
  farm::Outcome outcome;
  if (words.on == "local") {
    farm::LocalOptions options;
    options.jobs = words.jobs > 0 ? words.jobs : default_jobs();
    options.shard = shard;
    options.progress = progress;
    outcome = farm::make_here(parts, work, options);
  } else {
    farm::ClusterJob job;
    job.cluster = farm::cluster_of(words.on);
    job.name = "tumble-" + command.front();
    job.command = {(context.build / "bin/tumble").string()};
    job.command.insert(job.command.end(), command.begin(), command.end());
    job.directory = fs::current_path();
    job.needed = {job.command.front(), context.root.string(), job.directory.string(),
                  fs::absolute(parts.folder()).string()};
    job.environment = {{"TUMBLE_ROOT", context.root.string()}, {kTask, "1"}};
    job.shards = words.shards;
    job.hosts = words.hosts;
    job.jobs = words.jobs;
    job.progress = progress;
    job.notice = [](const std::string& sentence) { fmt::print(stderr, "tumble: {}\n", sentence); };
    fs::create_directories(parts.folder());
    outcome = farm::make_on(parts, work, job);
  }
  if (outcome.taken_over > 0)
    fmt::print(stderr, "tumble: {} of an earlier start taken over; --again makes them anew\n",
               counted(outcome.taken_over, work.unit));
  return outcome;
}

std::string lost_in_words(const farm::Outcome& outcome, const std::string& unit) {
  if (outcome.lost.empty()) return "";
  constexpr std::size_t kNamed = 5;
  std::string names;
  for (std::size_t i = 0; i < std::min(kNamed, outcome.lost.size()); ++i)
    names +=
        fmt::format("{}{} ({})", i == 0 ? "" : "; ", outcome.lost[i].label, outcome.lost[i].why);
  return fmt::format("{} missing: {}{}. The same command makes what is missing.",
                     counted(outcome.lost.size(), unit), names,
                     outcome.lost.size() > kNamed ? "; ..." : "");
}

void end_shard(Context& context, const SpreadWords& words, const farm::Outcome& outcome,
               const std::string& unit) {
  fmt::print("shard {}: the same command without --shard takes over what it has finished\n",
             words.shard);
  if (outcome.lost.empty()) return;
  fmt::print(stderr, "tumble: {}\n", lost_in_words(outcome, unit));
  context.exit = ExitCode::kCheckFailed;
}

}  // namespace tumble::cli
