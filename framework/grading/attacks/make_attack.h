/// From an attack to a folder as a student would hand it in.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "framework/grading/attacks/attack.h"

namespace tumble::grading {

/// What stands for {{word}} in an attack's text:
///   secret     a file that everybody may read, whose content no output may hold
///   mark       a name that no file may have afterwards
///   port       of a service on this machine to which nobody may connect
///   socket     name of an abstract socket, likewise
///   root, build, submissions, results   folders of this grading
///   honest, reference, hidden, judge, key   files: the honest submission, the reference solution,
///              the rubric of the hidden tests, the program of the judge, the key of this machine
///   pid        of the process that starts the grading
///   me         name of the attack's folder
using AttackPlaces = std::map<std::string, std::string>;

/// @throws UserError for a place that is not known
std::string with_places(std::string text, const AttackPlaces& places, const std::string& where);

/// A copy of `text` with `first` at the beginning of the body of a function.
/// @throws UserError when `text` defines no such function at the beginning of a line
std::string with_body(const std::string& text, const std::string& function,
                      const std::string& first, const std::string& where);

/// Writes the submission's folder.
/// @param base_text    of the stub or the reference, as the attack asks
/// @param source_name  of the module's file, "a1_impulse.cpp"
/// @throws UserError when a part cannot be made
void make_attack(const Attack& attack, const std::string& base_text, const std::string& source_name,
                 const AttackPlaces& places, const std::filesystem::path& folder);

}  // namespace tumble::grading
