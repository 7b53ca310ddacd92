/// The page of `tumble sample`: worlds in one picture, answers, error against CPU time, traces.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "framework/cli/module_choice.h"
#include "framework/cli/verb.h"
#include "framework/farm/spread.h"
#include "framework/sampling/answers.h"
#include "framework/scene/scene.h"

namespace tumble::cli {

/// What was sampled, and what it says.
struct Sampled {
  sampling::SampledScene worlds;
  ChosenLaws chosen;
  engines::RunOptions run;
  Sampling by;
  std::string source;  // whose functions `by` are
  std::vector<std::string> names;
  sampling::ChainOptions options;
  farm::Outcome outcome;  // what is missing of the chains
  std::vector<sampling::Chain> chains;
  std::vector<sampling::Answers> growing;  // of ever longer beginnings; the last is of all
  // worlds of the prior alone, where they were asked for
  std::optional<sampling::Chain> prior;
  std::vector<sampling::Answers> prior_growing;
};

/// "x +- e", in as many digits as the error has.
std::string with_error(const Answer& answer);

/// How far two answers are apart, in multiples of the error of their difference.
double errors_apart(const Answer& a, const Answer& b);

/// Writes index.html, and the picture and the played runs beside it.
/// @param folder  of the page
void write_sample_page(const Context& context, const Sampled& sampled,
                       const std::filesystem::path& folder);

}  // namespace tumble::cli
