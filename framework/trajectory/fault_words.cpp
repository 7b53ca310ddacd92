#include "framework/trajectory/fault_words.h"

#include <fmt/format.h>

namespace tumble {

std::string in_words(const RunFault& fault) {
  const std::string times =
      fault.count == 1 ? "once" : std::to_string(fault.count) + " times in all";
  return fmt::format("{} of {}, {:.3g} where {:.3g}{} is allowed, first at t = {:.6g} s, {}",
                     fault.kind, fault.subject, fault.worst, fault.allowed,
                     fault.unit.empty() ? "" : ' ' + fault.unit, fault.first_s, times);
}

std::string in_words(const std::vector<RunFault>& faults) {
  std::string words;
  for (const RunFault& fault : faults) words += (words.empty() ? "" : "; ") + in_words(fault);
  return words;
}

}  // namespace tumble
