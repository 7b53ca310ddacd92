#include "framework/grading/grades/class_files.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/grading/compiler/compile.h"
#include "framework/grading/grades/audit.h"
#include "framework/grading/grades/class_page.h"
#include "framework/grading/grades/find_submissions.h"
#include "framework/grading/grades/scoring.h"
#include "framework/grading/verdicts/plain_text.h"

namespace tumble::grading {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json number_or_null(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

std::optional<double> number_in(const Json& json) {
  return json.is_null() ? std::nullopt : std::optional<double>(json.get<double>());
}

Standing standing_in(const Json& json) {
  Standing standing;
  standing.person = {json.at("name"), json.at("id"), json.at("group"), {}, {}, {}};
  standing.is_in_roster = json.at("in_roster");
  standing.submission = json.at("submission");
  standing.folder = json.at("folder");
  standing.attempts = json.at("attempts");
  standing.is_time_known = json.at("time_known");
  standing.late_days = json.at("late_days");
  standing.free_days = json.at("free_days");
  standing.before = number_in(json.at("before"));
  standing.percent = json.at("penalty_percent");
  standing.after = number_in(json.at("after"));
  standing.why = json.at("why");
  return standing;
}

}  // namespace

std::string gradebook_csv(const std::string& assignment_title,
                          const std::vector<Standing>& standings, double possible,
                          bool is_official) {
  const std::string title =
      assignment_title + (is_official ? "" : " - not official; see the notes");
  std::string text = "Student,ID,SIS Login ID,Section," + csv_cell(title) + "," +
                     csv_cell(assignment_title + " before late days") + "," +
                     csv_cell(assignment_title + " reason") + "\n";
  text += "    Points Possible,,,," + points_text(possible) + ",(read only),(read only)\n";
  const auto points = [](const std::optional<double>& value) {
    return value ? points_text(*value) : std::string();
  };
  for (const Standing& standing : standings) {
    const std::string name = csv_name(standing.person.name);
    text += name + "," + csv_cell(standing.person.id) + "," + name + ",," + points(standing.after) +
            "," + points(standing.before) + "," + csv_cell(standing.why) + "\n";
  }
  return text;
}

std::string standing_json(const std::vector<Standing>& standings) {
  Json all = Json::array();
  for (const Standing& s : standings)
    all.push_back({{"name", s.person.name},
                   {"id", s.person.id},
                   {"group", s.person.group},
                   {"in_roster", s.is_in_roster},
                   {"submission", s.submission},
                   {"folder", s.folder},
                   {"attempts", s.attempts},
                   {"time_known", s.is_time_known},
                   {"late_days", s.late_days},
                   {"free_days", s.free_days},
                   {"before", number_or_null(s.before)},
                   {"penalty_percent", s.percent},
                   {"after", number_or_null(s.after)},
                   {"why", s.why}});
  return all.dump(1, ' ', false, Json::error_handler_t::replace) + '\n';
}

std::vector<Standing> read_standings(const fs::path& file) {
  if (!fs::exists(file))
    throw UserError(file.string(), "does not exist: no policy was given when this was graded",
                    "Run tumble grade again with --policy policy.json.");
  std::vector<Standing> standings;
  try {
    for (const Json& json : Json::parse(text_of(file))) standings.push_back(standing_in(json));
  } catch (const Json::exception&) {
    throw UserError(file.string(), "cannot be read", "Run tumble grade again: it writes it anew.");
  }
  return standings;
}

std::vector<std::string> what_needs_a_look(const std::vector<Standing>& standings) {
  std::vector<std::string> sentences;
  for (const Standing& standing : standings)
    if (!standing.after)
      sentences.push_back(plain_name(standing.person.name) + ": " + standing.why);
    else if (!standing.is_time_known)
      sentences.push_back(plain_name(standing.person.name) + ": " + standing.why);
  return sentences;
}

std::vector<KnownSlip> known_slips(const Course& course, const std::string& id) {
  std::vector<AuditResult> audited;
  try {
    audited = kept_audit(course, id);
  } catch (const UserError&) {
    return {};  // this tree has no slips, or one does not fit its base: the audit says so
  }
  std::vector<KnownSlip> known;
  for (const AuditResult& result : audited) {
    if (result.caught_by.empty() || !result.fault.empty()) continue;
    KnownSlip slip{plain_name(result.candidate.slip), result.candidate.keyword, {}};
    for (const TestResult& test : result.caught_by) slip.tests.insert(test.test);
    known.push_back(std::move(slip));
  }
  return known;
}

std::vector<NamedSource> sources_in(const fs::path& submissions, const modules::ModuleKind& kind) {
  std::vector<NamedSource> sources;
  for (const Submission& submission : find_submissions(submissions, kind).all) {
    std::string why;
    if (submission.source.empty()) continue;
    if (auto text = read_plain_file(submission.source, CompileLimits{}.source_bytes, why))
      sources.push_back({submission.name, std::move(*text)});
  }
  return sources;
}

std::string starter_of(const Course& course, const modules::ModuleKind& kind) {
  return text_of(course.root / "assignments" / kind.folder / (kind.folder + ".cpp"));
}

report::Page page_of_similar(const modules::ModuleKind& kind,
                             const std::vector<NamedSource>& sources,
                             const std::function<std::vector<SimilarPair>()>& compare,
                             const std::function<void(const std::string&)>& notice) {
  std::vector<SimilarPair> pairs;
  std::string problem;
  try {
    pairs = compare();
  } catch (const SourcesNotCompared& error) {
    problem = std::string("Nothing was compared: ") + error.what() +
              ". One odd file may be the cause. No grade depends on it.";
    if (notice) notice("similar.html: " + problem);
  }
  return similar_page(kind, sources, pairs, plain_text(problem));
}

namespace {

// Files that are alike, as far as they can be compared.
report::Page page_of_similar_in(const fs::path& submissions, const Course& course,
                                const modules::ModuleKind& kind, const GradeOptions& options) {
  const auto sources = sources_in(submissions, kind);
  if (!can_compare_sources())
    return similar_page(kind, sources, {},
                        "Nothing was compared, because sim_c++ is not installed: sudo apt-get "
                        "install similarity-tester, then run the same command again.");
  return page_of_similar(
      kind, sources, [&] { return similar_pairs(sources, starter_of(course, kind)); },
      options.notice);
}

}  // namespace

void write_class_files(const Course& course, const modules::ModuleKind& kind,
                       const fs::path& submissions, const PolicyFile* policy, const fs::path& out,
                       const std::vector<Grade>& grades, const SlipTally& slips,
                       const GradeOptions& options) {
  std::vector<Standing> standings;
  if (policy) {
    standings = apply_policy(policy->policy, policy->roster, policy->hand_ins, grades);
    double possible = 0.0;
    bool is_official = true;
    for (const Grade& grade : grades) {
      possible = std::max(possible, grade.possible);
      is_official = is_official && grade.is_official;
    }
    write_whole(out / "gradebook.csv", gradebook_csv(kind.title, standings, possible, is_official));
    write_whole(out / kStandingFile, standing_json(standings));
  } else {
    fs::remove(out / kStandingFile);
  }
  const auto write_failure = [&](const std::string& file, const std::string& why) {
    report::Page page(kind.title + ": " + file, kind.id);
    page.paragraph("The grader failed at this page: " + plain_text(why) +
                       ". No grade depends on it; the same command makes it again.",
                   report::Look::kWarning);
    try {
      page.write(out / file);
    } catch (const std::exception&) {
      // the file cannot be written at all: `failed` says so
    }
  };
  const auto write_page = [&](const std::string& file, const std::function<report::Page()>& make) {
    try {
      make().write(out / file);
    } catch (const std::exception& error) {
      if (!options.failed) throw;
      write_failure(file, error.what());
      options.failed(file, error.what());
    }
  };
  write_page("class.html", [&] { return class_page(kind, grades, slips, standings); });
  write_page("pictures.html", [&] { return pictures_page(kind, grades, out); });
  write_page("similar.html",
             [&] { return page_of_similar_in(submissions, course, kind, options); });
}

}  // namespace tumble::grading
