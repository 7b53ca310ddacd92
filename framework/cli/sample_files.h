/// What `tumble sample` writes for programs beside its page. chains.csv and answers.json hold no
/// times and no command: the same chains give the same bytes wherever they were made. Times stand
/// in times.json.
#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

#include "framework/cli/sample_page.h"

namespace tumble::cli {

nlohmann::ordered_json json_of(const sampling::Answers& answers);
nlohmann::ordered_json times_of(const sampling::Answers& answers);

/// @throws UserError when a file cannot be written
void write_sample_files(const Context& context, const Sampled& sampled,
                        const std::filesystem::path& folder);

}  // namespace tumble::cli
