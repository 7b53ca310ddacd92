// The folder of results: one of the grader's own, or an empty one. Of an earlier run only what this
// machine's key signed is trusted.
#include <cstdlib>
#include <fstream>

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/digest.h"
#include "framework/grading/grades/grade_files.h"
#include "framework/grading/course/machine_key.h"
#include "framework/grading/grades/ledger.h"
#include "framework/grading/grades/output_folder.h"
#include "framework/grading/grades/scoring.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Digest, IsSha256) {
  // FIPS 180-4's own examples.
  EXPECT_EQ(digest(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(digest("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Digest, AuthenticationIsHmacSha256) {
  // RFC 4231, test case 2.
  EXPECT_EQ(authentication_code("Jefe", "what do ya want for nothing?"),
            "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843");
}

TEST(Digest, OfAFileIsThatOfItsBytes) {
  const PrivateFolder folder;
  const std::string bytes(200'000, 'x');  // more than one piece
  write_whole(folder.path() / "file", bytes);
  EXPECT_EQ(digest_of_file(folder.path() / "file"), digest(bytes));
  EXPECT_EQ(digest_of_file(folder.path() / "none"), "missing");
}

TEST(Folders, OfTheDeadAreSweptAndOfTheLivingNot) {
  const PrivateFolder where;
  const pid_t gone = ::fork();
  if (gone == 0) ::_exit(0);
  ::waitpid(gone, nullptr, 0);
  const std::string dead = std::to_string(gone);
  for (const std::string& name :
       {"t-" + dead + "-a", "t-" + dead + "-held", "t-" + std::to_string(::getpid()) + "-a",
        "t-" + dead, "u-" + dead + "-a"})
    write_whole(where.path() / name / "file", "x");
  fs::create_directory_symlink(where.path() / ("u-" + dead + "-a"),
                               where.path() / ("t-" + dead + "-link"));
  // as by a process of another container, whose number is unused here
  const int held = hold_folder(where.path() / ("t-" + dead + "-held"));
  sweep_folders_of_the_dead(where.path(), "t-");
  EXPECT_FALSE(fs::exists(where.path() / ("t-" + dead + "-a")));
  for (const std::string& name : {"t-" + dead + "-held", "t-" + std::to_string(::getpid()) + "-a",
                                  "t-" + dead, "u-" + dead + "-a"})
    EXPECT_TRUE(fs::exists(where.path() / name / "file")) << name;
  ::close(held);
}

class Key : public ::testing::Test {
 protected:
  Key() { ::setenv("TUMBLE_GRADER_KEY", file().c_str(), 1); }
  ~Key() override { ::unsetenv("TUMBLE_GRADER_KEY"); }
  fs::path file() const { return folder_.path() / "state/grader.key"; }
  PrivateFolder folder_;
};

TEST_F(Key, IsMadeOnFirstUseForThisUserAloneAndKept) {
  const MachineKey first = machine_key(), second = machine_key();
  EXPECT_EQ(first.bytes.size(), 32u);
  EXPECT_NE(first.notice.find(file().string()), std::string::npos) << first.notice;
  EXPECT_EQ(second.bytes, first.bytes);
  EXPECT_EQ(second.notice, "");
  struct stat about {};
  ASSERT_EQ(::stat(file().c_str(), &about), 0);
  EXPECT_EQ(about.st_mode & 07777, 0600u);
}

// The file may belong to another purpose: named by mistake in TUMBLE_GRADER_KEY.
void expect_refused(const fs::path& file, const std::string& why) {
  try {
    machine_key();
    ADD_FAILURE() << why << ": taken";
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find(file.string()), std::string::npos) << error.what();
  }
}

TEST_F(Key, ThatOthersCanReadIsRefusedAndStays) {
  machine_key();
  const std::string first = text_of(file());
  ASSERT_EQ(::chmod(file().c_str(), 0644), 0);
  expect_refused(file(), "can be read or written by others");
  EXPECT_EQ(text_of(file()), first);
}

TEST_F(Key, ThatIsALinkOrNoKeyIsRefusedAndStays) {
  fs::create_directories(file().parent_path());
  fs::create_symlink("/etc/hostname", file());
  expect_refused(file(), "symbolic link");
  EXPECT_TRUE(fs::is_symlink(fs::symlink_status(file())));
  fs::remove(file());
  write_whole(file(), "short");
  fs::permissions(file(), fs::perms::owner_read | fs::perms::owner_write);
  expect_refused(file(), "is not a key");
  EXPECT_EQ(text_of(file()), "short");
}

TEST_F(Key, ThatCannotBeKeptIsAnotherEachTime) {
  ::setenv("TUMBLE_GRADER_KEY", "/proc/none/grader.key", 1);
  const MachineKey first = machine_key(), second = machine_key();
  EXPECT_NE(first.bytes, second.bytes);
  EXPECT_NE(first.notice.find("TUMBLE_GRADER_KEY"), std::string::npos) << first.notice;
}

class Output : public ::testing::Test {
 protected:
  Output() { fs::create_directories(subs()); }
  fs::path root() const { return folder_.path(); }
  fs::path subs() const { return root() / "subs"; }
  std::string refusal(const fs::path& out, const std::string& id = "a1") const {
    try {
      const OutputFolder folder(out, subs(), id);
      return "";
    } catch (const UserError& error) {
      return error.what();
    }
  }
  // A folder in which this grader has made `folder`, with the files of a submission.
  void make(const fs::path& out, const std::string& folder) const {
    OutputFolder output(out, subs(), "a1");
    output.claim({folder});
    for (const char* file : {"index.html", "results.json", "record.json", "media/pong.png"})
      write_whole(out / folder / file, "x");
  }
  PrivateFolder folder_;
};
bool names(const std::string& refusal, const std::string& part) {
  return refusal.find(part) != std::string::npos;
}

TEST_F(Output, ThatOverlapsTheSubmissionsIsRefusedByAnyPath) {
  fs::create_directories(subs() / "alice");
  fs::create_directory_symlink(subs(), root() / "link");
  fs::create_directory_symlink(root(), root() / "up");
  for (const fs::path& out :
       {subs(), subs() / ".", subs() / "alice/..", root() / "link", root() / "up/subs"})
    EXPECT_TRUE(names(refusal(out), "is the folder of the submissions itself")) << out;
  for (const fs::path& out :
       {subs() / "out", subs() / "alice", root() / "link/out", root() / "up/subs/a/b"})
    EXPECT_TRUE(names(refusal(out), "lies in the folder of the submissions")) << out;
  for (const fs::path& out : {root(), root() / "up", root() / "subs/.."})
    EXPECT_TRUE(names(refusal(out), "holds the folder of the submissions")) << out;
  EXPECT_FALSE(fs::exists(subs() / "out"));
  EXPECT_EQ(refusal(root() / "subs2"), "") << "a name that begins alike is another folder";
}

TEST_F(Output, FilesOfOthersAreNamedAndNothingIsTouched) {
  write_whole(root() / "out/thesis.txt", "years of work");
  EXPECT_TRUE(names(refusal(root() / "out"), "thesis.txt: was not written by this grader"))
      << refusal(root() / "out");
  EXPECT_EQ(std::distance(fs::directory_iterator(root() / "out"), {}), 1);
}

TEST_F(Output, FilesThatLookLikeOursAreNotWithoutTheManifest) {
  for (const char* file :
       {"index.html", "alice/record.json", "alice/results.json", ".making-alice/x"}) {
    fs::remove_all(root() / "out");
    write_whole(root() / "out" / file, "x");
    EXPECT_TRUE(names(refusal(root() / "out"), "was not written by this grader")) << file;
  }
}

TEST_F(Output, FilesPutAmongOursAreForeign) {
  for (const char* file : {"notes.txt", "bob/record.json", "alice/comments.txt",
                           "alice/media/talk.pdf", "alice/deep/x.html", ".making-bob/x"}) {
    fs::remove_all(root() / "out");
    make(root() / "out", "alice");
    EXPECT_EQ(refusal(root() / "out"), "") << file;
    write_whole(root() / "out" / file, "x");
    EXPECT_TRUE(names(refusal(root() / "out"), "was not written by this grader")) << file;
    EXPECT_EQ(text_of(root() / "out" / file), "x");
  }
}

TEST_F(Output, AManifestThatLeadsElsewhereIsRefusedAndNothingIsTouched) {
  for (const std::string name : {"x/../../victim", "..", ".", "", "/victim", "a/b"}) {
    fs::remove_all(root() / "out");
    write_whole(root() / "victim/thesis.txt", "years of work");
    fs::create_directories(root() / "out/.making-x");
    write_whole(root() / "out/.tumble-grade.json",
                R"({"assignment": "a1", "folders": ["x", ")" + name + R"("]})");
    EXPECT_TRUE(names(refusal(root() / "out"), "was not written by this grader")) << name;
    EXPECT_TRUE(fs::exists(root() / "victim/thesis.txt")) << name;
  }
}

TEST_F(Output, AListThatCannotBeReadIsSaidWithTheWayOnAndNothingIsTouched) {
  const fs::path list = root() / "out/.tumble-grade.json";
  make(root() / "out", "alice");
  const std::string whole = text_of(list);
  for (const std::string& text : {std::string(), whole.substr(0, whole.size() / 2),
                                  std::string("[]"), std::string(R"({"assignment": "a1"})"),
                                  std::string(R"({"assignment": 1, "folders": []})")}) {
    write_whole(list, text);
    const std::string said = refusal(root() / "out");
    EXPECT_TRUE(names(said, "cannot be read as the list")) << text << said;
    EXPECT_TRUE(names(said, "--mend-list")) << text << said;
    EXPECT_EQ(text_of(list), text);
    EXPECT_TRUE(fs::exists(root() / "out/alice/record.json")) << text;
    EXPECT_THROW(settings_of(root() / "out"), UserError) << text;
  }
}

TEST_F(Output, AListIsMadeAnewFromLedgerRecordsAndDraftsAndOfNothingElse) {
  const fs::path out = root() / "out";
  for (const char* name : {"alice", "bob"}) make(out, name);
  LedgerEntry entry;
  entry.assignment = "a1";
  entry.name = entry.folder = "alice";
  Ledger(out / kLedgerFile).append(entry);
  write_whole(out / "bob/record.json", R"({"assignment": "a1", "folder": "bob"})");
  write_whole(out / ".making-carl/.fault.txt", "half");
  write_whole(out / ".tumble-grade.json", "{");
  {
    const OutputFolder mended(out, subs(), "a1", {}, BrokenList::kMend);
    EXPECT_EQ(mended.folders(), (std::set<std::string>{"alice", "bob", "carl"}));
  }
  EXPECT_EQ(refusal(out), "") << "the list is not written again";
  EXPECT_FALSE(fs::exists(out / ".making-carl"));

  write_whole(out / ".tumble-grade.json", "{");
  const auto mend = [&](const std::string& id) {
    EXPECT_THROW(OutputFolder(out, subs(), id, {}, BrokenList::kMend), UserError) << id;
  };
  mend("a2");
  write_whole(out / "thesis/index.html", "years of work");
  mend("a1");
  EXPECT_EQ(text_of(out / "thesis/index.html"), "years of work");
  EXPECT_EQ(text_of(out / ".tumble-grade.json"), "{") << "the list is made for what is refused";
}

TEST_F(Output, SettingsStayWhereAFolderIsOpenedWithoutAny) {
  const RunSettings settings{"a1", subs(), 7.0, false, "/policy.json", "none"};
  { const OutputFolder graded(root() / "out", subs(), "a1", settings); }
  { const OutputFolder looked_at(root() / "out", subs(), "a1"); }
  EXPECT_EQ(settings_of(root() / "out").policy, "/policy.json");
  EXPECT_EQ(settings_of(root() / "out").submissions, subs());
  EXPECT_EQ(settings_of(root() / "out").budget_s, 7.0);
}

TEST_F(Output, ALinkAmongOursIsForeign) {
  make(root() / "out", "alice");
  fs::remove_all(root() / "out/alice");
  fs::create_directory_symlink(subs(), root() / "out/alice");
  EXPECT_TRUE(names(refusal(root() / "out"), "was not written by this grader"));
}

TEST_F(Output, ResultsOfAnotherAssignmentStay) {
  make(root() / "out", "alice");
  EXPECT_TRUE(names(refusal(root() / "out", "a2"), "holds results of a1, not of a2"))
      << refusal(root() / "out", "a2");
}

TEST_F(Output, IsLockedForAsLongAsAProcessOfTheGradingLives) {
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t other = ::fork();
  if (other == 0) {
    const OutputFolder held(root() / "out", subs(), "a1");
    const ssize_t told = ::write(ready[1], "x", 1);
    ::pause();
    ::_exit(static_cast<int>(told));
  }
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  EXPECT_TRUE(names(refusal(root() / "out"), "another grading writes there"));
  ::kill(other, SIGKILL);
  ::waitpid(other, nullptr, 0);
  EXPECT_EQ(refusal(root() / "out"), "") << "a lock outlives its process";
}

TEST_F(Output, WhatAKilledRunLeftIsSwept) {
  make(root() / "out", "alice");
  for (const char* file : {".making-alice/alice/results.json", ".index.draft123.html",
                           ".gradebook.draft9.csv", "..tumble-grade.draft5.json"})
    write_whole(root() / "out" / file, "half");
  EXPECT_EQ(refusal(root() / "out"), "");
  for (const char* file : {".making-alice", ".index.draft123.html", ".gradebook.draft9.csv",
                           "..tumble-grade.draft5.json"})
    EXPECT_FALSE(fs::exists(root() / "out" / file)) << file;
  EXPECT_TRUE(fs::exists(root() / "out/alice/record.json"));
}

// ---- Records -----------------------------------------------------------------------------------

class Record : public ::testing::Test {
 protected:
  Record() {
    kind.id = "a9";
    kind.title = "Thing";
    grade.name = "x\xff";  // no UTF-8
    grade.folder = "x";
    grade.state = GradeState::kJudged;
    TestResult crashed;
    crashed.test = "S.Open";
    crashed.verdict = Verdict::kCrashed;
    crashed.story = "SIGSEGV";
    grade.tests = {{{"S.Open", 100.0, "basic", "Open one", false}, crashed, 0.0}};
    grade.notes = {"a note"};
    grade.changes = {
        {"S.Open", "Open one", "right, 100 of 100", "crashed, 0 of 100", "the submission changed"}};
    grade.media = {{"pong",
                    "Pong",
                    "about",
                    "pong.png",
                    "pong.mp4",
                    "",
                    true,
                    {{"gap", "all", INFINITY, 0.0, "m", false, "why", true, "at 1 s"}},
                    "pong.html"}};
    grade.cost.scene = "A ball";
    grade.cost.plots = {{"Error",
                         {"step", "s", report::Scale::kLog},
                         {"error", "m", report::Scale::kLog},
                         {{"rk4", {1.0, 0.5}, {0.1, std::nan("")}, true}},
                         {{1e-9, "floor"}},
                         "caption"}};
    grade.cost.tables = {
        {"counts", {{"name"}, {"n", true}}, {{{"a"}, {"1", "#x", report::Look::kBad}}}}};
    add_up(grade);
    write_grade(kind, grade, {"s", "j", "r", "p"}, place(), key);
  }
  fs::path place() const { return folder_.path() / "x"; }
  EarlierRun read(const std::string& with) const { return read_earlier_run(place(), "a9", with); }
  std::string record() const { return text_of(place() / "record.json"); }

  PrivateFolder folder_;
  modules::ModuleKind kind;
  Grade grade;
  const std::string key = std::string(32, 'k');
};

TEST_F(Record, IsReadAsItWasWritten) {
  const EarlierRun run = read(key);
  ASSERT_TRUE(run.record) << run.problem;
  EXPECT_EQ(record_json(*run.record, key), record());
  EXPECT_TRUE(std::isinf(run.record->grade.media[0].checks[0].value));
  EXPECT_EQ(run.record->grade.cost.plots.at(0).curves.at(0).x, (std::vector<double>{1.0, 0.5}));
  EXPECT_EQ(run.record->grade.cost.tables.at(0).rows.at(0).at(1).look, report::Look::kBad);
}

TEST_F(Record, KeepsFaultsBehindTheVerdictsForTheGraderAlone) {
  grade.faults = {"the pictures: secret_file.json"};
  write_grade(kind, grade, {"s", "j", "r", "p"}, place(), key);
  const EarlierRun run = read(key);
  ASSERT_TRUE(run.record) << run.problem;
  EXPECT_EQ(run.record->grade.faults, grade.faults);
  EXPECT_TRUE(run.record->grade.has_score());
  EXPECT_NE(text_of(place() / "index.html").find("secret_file"), std::string::npos);
  for (const char* file : {"student.html", "results.json"})
    EXPECT_EQ(text_of(place() / file).find("secret_file"), std::string::npos) << file;
}

TEST_F(Record, CountsOnlyWithTheKeyThatSignedIt) {
  const EarlierRun run = read(std::string(32, 'l'));
  EXPECT_FALSE(run.record);
  EXPECT_EQ(run.problem, "its record is not signed by this machine's key");
}

TEST_F(Record, WithAnyFieldChangedIsNotTrusted) {
  const std::string whole = record();
  const auto json = nlohmann::ordered_json::parse(whole);
  for (const auto& [field, value] : json.items()) {
    auto forged = json;
    if (field == "mac")
      forged[field] = std::string(64, '0');
    else if (value.is_number())
      forged[field] = 100.0;
    else if (value.is_string())
      forged[field] = value.get<std::string>() + "x";
    else
      forged.erase(field);
    if (forged == json) continue;
    write_whole(place() / "record.json", forged.dump());
    EXPECT_FALSE(read(key).record) << field;
  }
  for (const std::string& text : {std::string(), std::string("{"), std::string("[]"),
                                  std::string("{\"mac\": 1}"), whole.substr(0, whole.size() / 2)}) {
    write_whole(place() / "record.json", text);
    EXPECT_FALSE(read(key).record) << text;
  }
  write_whole(place() / "record.json", whole);
  EXPECT_TRUE(read(key).record);
}

TEST_F(Record, OfOtherFilesOrAnotherFolderIsNotTrusted) {
  fs::copy(place(), folder_.path() / "y");
  EXPECT_FALSE(read_earlier_run(folder_.path() / "y", "a9", key).record)
      << "a copy under another student's name";
  EXPECT_FALSE(read_earlier_run(place(), "a8", key).record);
  write_whole(place() / "index.html", "all right");
  EXPECT_EQ(read(key).problem, "its files have changed");
}

}  // namespace
}  // namespace tumble::grading
