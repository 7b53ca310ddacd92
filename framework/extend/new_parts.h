/// `tumble new effect | scene | slip | test`: one part of the course, ready to be written.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/extend/templates.h"

namespace tumble::extend {

/// An effect with its words in a scene, its physics and a test.
/// @param function  of an assignment that it asks: "a6.plate_drag". The effect has its law then,
///   which the assignment's binding sets. Empty: none
/// @return what was written; of an effect with a function the binding, too
/// @throws UserError for a name that is taken or cannot be one; so do all below
std::vector<NewFile> new_effect(const std::filesystem::path& root, const std::string& name,
                                const std::string& function = "");

/// A scene of an assignment.
std::vector<NewFile> new_scene(const std::filesystem::path& root, const std::string& id,
                               const std::string& name);

/// A slip of an assignment's reference, with a line of the function in question to be changed.
/// @param function  of the module
std::vector<NewFile> new_slip(const std::filesystem::path& root, const std::string& id,
                              const std::string& name, const std::string& function);

/// A test with its file and its entry in the rubric, which is worth 0 points until it is given
/// some.
/// @param test    "Suite.Name"
/// @param hidden  below solutions_private/
std::vector<NewFile> new_test(const std::filesystem::path& root, const std::string& id,
                              const std::string& test, bool hidden);

}  // namespace tumble::extend
