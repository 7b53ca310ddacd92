/// What a sweep varies: the words after --over, and the scene and run of one point of their grid.
///
///   restitution, friction   of every body [-]
///   gravity                 its strength, along the scene's own, down where it has none [m/s^2]
///   step_s                  largest step [s]
///   tolerance               of a method that chooses its steps by one [-]
///   method, engine          words, as for tumble run
///   BODY.WHAT               one number of one body: a word that "sampling" in a scene may perturb
/// Values are START:END:STEP, both ends included, or a list; numbers may be fractions: 1/240.
#pragma once

#include <string>
#include <vector>

#include "framework/cli/run_words.h"
#include "framework/scene/scene.h"

namespace tumble::cli {

struct Varied {
  std::string word;  // "restitution", "ball.position_z_m"
  std::string unit;  // "m"; empty: a number without one, or a word
  bool is_number = true;
  std::vector<double> numbers;     // where it is one
  std::vector<std::string> texts;  // of each value, with all digits
  std::size_t size() const { return texts.size(); }
};

/// A value as people read it: a step as step_in_words (core/text.h) has it where it is long, other
/// numbers in six digits.
std::string value_in_words(const Varied& varied, std::size_t value);

/// @param over   of each --over: "restitution=0:1:0.05", or several with commas between them
/// @param scene  for the names of bodies
/// @throws UserError for a word that is unknown or given twice, for a value outside its range, an
///   empty or reversed range, and a grid of too many points
std::vector<Varied> parse_over(const std::vector<std::string>& over, const scene::Scene& scene);

/// A point of the grid: which value of each varied word.
using GridPoint = std::vector<std::size_t>;
/// All of them; the last word varies fastest.
std::vector<GridPoint> grid_of(const std::vector<Varied>& varied);
/// "restitution=0.5, step_s=0.001"
std::string in_words(const std::vector<Varied>& varied, const GridPoint& point);

/// Sets the values of a point: in the words of its run (step_s, method, engine, tolerance), and in
/// the scene (all others).
void set_words(const std::vector<Varied>& varied, const GridPoint& point, RunWords& words);
void set_scene(const std::vector<Varied>& varied, const GridPoint& point, scene::Scene& scene);

}  // namespace tumble::cli
