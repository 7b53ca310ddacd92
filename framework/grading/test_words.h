/// The words on a test program's command line that choose tests.
#pragma once

#include <string>

namespace tumble::grading {

/// GoogleTest's own pattern language: '*' and '?', patterns joined by ':'. An empty filter chooses all.
bool chosen(const std::string& test, const std::string& filter);

}  // namespace tumble::grading
