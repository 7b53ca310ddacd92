// What runs a case, and the list of all of them.
#include <algorithm>

#include "framework/core/error.h"
#include "framework/core/not_implemented.h"
#include "tests/stability/cases.h"

namespace tumble::battery {
namespace {

report::Measure measure(const std::string& what, double value, double threshold,
                        const std::string& unit, const std::string& why) {
  report::Measure m;
  m.what = what;
  m.value = value;
  m.threshold = threshold;
  m.unit = unit;
  m.why = why;
  return m;
}

// What a case needs beside integration; empty: all is there.
std::string missing(const std::string& needs, const Laws& laws) {
  std::string words;
  const auto need = [&](const char* id, bool there) {
    if (needs.find(id) == std::string::npos || there) return;
    words += (words.empty() ? "needs the laws of " : " and ") + std::string(id);
  };
  need("a1", static_cast<bool>(laws.collision_impulse));
  need("a3", static_cast<bool>(laws.constraint_multipliers));
  return words.empty() ? "" : words + ", which nobody provides here";
}

}  // namespace

void Findings::add(report::Measure measure) {
  if (on_measure_) on_measure_(measure);
  row_.measures.push_back(std::move(measure));
}

void Findings::at_most(const std::string& what, double value, double threshold,
                       const std::string& unit, const std::string& why) {
  add(measure(what, value, threshold, unit, why));
}

void Findings::at_least(const std::string& what, double value, double threshold,
                        const std::string& unit, const std::string& why) {
  report::Measure m = measure(what, value, threshold, unit, why);
  m.at_least = true;
  add(std::move(m));
}

void Findings::must_fail(const std::string& what, double value, double threshold,
                         const std::string& unit, const std::string& why) {
  report::Measure m = measure(what, value, threshold, unit, why);
  m.must_fail = true;
  add(std::move(m));
}

void Findings::is_true(const std::string& what, bool answer, const std::string& why) {
  report::Measure m = measure(what, answer ? 1.0 : 0.0, 1.0, "", why);
  m.is_question = true;
  add(std::move(m));
}

void Findings::not_run(const std::string& what, const std::string& reason) {
  report::Measure m = measure(what, kUnset, kUnset, "", "");
  m.not_run = reason;
  add(std::move(m));
}

void Findings::part(const std::string& what, const std::function<void()>& work) {
  try {
    work();
  } catch (const NotImplemented& stub) {
    not_run(what, stub.what());
  } catch (const std::exception& error) {
    report::Measure m = measure(what, kUnset, kUnset, "", "");
    m.error = error.what();
    add(std::move(m));
  }
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const auto add : {add_springs, add_chains, add_loops, add_tops, add_meshes, add_impacts,
                         add_sweeps, add_scales, add_rotation, add_stacks, add_cards,
                         add_structures, add_friction, add_piles, add_rollbacks})
    add(all);
  std::stable_sort(all.begin(), all.end(),
                   [](const Case& a, const Case& b) { return a.row < b.row; });
  return all;
}

report::BatteryRow run(const Case& the_case, const Given& given) {
  report::BatteryRow row{the_case.row, the_case.name, the_case.about, {}, {}, the_case.not_part};
  if (!the_case.run) return row;
  Findings findings(row, given.on_measure);
  if (const std::string lack = missing(the_case.needs, given.laws); !lack.empty())
    findings.not_run("all", lack);
  else
    findings.part("all", [&] { the_case.run(given, findings); });
  for (report::Measure& m : row.measures)
    m.shortfall = known_shortfall(row.row, m.what, given.is_long);
  return row;
}

}  // namespace tumble::battery
