/// A run as the page has it: a scene, what was changed in it, and what was done to it by hand. As
/// JSON text, so that only recipe.cpp knows the library.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/math.h"
#include "framework/scene/scene.h"

namespace tumble::live {

/// What the page may change; all for the whole run.
struct Changes {
  std::optional<Vector3d> gravity_m_s2;
  std::optional<double> restitution, friction;  // of all bodies
  std::map<std::string, double> mass_kg;        // by body
  std::optional<double> step_s;
  std::string engine, method, coordinates;  // empty: the scene's, the laws', the scene's
};

struct Recipe {
  std::string document;        // of the scene's file; empty: the scene is made by code
  std::filesystem::path file;  // its name, beside which models are searched
  Changes changes;
  std::vector<std::string> pushes;  // entries of "point_forces", in order
  std::optional<double> duration_s;
};

/// @param change  an object of the page: {"gravity_m_s2": [0, 0, -9.81]}, {"mass_kg": {"box": 2}},
///   null takes a change back
/// @throws UserError for a value that no scene may have
void change(Changes& changes, const std::string& change);

/// The scene's file with all of it. @throws UserError where a body's mass stands in no entry of its
/// own
std::string document_of(const Recipe& recipe);

/// The file that is saved: what was done until a frame, which lies in a whole step of its run, so
/// that it comes out the same to the last bit. Title and checks say that a hand was here.
/// @param until_s  time of the last frame
/// @param again    the command that runs it again, in the text about the scene
std::string saved_document(Recipe recipe, double until_s, const std::string& again);

/// The same changes on a scene that is made by code.
void apply(const Recipe& recipe, scene::Scene& scene);

/// Entries that begin before a time.
std::vector<std::string> before(const std::vector<std::string>& pushes, double time_s);

/// To the process that simulates and back.
std::string as_text(const Recipe& recipe);
Recipe recipe_of(const std::string& text);

}  // namespace tumble::live
