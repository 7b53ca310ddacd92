/// The laws of a scene, from the words after --modules.
///
/// A word is `student` (build/modules/aN_student.so), `reference`, `library` (Boost.Odeint: motion
/// only), a shared object PATH.so, a source file PATH.cpp, or a submission's folder with such a
/// file. A path's code is compiled and called in the sandbox, never loaded here. `a1=WORD,a2=WORD`
/// chooses for each module, a WORD alone for every module to which it can apply.
/// Modules without a word: the scene's own assignment runs on the student's file; other modules
/// that the scene needs run on the reference where there is one; the rest comes from the library
/// where it has them. So a later assignment never fails because of an earlier one, and scenes run
/// before a student has written an integrator: the library replaces a stub of a module that the
/// scene is not about, with a notice.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "framework/cli/verb.h"
#include "framework/dynamics/laws.h"
#include "framework/scene/scene.h"

namespace tumble::cli {

/// By module id; the id "" stands for all modules without a word of their own.
using ModuleWords = std::map<std::string, std::string>;

/// @param text  "a1=student,a2=library" or "reference"; empty: no words
/// @throws UserError for an id that is no module, or a module named twice
ModuleWords parse_module_words(const std::string& text, const modules::Registry& registry);

struct ChosenModule {
  std::string id;      // "a1"
  std::string source;  // "student", "reference", "library", or a path
};

struct ChosenLaws {
  Laws laws;
  std::vector<ChosenModule> modules;  // modules that the scene needs or that were named, by id
  // for people: what replaces functions that are not written yet
  std::vector<std::string> notices;
  // to sandboxes: must outlive every call of the laws
  std::vector<std::shared_ptr<void>> connections;
};

/// The file of a word that is a path, or the one in that folder.
/// @param for_all  whether the word stands for every module
/// @return empty where the path, given for all modules, belongs to others
/// @throws UserError where there is none
std::filesystem::path module_file(const Context& context, const modules::ModuleKind& kind,
                                  const std::string& word, bool for_all = false);

/// Refuses what is known without loading: a word that is no module's, a file that is not there.
/// @throws UserError
void expect_module_files(const Context& context, const ModuleWords& words);

/// @param engine  of the run; empty: the scene's own. In a tree without a fast scheduler, timewarp
///   (or a list of engines with "tw") needs a scheduler's module, as a scene about it does.
/// @throws UserError for a word that names nothing that can be loaded, with a remedy
ChosenLaws choose_laws(const Context& context, const scene::Scene& scene, const ModuleWords& words,
                       const std::string& engine = "");

/// What is bound in place of a module: the same one with calls that are counted, for example.
/// @param word  that has chosen it
using InPlaceOf = std::function<modules::AnyModule(
    const modules::ModuleKind& kind, const std::string& word, const modules::AnyModule& module)>;
/// The same, with other modules in place of those that are chosen.
ChosenLaws choose_laws(const Context& context, const scene::Scene& scene, const ModuleWords& words,
                       const std::string& engine, const InPlaceOf& in_place_of);

/// Whose each law is: "impulses by a1 student", "motion by Boost.Odeint"; and, of a scene that asks
/// them, "springs, rods and contact by a3 student, where it rubs, is linked or is one of many by
/// the framework", "the drag of a plate by a6 student".
std::vector<std::string> authors_of_laws(const scene::Scene& scene, const Laws& laws);

/// Refuses the word library where a module's own functions are asked for, which the library lacks.
/// @param functions  "functions of a Markov chain"  @param more  a remedy besides, a sentence
[[noreturn]] void refuse_library(const modules::ModuleKind& kind, const std::string& functions,
                                 const std::string& more = "");

/// @throws UserError where several threads would call laws of a sandbox, which executes one call at
///   a time
void refuse_threads_of_sandboxes(const ChosenLaws& chosen, int threads);

/// One module by its word, loaded into this process: for the user's own code.
/// @param word  student, reference, PATH.so, or PATH.cpp, which is compiled first
/// @throws UserError when the word names nothing that can be loaded, with a remedy
modules::AnyModule load_word(const Context& context, const modules::ModuleKind& kind,
                             const std::string& word);

}  // namespace tumble::cli
