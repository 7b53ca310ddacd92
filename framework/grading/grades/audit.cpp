#include "framework/grading/grades/audit.h"

#include <algorithm>
#include <cctype>
#include <fstream>

#include <unistd.h>

#include "framework/core/files.h"
#include "framework/core/nearest_word.h"
#include "framework/core/text.h"
#include "framework/grading/course/build_submission.h"
#include "framework/grading/compiler/compiler_words.h"
#include "framework/core/digest.h"
#include "framework/grading/grades/grade_key.h"
#include "framework/grading/grades/kept_file.h"
#include "framework/farm/processes.h"
#include "framework/grading/grades/scoring.h"
#include "framework/grading/sandbox/sandbox_user.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> files_in(const fs::path& folder, const std::vector<std::string>& extensions) {
  std::vector<fs::path> files;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    if (std::find(extensions.begin(), extensions.end(), entry.path().extension()) !=
        extensions.end())
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

Candidate read_mutant(const fs::path& file, const fs::path& solutions) {
  if (file.extension() != kSlipExtension) {
    const SlipTitle title = read_slip_title(file);
    return {title.name, file, false, title.slip, title.keyword};
  }
  const Slip slip = read_slip(file);
  return {slip.title.name,         file, false, slip.title.slip, slip.title.keyword,
          base_of(slip, solutions)};
}

// Does `work` for all, and then says what stands in the way of each that it could not do: a changed
// base concerns many slips.
template <class Item, class Work>
void for_each_or_refuse(const std::vector<Item>& items, const Work& work) {
  std::vector<UserError> errors;
  for (const Item& item : items) {
    try {
      work(item);
    } catch (const UserError& error) {
      errors.push_back(error);
    }
  }
  if (errors.size() == 1) throw errors.front();
  std::string all;
  for (const UserError& error : errors) all += std::string("\n  ") + error.what();
  if (!errors.empty())
    throw UserError(
        "", std::to_string(errors.size()) + " known-wrong solutions cannot be judged:" + all);
}

bool is_caught(const TestResult& result) {
  return result.verdict == Verdict::kWrong || result.verdict == Verdict::kCrashed ||
         result.verdict == Verdict::kOutOfResources;
}

constexpr std::size_t kNameDigits = 32;  // of a digest, in a file's name: 128 bits

std::string whole_name(const Candidate& candidate) {
  return candidate.file.stem().string() + ".cpp";
}

// Where the results of an audit lie that need not be run again.
struct Kept {
  fs::path results, refused;
};

Kept kept_for(const Course& course, const std::string& id, const std::string& grader,
              const Candidate& candidate, const JudgedSource& source) {
  const fs::path base = course.build / "audit" / id /
                        (candidate.file.stem().string() + "-" +
                         digest(grader + digest(source.text)).substr(0, kNameDigits));
  return {base.string() + ".results", base.string() + ".refused.txt"};
}

// In a process of its own: leaves either the judge's results or why there are none.
void run_one(const Course& course, const std::string& id, const Candidate& candidate,
             const JudgedSource& source, const Kept& kept) {
  fs::create_directories(kept.results.parent_path());
  const fs::path object = kept.results.string() + ".so";
  // what is compiled is what the digest was taken of, whatever is saved meanwhile
  const PrivateFolder folder;
  const fs::path file = folder.path() / whole_name(candidate);
  write_whole(file, source.text);
  const BuiltSubmission built = build_submission(course, id, file, object);
  if (built.outcome != BuiltSubmission::Outcome::kBuilt) {
    const std::string story = compiler_story(built.said, file, module_header(course, id));
    write_whole(kept.refused,
                "does not compile: " +
                    (source.made ? in_places_of_slip(story, file.filename().string(), *source.made)
                                 : story));
    return;
  }
  Judgement judgement = judge_module(course, id, object);
  fs::remove(object);
  // a fault of ours is not kept: the next audit tries again
  for (const TestResult& test : judgement.results)
    if (!is_final_verdict(test.verdict)) judgement.fault = test.test + ": " + test.story;
  if (!judgement.fault.empty()) return write_whole(kept.refused, judgement.fault);
  const fs::path results = folder.path() / "results.json";
  write_results(results.string(), judgement.results);
  keep_file(kept.results, text_of(results));
}

// What an earlier run has kept, if it is whole.
std::optional<std::vector<TestResult>> results_in(const Kept& kept) {
  const std::optional<std::string> text = kept_file(kept.results);
  if (!text) return std::nullopt;
  const PrivateFolder folder;
  const fs::path results = folder.path() / "results.json";
  write_whole(results, *text);
  return read_results(results.string());
}

AuditResult read_result(const Rubric& rubric, const Candidate& candidate, const Kept& kept) {
  AuditResult result;
  result.candidate = candidate;
  const std::optional<std::vector<TestResult>> tests = results_in(kept);
  if (!tests) {
    std::ifstream in(kept.refused);
    result.fault.assign(std::istreambuf_iterator<char>(in), {});
    if (result.fault.empty()) result.fault = "was not judged";
    std::error_code ignored;
    fs::remove(kept.refused, ignored);  // a failure is tried again
    return result;
  }
  for (const ScoredTest& test : score_tests(rubric, {*tests, ""})) {
    result.score += test.score;
    result.possible += test.item.points;
    if (!is_final_verdict(test.result.verdict))
      result.fault = test.item.test + ": " + test.result.story;
  }
  const std::string keyword = lowercase(candidate.keyword);
  for (const TestResult& test : *tests) {
    if (!is_caught(test)) continue;
    result.caught_by.push_back(test);
    const bool names = !keyword.empty() && lowercase(test.story).find(keyword) != std::string::npos;
    if (result.best.empty() || (names && !result.is_named)) result.best = test.test;
    result.is_named = result.is_named || names;
  }
  return result;
}

}  // namespace

