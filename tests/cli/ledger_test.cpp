// The ledger: a chain in which a change of any entry shows, and to which a killed run loses nothing.
#include <fstream>

#include <gtest/gtest.h>

#include "framework/core/digest.h"
#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/grading/grades/class_facts.h"
#include "framework/grading/grades/ledger.h"
#include "framework/grading/grades/ledger_records.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

class LedgerOfThree : public ::testing::Test {
 protected:
  LedgerOfThree() {
    Ledger ledger(file());
    for (const char* name : {"ada", "blaise", "carl"}) {
      write_whole(out() / name / "results.json", name);
      ledger.append(entry(name, 80.0));
    }
  }
  LedgerEntry entry(const std::string& name, double score) const {
    LedgerEntry entry;
    entry.assignment = "a9";
    entry.name = entry.folder = name;
    entry.submission = digest(name);
    entry.results = digest(name);
    entry.score = score;
    return entry;
  }
  fs::path out() const { return folder_.path(); }
  fs::path file() const { return out() / kLedgerFile; }
  std::vector<std::string> lines() const {
    std::vector<std::string> lines;
    std::ifstream in(file());
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
  }
  void write(const std::vector<std::string>& lines) const {
    std::string text;
    for (const std::string& line : lines) text += line + '\n';
    write_whole(file(), text);
  }
  std::string fault() const { return read_ledger(file()).fault; }

  PrivateFolder folder_;
};

TEST_F(LedgerOfThree, FitsTogetherAndDescribesTheResults) {
  const LedgerContent ledger = read_ledger(file());
  EXPECT_EQ(ledger.fault, "");
  ASSERT_EQ(ledger.entries.size(), 3u);
  EXPECT_EQ(ledger.entries[2].name, "carl");
  EXPECT_EQ(ledger.entries[2].score, 80.0);
  EXPECT_EQ(differences_from_results(ledger, out()), std::vector<std::string>{});
}

TEST_F(LedgerOfThree, DigestIsOfTheLineUpToIt) {
  std::string line = lines()[0];
  const auto at = line.find(",\"digest\":\"");
  const std::string said = line.substr(at + 11, 64);
  EXPECT_EQ(said, digest(line.substr(0, at) + "}"));
  EXPECT_NE(lines()[1].find("\"previous\":\"" + said + "\""), std::string::npos);
}

TEST_F(LedgerOfThree, GrowsOnlyByWhatIsNew) {
  Ledger ledger(file());
  ledger.append(entry("ada", 80.0));
  EXPECT_EQ(lines().size(), 3u);
  ledger.append(entry("ada", 90.0));
  EXPECT_EQ(lines().size(), 4u);
  EXPECT_EQ(fault(), "");
  EXPECT_EQ(latest_entries(read_ledger(file())).at("ada").score, 90.0);
}

// A fault of the grader has no score: who lowers the next one lowers the one before it.
TEST_F(LedgerOfThree, HoldsTheLastScoreBehindAnEntryWithoutOne) {
  LedgerEntry fault = entry("ada", 0.0);
  fault.score.reset();
  fault.is_final = false;
  Ledger ledger(file());
  ledger.append(fault);
  ASSERT_NE(ledger.last_score("ada"), nullptr);
  EXPECT_EQ(ledger.last_score("ada")->score, 80.0);
  EXPECT_EQ(Ledger(file()).last_score("ada")->score, 80.0) << "it is lost by reading it again";
  EXPECT_EQ(Ledger(file()).last_score("ada")->submission, digest("ada"));
  EXPECT_EQ(ledger.last_score("dora"), nullptr);
}

