#include "framework/core/error.h"

namespace tumble {
namespace {

std::string sentence(const std::string& where, const std::string& problem,
                     const std::string& remedy) {
  std::string text = where.empty() ? problem : where + ": " + problem;
  const bool is_ended = text.ends_with('.') || text.ends_with('?') || text.ends_with('!');
  if (!remedy.empty()) text += (is_ended ? " " : ". ") + remedy;
  return text;
}

}  // namespace

UserError::UserError(std::string where, std::string problem, std::string remedy)
    : std::runtime_error(sentence(where, problem, remedy)),
      where_(std::move(where)),
      problem_(std::move(problem)),
      remedy_(std::move(remedy)) {}

}  // namespace tumble
