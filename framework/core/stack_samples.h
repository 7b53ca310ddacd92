/// Sampling profiler: at even intervals of CPU time the stack of the running thread is recorded.
///
///   StackSamples samples;
///   samples.begin();  work();  samples.end();
///   const auto shares = samples.shares({{"search", {"tumble::collision::"}}, {"contacts",
///   {"tumble::solve_contacts"}}}, {"tumble::build_world"});
///
/// The overhead is under one percent, and the profiled code needs no change; short functions can be
/// measured that a clock around each call would distort. An inlined function counts as its caller.
/// The system's tick is the interval, 1 to 10 ms: a share p of N samples has the standard error
/// sqrt(p (1 - p) / N).
/// While samples are taken, the clock of the process's CPU time advances by these ticks; a thread's
/// own clock keeps its resolution.
/// Linux only: a timer of CPU time (setitimer), its signal, and the functions' names from the
/// program's own files (ELF).
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace tumble {

class StackSamples {
 public:
  /// Functions that are counted together: their full name, without arguments
  /// ("tumble::collision::compute_gap"), begins with one of these prefixes. Names are compared
  /// without unnamed namespaces and template arguments.
  struct Part {
    std::string name;
    std::vector<std::string> functions;
  };
  struct Shares {
    // share of the counted samples, by part; all 0 where there is no sample
    std::vector<double> of_part;
    double rest = 0.0;        // share in no part
    std::size_t samples = 0;  // number of counted samples
  };

  StackSamples();
  ~StackSamples();
  StackSamples(const StackSamples&) = delete;
  StackSamples& operator=(const StackSamples&) = delete;

  /// Takes samples of all threads until end(). May be called again: samples add up.
  /// @throws PreconditionError while another StackSamples takes samples: a process has one timer of
  ///   its CPU time
  void begin();
  void end();

  /// A sample belongs to the part that names its innermost named function; the longest matching
  /// prefix wins.
  /// @param without  prefixes; a sample with one of them anywhere on its stack is left out
  Shares shares(const std::vector<Part>& parts, const std::vector<std::string>& without) const;

  /// Whether a function of this program, or of a library that it has loaded, has a name with this
  /// prefix. Checks a list of parts.
  static bool is_known(const std::string& beginning);

 private:
  struct Stacks;
  std::unique_ptr<Stacks> stacks_;
};

}  // namespace tumble