// What a class is shown and students get is held against the ledger, as what is graded.
TEST_F(LedgerOfThree, AnOlderResultThatWasPutBackIsNotAmongThoseOfTheClass) {
  const std::string key(32, 'k');
  const auto put_back = [&](const std::string& name, double score, const std::string& submission) {
    GradeRecord record;
    record.assignment = "a9";
    record.key.submission = submission;
    record.grade.name = record.grade.folder = name;
    record.grade.state = GradeState::kJudged;
    record.grade.score = score;
    record.files = digests_below(out() / name);
    write_whole(out() / name / "record.json", record_json(record, key));
  };
  put_back("ada", 70.0, digest("ada"));
  put_back("blaise", 80.0, digest("blaise"));
  put_back("carl", 70.0, digest("another file of his"));
  std::string said;
  std::vector<std::string> names;
  for (const GradeRecord& record :
       records_of(out(), "a9", key, [&](const std::string& text) { said += text + '\n'; }))
    names.push_back(record.grade.name);
  EXPECT_EQ(names, (std::vector<std::string>{"blaise", "carl"}));
  EXPECT_EQ(said, std::string("ada is left out, because ") + kOlderThanLedger + '\n');
}

// The name of a folder with a line break: escaped once, and the same after it was read again.
TEST_F(LedgerOfThree, AnEscapedNameStaysAsItIs) {
  const LedgerEntry odd = entry("a\\x0Ab", 80.0);
  Ledger(file()).append(odd);
  EXPECT_EQ(read_ledger(file()).entries.back().name, odd.name);
  Ledger(file()).append(odd);
  EXPECT_EQ(lines().size(), 4u) << "nothing is new";
}

TEST_F(LedgerOfThree, AnEditedEntryIsNamed) {
  auto all = lines();
  all[1].replace(all[1].find("80"), 2, "90");
  write(all);
  EXPECT_EQ(fault(), "entry 2, blaise: its text was changed: its digest is of another text");
}

TEST_F(LedgerOfThree, AnEntryWrittenAnewShowsInTheNextOne) {
  auto all = lines();
  const std::string first = read_ledger(file()).entries[0].digest;
  all[1] = ledger_line(entry("blaise", 100.0), 2, first);
  write(all);
  EXPECT_EQ(fault(),
            "entry 3, carl: it does not continue the entry before it: that one was replaced");
}

TEST_F(LedgerOfThree, ARemovedAndAMovedEntryAreNamed) {
  const auto all = lines();
  write({all[0], all[2]});
  EXPECT_NE(fault().find("entry 2, carl: it has the number 3"), std::string::npos) << fault();
  write({all[1], all[0], all[2]});
  EXPECT_NE(fault().find("entry 1, blaise: it has the number 2"), std::string::npos) << fault();
}

TEST_F(LedgerOfThree, AnEndCutOffShowsBesideTheResults) {
  const auto all = lines();
  write({all[0], all[1]});
  EXPECT_EQ(fault(), "") << "the chain alone cannot show it";
  EXPECT_EQ(differences_from_results(read_ledger(file()), out()),
            std::vector<std::string>{"carl: has results, and no entry in the ledger"});
}

TEST_F(LedgerOfThree, AChangedResultShows) {
  write_whole(out() / "ada/results.json", "100 points");
  const auto differences = differences_from_results(read_ledger(file()), out());
  ASSERT_EQ(differences.size(), 1u);
  EXPECT_EQ(differences[0], "ada: ada/results.json is not the result that its last entry names");
}

TEST_F(LedgerOfThree, AnUnfinishedLineIsWrittenAgain) {
  const auto all = lines();
  for (const std::size_t kept : {std::size_t{1}, all[2].size() / 2, all[2].size()}) {
    write_whole(file(), all[0] + '\n' + all[1] + '\n' + all[2].substr(0, kept));
    EXPECT_EQ(read_ledger(file()).unfinished.size(), kept);
    Ledger ledger(file());
    EXPECT_TRUE(ledger.was_mended());
    ledger.append(entry("carl", 80.0));
    EXPECT_EQ(lines(), all) << kept;
  }
}

TEST_F(LedgerOfThree, NothingIsAppendedToABrokenChain) {
  auto all = lines();
  all[0].replace(all[0].find("80"), 2, "90");
  write(all);
  EXPECT_THROW(Ledger{file()}, UserError);
  EXPECT_EQ(lines(), all);
}

}  // namespace
}  // namespace tumble::grading
