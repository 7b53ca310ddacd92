/// solutions_private/aN_name/causes.json: what an audit found of each known slip, for
/// likely_slips.h. `tumble audit aN` writes it anew; nobody edits it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/grading/course/course.h"
#include "framework/grading/grades/audit.h"
#include "framework/grading/grades/likely_slips.h"

namespace tumble::grading {

std::filesystem::path causes_file(const Course& course, const std::string& id);

/// The slips among audited candidates. Whole files are no slips: nobody writes them by mistake.
/// @param functions  of the module
std::vector<AuditedSlip> audited_slips(const std::vector<AuditResult>& results,
                                       const std::vector<std::string>& functions);

/// The file's text. The same audit gives the same bytes.
std::string causes_json(const std::string& id, const std::vector<AuditedSlip>& slips);

/// @throws UserError when the file is not written as above
std::vector<AuditedSlip> read_causes(const std::filesystem::path& file);
/// Empty where the tree has no such file.
std::vector<AuditedSlip> audited_slips_of(const Course& course, const std::string& id);

}  // namespace tumble::grading
