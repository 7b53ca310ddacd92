#include "framework/grading/grades/mend_first.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "framework/core/text.h"
#include "framework/grading/grades/causes.h"
#include "framework/grading/grades/scoring.h"
#include "framework/grading/verdicts/plain_text.h"
#include "framework/grading/verdicts/xray.h"
#include "framework/report/html_text.h"

namespace tumble::grading {
namespace {

using report::Look;

// Tests that ended without the right answer: what the causes explain.
std::size_t failing(const Grade& grade) {
  return static_cast<std::size_t>(
      std::count_if(grade.tests.begin(), grade.tests.end(), [](const ScoredTest& test) {
        return test.result.verdict == Verdict::kWrong || test.result.verdict == Verdict::kCrashed ||
               (test.result.verdict == Verdict::kOutOfResources && !is_cut_off(test.result));
      }));
}

std::string anchor(std::string id, const std::string& name) {
  for (const char c : name) id += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '-';
  return id;
}

// What the tiles above say, in the words of the causes, and in what order these stand.
std::string how_to_read(const Grade& grade) {
  std::string text;
  if (const std::size_t n = failing(grade); n > 0)
    text =
        fmt::format("{} failed (wrong, crashed, or out of time or memory). ", counted(n, "test"));
  text += "Each part below is one cause of lost points; the one that costs the most stands first. ";
  if (std::any_of(grade.causes.begin(), grade.causes.end(),
                  [](const Cause& cause) { return !cause.not_run.empty(); }))
    text += "Only a cause that kept other tests from running stands before it. ";
  return text +
         "A likely mistake is one whose wrong answers are the same as those of this file: a hint, "
         "not a proof.";
}

// "the 40 failed tests": wrong, crashed, or out of time or memory.
// Some of the failed tests, or all.
std::string of_failed_tests(std::size_t n, std::size_t failing) {
  if (n < failing) return fmt::format("{} of the {} failed tests", n, failing);
  return failing == 1   ? "the one failed test"
         : failing == 2 ? "both failed tests"
                        : fmt::format("all {} failed tests", failing);
}

// How sure two mistakes are, and the share of each.
std::string evidence_of_two(const Cause& cause, std::size_t failing) {
  const std::size_t n = cause.tests.size();
  return fmt::format(
      "Together they explain {}: in {} your answer is the one that follows from both, and in "
      "{} neither alone gives it. Alone, the first fails {} of these tests, the second {}. Both "
      "may "
      "stand in one line. Correct both before you run the tests again: while one is left, some of "
      "these tests still fail.",
      of_failed_tests(n, failing),
      cause.same_numbers == n ? "all of them" : fmt::format("{} of them", cause.same_numbers),
      cause.by_both == cause.same_numbers ? "all these" : std::to_string(cause.by_both),
      cause.alone[0], cause.alone[1]);
}

// Whether the story's equation marks how the wrong answer comes out.
bool is_explained(const std::string& story) {
  const std::vector<StoryTerm> terms = parts_of_story(story).terms;
  return std::any_of(terms.begin(), terms.end(), [](const StoryTerm& term) {
    return term.mark.find(kComesOut) != std::string::npos;
  });
}

// How sure it is, in a sentence.
// @param story  that the page shows below it
std::string evidence_of(const Cause& cause, std::size_t failing, const std::string& story) {
  const std::size_t n = cause.tests.size();
  const std::string of_them = of_failed_tests(n, failing);
  switch (cause.kind) {
    case Cause::Kind::kSlip:
      if (!cause.and_also.empty()) return evidence_of_two(cause, failing);
      if (cause.same_numbers == 0)
        return fmt::format(
            "One way to fail {}: {}. But {}.", of_them, cause.says,
            is_explained(story)
                ? "alone it gives other numbers than yours: the equation below marks how yours "
                  "come out"
                : "it gives other numbers than yours, so your mistake may be another one");
      if (cause.same_numbers == n)
        return fmt::format("This mistake alone explains {}, with the same wrong {}.", of_them,
                           n == 1 ? "answer" : "answers");
      return fmt::format("This mistake alone would fail {}, and {} of them with the same wrong {}.",
                         of_them, cause.same_numbers,
                         cause.same_numbers == 1 ? "answer" : "answers");
    case Cause::Kind::kNotWritten:
      return fmt::format("{} not attempted, because this function is not written.",
                         n == 1 ? "One test was" : counted(n, "test") + " were");
    case Cause::Kind::kUnknown:
      if (cause.functions.empty()) return "";
      return capitalised(fmt::format("{} called this function last.", of_them));
    default:
      return capitalised(fmt::format("{} {} in this way.", of_them, n == 1 ? "ends" : "end"));
  }
}

// "Likely mistake in collision_impulse: e where (1 + e) belongs". Where no number agrees, the
// mistake may be another one, and does not stand in the heading.
std::string title_of(const Cause& cause) {
  if (cause.kind != Cause::Kind::kSlip) return cause.says;
  const bool is_likely = cause.same_numbers > 0 && 2 * cause.same_numbers >= cause.tests.size();
  const std::string function = cause.functions.empty() ? "" : cause.functions.front();
  const std::string in_function = function.empty() ? "" : " in " + function;
  if (cause.same_numbers == 0)
    return (function.empty() ? "The submission" : function) +
           " gives wrong answers (the mistake is not certain)";
  if (!cause.and_also.empty())
    return fmt::format("Two {} mistakes{}: {}, and {}", is_likely ? "likely" : "possible",
                       in_function, cause.says, cause.and_also);
  return fmt::format("{} mistake{}: {}", is_likely ? "Likely" : "Possible", in_function,
                     cause.says);
}

std::string points_in_words(double points) {
  return points_text(points) + (points == 1.0 ? " point" : " points");
}

// Where a function is: "rk4_step begins in line 17 of a2_integration.cpp."
std::string places_of(const Cause& cause) {
  std::string text;
  for (std::size_t i = 0; i < cause.functions.size(); ++i) {
    const std::string& place = i < cause.places.size() ? cause.places[i] : "";
    const std::size_t colon = place.rfind(':');
    if (colon == place.npos) continue;
    const std::string where =
        fmt::format("line {} of {}", place.substr(colon + 1), place.substr(0, colon));
    text += text.empty() ? "" : "; ";
    text += cause.kind == Cause::Kind::kCrash && cause.is_marked(i)
                ? cause.functions[i] + " crashed in " + where +
                      ". Look at the lines above it, too: what it uses was made there"
                : cause.functions[i] + " begins in " + where;
  }
  return text.empty() ? "" : text + '.';
}

// The test to look at first: one that its author can run, as basic as there is.
const ScoredTest* test_to_show(const Cause& cause, const Grade& grade) {
  const auto rank = [](const ScoredTest& test) {
    const std::string& level = test.item.level;
    const int depth = level == "basic"          ? 0
                      : level == "intermediate" ? 1
                      : level == "advanced"     ? 2
                                                : 3;
    return (test.item.hidden ? 10 : 0) + depth + (test.result.story.empty() ? 100 : 0);
  };
  const ScoredTest* best = nullptr;
  for (const ScoredTest& test : grade.tests)
    if (std::find(cause.tests.begin(), cause.tests.end(), test.item.test) != cause.tests.end() &&
        (best == nullptr || rank(test) < rank(*best)))
      best = &test;
  return best;
}

bool is_wrong(const SceneMedia& scene) {
  return !scene.story.empty() ||
         std::any_of(scene.checks.begin(), scene.checks.end(),
                     [](const engines::CheckResult& check) { return !check.passed; });
}

bool acts_in(const Cause& cause, const SceneMedia& scene) {
  return std::any_of(cause.functions.begin(), cause.functions.end(),
                     [&](const std::string& function) {
                       return std::find(scene.functions.begin(), scene.functions.end(), function) !=
                              scene.functions.end();
                     });
}

// Whether a cause before it is about the same functions of this run: that one costs more, and the
// page says that both are to be read together.
bool stands_under_another(std::size_t index, const Grade& grade, const SceneMedia& scene) {
  const auto is_before = [&](const Cause& other) {
    return std::all_of(grade.causes[index].functions.begin(), grade.causes[index].functions.end(),
                       [&](const std::string& function) {
                         return std::find(scene.functions.begin(), scene.functions.end(),
                                          function) == scene.functions.end() ||
                                std::find(other.functions.begin(), other.functions.end(),
                                          function) != other.functions.end();
                       });
  };
  return std::any_of(grade.causes.begin(), grade.causes.begin() + static_cast<long>(index),
                     is_before);
}

// Causes whose functions a run called, by their places.
std::vector<std::size_t> causes_in(const SceneMedia& scene, const Grade& grade) {
  std::vector<std::size_t> causes;
  for (std::size_t i = 0; i < grade.causes.size(); ++i)
    if (acts_in(grade.causes[i], scene)) causes.push_back(i);
  return causes;
}

// The scenes that go wrong and call a function of the cause. Its picture stands beside the cause
// only where no other cause acts in it: else it may show the other's mistake.
void add_scenes(report::Page& page, std::size_t index, const Grade& grade,
                std::vector<report::Field>& fields) {
  constexpr std::size_t kMost = 3;  // named; the part of scenes has all
  bool has_picture = false;
  std::string text;
  std::vector<report::Cell> links;
  for (const SceneMedia& scene : grade.media) {
    if (!is_wrong(scene) || !acts_in(grade.causes[index], scene) ||
        stands_under_another(index, grade, scene))
      continue;
    std::string others;
    const std::vector<std::size_t> acting = causes_in(scene, grade);
    for (const std::size_t other : acting)
      if (other != index && !stands_under_another(other, grade, scene))
        others += fmt::format("{}{}", others.empty() ? "" : ", ", other + 1);
    if (acting.size() == 1 && !has_picture && !scene.picture.empty()) {
      page.figures({{std::filesystem::path("media") / scene.picture,
                     {},
                     scene.title + ": submission left, reference right",
                     ""}});
      has_picture = true;
    }
    if (links.size() == kMost) continue;
    const std::string title = plain_name(scene.title);
    text += (text.empty() ? "" : "\n") + title;
    if (!others.empty())
      text += fmt::format(" (cause{} {} may act in it, too)",
                          others.find(',') == others.npos ? "" : "s", others);
    links.push_back({title, "#" + anchor_of_scene(scene.scene)});
  }
  if (!text.empty()) fields.push_back({"scenes", text, links});
}

// A formula that the header continues in a line of its own, "   + b", goes on: a page breaks it
// where it is wide.
std::string formula_of(std::string formula) {
  for (const char* operation : {"\n+ ", "\n- ", "\n/ "})
    for (std::size_t at = formula.find(operation); at != formula.npos;
         at = formula.find(operation, at))
      formula[at] = ' ';
  return report::formula_in_parts(formula);
}

// What the header says of the functions, and where the handout has more.
void add_help(const Cause& cause, const PageView& view, std::vector<report::Field>& fields) {
  const bool is_new = cause.kind == Cause::Kind::kNotWritten;
  std::string should_be, returns, places;
  std::vector<std::string> seen;  // functions of one formula name it once
  const auto add = [&](std::string& text, const std::string& more, const char* gap) {
    if (more.empty() || std::find(seen.begin(), seen.end(), more) != seen.end()) return;
    seen.push_back(more);
    text += (text.empty() ? "" : gap) + more;
  };
  for (std::size_t i = 0; i < cause.told.size(); ++i) {
    const FunctionInHeader& told = cause.told[i];
    const std::string words =
        is_new || told.formula.empty() ? told.purpose : formula_of(told.formula);
    const bool is_one = cause.told.size() == 1 || words.empty();
    add(should_be, (is_one ? "" : cause.functions[i] + ":\n") + words, "\n");
    if (is_new) add(returns, told.returns, "\n");
    for (const std::string& equation : told.equations) add(places, equation, "; ");
    add(places, told.hints, "; ");
  }
  if (!should_be.empty()) fields.push_back({is_new ? "to write" : "it should be", should_be});
  if (!returns.empty()) fields.push_back({"it returns", returns});
  if (!places.empty()) fields.push_back(reading(places, view));
}

// "3 of its tests also need cause 2 mended."
std::string needs_of(const Cause& cause) {
  std::string text;
  for (const auto& [other, n] : cause.also_needed)
    text += fmt::format("{}{} of its tests also {} cause {} mended.", text.empty() ? "" : " ", n,
                        n == 1 ? "needs" : "need", other + 1);
  return text;
}

// "The mistake of cause 2 gives the same answer in 1 of its 3 tests."
std::string may_follow_from(const Cause& cause) {
  std::string text;
  for (const auto& [other, n] : cause.may_follow)
    text += fmt::format(
        "{}The mistake of cause {} gives the same wrong {} in {}: mend that one first, this may "
        "follow from it.",
        text.empty() ? "" : " ", other + 1, n == 1 ? "answer" : "answers",
        n < cause.tests.size() ? fmt::format("{} of its {} tests", n, cause.tests.size())
        : n == 1               ? "its test"
                               : fmt::format("all {} of its tests", n));
  return text;
}

// "Cause 7 is about the same function."
std::string same_function(std::size_t index, const Grade& grade) {
  std::vector<std::string> numbers;
  const auto& functions = grade.causes[index].functions;
  for (std::size_t i = 0; i < grade.causes.size(); ++i)
    if (i != index && !functions.empty() && !grade.causes[i].functions.empty() &&
        grade.causes[i].functions.front() == functions.front())
      numbers.push_back(std::to_string(i + 1));
  if (numbers.empty()) return "";
  return fmt::format("{} {} {} about the same function: read them together.",
                     numbers.size() == 1 ? "Cause" : "Causes", fmt::join(numbers, ", "),
                     numbers.size() == 1 ? "is" : "are");
}

// All tests of a cause. Each leads to its story, and one without a story to its row in the table.
void add_tests(report::Page& page, const Cause& cause, const Grade& grade) {
  std::vector<report::Cell> tests;
  for (const ScoredTest& test : grade.tests)
    for (const auto* names : {&cause.tests, &cause.following, &cause.not_run})
      if (std::find(names->begin(), names->end(), test.item.test) != names->end())
        tests.push_back(
            {test.item.title, "#" + (has_story_in_page(test) ? anchor_of_story(test.item.test)
                                                             : anchor_of_row(test.item.test))});
  if (tests.empty()) return;
  page.begin(report::Part::kFold, tests.size() == 1
                                      ? "The test of this cause"
                                      : fmt::format("All {} tests of this cause", tests.size()));
  page.list(tests);
  page.end();
}

void add_cause(report::Page& page, std::size_t index, const Grade& grade, const PageView& view) {
  const Cause& cause = grade.causes[index];
  const std::size_t number = index + 1;
  page.begin(report::Part::kCard, "", fmt::format("cause-{}", number));
  page.heading(fmt::format("{}. {} ({})", number, plain_name(title_of(cause)),
                           points_in_words(points_lost(cause, grade.tests))),
               3);
  std::vector<report::Field> fields;
  add_help(cause, view, fields);
  add_scenes(page, index, grade, fields);
  const ScoredTest* shown = test_to_show(cause, grade);
  const std::string evidence =
      cause.tests.empty()
          ? ""
          : evidence_of(cause, failing(grade), shown == nullptr ? "" : shown->result.story);
  if (!evidence.empty()) page.paragraph(evidence);
  if (!cause.or_else.empty())
    page.paragraph(fmt::format("As well possible{}: {}.",
                               cause.and_also.empty() ? "" : " in place of the second",
                               fmt::join(cause.or_else, "; or ")));
  for (const std::string& more :
       {may_follow_from(cause), needs_of(cause), same_function(index, grade)})
    if (!more.empty()) page.paragraph(more);
  if (!fields.empty()) page.fields(fields);
  if (const std::string places = places_of(cause); !places.empty())
    page.paragraph(plain_name(places));
  for (std::size_t i = 0; i < cause.code.size(); ++i) {
    if (cause.code[i].empty()) continue;
    const bool is_short = cause.is_marked(i);  // the lines around a crash
    if (!is_short)
      page.begin(report::Part::kFold, plain_name(cause.functions[i]) + " of this file");
    page.code(plain_text(cause.code[i]));
    if (!is_short) page.end();
  }
  if (const std::size_t n = cause.not_run.size(); n > 0)
    page.paragraph(fmt::format("{} not run, because the time of all tests together was used up.",
                               n == 1 ? "One more test was" : counted(n, "more test") + " were"));
  if (const std::size_t n = cause.following.size(); n > 0)
    page.paragraph(fmt::format(
        "{} functions that ask {}: what they give probably follows from it. Mend this first.",
        n == 1 ? "One more test fails, of" : counted(n, "more test") + " fail, of",
        cause.functions.empty() ? "this one" : plain_name(cause.functions.front())));
  if (shown != nullptr && !shown->result.story.empty() && cause.kind != Cause::Kind::kNotWritten) {
    page.paragraph("For example, " + shown->item.title + ":", Look::kMuted);
    add_story(page, shown->result.story, view);
  } else if (shown != nullptr && shown->item.hidden && cause.kind != Cause::Kind::kNotWritten) {
    page.paragraph("Seen by hidden tests only: they tell no numbers.", Look::kMuted);
  }
  add_tests(page, cause, grade);
  page.end();
}

}  // namespace

bool has_story_in_page(const ScoredTest& test) {
  return test.result.verdict != Verdict::kRight && test.result.verdict != Verdict::kNotAttempted &&
         !test.result.story.empty();
}

std::string anchor_of_story(const std::string& test) { return anchor("t-", test); }
std::string anchor_of_row(const std::string& test) { return anchor("r-", test); }
std::string anchor_of_scene(const std::string& scene) { return anchor("s-", scene); }

void add_mend_first(report::Page& page, const Grade& grade, const PageView& view) {
  if (grade.causes.empty()) return;
  page.begin(report::Part::kBox, "", "mend-first");
  page.heading("Mend first");
  page.paragraph(how_to_read(grade), Look::kMuted);
  for (std::size_t i = 0; i < grade.causes.size(); ++i) add_cause(page, i, grade, view);
  page.end();
}

}  // namespace tumble::grading
