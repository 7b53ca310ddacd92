/// The line of a submission that a worker was in when it died.
#pragma once

#include <string>

#include "framework/grading/sandbox/sandbox_job.h"

namespace tumble::grading {

/// Looks up frames (dying_words.h) in the debug information of the submission's shared object. Both
/// come from a submission: addr2line reads them in a sandbox like the worker's, and only a plain
/// file name and a number come out.
/// @param worker   the job of the worker that died
/// @param object   name inside of the shared object
/// @param printed  what the worker printed
/// @return "a1_impulse.cpp:26", the innermost line of the submission's own file; empty where none
///         is found
std::string crash_place(const SandboxJob& worker, const std::string& object,
                        const std::string& printed);

/// The offsets in what a worker printed, as words for addr2line: at most 32.
std::vector<std::string> frames_in(const std::string& printed);

/// The first line in what addr2line says that is of the submission's own file.
std::string own_line(const std::string& told);

}  // namespace tumble::grading
