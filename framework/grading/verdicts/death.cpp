#include "framework/grading/verdicts/death.h"

#include <signal.h>

#include <cstdio>
#include <cstring>

namespace tumble::grading {
namespace {

std::string place(const std::string& last_call, bool in_call) {
  if (last_call.empty()) return ", before any function was called (a global object?)";
  return (in_call ? ", in " : ", after ") + last_call;
}

}  // namespace

std::string signal_words_of(int signal) {
  const char* abbreviation = ::sigabbrev_np(signal);
  std::string text = std::string("SIG") +
                     (abbreviation != nullptr ? abbreviation : std::to_string(signal)) + ": " +
                     ::strsignal(signal);
  if (signal == SIGSEGV) text += " (an index or pointer out of range, or endless recursion)";
  if (signal == SIGFPE) text += " (an integer divided by zero)";
  if (signal == SIGABRT)
    text += " (a failed assertion inside a library, such as sizes in Eigen that do not match)";
  if (signal == SIGSYS) text += " (a system call that the sandbox refuses)";
  return text;
}

std::string signal_story(int signal, const std::string& last_call, bool in_call) {
  return signal_words_of(signal) + place(last_call, in_call);
}

std::string exit_story(int code, const std::string& last_call, bool in_call) {
  return "the program was ended with exit code " + std::to_string(code) +
         place(last_call, in_call) + "; a function must return its answer";
}

std::string timeout_story(double limit_s, const std::string& last_call, bool in_call) {
  char text[64];
  std::snprintf(text, sizeof text, "no answer within %g s", limit_s);
  return text + place(last_call, in_call) +
         " (an endless loop, or work that grows too fast with the input)";
}

std::string asked_words(const std::string& arguments) {
  return arguments.empty() ? "" : "\n  called with: " + arguments;
}

std::string busy_story(const std::string& last_call) {
  return "the machine was too busy" + (last_call.empty() ? std::string() : ", in " + last_call) +
         ": the code got too little CPU time for a verdict. Run it again when the machine is less "
         "busy";
}

}  // namespace tumble::grading
