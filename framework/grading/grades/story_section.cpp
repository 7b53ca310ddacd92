#include "framework/grading/grades/story_section.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "framework/core/math.h"
#include "framework/grading/verdicts/mend_order.h"
#include "framework/grading/verdicts/plain_text.h"
#include "framework/report/html_text.h"
#include "framework/report/ticks.h"

namespace tumble::grading {
namespace {

// What tests/support/story.h, a crash and an x-ray say; all else is text.
constexpr std::array<std::string_view, 11> kNames = {"scene",  "steps",       "expected", "found",
                                                     "off by", "likely",      "look at",  "read",
                                                     "more",   "called with", "x-ray"};
constexpr std::string_view kXray = "x-ray", kMark = "<-";
constexpr std::size_t kTermIndent = 12;  // blanks before a term; a value that goes on has fewer

std::string bare(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t"), end = text.find_last_not_of(" \t");
  return begin == text.npos ? "" : text.substr(begin, end - begin + 1);
}

std::size_t blanks_before(const std::string& line) {
  return std::min(line.find_first_not_of(' '), line.size());
}

// "  found:    2 m"; an empty name: none.
report::Field field_in(const std::string& line) {
  const std::size_t begin = blanks_before(line), colon = line.find(':', begin);
  if (begin > 2 || colon == line.npos) return {};
  const std::string name = line.substr(begin, colon - begin);
  if (std::find(kNames.begin(), kNames.end(), name) == kNames.end()) return {};
  return {name, bare(line.substr(colon + 1))};
}

// Name and value have two blanks between them, and a mark its arrow.
// "(  3,   4) m": blanks that put numbers below each other in a terminal. Rows of a table have
// none.
std::string unpadded(const std::string& value) {
  std::string text;
  for (const char letter : value)
    if (letter != ' ' || text.empty() || (text.back() != ' ' && text.back() != '(')) text += letter;
  return text;
}

StoryTerm term_in(const std::string& line) {
  StoryTerm term;
  std::string text = bare(line);
  if (const std::size_t mark = text.find(kMark); mark != text.npos) {
    term.mark = bare(text.substr(mark + kMark.size()));
    text = bare(text.substr(0, mark));
  }
  const std::size_t gap = text.find("  ");
  term.name = text.substr(0, gap);
  if (gap != text.npos) term.value = unpadded(bare(text.substr(gap)));
  return term;
}

// "(1, 0, -1) m"; nothing else than three numbers in brackets.
std::optional<Vector3d> vector_in(const std::string& value) {
  if (value.empty() || value.front() != '(') return std::nullopt;
  Vector3d v;
  const char* at = value.c_str() + 1;
  for (int i = 0; i < 3; ++i) {
    char* end = nullptr;
    v[i] = std::strtod(at, &end);
    if (end == at || *end != (i < 2 ? ',' : ')')) return std::nullopt;
    at = end + 1;
  }
  return v;
}

// "handouts/a1_impulse.md#eq-a1-9" as a reader of a page calls it.
std::string name_of_place(const std::string& anchor) {
  const auto after = [&](const std::string& begin) {
    return anchor.starts_with(begin) ? anchor.substr(begin.size()) : "";
  };
  if (std::string number = after("eq-"); !number.empty()) {
    std::replace(number.begin(), number.end(), '-', '.');
    number.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(number.front())));
    return "equation (" + number + ") of the handout";
  }
  if (const std::string hint = after("hint-"); !hint.empty())
    return "the hint '" + hint + "' of the handout";
  return anchor.empty() ? "the handout" : "the handout, '" + anchor + "'";
}

// The handout's places in a text, as links to the page of the handout; in the text they are called
// as a reader would.
std::vector<report::Cell> handout_links(std::string& text, const PageView& view) {
  std::vector<report::Cell> links;
  constexpr std::string_view kFolder = "handouts/";
  for (std::size_t at = text.find(kFolder); at != text.npos && !view.handout.empty();
       at = text.find(kFolder, at + 1)) {
    std::size_t end = at;
    while (end < text.size() &&
           (std::isalnum(static_cast<unsigned char>(text[end])) != 0 ||
            std::string_view("/_-.#").find(text[end]) != std::string_view::npos))
      ++end;
    const std::string named = text.substr(at, end - at);
    const std::size_t hash = named.find('#');
    const std::string stem = std::filesystem::path(named.substr(0, hash)).stem().string();
    if (stem != view.handout_name) continue;
    const std::string anchor = hash == named.npos ? "" : named.substr(hash),
                      said = name_of_place(anchor.empty() ? "" : anchor.substr(1));
    links.push_back({said, view.handout + anchor});
    text.replace(at, named.size(), said);
  }
  return links;
}

// A page has a story's names in its own words: what is only "look at" in a terminal may not be the
// mistake that was made.
std::string name_in_page(const std::string& name) {
  if (name == "likely") return "likely mistake";
  if (name == "look at") return "to check";
  return name;
}

// "(0.6, 0.8) (unit)" of a direction. What was found may be of any length, and is called no unit
// vector.
std::string without_unit_mark(const report::Field& field) {
  constexpr std::string_view kUnitVector = " (unit)";
  if ((field.name != "expected" && field.name != "found") || !field.text.ends_with(kUnitVector))
    return field.text;
  return field.text.substr(0, field.text.size() - kUnitVector.size()) +
         (field.name == "expected" ? ", of length 1" : "");
}