bool AuditResult::is_as_it_should() const {
  constexpr double kSlack = 1e-9;  // points: round-off of the sum
  if (!fault.empty()) return false;
  return candidate.is_right ? score >= possible - kSlack && caught_by.empty() : !caught_by.empty();
}

fs::path reference_of(const Course& course, const std::string& id) {
  const std::string folder = course.registry->find(id).folder;
  return course.root / "solutions_private" / folder / (folder + ".cpp");
}

std::vector<Candidate> find_candidates(const Course& course, const std::string& id,
                                       const fs::path& mutants) {
  const fs::path reference = reference_of(course, id), own = reference.parent_path();
  std::vector<Candidate> all;
  const fs::path wrong = mutants.empty() ? own / "mutants" : mutants;
  for_each_or_refuse(files_in(wrong, {".cpp", kSlipExtension}),
                     [&](const fs::path& file) { all.push_back(read_mutant(file, own)); });
  if (all.empty())
    throw UserError(wrong.string(), "holds no known-wrong solution",
                    "Put one .slip or .cpp a slip there.");
  if (fs::exists(reference)) all.push_back({"reference", reference, true, "", ""});
  for (const fs::path& file : files_in(own / "alternatives", {".cpp"}))
    all.push_back({file.stem().string(), file, true, "", ""});
  return all;
}

std::vector<JudgedSource> sources_of(const std::vector<Candidate>& candidates) {
  std::vector<JudgedSource> sources;
  for_each_or_refuse(candidates, [&](const Candidate& candidate) {
    if (candidate.base.empty()) {
      sources.push_back({text_of(candidate.file), std::nullopt});
      return;
    }
    MadeSolution made =
        make_solution(read_slip(candidate.file), candidate.base, text_of(candidate.base));
    std::string text = made.text;
    sources.push_back({std::move(text), std::move(made)});
  });
  return sources;
}

std::vector<Candidate> only(const std::vector<Candidate>& candidates,
                            const std::vector<std::string>& names) {
  if (names.empty()) return candidates;
  std::vector<std::string> known;
  for (const Candidate& candidate : candidates)
    known.insert(known.end(), {candidate.file.stem().string(), candidate.name});
  std::vector<Candidate> chosen;
  for (const std::string& name : names) {
    const auto found = std::find_if(candidates.begin(), candidates.end(), [&](const Candidate& c) {
      return c.name == name || c.file.stem() == name;
    });
    if (found == candidates.end())
      throw UserError("--only " + name,
                      "no solution of this audit has such a name." + did_you_mean(name, known),
                      "The first column of the whole audit has the names.");
    chosen.push_back(*found);
  }
  return chosen;
}

std::map<std::string, Catches> catches_of(const std::vector<AuditResult>& results) {
  std::map<std::string, Catches> all;
  for (const AuditResult& result : results) {
    if (result.candidate.is_right) continue;
    for (const TestResult& test : result.caught_by) ++all[test.test].count;
    if (result.caught_by.size() == 1)
      all[result.caught_by.front().test].alone.push_back(result.candidate.name);
  }
  return all;
}

std::vector<AuditResult> kept_audit(const Course& course, const std::string& id) {
  const Rubric rubric = rubric_of(course, id);
  const std::string grader = judging_digest(course, id);
  std::vector<AuditResult> results;
  for (const Candidate& candidate : find_candidates(course, id)) {
    if (candidate.is_right) continue;
    const Kept kept = kept_for(course, id, grader, candidate, sources_of({candidate}).front());
    if (kept_file(kept.results)) results.push_back(read_result(rubric, candidate, kept));
  }
  return results;
}

std::vector<AuditResult> audit(const Course& course, const std::string& id,
                               const std::vector<Candidate>& candidates, int jobs,
                               const std::function<void(std::size_t, std::size_t)>& told) {
  const Rubric rubric = rubric_of(course, id);
  const std::string grader = judging_digest(course, id);
  const std::vector<JudgedSource> sources = sources_of(candidates);
  std::vector<Kept> kept;
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (sources[i].made)
      write_whole(course.build / "audit" / id / "slips" / whole_name(candidates[i]),
                  sources[i].text);
    kept.push_back(kept_for(course, id, grader, candidates[i], sources[i]));
    if (!kept_file(kept[i].results)) open.push_back(i);
  }
  std::size_t done = candidates.size() - open.size();
  if (told) told(done, candidates.size());
  farm::run_in_processes(
      open.size(), jobs,
      [&](std::size_t i) {
        run_one(course, id, candidates[open[i]], sources[open[i]], kept[open[i]]);
      },
      [&](std::size_t, int, double) {
        ++done;
        if (told) told(done, candidates.size());
      },
      sweep_stages_of_the_dead);
  std::vector<AuditResult> results;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    results.push_back(read_result(rubric, candidates[i], kept[i]));
  return results;
}

}  // namespace tumble::grading
