#include "framework/grading/grades/changes.h"

#include <fcntl.h>

#include <algorithm>
#include <cstdio>
#include <map>

#include <fmt/format.h>

#include "framework/grading/grades/scoring.h"

namespace tumble::grading {

namespace fs = std::filesystem;

void note_changes(const GradeRecord& old, const GradeKey& key, Grade& now) {
  const char* reason = old.key.submission != key.submission ? "the submission changed"
                       : old.key.judging != key.judging     ? "the tests or the grader changed"
                       : old.key.rubric != key.rubric       ? "the rubric changed"
                                                            : "run again";
  const auto said = [](const ScoredTest& test) {
    return fmt::format("{}, {} of {}", words(test.result.verdict), points_text(test.score),
                       points_text(test.item.points));
  };
  std::map<std::string, std::string> before;
  for (const ScoredTest& test : old.grade.tests) before[test.item.test] = said(test);
  for (const ScoredTest& test : now.tests) {
    const auto it = before.find(test.item.test);
    const std::string was = it == before.end() ? "absent" : it->second;
    if (was != said(test))
      now.changes.push_back({test.item.test, test.item.title, was, said(test), reason});
    if (it != before.end()) before.erase(it);
  }
  for (const auto& [test, was] : before) now.changes.push_back({test, test, was, "absent", reason});
  if (old.grade.score != now.score && old.grade.has_score() && now.has_score())
    now.change =
        fmt::format("{} -> {}: {}", points_text(old.grade.score), points_text(now.score), reason);
  else if (old.grade.has_score() != now.has_score())
    now.change =
        fmt::format("{} -> {}: {}", old.grade.has_score() ? points_text(old.grade.score) : "none",
                    now.has_score() ? points_text(now.score) : "none", reason);
}

void keep_media(const fs::path& place, const fs::path& made,
                const std::optional<GradeRecord>& earlier, Grade& grade, GradeKey& key) {
  const fs::path from = place / "media", to = made / "media";
  if (!fs::is_directory(fs::symlink_status(from))) return;
  fs::create_directories(to);
  for (const auto& entry : fs::directory_iterator(from)) {
    std::error_code failed;
    fs::create_hard_link(entry.path(), to / entry.path().filename(), failed);
    if (failed) fs::copy_file(entry.path(), to / entry.path().filename());
  }
  if (!earlier || earlier->grade.media.empty()) return;
  grade.media = earlier->grade.media;
  const bool is_same = earlier->key.submission == key.submission;
  key.pictures = is_same ? earlier->key.pictures : "";
  const std::string note =
      "the pictures are of an earlier version of the file (no new ones were made)";
  std::erase(grade.notes, note);
  const bool were_old = std::find(earlier->grade.notes.begin(), earlier->grade.notes.end(), note) !=
                        earlier->grade.notes.end();
  if (!is_same || were_old) grade.notes.push_back(note);
}

void put_in_place(const fs::path& made, const fs::path& place, const fs::path& aside) {
  if (!fs::exists(fs::symlink_status(place))) return fs::rename(made, place);
  if (::renameat2(AT_FDCWD, made.c_str(), AT_FDCWD, place.c_str(), RENAME_EXCHANGE) == 0) return;
  fs::rename(place, aside);
  fs::rename(made, place);
}

}  // namespace tumble::grading
