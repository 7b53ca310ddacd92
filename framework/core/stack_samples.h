/// Where the CPU time of a piece of work goes: at even intervals of CPU time the stack of whoever runs is looked at.
///
///   StackSamples samples;
///   samples.begin();  work();  samples.end();
///   const auto shares = samples.shares({{"search", {"tumble::collision::"}}, {"contacts", {"tumble::solve_contacts"}}}, {"tumble::build_world"});
///
/// What is looked at pays under a percent for it and knows nothing of it, so that short functions can be told apart, which no clock around
/// them could. Functions that the compiler has put into their callers count as these. Intervals are the system's, 1 to 10 ms: a share p of N
/// samples is known to sqrt(p (1 - p) / N).
/// Meanwhile the system's clock of the process's CPU time goes by these ticks: a thread's own stays as fine as it is.
/// Linux only: a timer of CPU time (setitimer), its signal, the functions' names from the program's own files (ELF).
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace tumble {

class StackSamples {
 public:
  /// What belongs together: functions whose full name, without arguments ("tumble::collision::compute_gap"), begins like one of these. Unnamed
  /// namespaces are no part of a name, nor is what a template is made for.
  struct Part {
    std::string name;
    std::vector<std::string> functions;
  };
  struct Shares {
    std::vector<double> of_part;   // of the samples that count, one a part; all 0 where there is no sample
    double rest = 0.0;             // in no part
    std::size_t samples = 0;       // that count
  };

  StackSamples();
  ~StackSamples();
  StackSamples(const StackSamples&) = delete;
  StackSamples& operator=(const StackSamples&) = delete;

  /// From now on samples are taken, of all threads, until end(). May be done again: samples add up.
  /// @throws PreconditionError where another one is at it: a process has one timer of its CPU time
  void begin();
  void end();

  /// A sample belongs to the part that names its innermost function; that which names it at greater length where several do.
  /// @param without  a sample with one of these anywhere on its stack is left out
  Shares shares(const std::vector<Part>& parts, const std::vector<std::string>& without) const;

  /// Whether a function of this program, or of a file that it has loaded, has a name that begins so: a list of parts can be checked by it.
  static bool is_known(const std::string& beginning);

 private:
  struct Stacks;
  std::unique_ptr<Stacks> stacks_;
};

}  // namespace tumble
