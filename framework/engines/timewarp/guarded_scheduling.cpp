#include "framework/engines/timewarp/guarded_scheduling.h"

#include <cmath>

#include <fmt/format.h>

#include "framework/core/error.h"
#include "framework/core/not_implemented.h"
#include "framework/engines/base/guarded_laws.h"

namespace tumble::engines {
namespace {

// Calls a decision; `problem_of` describes what makes its answer unusable, empty for a usable one.
template <class Function, class ProblemOf>
void guard(Function& function, const char* name, const std::string& source,
           const ProblemOf& problem_of) {
  function = [inner = function, name, source, problem_of](const auto&... arguments) {
    try {
      auto answer = inner(arguments...);
      if (const std::string problem = problem_of(answer); !problem.empty())
        throw StoppedRun(fmt::format("{} (of {}) returned {}", name, source, problem));
      return answer;
    } catch (const StoppedRun&) {
      throw;
    } catch (const NotImplemented&) {
      throw;
    } catch (const UserError&) {
      throw;
    } catch (const std::exception& error) {
      throw StoppedRun(fmt::format("{} (of {}) failed: {}", name, source, error.what()));
    }
  };
}

std::string any(const auto&) { return ""; }
std::string of_time(double time) { return std::isnan(time) ? "a time that is not a number" : ""; }
std::string of_rollbacks(const std::vector<Rollback>& rollbacks) {
  for (const Rollback& rollback : rollbacks)
    if (std::isnan(rollback.stamp.time)) return "a rollback to a time that is not a number";
  return "";
}
std::string of_event(const ScheduledEvent& event) {
  return std::isnan(event.stamp.time) || std::isnan(event.safe_time)
             ? "an event with a time that is not a number"
             : "";
}

}  // namespace

Scheduling guarded(const Scheduling& scheduling, const std::string& source) {
  Scheduling safe = scheduling;
  guard(safe.comes_before, "comes_before", source, [](bool answer) { return any(answer); });
  guard(safe.next_check_time, "next_check_time", source, of_time);
  guard(safe.on_collision_check, "on_collision_check", source, [](const CheckDecision& decision) {
    const std::string problem = of_event(decision.next);
    return problem.empty() ? of_rollbacks(decision.rollbacks) : problem;
  });
  guard(safe.contact_groups, "contact_groups", source,
        [](const std::vector<std::vector<std::int32_t>>& answer) { return any(answer); });
  guard(safe.on_group_check, "on_group_check", source, [](const GroupDecision& decision) {
    const std::string problem = of_event(decision.next);
    return problem.empty() ? of_rollbacks(decision.rollbacks) : problem;
  });
  guard(safe.on_callback, "on_callback", source, of_rollbacks);
  guard(safe.anti_messages, "anti_messages", source, of_rollbacks);
  guard(safe.plan_rollback, "plan_rollback", source, of_rollbacks);
  guard(safe.after_rollback, "after_rollback", source, of_event);
  guard(safe.global_virtual_time, "global_virtual_time", source, of_time);
  guard(safe.may_commit, "may_commit", source, [](bool answer) { return any(answer); });
  guard(safe.states_to_purge, "states_to_purge", source,
        [](std::uint32_t answer) { return any(answer); });
  return safe;
}

}  // namespace tumble::engines
