/// The words of a verb whose work is in independent pieces (chains of a scene, points of a sweep):
/// how many at a time, on which machines; and the pieces made as they say.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/cli/module_choice.h"
#include "framework/cli/verb.h"
#include "framework/farm/spread.h"
#include "framework/scene/scene.h"

namespace tumble::cli {

struct SpreadWords {
  int jobs = 0;  // 0: one a core
  std::string on = "local", hosts, shard;
  int shards = 0;
  bool again = false;
};

/// Declares --jobs, --on, --shards, --hosts, --shard and --again.
/// @param pieces  what the work consists of: "chains"
void add_spread_words(Verb& verb, SpreadWords& words, const std::string& pieces);

/// @throws UserError for words that contradict each other or mean nothing
void check(const SpreadWords& words);

/// A digest of all that decides a piece's result: this program, the scene with its models, every
/// module's code, and the verb's own options.
/// @param options  in any form, all that matter
std::string key_of(const Context& context, const scene::Scene& scene, const ModuleWords& words,
                   const std::string& options);

/// The folder is this command's until `parts` ends. A task that --on started has it from the
/// command that waits for it.
/// @throws UserError when another command holds it
void hold(const SpreadWords& words, farm::KeptParts& parts);

/// Makes what is missing of the work, with progress on stderr. With --shard only that part, and the
/// verb then ends: nothing is to be shown of a part.
/// @param command  words of a task on another machine: the verb's, without those of SpreadWords
/// @throws UserError as farm::make_on; what a piece threw
farm::Outcome spread(const Context& context, const SpreadWords& words, const farm::KeptParts& parts,
                     const farm::SplitWork& work, const std::vector<std::string>& command);

/// What is missing in a sentence for terminals and pages; empty where nothing is.
std::string lost_in_words(const farm::Outcome& outcome, const std::string& unit);

/// Ends a command that was one shard: says what it did, and sets the exit code.
void end_shard(Context& context, const SpreadWords& words, const farm::Outcome& outcome,
               const std::string& unit);

}  // namespace tumble::cli
