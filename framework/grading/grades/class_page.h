/// The pages of an instructor: how a class did, its pictures, and which submissions are alike.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/grading/grades/class_facts.h"
#include "framework/grading/grades/policy.h"
#include "framework/grading/grades/similar.h"
#include "framework/report/html.h"

namespace tumble::grading {

/// OUT/class.html: histogram, tests, slips, points by the course's rules, matrix of tests by
/// submissions.
/// @param slips      of all submissions
/// @param standings  empty: there is no policy
report::Page class_page(const modules::ModuleKind& kind, const std::vector<Grade>& grades,
                        const SlipTally& slips, const std::vector<Standing>& standings);

/// OUT/pictures.html: each scene's pictures, those farthest from the reference first.
/// @param out  where the pictures are
report::Page pictures_page(const modules::ModuleKind& kind, const std::vector<Grade>& grades,
                           const std::filesystem::path& out);

/// OUT/similar.html: pairs, and what they have in common side by side.
/// @param problem  why nothing was compared; empty: it was
report::Page similar_page(const modules::ModuleKind& kind, const std::vector<NamedSource>& sources,
                          const std::vector<SimilarPair>& pairs, const std::string& problem);

}  // namespace tumble::grading
