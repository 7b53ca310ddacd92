/// The code of a C++ source, without what only people read.
#pragma once

#include <string>

namespace tumble::grading {

/// The same text with comments and preprocessor lines blanked: places stay. Text between quotes is
/// kept.
std::string code_of(std::string text);

}  // namespace tumble::grading
