#include "framework/grading/grades/mend_first.h"

#include <algorithm>
#include <cctype>
#include <set>

#include <fmt/format.h>

#include "framework/core/text.h"
#include "framework/grading/grades/causes.h"
#include "framework/grading/grades/scoring.h"
#include "framework/grading/verdicts/plain_text.h"

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

// How sure two mistakes are, and the share of each.
std::string evidence_of_two(const Cause& cause, std::size_t failing) {
  const std::size_t n = cause.tests.size();
  return fmt::format(
      "Together they explain {} of the {} that this file fails: in {} the answer that came is the "
      "one that follows from both, and in {} neither alone gives it. Alone, the first fails {} of "
      "these tests, the second {}. Both may stand in one line. Correct both before you run the "
      "tests again: while one is left, some of these tests still fail.",
      n, counted(failing, "test"),
      cause.same_numbers == n ? "all of them" : fmt::format("{} of them", cause.same_numbers),
      cause.by_both == cause.same_numbers ? "all these" : std::to_string(cause.by_both),
      cause.alone[0], cause.alone[1]);
}

// How sure it is, in a sentence.
std::string evidence_of(const Cause& cause, std::size_t failing) {
  const std::size_t n = cause.tests.size();
  switch (cause.kind) {
    case Cause::Kind::kSlip: {
      if (!cause.and_also.empty()) return evidence_of_two(cause, failing);
      const std::string fails =
          fmt::format("A file with this mistake fails {} of the {} that this file fails", n,
                      counted(failing, "test"));
      if (cause.same_numbers == 0) return fails + ", though with other answers.";
      return fmt::format("{}, and {} the same wrong answer as this file.", fails,
                         n == 1 ? "gives there"
                         : cause.same_numbers == n
                             ? "gives in all of them"
                             : fmt::format("gives in {} of them", cause.same_numbers));
    }
    case Cause::Kind::kNotWritten:
      return fmt::format("{} not attempted for it.",
                         n == 1 ? "One test is" : counted(n, "test") + " are");
    case Cause::Kind::kUnknown:
      return fmt::format("In {} of the {} that {} it was the last function called.", n,
                         counted(failing, "test"), failing == 1 ? "fails" : "fail");
    default:
      return fmt::format("{} of the {} that {} {} in this way.", n, counted(failing, "test"),
                         failing == 1 ? "fails" : "fail", n == 1 ? "ends" : "end");
  }
}

// "Likely mistake in collision_impulse: e where (1 + e) belongs": whether the words are of the
// mistake or of its remedy must be plain.
std::string title_of(const Cause& cause) {
  if (cause.kind != Cause::Kind::kSlip) return cause.says;
  const bool is_likely = cause.same_numbers > 0 && 2 * cause.same_numbers >= cause.tests.size();
  const std::string in_function = cause.functions.empty() ? "" : " in " + cause.functions.front();
  if (!cause.and_also.empty())
    return fmt::format("Two {} mistakes{}: {}, and {}", is_likely ? "likely" : "possible",
                       in_function, cause.says, cause.and_also);
  return fmt::format("{} mistake{}: {}", is_likely ? "Likely" : "Possible", in_function,
                     cause.says);
}

std::string points_in_words(double points) {
  return points_text(points) + (points == 1.0 ? " point" : " points");
}

