// What platforms give to download, as folders and as archives, and archives that students hand in.
#include "framework/grading/handins/layouts.h"

#include <map>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/zip.h"
#include "framework/grading/grades/find_submissions.h"
#include "framework/grading/handins/unpack.h"

namespace tumble::grading::layouts_test {
namespace {

namespace fs = std::filesystem;

using Files = std::map<std::string, std::string>;

const std::string kGradescopeText = R"(---
submission_11:
  :submitters:
  - :name: Ada Lovelace
    :sid: '1001'
    :email: ada@example.edu
  :created_at: 2026-10-12 21:58:00.000000000 Z
  :score: 12.0
  :results:
    tests:
    - name: "output of a submission"
      output: |
        submission_99:
          :submitters:
          - :name: Nobody
  :history: []
submission_12:
  :submitters:
  - :name: "Ren\u00e9 \"R\" Descartes"
    :sid: ''
  - :name: 'Blaise O''Pascal'
    :sid: "1003"
  :created_at: 2026-10-12 22:01:00.000000000 Z
submission_13:
  :submitters: []
)";

std::vector<ZipMember> members(const Files& files, const std::string& below = "") {
  std::vector<ZipMember> all;
  for (const auto& [name, bytes] : files) all.push_back({below + name, bytes});
  return all;
}

class Layouts : public ::testing::Test {
 protected:
  Layouts() {
    kind.id = "a9";
    kind.folder = "a9_thing";
  }
  fs::path folder_of(const Files& files) const {
    for (const auto& [name, bytes] : files) write_whole(root / "in" / name, bytes);
    return root / "in";
  }
  fs::path zip_with(const std::vector<ZipMember>& all) const {
    write_whole(root / "class.zip", zip_of(all));
    return root / "class.zip";
  }
  FoundSubmissions found(const fs::path& what) const { return find_submissions(what, kind); }
  /// Name, number and text of each submission; its problem where it has no source.
  std::vector<std::string> told(const FoundSubmissions& found) const {
    std::vector<std::string> all;
    for (const Submission& s : found.all)
      all.push_back(s.name + " | " + s.student_id + " | " +
                    (s.problem.empty() ? text_of(s.source) : s.problem));
    return all;
  }
  using Told = std::vector<std::string>;

