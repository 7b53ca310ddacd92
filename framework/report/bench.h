/// The part of a page in which code that was handed in answers: compiled to WebAssembly, run in a
/// worker of the page and ended where it does not answer. The scripts: framework/report/bench/.
#pragma once

#include <string>

#include "framework/report/html.h"

namespace tumble::report {

struct Bench {
  std::string own;          // the module's bytes; empty: there is no bench
  std::string right;        // of the right law, drawn beside it; empty: it runs alone
  std::string experiments;  // the assignment's script (assignments/aN_name/page.js)
};

/// Adds the bench. The page then lets this program's own script run, by its digest, and no other.
/// @pre  own is not empty, and no bench was added before
void add_bench(Page& page, const Bench& bench);

}  // namespace tumble::report
