/// The ledger of a folder of results: a file to which every result is appended once, and from which
/// nothing is removed.
///
/// OUT/ledger.jsonl holds one entry a line, as JSON without line breaks. An entry names what was
/// judged, by what, and the digest of the result; "previous" is the digest of the entry before it
/// (64 zeros for the first), and "digest", the last field, is the SHA-256 of the line up to it,
/// closed by "}". So a change of one entry shows in that entry or in the next one. Entries hold no
/// times, so that equal runs write equal ledgers.
///
/// The chain alone does not show that its end was cut off, or that all of it was written anew. For
/// that, keep the digest of the last entry (the head) elsewhere, or check the ledger together with
/// the results beside it, whose records are signed.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "framework/grading/grades/test_change.h"

namespace tumble::grading {

inline constexpr const char* kLedgerFile = "ledger.jsonl";

/// What one entry says.
struct LedgerEntry {
  std::string assignment;
  std::string name;                         // as plain_name gives it
  std::string folder;                       // of its results, in OUT
  std::string submission, judging, rubric;  // digests, as in GradeKey
  std::string version;                      // of the program
  std::string compiler;                     // in words, with its version
  std::string sandbox;                      // in words
  bool is_official = true, is_final = true;
  std::string results;  // digest of results.json
  std::optional<double> score;
  std::string change;               // "80 -> 85: the tests changed"; empty: none
  std::vector<TestChange> changes;  // test by test
  std::string digest;               // of the entry, once it stands in a ledger
};

/// "g++ (Debian 12.2.0-14) 12.2.0": the compiler of submissions, as it names itself.
std::string compiler_in_words();

/// The line of an entry, without its line break.
/// @param number  of the entry, from 1
std::string ledger_line(const LedgerEntry& entry, std::size_t number, const std::string& previous);

/// What stands in a ledger.
struct LedgerContent {
  std::vector<LedgerEntry> entries;  // up to the first that does not fit
  std::string head;                  // digest of the last of them; 64 zeros: none
  // the first entry that does not fit, and why: "entry 5 (line 5, ada): ..."; empty: all do
  std::string fault;
  // bytes after the last line break: what a killed run was writing
  std::string unfinished;
  std::size_t whole_bytes = 0;  // of the file, without `unfinished`
};

/// Reads and checks a ledger. A missing file is an empty ledger.
/// @throws UserError when the file exists and cannot be read
LedgerContent read_ledger(const std::filesystem::path& file);

/// The last entry of each folder.
std::map<std::string, LedgerEntry> latest_entries(const LedgerContent& ledger);

/// Compares a ledger with the results beside it.
/// @param out  a folder of results
/// @return one sentence for each folder of results that its last entry does not describe, and for
///         each that has none
std::vector<std::string> differences_from_results(const LedgerContent& ledger,
                                                  const std::filesystem::path& out);

/// A score of a folder of results, and the submission that has it.
struct LedgerScore {
  std::string submission;  // digest
  double score = 0.0;
};

/// The last score of each folder, also where later entries have none.
std::map<std::string, LedgerScore> last_scores(const LedgerContent& ledger);

/// A ledger open for appending.
class Ledger {
 public:
  /// Reads the ledger. An unfinished last line is removed: the result that it was about still lies
  /// in place, and is appended again.
  /// @throws UserError when an entry does not fit: nothing is appended to a broken chain
  explicit Ledger(const std::filesystem::path& file);

  /// Whether a line was unfinished.
  bool was_mended() const { return was_mended_; }

  /// The last score of a folder, also where later entries have none; null: it never had one.
  const LedgerScore* last_score(const std::string& folder) const;

  /// Appends the entry, unless the last entry of its folder says the same.
  /// @throws UserError when the file cannot be written
  void append(const LedgerEntry& entry);

 private:
  std::filesystem::path file_;
  std::map<std::string, LedgerEntry> latest_;
  std::map<std::string, LedgerScore> scores_;  // by folder
  std::size_t count_ = 0;
  std::string head_;
  bool was_mended_ = false;
};

}  // namespace tumble::grading
