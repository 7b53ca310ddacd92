// tumble audit a1 [--mutants FOLDER] [--lines]: do the tests catch every known-wrong solution, and
// accept every right one?
#include <cstdio>
#include <memory>
#include <set>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "framework/cli/json_output.h"
#include "framework/cli/verb.h"
#include "framework/core/files.h"
#include "framework/core/text.h"
#include "framework/extend/unwritten.h"
#include "framework/grading/grades/touched_lines.h"
#include "framework/grading/grades/audit.h"
#include "framework/grading/grades/causes_file.h"
#include "framework/grading/grades/equal_mutations.h"
#include "framework/grading/grades/scoring.h"

namespace tumble::cli {
namespace {

using grading::AuditResult;

struct AuditWords {
  std::string id, mutants;
  std::vector<std::string> only;
  int jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  bool lines = false, json = false;
};

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

void print_mutants(const std::vector<AuditResult>& results) {
  std::size_t widest = 0;
  for (const AuditResult& r : results) widest = std::max(widest, r.candidate.name.size());
  fmt::print("{:<{}}  caught by  points  names the slip  for example by\n", "known-wrong solution",
             widest);
  for (const AuditResult& r : results) {
    if (r.candidate.is_right) continue;
    if (!r.fault.empty())
      fmt::print("{:<{}}  FAULT      {}\n", r.candidate.name, widest, first_line(r.fault));
    else if (r.caught_by.empty())
      fmt::print("{:<{}}  SURVIVES   {}\n", r.candidate.name, widest, r.candidate.slip);
    else
      fmt::print("{:<{}}  {:>9}  {:>6}  {:<14}  {}\n", r.candidate.name, widest, r.caught_by.size(),
                 grading::points_text(r.score),
                 r.is_named ? "yes" : "NO: '" + r.candidate.keyword + "'", r.best);
  }
  fmt::print("\n{:<{}}  score\n", "right solution", widest);
  for (const AuditResult& r : results) {
    if (!r.candidate.is_right) continue;
    fmt::print("{:<{}}  {:g} of {:g}", r.candidate.name, widest, r.score, r.possible);
    if (!r.fault.empty()) fmt::print("  FAULT: {}", first_line(r.fault));
    for (const auto& test : r.caught_by) fmt::print("  ACCUSED by {}", test.test);
    fmt::print("\n");
  }
}

/// @param catching_only  leave out tests that catch nothing, and count them
void print_tests(const grading::Rubric& rubric, const std::vector<AuditResult>& results,
                 bool catching_only) {
  const auto catches = grading::catches_of(results);
  std::size_t widest = 0;
  for (const auto& item : rubric.items) widest = std::max(widest, item.test.size());
  fmt::print("\n{:<{}}  catches  alone\n", "test", widest);
  int idle = 0;
  for (const auto& item : rubric.items) {
    const auto found = catches.find(item.test);
    const grading::Catches none, &of_test = found == catches.end() ? none : found->second;
    if (catching_only && of_test.count == 0) {
      ++idle;
      continue;
    }
    std::string alone;
    for (const std::string& slip : of_test.alone) alone += (alone.empty() ? "" : ", ") + slip;
    fmt::print("{:<{}}  {:>7}  {}\n", item.test, widest, of_test.count,
               of_test.count == 0 ? "none of these slips" : alone);
  }
  if (idle > 0) fmt::print("{} others: none of these slips\n", idle);
}

void print_json(const std::vector<AuditResult>& results) {
  auto page = nlohmann::ordered_json::array();
  for (const AuditResult& r : results) {
    std::vector<std::string> tests;
    for (const auto& test : r.caught_by) tests.push_back(test.test);
    page.push_back({{"name", r.candidate.name},
                    {"right", r.candidate.is_right},
                    {"slip", r.candidate.slip},
                    {"keyword", r.candidate.keyword},
                    {"fault", r.fault},
                    {"score", r.score},
                    {"possible", r.possible},
                    {"caught_by", tests},
                    {"named", r.is_named},
                    {"as_it_should", r.is_as_it_should()}});
  }
  fmt::print("{}\n", page.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

std::string share_touched(const grading::TouchedLines& lines) {
  return fmt::format("slips touch {} of {} lines of code of {} ({} %)", lines.touched,
                     lines.code_lines, lines.file.filename().string(),
                     lines.code_lines == 0 ? 0 : 100 * lines.touched / lines.code_lines);
}

void print_lines(const grading::TouchedLines& lines, bool json) {
  if (json) {
    auto untouched = nlohmann::ordered_json::array();
    for (const grading::LineRange& range : lines.untouched)
      untouched.push_back(
          {{"first", range.first}, {"last", range.last}, {"code_lines", range.code_lines}});
    fmt::print("{}\n", json_text({{"file", lines.file.string()},
                                  {"code_lines", lines.code_lines},
                                  {"touched", lines.touched},
                                  {"untouched", untouched}},
                                 2));
    return;
  }
  constexpr std::size_t kWidth = 80;  // of a shown line of code
  fmt::print("{}\nno slip touches\n{:>9}  {:>4}  beginning with\n", share_touched(lines), "lines",
             "code");
  for (const grading::LineRange& range : lines.untouched)
    fmt::print("{:>9}  {:>4}  {}\n",
               range.first == range.last ? std::to_string(range.first)
                                         : fmt::format("{}-{}", range.first, range.last),
               range.code_lines, range.text.substr(0, kWidth));
}

// How well each function is guarded: its slips, the tests that catch one of them, and the test
// without which the others would catch none.
void print_functions(const std::vector<AuditResult>& results,
                     const std::vector<std::string>& functions) {
  std::size_t widest = 0;
  for (const std::string& function : functions) widest = std::max(widest, function.size());
  fmt::print("\n{:<{}}  slips  caught by\n", "function", widest);
  const auto slips = grading::audited_slips(results, functions);
  for (const std::string& function : functions) {
    std::set<std::string> tests;
    std::size_t count = 0;
    for (const grading::AuditedSlip& slip : slips) {
      if (slip.function != function) continue;
      ++count;
      for (const grading::Failure& failure : slip.fails) tests.insert(failure.test);
    }
    fmt::print("{:<{}}  {:>5}  {}\n", function, widest, count,
               count == 0          ? "NO SLIP is in it alone"
               : tests.size() == 1 ? "ONE TEST alone: " + *tests.begin()
                                   : counted(tests.size(), "test"));
  }
}

// What of a new assignment its author has not written yet.
void print_unwritten(const std::vector<extend::Unwritten>& places) {
  for (const extend::Unwritten& one : places) fmt::print("{}: {}\n", one.place, one.what);
  fmt::print("{} to be written\n\n", counted(places.size(), "place"));
  std::fflush(stdout);  // before what is told on stderr
}

// What graded pages take their likely causes from.
void write_causes(const grading::Course& course, const std::string& id,
                  const std::vector<AuditResult>& results) {
  const auto file = grading::causes_file(course, id);
  const std::string text = grading::causes_json(
      id, grading::audited_slips(results, course.registry->find(id).functions));
  if (std::filesystem::exists(file) && text_of(file) == text) return;
  write_whole(file, text);
  fmt::print(stderr, "wrote {}\n", file.string());
}

void audit(Context& context, const AuditWords& words) {
  const grading::Course course{context.root, context.build, &context.registry,
                               context.command_line};
  const auto all = grading::find_candidates(course, words.id, words.mutants);
  if (words.lines)
    return print_lines(grading::touched_lines_of_reference(course, words.id, all), words.json);
  const auto candidates = grading::only(all, words.only);
  std::vector<extend::Unwritten> unwritten;
  if (words.only.empty() && words.mutants.empty())
    unwritten = extend::unwritten_of(context.root, context.registry.find(words.id).folder);
  if (!words.json && !unwritten.empty()) print_unwritten(unwritten);
  grading::judge_of(course, words.id);
  const bool line = ::isatty(STDERR_FILENO) == 1;
  const auto told = [&](std::size_t done, std::size_t total) {
    if (line)
      fmt::print(stderr, "\r{} of {} judged{}", done, total, done == total ? "\n" : "");
    else if (done == total || done % 10 == 0)
      fmt::print(stderr, "{} of {} judged\n", done, total);
  };
  const auto results = grading::audit(course, words.id, candidates, words.jobs, told);
  const auto equal = words.mutants.empty() ? grading::EqualMutations()
                                           : grading::read_equal_mutations(course, words.id);
  std::size_t explained = 0;
  std::size_t wrong = 0, caught = 0, named = 0, right = 0, whole = 0, uncompiled = 0;
  for (const AuditResult& r : results) {
    // of collected or proposed ones: nobody can hand it in
    if (!words.mutants.empty() && !r.candidate.is_right &&
        r.fault.starts_with("does not compile")) {
      ++uncompiled;
      continue;
    }
    (r.candidate.is_right ? right : wrong) += 1;
    if (r.is_as_it_should()) (r.candidate.is_right ? whole : caught) += 1;
    if (r.is_named) ++named;
    const std::string because =
        r.candidate.is_right || r.is_as_it_should() ? "" : grading::why_equal(r.candidate, equal);
    if (because.empty()) continue;
    ++explained;
    if (!words.json) fmt::print("{} makes no difference: {}\n", r.candidate.name, because);
  }
  if (words.json) {
    print_json(results);
  } else {
    print_mutants(results);
    print_tests(grading::rubric_of(course, words.id), results, !words.only.empty());
    if (words.only.empty() && words.mutants.empty())
      print_functions(results, context.registry.find(words.id).functions);
    fmt::print(
        "\n{} of {} known-wrong solutions caught, {} of them by a story that names the slip; {} of "
        "{} right solutions have every point\n",
        caught, wrong, named, whole, right);
    if (!words.mutants.empty())
      fmt::print("{} survive with a reason, {} without one: {:.1f} in 100\n", explained,
                 wrong - caught - explained,
                 wrong == 0 ? 0.0
                            : 100.0 * static_cast<double>(wrong - caught - explained) /
                                  static_cast<double>(wrong));
    if (uncompiled > 0) fmt::print("{} more do not compile and do not count\n", uncompiled);
    if (words.only.empty())
      fmt::print("{}; --lines lists the others\n",
                 share_touched(grading::touched_lines_of_reference(course, words.id, all)));
  }
  const bool is_whole =
      caught + explained == wrong && whole == right && wrong + right > 0 && unwritten.empty();
  if (words.only.empty() && words.mutants.empty() && is_whole)
    write_causes(course, words.id, results);
  context.exit = is_whole ? ExitCode::kFine : ExitCode::kCheckFailed;
}

}  // namespace

void add_audit(CLI::App& app, Context& context) {
  auto words = std::make_shared<AuditWords>();
  Verb verb(app, "audit",
            "Judge every known-wrong solution: which test catches which, and does its story name "
            "the slip");
  verb.option("assignment", words->id, "Which, e.g. a1").required().type_name("ID");
  verb.option("--mutants", words->mutants,
              "Known-wrong solutions to judge instead of the assignment's own")
      .type_name("FOLDER");
  verb.option("--only", words->only,
              "These alone, by the first column's names, with commas between them; reference and "
              "other right solutions too")
      .separated_by(',')
      .type_name("SLIP");
  verb.option("--jobs", words->jobs, "At a time").between(1, 256).default_text("number of cores");
  verb.flag("--lines", words->lines,
            "List the lines of the reference that no slip touches, and judge nothing");
  verb.flag("--json", words->json, "For machines");
  verb.footer(
      "A known-wrong solution is a slip (NAME.slip: what differs from a right solution; "
      "framework/grading/course/slip.h) or a whole file (NAME.cpp). A line of the reference is "
      "touched "
      "where a slip takes it out or writes it anew; comments, #include, namespaces and braces "
      "alone do not count.\n"
      "A whole audit in which all is as it should be writes solutions_private/aN_name/causes.json, "
      "from which graded pages take their likely causes.\n"
      "Places of a new assignment that are still \"(to be written: ...)\" come first, with file "
      "and "
      "line.\n"
      "Of --mutants, solutions_private/aN_name/equal_mutations.json may say which changes make no "
      "difference, and why: they count as explained.\n"
      "Exit: 0 all caught, no right solution accused and nothing left to be written, 1 otherwise.");
  verb.runs([&context, words] { audit(context, *words); });
}

}  // namespace tumble::cli
