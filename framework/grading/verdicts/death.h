/// What is said of code that ended without an answer.
#pragma once

#include <string>

namespace tumble::grading {

/// "SIGSEGV: Segmentation fault (an index or pointer out of range, or a recursion without end), in rk4_step"
/// @param last_call  empty when no function of the module was called
/// @param in_call    it had not returned
/// The same without the place: "SIGSEGV: Segmentation fault (an index or pointer out of range, or a recursion without end)"
std::string signal_words_of(int signal);
std::string signal_story(int signal, const std::string& last_call, bool in_call);
std::string exit_story(int code, const std::string& last_call, bool in_call);
/// @param limit_s  of own time (own_time.h)
std::string timeout_story(double limit_s, const std::string& last_call, bool in_call);
/// What a story adds of the call's arguments: a line, or nothing where they are not known.
std::string asked_words(const std::string& arguments);
/// Of a test that says nothing because the machine had no time for it.
std::string busy_story(const std::string& last_call);

}  // namespace tumble::grading