  PrivateFolder scratch_;
  fs::path root = scratch_.path();
  modules::ModuleKind kind;
};

// Each layout is given as a folder, as an archive, and as an archive with a folder around it.
#define EXPECT_LAYOUT(files, expected)                                   \
  EXPECT_EQ(told(found(folder_of(files))), expected);                    \
  EXPECT_EQ(told(found(zip_with(members(files)))), expected) << "a zip"; \
  EXPECT_EQ(told(found(zip_with(members(files, "all of a9/")))), expected) << "a zip of a folder"

TEST_F(Layouts, OfGradescopeNamesSubmitters) {
  const Files files = {{"submission_metadata.yml", kGradescopeText},
                       {"submission_11/a9_thing.cpp", "int ada;\n"},
                       {"submission_12/src/a9_thing.cpp", "int group;\n"},
                       {"submission_13/a9_thing.cpp", "int unknown;\n"}};
  const Told expected = {"Ada Lovelace_1001 | 1001 | int ada;\n",
                         "Ren\xc3\xa9 \"R\" Descartes_submission_12 |  | int group;\n",
                         "submission_13 |  | int unknown;\n"};
  EXPECT_LAYOUT(files, expected);
  const FoundSubmissions group = found(folder_of(files));
  EXPECT_EQ(group.all[1].notes,
            std::vector<std::string>{"handed in together with Blaise O'Pascal (1003)"});
  EXPECT_TRUE(group.passed_over.empty());
  // The folder that holds the export, as an unpacked archive has it.
  for (const auto& [name, bytes] : files)
    write_whole(root / "down/assignment_5_export" / name, bytes);
  EXPECT_EQ(told(found(root / "down")), expected);
}

TEST_F(Layouts, OfMoodleNamesParticipants) {
  const Files files = {{"Ada Lovelace_101_assignsubmission_file_/a9_thing.cpp", "int ada;\n"},
                       {"Ada Lovelace_101_assignsubmission_onlinetext_/onlinetext.html", "<p>"},
                       {"Blaise_von Pascal_102_assignsubmission_file/x/a9_thing.cpp", "int b;\n"},
                       {"Carl_103_assignsubmission_file_a9_thing.cpp", "int c;\n"},
                       {"Dora_104_assignsubmission_onlinetext_/onlinetext.html", "<p>"}};
  EXPECT_LAYOUT(
      files,
      (Told{"Ada Lovelace_101 | 101 | int ada;\n", "Blaise_von Pascal_102 | 102 | int b;\n",
            "Carl_103 | 103 | int c;\n",
            "Dora_104 | 104 | Holds no a9_thing.cpp, but "
            "Dora_104_assignsubmission_onlinetext_/onlinetext.html. Hand in a9_thing.cpp."}));
}

TEST_F(Layouts, OfCanvasNamesStudents) {
  const Files files = {{"doejane_12_678_a9_thing.cpp", "int a;\n"},
                       {"roejohn_LATE_22_679_a9_thing-1.cpp", "int b;\n"}};
  EXPECT_LAYOUT(files, (Told{"doejane_12 | 12 | int a;\n", "roejohn_22 | 22 | int b;\n"}));
}

// Who typed a text in the place of a file has handed in, and stands in the gradebook.
TEST_F(Layouts, OfCanvasNamesWhoTypedAText) {
  EXPECT_LAYOUT(
      (Files{{"doejane_12_text.html", "<p>"}, {"roejohn_LATE_22_link.html", "<p>"}}),
      (Told{"doejane_12 | 12 | Holds no a9_thing.cpp, but doejane_12_text.html. Hand in "
            "a9_thing.cpp.",
            "roejohn_22 | 22 | Holds no a9_thing.cpp, but roejohn_LATE_22_link.html. Hand in "
            "a9_thing.cpp."}));
}

// An anonymous assignment of Canvas has letters for the number; all files of one are together.
TEST_F(Layouts, OfCanvasHoldsAnonymousFilesTogether) {
  const Files files = {{"LATE_anon_x7B_15_a9_thing.cpp", "int x;\n"},
                       {"anon_Ab3xY_12_a9_thing.cpp", "int a;\n"},
                       {"anon_Ab3xY_13_other.cpp", "int b;\n"}};
  EXPECT_LAYOUT(files, (Told{"anon_Ab3xY | Ab3xY | int a;\n", "anon_x7B | x7B | int x;\n"}));
}

TEST_F(Layouts, AFileOfAnotherKindIsNamed) {
  EXPECT_LAYOUT((Files{{"ada/a9_thing.cpp.txt", "int a;\n"}, {"bo/a9.pdf", "%PDF"}}),
                (Told{"ada |  | Holds no a9_thing.cpp, but a9_thing.cpp.txt. Hand in a9_thing.cpp.",
                      "bo |  | Holds no a9_thing.cpp, but a9.pdf. Hand in a9_thing.cpp."}));
}

// Of an archive without a source the reason names it, and no note says that a file was taken.
TEST_F(Layouts, AnArchiveInAnArchiveIsNamed) {
  const std::string inner = zip_of(members({{"a9_thing.cpp", "int a;\n"}}));
  const FoundSubmissions all = found(folder_of({{"ada/hw.zip", zip_of({{"in.zip", inner}})}}));
  EXPECT_EQ(told(all),
            (Told{"ada |  | In hw.zip: Holds no a9_thing.cpp, only an archive: in.zip. Unpack it "
                  "first."}));
  EXPECT_TRUE(all.all[0].notes.empty());
}

// The name of the file is the student's: it chooses nobody else's number.
TEST_F(Layouts, ANumberIsThatOfCanvasAndNotTheStudents) {
  EXPECT_LAYOUT((Files{{"evemiller_5_777_x_999_assignsubmission_file_a9_thing.cpp", "int e;\n"}}),
                (Told{"evemiller_5 | 5 | int e;\n"}));
}

TEST_F(Layouts, ANumberIsMoodlesAndNotTheStudents) {
  EXPECT_LAYOUT(
      (Files{{"Eve Miller_5_assignsubmission_file_x_999_assignsubmission_file_a9_thing.cpp",
              "int e;\n"}}),
      (Told{"Eve Miller_5 | 5 | int e;\n"}));
}

TEST_F(Layouts, OfFoldersOfStudents) {
  const Files files = {{"ada/a9_thing.cpp", "int a;\n"}, {"blaise/x/a9_thing.cpp", "int b;\n"}};
  EXPECT_LAYOUT(files, (Told{"ada |  | int a;\n", "blaise |  | int b;\n"}));
  // One folder with one submission is a submission, not a folder around one.
  EXPECT_EQ(told(found(zip_with({{"ada/src/a9_thing.cpp", "int a;\n"}}))),
            (Told{"ada |  | int a;\n"}));
}

TEST(GradescopeMetadata, IsReadByItsIndentationWhateverStandsInOutputs) {
  const auto all = read_gradescope_metadata(kGradescopeText);
  EXPECT_EQ(all.size(), 2u);
  EXPECT_FALSE(all.contains("submission_99"));
  EXPECT_EQ(all.at("submission_12").at(1).name, "Blaise O'Pascal");
  EXPECT_TRUE(read_gradescope_metadata("").empty());
  EXPECT_TRUE(
      read_gradescope_metadata("submission_1\n\x01: - :name\n  :submitters:\n -\n").empty());
}

TEST_F(Layouts, AZipOfAStudentIsUnpacked) {
  const std::string zip =
      zip_of({{"My Work/a9_thing.cpp", "int a;\n"}, {"__MACOSX/My Work/._a9_thing.cpp", "litter"}});
  const FoundSubmissions all =
      found(folder_of({{"adam/hw.zip", zip}, {"doejane_12_678_hw.zip", zip}}));
  EXPECT_EQ(told(all), (Told{"adam |  | int a;\n", "doejane_12 | 12 | int a;\n"}));
  EXPECT_EQ(all.all[0].notes, std::vector<std::string>{"its file was in hw.zip"});
  // Beside a source it is not looked at, and a zip in a zip is none.
  const FoundSubmissions beside = found(
      folder_of({{"adam/a9_thing.cpp", "int b;\n"}, {"eve/outer.zip", zip_of({{"hw.zip", zip}})}}));
  EXPECT_EQ(text_of(beside.all[0].source), "int b;\n");
  EXPECT_NE(beside.all[2].problem.find("only an archive"), std::string::npos)
      << beside.all[2].problem;
}

TEST_F(Layouts, AZipOfAStudentWithAFaultIsRefusedWithItsEntry) {
  std::string out = zip_of({{"a9_thing.cpp", "int a;\n"}, {"xx/evil", ""}});
  for (std::size_t at; (at = out.find("xx/evil")) != std::string::npos;)
    out.replace(at, 7, "../evil");
  const FoundSubmissions all = found(folder_of({{"eve/hw.zip", out}, {"adam/a9_thing.cpp", "1"}}));
  EXPECT_EQ(all.all[1].problem,
            "hw.zip is not unpacked: ../evil would be unpacked outside of its folder. Hand in the "
            "source file itself.");
  EXPECT_EQ(all.all[0].problem, "");
}

// One student's entry must not cost the others their grades.
TEST_F(Layouts, AnEntryThatIsRefusedCostsItsOwnSubmissionAlone) {
  const Files files = {{"submission_metadata.yml", kGradescopeText},
                       {"submission_11/a9_thing.cpp", "int ada;\n"},
                       {"submission_11/A9_THING.CPP", "int clash;\n"},
                       {"submission_12/a9_thing.cpp", "int group;\n"}};
  auto all = members(files, "assignment_5_export/");
  const Told said = told(found(zip_with(all)));
  ASSERT_EQ(said.size(), 2u);
  EXPECT_NE(said[0].find("Ada Lovelace_1001 | 1001 | Was not unpacked: "), std::string::npos);
  EXPECT_NE(said[0].find("in capitals only"), std::string::npos) << said[0];
  EXPECT_NE(said[1].find("int group;"), std::string::npos);
}

TEST_F(Layouts, AFlatFileThatIsRefusedIsStillASubmission) {
  std::string zip = zip_of(
      {{"doejane_12_678_a9_thing.cpp", "int a;\n"}, {"roejohn_22_679_a9_thing.cpp", "int b;\n"}});
  zip[zip.find("int a;")] ^= 1;  // another CRC
  write_whole(root / "class.zip", zip);
  const Told said = told(found(root / "class.zip"));
  ASSERT_EQ(said.size(), 2u);
  EXPECT_NE(said[0].find("doejane_12 | 12 | Was not unpacked: doejane_12_678_a9_thing.cpp does not "
                         "unpack"),
            std::string::npos)
      << said[0];
  EXPECT_EQ(said[1], "roejohn_22 | 22 | int b;\n");
}

TEST_F(Layouts, AnArchiveThatIsRefusedIsNamedWithItsEntry) {
  std::string zip = zip_of({{"ada/a9_thing.cpp", "int a;\n"}, {"xx/evil", ""}});
  for (std::size_t at; (at = zip.find("xx/evil")) != std::string::npos;)
    zip.replace(at, 7, "../evil");
  write_whole(root / "class.zip", zip);
  try {
    found(root / "class.zip");
    ADD_FAILURE() << "taken";
  } catch (const UserError& error) {
    EXPECT_EQ(error.where(), (root / "class.zip").string());
    EXPECT_NE(error.problem().find("../evil would be unpacked outside"), std::string::npos);
  }
  EXPECT_FALSE(fs::exists(root / "evil"));
}

TEST_F(Layouts, WhatIsNeitherFolderNorArchiveIsRefused) {
  write_whole(root / "class.rar", "Rar!");
  EXPECT_THROW(found(root / "class.rar"), UserError);
  EXPECT_THROW(found(root / "none.zip"), UserError);
}

// Unpacked folders end with what was found.
TEST_F(Layouts, NothingThatWasUnpackedIsLeft) {
  fs::path unpacked;
  {
    const FoundSubmissions all = found(zip_with({{"ada/a9_thing.cpp", "int a;\n"}}));
    unpacked = all.unpacked->path();
    EXPECT_TRUE(fs::exists(all.all[0].source));
  }
  EXPECT_FALSE(fs::exists(unpacked));
}

}  // namespace
}  // namespace tumble::grading::layouts_test
