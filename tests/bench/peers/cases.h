/// The scenes that every engine runs, S1 to S8, as the course's own plain data: an adapter turns
/// them into its engine's world.
///
/// Each has a truth that comes from none of the engines (judge.cpp): a file of tests/truths, a
/// closed form, or a law of conservation together with the constraint that must hold. SI units,
/// world frame, z up.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "framework/scene/scene.h"

namespace tumble::peers {

/// One thing that the project wants to reach, as numbers that the rows decide. A goal names some
/// of: an error, a step, a price, a peer.
///   error, step          the row of that step is at most so wrong
///   error, price_s       the cheapest row of that error costs at most so much
///   error, ratio, peer   ... at most so many times the peer's cheapest of that error
///   step, ratio, peer    the row of that step costs at most so many times the peer's row of the
/// same step, whatever their errors
///   error                some row is at most so wrong
///   step, ratio, bench   a step costs at most so many times one of that step in the other case
struct Goal {
  std::string words;
  // step [s]
  double error = std::numeric_limits<double>::quiet_NaN(),
         step = std::numeric_limits<double>::quiet_NaN();
  double price_s = std::numeric_limits<double>::quiet_NaN(),
         ratio = std::numeric_limits<double>::quiet_NaN();
  std::string peer = {}, bench = {};
};

struct BenchCase {
  std::string id;                      // "S3-100": unique, a file's name
  std::string name, title;             // a few words for tables, and a line
  std::string error_name, error_unit;  // of the one number that is drawn
  std::string truth;                   // where the truth comes from, for the page
  std::vector<Goal> goals;
  std::string note;  // what to know when reading the picture
  scene::Scene scene;
  // [s], ascending, ends of steps of every ladder; the last is the end of the run
  std::vector<double> sample_times;
  std::vector<double> steps;        // the ladder, from coarse to fine [s]
  bool watches_first_body = false;  // the error is in the instants at which it bounces
};

/// @param quick  fewer and coarser steps, and no scene that takes an engine more than a few seconds
std::vector<BenchCase> all_cases(bool quick);

// Sizes that the judge needs again.
inline constexpr double kGravity = 9.81;     // m/s^2
inline constexpr double kChainLink = 0.25;   // m, S2: eight of them
inline constexpr double kBobLink = 0.1;      // m, S6: ten of them
inline constexpr double kBallRadius = 0.05;  // m, S3
// m, S7: wall about x = 0, so thick
inline constexpr double kBulletRadius = 0.05, kBulletStart = -10.0, kBulletWall = 0.01;
/// Speed of the bullet of a case of S7. [m/s]
double bullet_speed(const BenchCase& bench);

}  // namespace tumble::peers
