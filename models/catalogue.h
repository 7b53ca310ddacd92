/// Every model of this folder, made from nothing but numbers.
#pragma once

#include <string>
#include <vector>

#include "models/write_3ds.h"

namespace tumble::models {

struct Model {
  std::string file;             // relative to models/
  std::vector<Object> objects;  // [m], z up
};

/// The models in the order of their README. The same list on every call.
std::vector<Model> catalogue();

/// Surfaces that are refused, under broken/: one for each way not to be a solid.
std::vector<Model> broken_catalogue();

}  // namespace tumble::models
