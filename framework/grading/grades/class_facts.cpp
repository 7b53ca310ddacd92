#include "framework/grading/grades/class_facts.h"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "framework/core/text.h"
#include "framework/grading/grades/ledger.h"
#include "framework/grading/grades/ledger_records.h"
#include "framework/grading/verdicts/mend_order.h"
#include "framework/grading/verdicts/plain_text.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

// What follows "likely:" in a story, each once.
void collect_slips(const std::string& story, std::set<std::string>& slips) {
  constexpr std::string_view kMark = "likely:";
  std::istringstream lines(story);
  for (std::string line; std::getline(lines, line);) {
    const auto first = line.find_first_not_of(' ');
    if (first == std::string::npos || line.compare(first, kMark.size(), kMark) != 0) continue;
    const auto text = line.find_first_not_of(' ', first + kMark.size());
    if (text != std::string::npos)
      slips.insert(plain_name(parts_of_mistake(line.substr(text)).mistake));
  }
}

bool is_failed(const ScoredTest& test) {
  const Verdict verdict = test.result.verdict;
  return verdict == Verdict::kWrong || verdict == Verdict::kCrashed ||
         verdict == Verdict::kOutOfResources;
}

// Stories of the failing tests, in lower case, by test.
std::map<std::string, std::string> failing_stories(const Grade& grade) {
  std::map<std::string, std::string> stories;
  for (const ScoredTest& test : grade.tests)
    if (is_failed(test)) stories[test.item.test] = lowercase(test.result.story);
  return stories;
}

bool is_recognised(const KnownSlip& known, const std::map<std::string, std::string>& stories) {
  const std::string keyword = lowercase(known.keyword);
  bool is_named = false;
  for (const std::string& test : known.tests) {
    const auto it = stories.find(test);
    if (it == stories.end()) return false;
    is_named = is_named || it->second.find(keyword) != std::string::npos;
  }
  return is_named;
}

std::set<std::string> known_slips_of(const Grade& grade, const std::vector<KnownSlip>& known) {
  const auto stories = failing_stories(grade);
  std::vector<const KnownSlip*> recognised;
  for (const KnownSlip& slip : known)
    if (is_recognised(slip, stories)) recognised.push_back(&slip);
  std::set<std::string> slips, explained;
  for (;;) {
    const KnownSlip* best = nullptr;
    std::ptrdiff_t most = 0;
    for (const KnownSlip* slip : recognised) {
      const std::ptrdiff_t gain =
          std::count_if(slip->tests.begin(), slip->tests.end(),
                        [&](const std::string& test) { return !explained.contains(test); });
      if (gain > most) {
        most = gain;
        best = slip;
      }
    }
    if (!best) return slips;
    slips.insert(best->slip);
    explained.insert(best->tests.begin(), best->tests.end());
  }
}

}  // namespace

std::set<std::string> slips_of(const Grade& grade, const std::vector<KnownSlip>& known) {
  std::set<std::string> slips = known_slips_of(grade, known);
  if (!slips.empty()) return slips;
  for (const ScoredTest& test : grade.tests)
    if (test.result.verdict == Verdict::kWrong) collect_slips(test.result.story, slips);
  return slips;
}

void SlipTally::add(const Grade& grade) {
  for (const std::string& slip : slips_of(grade, known_)) names_[slip].insert(grade.name);
}

std::vector<SlipCount> SlipTally::made_most(std::size_t most) const {
  std::vector<SlipCount> counts;
  for (const auto& [slip, who] : names_) counts.push_back({slip, {who.begin(), who.end()}});
  std::stable_sort(counts.begin(), counts.end(), [](const SlipCount& a, const SlipCount& b) {
    return a.names.size() > b.names.size();
  });
  if (counts.size() > most) counts.resize(most);
  return counts;
}

std::vector<TestCount> test_counts(const std::vector<Grade>& grades) {
  std::vector<TestCount> counts;
  std::map<std::string, std::size_t> place;
  for (const Grade& grade : grades) {
    if (!grade.has_score()) continue;
    grade.each_verdict([&](const RubricItem& item, Verdict verdict) {
      const auto [it, is_new] = place.emplace(item.test, counts.size());
      if (is_new) counts.push_back({item});
      ++counts[it->second].judged;
      counts[it->second].right += verdict == Verdict::kRight;
    });
  }
  return counts;
}

std::vector<std::vector<std::string>> equal_submissions(const std::vector<GradeRecord>& records) {
  std::map<std::string, std::vector<std::string>> by_digest;
  for (const GradeRecord& record : records)
    if (record.grade.state != GradeState::kNothingToCompile)
      by_digest[record.key.submission].push_back(record.grade.name);
  std::vector<std::vector<std::string>> groups;
  for (auto& [digest, names] : by_digest)
    if (names.size() > 1) groups.push_back(std::move(names));
  std::sort(groups.begin(), groups.end());
  return groups;
}

std::vector<GradeRecord> records_of(const fs::path& out, const std::string& assignment,
                                    const std::string& machine_key,
                                    const std::function<void(const std::string&)>& notice) {
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(out))
    if (entry.is_directory() && !entry.is_symlink() && fs::exists(entry.path() / "record.json"))
      folders.push_back(entry.path());
  std::sort(folders.begin(), folders.end());
  const LedgerContent ledger = read_ledger(out / kLedgerFile);
  if (!ledger.fault.empty())
    notice(
        "the ledger does not fit together, and results are not compared with it from there on: " +
        ledger.fault);
  const std::map<std::string, LedgerScore> scores = last_scores(ledger);
  std::vector<GradeRecord> records;
  for (const fs::path& folder : folders) {
    const std::string name = folder.filename().string();
    EarlierRun run = read_earlier_run(folder, assignment, machine_key);
    const auto last = scores.find(name);
    if (run.record &&
        is_older_than_ledger(*run.record, last == scores.end() ? nullptr : &last->second))
      run = {{}, kOlderThanLedger};
    if (run.record && run.record->grade.is_held)
      run = {{}, "it is missing, and tumble regrade asks whether the new score may be lower"};
    if (run.record)
      records.push_back(std::move(*run.record));
    else if (!name.starts_with('.'))
      notice(plain_name(name) + " is left out, because " + run.problem);
  }
  return records;
}

}  // namespace tumble::grading
