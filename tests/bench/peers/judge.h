/// How wrong a run is, by truths that belong to no engine.
#pragma once

#include <map>
#include <string>

#include "tests/bench/peers/harness.h"

namespace tumble::peers {

struct Judgement {
  double error;                         // what is drawn; NaN where the run left the numbers
  std::map<std::string, double> parts;  // what it is made of, with units in the names
};

Judgement judge(const BenchCase& bench, const World& world, const Observed& run);

}  // namespace tumble::peers
