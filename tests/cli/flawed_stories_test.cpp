// What the pages and stories of the flawed submissions say is written as sentences.
#include <regex>
#include <set>

#include "tests/cli/grading_fixture.h"

namespace tumble::grading {
namespace {

/// Text of a page as it is read, without pictures, scripts and listings.
std::string read_off(std::string html) {
  for (const std::string name : {"script", "style", "svg", "pre"})
    for (std::size_t at = html.find('<' + name); at != std::string::npos;
         at = html.find('<' + name, at)) {
      const std::size_t end = html.find("</" + name + '>', at);
      html.erase(at, end == std::string::npos ? end : end + name.size() + 3 - at);
    }
  std::string text;
  bool in_tag = false;
  for (const char c : html) {
    if (c == '<') text += '\n';
    in_tag = (in_tag || c == '<') && c != '>';
    if (!in_tag && c != '>') text += c;
  }
  // the last one: a no-break space, which is read as any other
  for (const auto& [mark, letter] :
       {std::pair{"&lt;", "<"}, {"&gt;", ">"}, {"&amp;", "&"}, {"\u00a0", " "}})
    for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at + 1))
      text.replace(at, std::string(mark).size(), letter);
  return text;
}

struct Rule {
  std::string what;
  std::regex seen;
};

// Products stand with blanks ("n . u"), and code may be quoted.
const std::vector<Rule>& rules() {
  static const std::vector<Rule> all = {
      {"a full stop, and a small letter behind it", std::regex("[A-Za-z0-9)']\\. [a-z]")},
      {"a comparison of two numbers in place of words", std::regex("[0-9] [<>]=? -?[0-9]")},
      {"two marks, one behind the other",
       std::regex("[,;:]\\.( |$)|[.,;:] [.,;:]( |$)|[^.]\\.\\.( |$)")},
      {"one of what stands in the plural",
       std::regex("(^|[^0-9.,:/*^+-])1 (equal )?(steps|tests|calls|points|numbers|scenes)\\b")},
  };
  return all;
}

// @return every line in which a rule is broken
std::set<std::string> faults_in(const std::string& text) {
  std::set<std::string> faults;
  std::istringstream lines(text);
  static const std::regex number_of_a_heading("^ *[0-9]+\\. ");
  for (std::string line; std::getline(lines, line);) {
    line = std::regex_replace(line, number_of_a_heading, "");
    for (const Rule& rule : rules())
      if (std::regex_search(line, rule.seen)) faults.insert(rule.what + ": " + line);
  }
  return faults;
}

// @return every link within a page that has no target there
std::set<std::string> links_to_nowhere(const std::string& html) {
  const auto all = [&](const std::string& begin) {
    std::set<std::string> names;
    for (std::size_t at = html.find(begin); at != html.npos; at = html.find(begin, at + 1)) {
      const std::size_t from = at + begin.size();
      names.insert(html.substr(from, html.find('"', from) - from));
    }
    return names;
  };
  std::set<std::string> nowhere;
  const std::set<std::string> ids = all(" id=\"");
  for (const std::string& link : all("href=\"#"))
    if (!ids.contains(link)) nowhere.insert("a link to nowhere: #" + link);
  return nowhere;
}

TEST(FlawedStories, TheRulesSeeWhatWasFound) {
  EXPECT_EQ(links_to_nowhere("<a href=\"#a\"><a href=\"#b\"><p id=\"b\">"),
            std::set<std::string>{"a link to nowhere: #a"});
  EXPECT_EQ(faults_in("at t = 0.933 s. both impulses act at the same point").size(), 1u);
  EXPECT_EQ(faults_in("0.323 <= 1e-09").size(), 1u);
  EXPECT_EQ(faults_in("it has ended:.").size(), 1u);
  EXPECT_EQ(faults_in("1 equal steps").size(), 1u);
  EXPECT_EQ(faults_in("1. rk4_step crashes"), std::set<std::string>());
  EXPECT_EQ(faults_in("n . u = 3 m/s; a hit has t >= 0. In 1.5 steps, 0..3, e + ... + e^n"),
            std::set<std::string>());
}

TEST_F(Grading, PagesAndStoriesOfTheFlawedSubmissionsAreSentences) {
  const fs::path solutions = fs::path(test::source_dir()) / "solutions_private";
  for (const std::string folder : {"a1_impulse", "a2_integration", "a3_constraints"}) {
    id = folder.substr(0, 2);
    fs::remove_all(root / "in");
    put("flawed/" + folder + ".cpp",
        text_of(solutions / folder / "flawed_submission" / (folder + ".cpp")));
    const ProgramOutcome graded = grade(id);
    ASSERT_EQ(graded.code, 0) << graded.printed;
    std::set<std::string> faults;
    for (const auto& result : results("flawed", id)["tests"])
      faults.merge(faults_in(result.value("output", std::string())));
    for (const char* page : {"flawed/index.html", "flawed/student.html", "index.html"})
      faults.merge(faults_in(read_off(text_of(root / id / page))));
    for (const char* page : {"flawed/index.html", "flawed/student.html"})
      faults.merge(links_to_nowhere(text_of(root / id / page)));
    for (const std::string& fault : faults) ADD_FAILURE() << id << ": " << fault;
    // the equation of a2's dearest cause
    if (id != "a2") continue;
    const std::string page = read_off(text_of(root / id / "flawed/index.html"));
    for (const char* words : {"k3: t + h/2; y + h/2 k2", "which is y + h/2 k1, here",
                              "as these lines give", "gap = a function, t_low = "})
      EXPECT_NE(page.find(words), std::string::npos) << words;
  }
}

// A folder that is handed on alone has what its pages link to.
TEST_F(Grading, TheHandoutLiesInTheFolderOfEachSubmission) {
  put("ada/a1_impulse.cpp", text_of(kStub));
  put("bo/a1_impulse.cpp", "int x = ;\n");
  ASSERT_EQ(grade("out").code, 0);
  for (const char* name : {"ada", "bo"}) {
    const std::string page = text_of(root / "out" / name / "student.html");
    EXPECT_NE(page.find("href=\"handout.html"), std::string::npos) << name;
    EXPECT_EQ(page.find("../"), std::string::npos) << name;
    EXPECT_TRUE(fs::equivalent(root / "out/handout.html", root / "out" / name / "handout.html"))
        << "one file, of two names";
  }
  // It belongs to no result: graded again, everything is current.
  const ProgramOutcome again = grade("out");
  EXPECT_TRUE(says(again, "unchanged since the last run")) << again.printed;
  const ProgramOutcome page =
      tumble({"class", "page", (root / "out").string(), "--to", (root / "for_students").string()});
  EXPECT_EQ(page.code, 0) << page.printed;
  EXPECT_EQ(text_of(root / "for_students/ada/handout.html"), text_of(root / "out/handout.html"));
  EXPECT_FALSE(fs::equivalent(root / "for_students/ada/handout.html", root / "out/handout.html"));
}

}  // namespace
}  // namespace tumble::grading
