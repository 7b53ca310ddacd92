#include "framework/grading/course.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <fstream>

#include "framework/core/error.h"

namespace tumble::grading {

namespace fs = std::filesystem;

fs::path judge_of(const Course& course, const std::string& id) {
  const fs::path judge = course.build / "bin" / ("judge_" + id);
  if (!fs::exists(judge))
    throw UserError(judge.string(), "is not built", "Grading needs the hidden tests, which students do not have. ./tumble check " + id + " runs the public ones.");
  return judge;
}

fs::path built_module(const Course& course, const std::string& id, const std::string& word) {
  return course.build / "modules" / (id + '_' + word + ".so");
}

Rubric rubric_of(const Course& course, const std::string& id) {
  const std::string folder = course.registry->find(id).folder;
  Rubric rubric = joined(read_rubric(course.root / "assignments" / folder / "rubric.json"),
                         read_rubric(course.root / "solutions_private" / folder / "rubric_hidden.json", true));
  if (rubric.title.empty()) rubric.title = course.registry->find(id).title;
  return rubric;
}

std::vector<fs::path> scenes_of(const Course& course, const std::string& id) {
  std::vector<fs::path> files;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(course.root / "assignments" / course.registry->find(id).folder / "scenes", ignored))
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::string digest(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325ull;  // FNV-1a: offset and prime of its 64-bit form
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

std::string digest_of_file(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return "missing";
  const std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  return digest(bytes);
}

}  // namespace tumble::grading
