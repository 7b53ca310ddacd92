/// Cases computed with the reference's functions, right or with one of them made wrong.
#pragma once

#include <functional>

#include "tests/support/places.h"
#include "assignments/a1_impulse/a1_binding.h"
#include "assignments/a2_integration/a2_binding.h"
#include "assignments/a3_constraints/a3_binding.h"
#include "framework/cli/read_truth.h"
#include "framework/truths/families.h"
#include "framework/truths/module_truths.h"
#include "framework/modules/load.h"
#include "framework/modules/registry.h"

namespace tumble::testing {

struct Reference {
  modules::Registry registry;
  a1::Module a1;
  a2::Module a2;
  a3::Module a3;

  Reference() {
    register_assignments(registry);
    const std::filesystem::path built = std::filesystem::path(test::binary_dir()) / "modules";
    a1 = *std::static_pointer_cast<const a1::Module>(
        modules::load_module(registry.find("a1"), built / "a1_reference.so"));
    a2 = *std::static_pointer_cast<const a2::Module>(
        modules::load_module(registry.find("a2"), built / "a2_reference.so"));
    a3 = *std::static_pointer_cast<const a3::Module>(
        modules::load_module(registry.find("a3"), built / "a3_reference.so"));
  }

  Laws laws() const {
    Laws laws = library_laws();
    a1::bind(a1, laws);
    a2::bind(a2, laws);
    a3::bind(a3, laws);
    return laws;
  }

  /// The lines of a case; empty for an unknown family.
  std::vector<truths::Line> compare(const truths::Case& truth) const {
    const Laws laws = this->laws();
    truths::Comparison comparison;
    if (const auto family = truths::framework_families().find(truth.family);
        family != truths::framework_families().end())
      comparison.attempt(truth.family, [&] { family->second(truth, laws, comparison); });
    const auto with = [&](const std::string& id, modules::AnyModule table) {
      const auto families = registry.find(id).note<truths::ModuleTruths>().families;
      if (const auto family = families.find(truth.family); family != families.end())
        comparison.attempt(truth.family, [&] { family->second(table, truth, comparison); });
    };
    with("a1", std::make_shared<const a1::Module>(a1));
    with("a2", std::make_shared<const a2::Module>(a2));
    return comparison.lines();
  }
};

inline truths::Case truth_named(const std::string& name) {
  return cli::read_truth(std::filesystem::path(test::source_dir()) / "tests/truths" /
                         (name + ".json"));
}

inline std::string failures(const std::vector<truths::Line>& lines) {
  std::string text;
  for (const truths::Line& line : lines)
    if (line.verdict != truths::Verdict::kRight && line.verdict != truths::Verdict::kNotCompared)
      text += "\n  " + line.output + ": error " + std::to_string(line.error) + ", mark " +
              std::to_string(line.tolerance) + "  " + line.note;
  return text;
}

}  // namespace tumble::testing