std::string places_of(const Cause& cause) {
  std::string text;
  for (std::size_t i = 0; i < cause.functions.size(); ++i) {
    const std::string& place = i < cause.places.size() ? cause.places[i] : "";
    text += (text.empty() ? "" : "; ") + cause.functions[i] + (place.empty() ? "" : ", " + place);
  }
  return text;
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

// The scene to look at: the submission's run goes wrong in it, and calls a function of the cause;
// no other cause has shown it.
const SceneMedia* scene_to_show(const Cause& cause, const Grade& grade,
                                std::set<std::string>& seen) {
  for (const SceneMedia& scene : grade.media) {
    const bool is_its = std::any_of(
        cause.functions.begin(), cause.functions.end(), [&](const std::string& function) {
          return std::find(scene.functions.begin(), scene.functions.end(), function) !=
                 scene.functions.end();
        });
    if (!is_its || scene.picture.empty() || seen.contains(scene.picture)) continue;
    const bool is_wrong =
        !scene.story.empty() ||
        std::any_of(scene.checks.begin(), scene.checks.end(),
                    [](const engines::CheckResult& check) { return !check.passed; });
    if (!is_wrong) continue;
    seen.insert(scene.picture);
    return &scene;
  }
  return nullptr;
}

void add_cause(report::Page& page, const Cause& cause, std::size_t number, const Grade& grade,
               const PageView& view, std::set<std::string>& seen) {
  page.begin(report::Part::kCard, "", fmt::format("cause-{}", number));
  page.heading(fmt::format("{}. {} ({})", number, plain_name(title_of(cause)),
                           points_in_words(points_lost(cause, grade.tests))),
               3);
  if (const SceneMedia* scene = scene_to_show(cause, grade, seen))
    page.figures({{std::filesystem::path("media") / scene->picture,
                   {},
                   scene->title + ": submission left, reference right",
                   ""}});
  if (!cause.tests.empty()) page.paragraph(evidence_of(cause, failing(grade)));
  if (!cause.or_else.empty())
    page.paragraph(fmt::format("As well possible{}: {}.",
                               cause.and_also.empty() ? "" : " in place of the second",
                               fmt::join(cause.or_else, "; or ")));
  if (const std::string places = places_of(cause); !places.empty())
    page.paragraph("Look at " + plain_name(places) + ".");
  for (std::size_t i = 0; i < cause.code.size(); ++i) {
    if (cause.code[i].empty()) continue;
    const bool is_short = cause.kind == Cause::Kind::kCrash;  // the lines around it
    if (!is_short)
      page.begin(report::Part::kFold, plain_name(cause.functions[i]) + " of this file");
    page.preformatted(plain_text(cause.code[i]));
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
  const ScoredTest* shown = test_to_show(cause, grade);
  if (shown != nullptr && !shown->result.story.empty() && cause.kind != Cause::Kind::kNotWritten) {
    page.paragraph("For example, " + shown->item.title + ":", Look::kMuted);
    add_story(page, shown->result.story, view);
  }
  std::vector<report::Cell> others;
  const auto is_of_cause = [&](const ScoredTest& test) {
    const std::string& name = test.item.test;
    return std::find(cause.tests.begin(), cause.tests.end(), name) != cause.tests.end() ||
           std::find(cause.following.begin(), cause.following.end(), name) != cause.following.end();
  };
  for (const ScoredTest& test : grade.tests)
    if (is_of_cause(test) && &test != shown)
      others.push_back({test.item.title, test.result.story.empty()
                                             ? "#tests"
                                             : "#" + anchor_of_story(test.item.test)});
  if (!others.empty()) {
    page.begin(report::Part::kFold, counted(others.size(), "other test") + " of this cause");
    page.list(others);
    page.end();
  }
  page.end();
}

}  // namespace

std::string anchor_of_story(const std::string& test) {
  std::string id = "t-";
  for (const char c : test) id += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '-';
  return id;
}

void add_mend_first(report::Page& page, const Grade& grade, const PageView& view) {
  if (grade.causes.empty()) return;
  page.begin(report::Part::kBox, "", "mend-first");
  page.heading("Mend first");
  page.paragraph(
      "What costs the most points stands first, before it only what kept tests from running. A "
      "cause that is called likely was found by "
      "comparing the tests that fail, and the answers that came, with known slips: read it as a "
      "hint, not as a verdict.",
      Look::kMuted);
  std::set<std::string> seen;  // pictures
  for (std::size_t i = 0; i < grade.causes.size(); ++i)
    add_cause(page, grade.causes[i], i + 1, grade, view, seen);
  page.end();
}

}  // namespace tumble::grading
