/// The page that plays a run (`--html`), alone or beside another of the same scene (`--beside`).
#pragma once

#include <string>

#include "framework/cli/module_choice.h"
#include "framework/cli/run_words.h"
#include "framework/cli/verb.h"
#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"
#include "framework/trajectory/virtual_times.h"

namespace tumble::cli {

/// Declares --html and --beside.
void add_page_words(Verb& verb, RunWords& words);

/// What --beside says: how the second run differs from the first.
struct BesideWords {
  std::string modules;                 // for parse_module_words; what is not named is as in the first run
  std::string engine;                  // empty: the first run's
  std::optional<double> step_s;
  std::string recording;               // a recorded run instead of one of its own; empty: none
};

/// @param text  "reference", "a1=reference,engine=tw,step-s=0.001", "recording=FILE"
/// @throws UserError when a step is no positive number, or a recording is named beside what it cannot change
BesideWords parse_beside(const std::string& text);

/// Before anything runs: what --html and --beside say can be done.
/// @throws UserError
void check_page_words(const Context& context, const RunWords& words);

/// Makes the second run where --beside asks for one, writes words.html, and says so on stderr. Nothing where words.html is empty.
/// @param times  what timewarp's processes did; empty: nothing is shown of it
/// @throws UserError naming what does not fit
void write_page(const Context& context, const scene::Scene& scene, const ChosenLaws& chosen, const Trajectory& run, const RunWords& words);

}  // namespace tumble::cli
