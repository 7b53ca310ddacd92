#include "framework/grading/grades/page_code.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "framework/core/digest.h"
#include "framework/core/error.h"
#include "framework/core/nearest_word.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWords[] = {"none", "own", "both"};

fs::path folder_in(const Course& course, const char* room, const std::string& id) {
  return course.root / room / course.registry->find(id).folder;
}

fs::path right_source(const Course& course, const std::string& id) {
  return folder_in(course, "solutions_private", id) / (course.registry->find(id).folder + ".cpp");
}

fs::path own_module(const fs::path& folder) { return folder / "media" / "own.wasm"; }
fs::path right_module(const fs::path& folder) { return folder / "media" / "right.wasm"; }

std::string bytes_of(const fs::path& file) { return fs::exists(file) ? text_of(file) : ""; }

}  // namespace

CodeInPages code_in_pages_of(const std::string& word) {
  for (std::size_t i = 0; i < std::size(kWords); ++i)
    if (word == kWords[i]) return static_cast<CodeInPages>(i);
  throw UserError(
      "--code-in-pages " + word,
      "is none of none, own, both." + did_you_mean(word, {std::begin(kWords), std::end(kWords)}),
      "See tumble grade --help.");
}

std::string word_of(CodeInPages which) { return kWords[static_cast<std::size_t>(which)]; }

std::string page_script(const Course& course, const std::string& id) {
  return bytes_of(folder_in(course, "assignments", id) / "page.js");
}

std::string page_code_digest(const Course& course, const std::string& id, CodeInPages which) {
  const std::string script = page_script(course, id);
  if (script.empty() || which == CodeInPages::kNone) return "none";
  return digest(fmt::format("{} {} {} {} {} {}", word_of(which), digest(script),
                            digest_of_file(course.root / "framework/modules/in_page.h"),
                            digest_of_file("/usr/bin/clang++-14"),
                            digest_of_file(right_source(course, id)),
                            fmt::join(missing_page_packages(), " ")));
}

PageCode::PageCode(const Course& course, const std::string& id, CodeInPages which) {
  laws_.script = page_script(course, id);
  if (laws_.script.empty() || which == CodeInPages::kNone) return;
  laws_.is_for_students = which == CodeInPages::kBoth;
  compiler_.emplace(course.root, course.build, id, course.registry->find(id).folder);
  const fs::path source = right_source(course, id);
  if (!compiler_->obstacle().empty()) return;  // each page says it of its own module
  if (!fs::exists(source)) {
    if (laws_.is_for_students) laws_.why_no_right = "this tree has no right solution";
    return;
  }
  const PageModule right = compiler_->compile(source);
  laws_.right = right.wasm;
  laws_.why_no_right = right.why_not;
}

std::string PageCode::add(const fs::path& source, const fs::path& folder) const {
  if (!compiler_) return "";
  const PageModule module = compiler_->compile(source);
  if (module.wasm.empty()) return module.why_not;
  fs::create_directories(folder / "media");
  write_whole(own_module(folder), module.wasm);
  if (laws_.is_for_students && !laws_.right.empty()) write_whole(right_module(folder), laws_.right);
  return "";
}

report::Bench bench_of(const fs::path& folder, const std::string& script,
                       const std::string& right) {
  if (script.empty()) return {};
  return {bytes_of(own_module(folder)), right.empty() ? bytes_of(right_module(folder)) : right,
          script};
}

void forget_page_code(const fs::path& folder) {
  std::error_code ignored;
  for (const fs::path& file : {own_module(folder), right_module(folder)}) fs::remove(file, ignored);
}

}  // namespace tumble::grading
