/// The processes that the page of `live` is made of, besides the one that serves it: each is this
/// program again, with a hidden word.
#pragma once

#include <string>

#include "framework/cli/run_words.h"
#include "framework/cli/verb.h"

namespace tumble::cli {

/// Simulates (live/simulate.h): reads its recipe and then commands from stdin, writes records to
/// stdout. @param words  with the scene as the user named it
void simulate_for_page(Context& context, const RunWords& words);

/// Prints the verdicts on the user's file as the page reads them (live/session.h).
void judge_for_page(Context& context, const RunWords& words, const std::string& id);

/// Reads what a process said that ended badly, and prints the line of the user's file, where it can
/// be found: of the innermost frame of the stack in the user's code, else of a function that is
/// named.
void locate_for_page(Context& context, const RunWords& words);

}  // namespace tumble::cli
