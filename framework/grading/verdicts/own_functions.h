/// What a submission's own text says of its functions: where each begins, and which asks which.
/// Read off the text, without a compiler: good enough to say where to look first, and for nothing
/// else.
#pragma once

#include <map>
#include <set>
#include <string>

namespace tumble::grading {

/// The line, from 1, where a function is defined; 0 where it is not found.
int line_of_definition(const std::string& source, const std::string& function);

/// "collision_impulse (which begins in line 100)"; the name alone where it is not found.
std::string with_its_line(const std::string& source, const std::string& function);

/// By function, of those that the text has: those of the text that it asks, itself or through
/// others. A function is not in its own set, also where it asks itself.
std::map<std::string, std::set<std::string>> functions_asked(
    const std::string& source, const std::set<std::string>& functions);

}  // namespace tumble::grading
