/// Stories of calls that ended without an answer.
#pragma once

#include <string>

namespace tumble::grading {

/// "SIGSEGV: Segmentation fault (an index or pointer out of range, or endless recursion)"
std::string signal_words_of(int signal);
/// "SIGSEGV: Segmentation fault (an index or pointer out of range, or endless recursion), in
/// rk4_step"
/// @param last_call  empty when no function of the module was called
/// @param in_call    it had not returned
std::string signal_story(int signal, const std::string& last_call, bool in_call);
std::string exit_story(int code, const std::string& last_call, bool in_call);
/// @param limit_s  of own time (own_time.h)
std::string timeout_story(double limit_s, const std::string& last_call, bool in_call);
/// The line of a story with the call's arguments; empty where they are not known.
std::string asked_words(const std::string& arguments);
/// Of a test without a verdict, because the machine was too busy.
std::string busy_story(const std::string& last_call);

}  // namespace tumble::grading
