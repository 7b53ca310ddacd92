/// The files about a class in a folder of results: gradebook by the course's rules, pages of the
/// instructor, and what later commands read.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "framework/grading/course/course.h"
#include "framework/grading/grades/class_facts.h"
#include "framework/grading/grades/policy_file.h"
#include "framework/grading/grades/similar.h"

namespace tumble::grading {

inline constexpr const char* kStandingFile = "standing.json";

/// gradebook.csv with the points after the course's rules in the column that Canvas imports, and
/// two that it ignores ("read only"): points before them, and why. Blank where there is no score.
std::string gradebook_csv(const std::string& assignment_title,
                          const std::vector<Standing>& standings, double possible,
                          bool is_official);

/// standing.json: every standing, for programs.
std::string standing_json(const std::vector<Standing>& standings);
/// @throws UserError when the file is missing or cannot be read
std::vector<Standing> read_standings(const std::filesystem::path& file);

/// One sentence for each person without a score and each submission of nobody in the roster.
std::vector<std::string> what_needs_a_look(const std::vector<Standing>& standings);

/// The assignment's known slips, as far as an audit has judged them; none where the tree has none.
std::vector<KnownSlip> known_slips(const Course& course, const std::string& id);

/// The submissions' texts, and the starter's.
std::vector<NamedSource> sources_in(const std::filesystem::path& submissions,
                                    const modules::ModuleKind& kind);
std::string starter_of(const Course& course, const modules::ModuleKind& kind);

/// The page of sources that are alike. Where sim_c++ fails on them the page says so, and a notice:
/// one odd file may be the cause, and is no fault of the grader.
/// @param compare  finds the pairs
/// @throws whatever `compare` throws but SourcesNotCompared
report::Page page_of_similar(const modules::ModuleKind& kind,
                             const std::vector<NamedSource>& sources,
                             const std::function<std::vector<SimilarPair>()>& compare,
                             const std::function<void(const std::string&)>& notice);

/// Writes class.html, pictures.html, similar.html, and with a policy gradebook.csv and
/// standing.json (without one, an earlier standing.json is removed).
/// @param policy  none: nullptr
/// @param options  its `failed` is called with each of the three pages that could not be made, and
///   why (the page says so, too, where it can be written), `notice` with what else a person should
///   know
/// @throws UserError when a file of the policy cannot be written, and whatever the policy throws:
///   without it there is no gradebook
void write_class_files(const Course& course, const modules::ModuleKind& kind,
                       const std::filesystem::path& submissions, const PolicyFile* policy,
                       const std::filesystem::path& out, const std::vector<Grade>& grades,
                       const SlipTally& slips, const GradeOptions& options);

}  // namespace tumble::grading
