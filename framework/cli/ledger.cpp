// tumble ledger verify OUT: does every entry of the ledger fit the one before it?
#include <algorithm>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/json_output.h"
#include "framework/cli/verb.h"
#include "framework/core/nearest_word.h"
#include "framework/grading/grades/ledger.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;

struct LedgerWords {
  std::string action, place, head;
  bool json = false;
};

// The sentences that say what is wrong.
std::vector<std::string> faults_of(const grading::LedgerContent& ledger, const fs::path& place,
                                   const std::string& head) {
  std::vector<std::string> faults;
  if (!ledger.fault.empty()) return {ledger.fault};
  if (!ledger.unfinished.empty())
    faults.push_back(
        "the last line is unfinished, because a run was killed while it wrote it; the same grade "
        "command writes it again");
  const bool has_head =
      std::any_of(ledger.entries.begin(), ledger.entries.end(),
                  [&](const grading::LedgerEntry& entry) { return entry.digest == head; });
  if (!head.empty() && !has_head)
    faults.push_back("no entry has the digest " + head +
                     ": entries were removed from the end, or all were written anew");
  if (fs::is_directory(place))
    for (const std::string& difference : grading::differences_from_results(ledger, place))
      faults.push_back(difference);
  return faults;
}

void verify(Context& context, const LedgerWords& words) {
  if (words.action != "verify")
    throw UserError("ledger " + words.action,
                    "there is no such action." + did_you_mean(words.action, {"verify"}),
                    "For example: tumble ledger verify out/grade_a1");
  const fs::path place(words.place);
  const bool is_folder = fs::is_directory(place);
  const fs::path file = is_folder ? place / grading::kLedgerFile : place;
  if (!fs::exists(file))
    throw UserError(file.string(), "does not exist",
                    "Name a folder of results, or a ledger.jsonl.");
  const grading::LedgerContent ledger = grading::read_ledger(file);
  const auto faults = faults_of(ledger, place, words.head);
  if (!faults.empty()) context.exit = ExitCode::kCheckFailed;
  if (words.json)
    return print_json(context, {{"ledger", file.string()},
                                {"entries", ledger.entries.size()},
                                {"submissions", grading::latest_entries(ledger).size()},
                                {"head", ledger.head},
                                {"faults", faults}});
  for (const std::string& fault : faults) fmt::print("{}: {}\n", file.string(), fault);
  if (!faults.empty()) return;
  fmt::print("{}: {} entries of {} submissions fit together{}\nhead {}\n", file.string(),
             ledger.entries.size(), grading::latest_entries(ledger).size(),
             is_folder
                 ? ", and describe the results.json beside it (a gradebook.csv is not compared: "
                   "the next grading into the folder writes it anew from these)"
                 : "",
             ledger.head);
}

}  // namespace

void add_ledger(CLI::App& app, Context& context) {
  auto words = std::make_shared<LedgerWords>();
  Verb verb(app, "ledger", "Check the ledger of a folder of results, entry by entry");
  verb.option("action", words->action, "verify").required().type_name("ACTION");
  verb.option(
          "place", words->place,
          "A folder of results, whose results.json files are compared with its ledger too; or a "
          "ledger.jsonl alone")
      .required()
      .type_name("OUT|FILE");
  verb.option("--head", words->head,
              "The digest that an earlier verify printed as head and that was kept elsewhere: the "
              "ledger must still hold that entry")
      .type_name("DIGEST");
  verb.flag("--json", words->json, "For machines");
  verb.footer(
      "Exit: 0 every entry fits, 1 one does not (the first is named) or a result beside it is not "
      "the one that it names, 2 something to repair.\n"
      "Each entry holds the SHA-256 of the entry before it. That alone does not show that the end "
      "was cut off: keep the head.");
  verb.runs([&context, words] { verify(context, *words); });
}

}  // namespace tumble::cli
