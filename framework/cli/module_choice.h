/// Whose laws a scene runs by: turns the words after --modules into laws.
///
/// A word is `student` (build/modules/aN_student.so), `reference`, `library` (Boost.Odeint: motion only), a shared object
/// PATH.so, a source file PATH.cpp, or a submission's folder with such a file. What a path names is compiled and called in the
/// sandbox, never loaded here. `a1=WORD,a2=WORD` chooses for each module, a WORD alone for all that it can be about.
/// What is not named: the scene's own assignment runs on the student's file; other modules that the scene needs run on the
/// reference where there is one; what it does not need comes from the library where that has it. So a later assignment
/// never fails for an earlier bug, and scenes run before a student has written an integrator: a stub of a module that the
/// scene is not about is stood in for by the library, and a notice says so.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "framework/cli/verb.h"
#include "framework/dynamics/laws.h"
#include "framework/scene/scene.h"

namespace tumble::cli {

/// By module id; the id "" is for all modules that are not named.
using ModuleWords = std::map<std::string, std::string>;

/// @param text  "a1=student,a2=library" or "reference"; empty: nothing is told
/// @throws UserError for an id that is no module, or a module named twice
ModuleWords parse_module_words(const std::string& text, const modules::Registry& registry);

struct ChosenModule {
  std::string id;      // "a1"
  std::string source;  // "student", "reference", "library", or a path
};

struct ChosenLaws {
  Laws laws;
  std::vector<ChosenModule> modules;  // those that the scene needs or that were named, by id
  std::vector<std::string> notices;   // for people: who stands in for what is not written yet
  std::vector<std::shared_ptr<void>> connections;   // to sandboxes: must outlive every call of the laws
};

/// @param engine  that will run the scene; empty: the scene's own. In a tree without a fast scheduler, timewarp (a list of engines
///                that names "tw") asks for a scheduler's module as a scene about it does.
/// @throws UserError when a word names nothing that can be loaded, with what to do
ChosenLaws choose_laws(const Context& context, const scene::Scene& scene, const ModuleWords& words, const std::string& engine = "");

/// @throws UserError where several threads would call laws of a sandbox, which answers one call at a time
void refuse_threads_of_sandboxes(const ChosenLaws& chosen, int threads);

/// One module by its word, loaded into this process: for code of one's own.
/// @param word  student, reference, PATH.so, or PATH.cpp, which is compiled first
/// @throws UserError when the word names nothing that can be loaded, with what to do
modules::AnyModule load_word(const Context& context, const modules::ModuleKind& kind, const std::string& word);

}  // namespace tumble::cli
