#include "framework/grading/course/handout_page.h"

#include "framework/core/files.h"
#include "framework/core/run_program.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

// s: pandoc takes two, on an idle machine
constexpr double kPandocWall = 300.0;

fs::path handout_of(const Course& course, const std::string& id) {
  return course.root / "handouts" / (course.registry->find(id).folder + ".md");
}

std::string escaped(const std::string& text) {
  std::string html;
  for (const char c : text) html += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
  return html;
}

}  // namespace

bool has_handout(const Course& course, const std::string& id) {
  return fs::exists(handout_of(course, id));
}

void write_handout(const Course& course, const std::string& id, const fs::path& file) {
  if (!has_handout(course, id)) return;
  const fs::path handout = handout_of(course, id), folder = handout.parent_path();
  make_whole(file, [&](const fs::path& draft) {
    const ProgramOutcome made = run_program(
        {"pandoc", handout.string(), "--from=markdown", "--standalone", "--to=html5", "--mathml",
         "--self-contained", "--toc", "--toc-depth=2",
         "--lua-filter=" + (folder / "pages.lua").string(), "--resource-path=" + folder.string(),
         "--metadata=alone:true", "--metadata=lang:en",
         "--css=" + (folder / "handout.css").string(), "--output=" + draft.string()},
        Output::kCaptured, kPandocWall);
    if (made.code == 0) return;
    write_whole(draft, "<!DOCTYPE html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>" + id +
                           "</title>\n<pre style=\"white-space: pre-wrap\">" +
                           escaped(text_of(handout)) + "</pre></html>\n");
  });
}

void add_handout(const fs::path& page, const fs::path& folder) {
  const fs::path own = folder / kHandoutPage, draft = folder / ".handout.draft0.html";
  std::error_code failed;
  if (!fs::exists(page) || !fs::is_directory(folder) || fs::equivalent(page, own, failed)) return;
  fs::remove(draft, failed);
  fs::create_hard_link(page, draft, failed);
  if (failed == std::errc::too_many_links) {  // from here on another file with the same text
    const fs::path again = page.parent_path() / ".handout.draft0.html";
    fs::copy_file(page, again, fs::copy_options::overwrite_existing);
    fs::rename(again, page);
    fs::create_hard_link(page, draft, failed);
  }
  if (failed) fs::copy_file(page, draft, fs::copy_options::overwrite_existing);
  fs::rename(draft, own);
}

}  // namespace tumble::grading
