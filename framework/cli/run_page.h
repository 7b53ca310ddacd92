/// The page that plays a run (`--html`), alone or beside another run of the same scene
/// (`--beside`).
#pragma once

#include <optional>
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

/// The words after --beside: how the second run differs from the first.
struct BesideWords {
  // for parse_module_words; other modules are those of the first run
  std::string modules;
  std::string engine;  // empty: the first run's
  std::optional<double> step_s;
  std::string recording;  // a recorded run in place of a second run; empty: none
};

/// @param text  "reference", "a1=reference,engine=tw,step-s=0.001", "recording=FILE"
/// @throws UserError when a step is no positive number, or a recording is combined with words that
///   cannot change it
BesideWords parse_beside(const std::string& text);

/// What --beside names, loaded before the first run: neither, without that word.
struct PreparedPage {
  std::optional<ChosenLaws> laws;       // of the second run
  std::optional<Trajectory> recording;  // in its place
};

/// Does before the first run what can be refused of --html and --beside: loads the modules of the
/// second run, which is begun and ended at its first frame, or reads the recording.
/// @param chosen  the laws of the first run
/// @throws UserError with the word that does not fit
PreparedPage prepare_page(const Context& context, const scene::Scene& scene,
                          const ChosenLaws& chosen, const RunWords& words);

/// Makes the second run where --beside asks for one, writes words.html, and reports it on stderr.
/// Does nothing where words.html is empty.
void write_page(const Context& context, const scene::Scene& scene, const ChosenLaws& chosen,
                const PreparedPage& prepared, const Trajectory& run, const RunWords& words);

}  // namespace tumble::cli
