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

}  // namespace tumble::grading