// Fields of one scene each: a test may tell of up to three.
std::vector<std::vector<report::Field>> cases_of(const std::vector<report::Field>& fields) {
  std::vector<std::vector<report::Field>> cases(1);
  for (const report::Field& field : fields) {
    const auto is_scene = [](const report::Field& other) { return other.name == "scene"; };
    if (is_scene(field) && std::any_of(cases.back().begin(), cases.back().end(), is_scene))
      cases.emplace_back();
    if (field.name == "likely") {
      const MistakeParts parts = parts_of_mistake(field.text);
      cases.back().push_back({name_in_page(field.name), parts.mistake, field.links});
      if (!parts.cure.empty()) cases.back().push_back({"remember", parts.cure, field.links});
    } else {
      cases.back().push_back({name_in_page(field.name), without_unit_mark(field), field.links});
    }
  }
  return cases;
}

// "j = -(1 + e) u_n / k   (A1.9)" with its number first: at the end it would stand alone in a line.
std::string number_first(const std::string& equation) {
  const std::size_t gap = equation.find("   (");
  if (gap == equation.npos) return equation;
  const std::size_t end = equation.find_last_of(')') + 1;
  if (end <= gap) return equation;
  return bare(equation.substr(gap, end - gap)) + "  " + equation.substr(0, gap) +
         equation.substr(end);
}

// The terms of the equation, and a drawing of them. The equation itself is a field of the story.
void add_terms(report::Page& page, const StoryParts& parts) {
  constexpr std::size_t kLetters = 64;  // of a line, with a mark beside it
  report::Table table{"", {{""}, {""}, {""}}, {}};
  for (const StoryTerm& term : parts.terms)
    table.rows.push_back(
        {{term.name},
         {fmt::format("{}", fmt::join(report::wrapped(term.value, kLetters), "\n"))},
         {report::formula_in_parts(term.mark), "", report::Look::kBad}});
  // a column of marks only where there is one
  if (std::all_of(parts.terms.begin(), parts.terms.end(),
                  [](const StoryTerm& term) { return term.mark.empty(); })) {
    table.columns.pop_back();
    for (auto& row : table.rows) row.pop_back();
  }
  if (const auto arms = arms_of(parts.terms)) page.plot(*arms);
  if (!table.rows.empty()) page.table(table);
}

}  // namespace

report::Field reading(const std::string& places, const PageView& view) {
  std::string text = places;
  std::vector<report::Cell> links = handout_links(text, view);
  return {"read", text, links};
}

StoryParts parts_of_story(const std::string& story) {
  StoryParts parts;
  std::istringstream lines(story);
  bool in_xray = false;
  for (std::string line; std::getline(lines, line);) {
    const report::Field field = field_in(line);
    if (!field.name.empty()) {
      in_xray = field.name == kXray && parts.equation.empty();
      in_xray ? void(parts.equation = field.text) : parts.fields.push_back(field);
    } else if (in_xray && blanks_before(line) >= kTermIndent) {
      parts.terms.push_back(term_in(line));
    } else if (parts.fields.empty() && parts.equation.empty()) {
      if (!parts.before.empty() || !bare(line).empty())
        parts.before += (line.starts_with("  ") ? line.substr(2) : line) + '\n';
    } else if (!bare(line).empty()) {  // a value that goes on, such as rows of a matrix
      in_xray = false;
      if (parts.fields.empty()) parts.fields.push_back({"", ""});
      std::string& text = parts.fields.back().text;
      text += (text.empty() ? "" : "\n") + bare(line);
    }
  }
  return parts;
}

std::optional<report::Arms> arms_of(const std::vector<StoryTerm>& terms) {
  report::Arms arms;
  for (const StoryTerm& term : terms) {
    const std::string name = term.name.substr(0, term.name.find(" = "));
    const auto value = vector_in(term.value);
    if (!value) continue;
    if (name == "r_a" || name == "r_b" || name == "r")
      arms.arms.push_back({name, *value, name == "r_a" ? "A" : name == "r_b" ? "B" : ""});
    else if (term.name == "n" || term.name == "J" || term.name == "F")
      arms.directions.push_back({name, *value});
  }
  if (!report::can_be_drawn(arms)) return std::nullopt;
  const std::string& direction = arms.directions.front().name;
  const std::string out = report::out_of_plane_words(arms);
  arms.caption =
      "Arms to p in the plane of " + direction + ", to scale" + (out.empty() ? "" : "; " + out);
  return arms;
}

void add_story(report::Page& page, const std::string& story, const PageView& view) {
  std::string text = plain_text(story);
  const std::vector<report::Cell> links = handout_links(text, view);
  StoryParts parts = parts_of_story(text);
  if (parts.fields.empty() && parts.equation.empty()) return page.preformatted(parts.before, links);
  for (report::Field& field : parts.fields) field.links = links;
  page.begin(report::Part::kStory);
  if (!parts.before.empty()) page.preformatted(parts.before, links);
  // the x-ray is of the first failure, and stands with it
  auto cases = cases_of(parts.fields);
  if (!parts.equation.empty())
    cases.front().push_back(
        {std::string(kXray), report::formula_in_parts(number_first(parts.equation))});
  for (std::size_t i = 0; i < cases.size(); ++i) {
    if (cases.size() > 1) page.heading(fmt::format("Case {} of {}", i + 1, cases.size()), 4);
    if (!cases[i].empty()) page.fields(cases[i]);
    if (i == 0 && !parts.equation.empty()) add_terms(page, parts);
  }
  page.end();
}

}  // namespace tumble::grading
