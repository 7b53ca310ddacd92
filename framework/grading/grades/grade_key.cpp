#include "framework/grading/grades/grade_key.h"

#include <algorithm>

#include <fmt/format.h>

#include "framework/core/digest.h"
#include "framework/grading/compiler/build_module.h"
#include "framework/grading/sandbox/protection.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

std::string digest_of_files(const std::vector<fs::path>& files) {
  std::string digests;
  for (const fs::path& file : files) digests += digest_of_file(file) + ' ';
  return digest(digests);
}

}  // namespace

std::string judging_digest(const Course& course, const std::string& id) {
  const std::string folder = course.registry->find(id).folder;
  std::vector<fs::path> headers;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(course.root / "assignments" / folder, ignored))
    if (entry.path().extension() == ".h") headers.push_back(entry.path());
  std::sort(headers.begin(), headers.end());
  const fs::path bin = course.build / "bin", sdk = course.build / "submission_sdk";
  std::vector<fs::path> files = {judge_of(course, id),  bin / ("worker_" + id),
                                 bin / "sandbox_init",  "/usr/bin/g++",
                                 sdk / "precompiled.h", sdk / "libkernels.a"};
  if (traits_of(chosen_sandbox()).links_worker) files.push_back(bin / ("worker_" + id + ".o"));
  files.insert(files.end(), headers.begin(), headers.end());
  return digest(digest_of_files(files) + submission_flags());
}

std::string grader_digest(const Course& course, const std::string& id, double budget_s) {
  // what pages take their likely causes from (causes_file.h)
  const fs::path causes =
      course.root / "solutions_private" / course.registry->find(id).folder / "causes.json";
  return digest(judging_digest(course, id) + fmt::format(" {} ", budget_s) +
                digest_of_file("/proc/self/exe") +
                (fs::exists(causes) ? ' ' + digest_of_file(causes) : ""));
}

std::string rubric_digest(const Rubric& rubric) {
  std::string text;
  for (const RubricItem& item : rubric.items)
    text += fmt::format("{}\n{}\n{}\n{}\n{}\n", item.test, item.points, item.level, item.title,
                        item.hidden);
  return digest(text);
}

std::string pictures_digest(const Course& course, const std::string& id,
                            const GradeOptions& options) {
  const std::string code = page_code_digest(course, id, options.page_code());
  if (!options.media) return options.page_code() == CodeInPages::kNone ? "" : code;
  const MediaOptions& m = options.media_options;
  std::string text = fmt::format("{} {} {} {} {} {} {} ", m.width, m.height, m.samples, m.rate_hz,
                                 m.video, m.page, m.three_file.string());
  for (const fs::path& scene : options.scenes.empty() ? scenes_of(course, id) : options.scenes)
    text += scene.filename().string() + digest_of_file(scene) + ' ';
  return digest(text + code + digest_of_file(built_module(course, id, "reference")));
}

std::string submission_digest(const Submission& submission) {
  std::string text = submission.problem + '\0';
  for (const std::string& note : submission.notes) text += note + '\0';
  return digest(text + (submission.source.empty() ? "" : digest_of_file(submission.source)) +
                (submission.own_tests.empty() ? "" : " " + digest_of_file(submission.own_tests)));
}

std::string folder_of(const std::string& name) {
  // bytes: file systems allow 255, and names of drafts are longer
  constexpr std::size_t kLongest = 80;
  std::string plain;
  for (const char c : name) {
    const bool keep = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                      c == '_' || c == '-' || c == '.';
    plain += keep ? c : '_';
  }
  if (plain.size() > kLongest) plain.resize(kLongest);
  // Names that begin with "_" are reserved for names that are made here.
  const bool taken = plain.empty() || plain[0] == '.' || plain[0] == '-' || plain[0] == '_' ||
                     plain.ends_with(".html") || plain.ends_with(".csv") ||
                     plain.ends_with(".json") || plain.ends_with(".jsonl");
  // 64 bits of SHA-256: enough that no two names of a course collide by chance
  constexpr std::size_t kDigits = 16;
  return plain == name && !taken ? plain : "_" + plain + "-" + digest(name).substr(0, kDigits);
}

}  // namespace tumble::grading
