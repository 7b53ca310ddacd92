#include "framework/cli/cost_methods.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>

#include <fmt/format.h>

#include "framework/cli/find_scene.h"
#include "framework/cli/sandboxed_module.h"
#include "framework/core/error.h"
#include "framework/dynamics/iterative_solvers.h"
#include "framework/dynamics/root_methods.h"
#include "framework/cost/showcase.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/scene/words.h"

namespace tumble::cli {
namespace {

using cost::CostMethod;

}  // namespace

CostMethod method_by_integrator(const Method& integrator, const Laws& laws) {
  CostMethod method;
  method.name = integrator.name;
  method.word = integrator.word;
  method.step_function = [integrator](double tolerance) { return step_of(integrator, tolerance); };
  method.steps_in_units = needs_units(integrator);
  method.has_library_step = true;
  method.order = integrator.order;
  method.controlled = integrator.controlled;
  method.laws = laws;
  method.laws.integrator_source = integrator.name + " of the library";
  method.laws.step_function = Laws().step_function;
  return method;
}

CostMethod method_by_engine(const std::string& word, const Laws& laws, bool in_closed_form) {
  CostMethod method;
  method.laws = laws;
  if (!in_closed_form) method = method_by_integrator(method_named("rk4"), laws);
  method.word = word;
  if (word == "auto") {
    method.name = in_closed_form ? "rd, closed form" : "rd, closed form in flight";
    method.propagator = "auto";
    return method;
  }
  method.engine = word;
  method.has_refinement = !in_closed_form;
  method.name.clear();
  for (const auto& [known, meaning] : engines::engine_words())
    if (known == word) method.name = word + ", " + meaning;
  if (method.name.empty() || word == "rd")
    throw UserError("--engines " + word, "expected auto, ca, tw, ordered or none",
                    "rd runs with every method of --methods.");
  if (!in_closed_form) method.name = word + ", RK4";  // for bodies that do not fly freely
  return method;
}

namespace {

bool is_none(const std::vector<std::string>& words) {
  return words.size() == 1 && words.front() == "none";
}

[[noreturn]] void refuse_stabilisation(const std::string& word) {
  throw UserError("--stabilisations " + word, "expected none, baumgarte or projection",
                  "For example --stabilisations baumgarte,projection.");
}

[[noreturn]] void refuse_solver(const std::string& word) {
  throw UserError(
      "--solvers " + word,
      "expected gradients (of rods and joints), sweeps or newton (of persistent contacts)",
      "For example --solvers sweeps,newton.");
}

CostMethod by_stabilisation(const std::string& word, const scene::Scene& scene, const Laws& laws) {
  if (!scene.stabilisation)
    throw UserError("--stabilisations " + word, scene.name + " has no rods and no joints",
                    "Leave the flag out, or take a scene such as double_pendulum.");
  CostMethod method = method_by_integrator(method_named("rk4"), laws);
  method.stabilisation = *scene.stabilisation;
  if (word == "none")
    method.stabilisation->kind = scene::StabilisationKind::kNone;
  else if (word == "baumgarte")
    method.stabilisation->kind = scene::StabilisationKind::kBaumgarte;
  else if (word == "projection")
    method.stabilisation->kind = scene::StabilisationKind::kProjection;
  else
    refuse_stabilisation(word);
  method.name = word == "none" ? "RK4, no stabilisation"
                : word == "baumgarte"
                    ? fmt::format("RK4, Baumgarte {:g} s", method.stabilisation->time_constant_s)
                    : "RK4, projection";
  method.word = word;
  method.order = kUnset;  // the stabilisation may determine it
  return method;
}

/// The same method in joint coordinates.
CostMethod in_joint_coordinates(CostMethod method) {
  method.name += kInJointCoordinates;
  method.coordinates = scene::Coordinates::kReduced;
  return method;
}

/// The coordinates of rods and joints that are measured: words of the flag, else both where a scene
/// is of linked bodies alone.
std::vector<scene::Coordinates> coordinates_for(const scene::Scene& scene, const CostWords& words) {
  using scene::Coordinates;
  if (!words.coordinates.empty()) {
    if (!scene::is_constrained(scene))
      throw UserError("--coordinates", scene.name + " has no rods and no joints",
                      "Leave the flag out, or take a scene such as double_pendulum.");
    std::vector<Coordinates> all;
    for (const std::string& word : words.coordinates)
      all.push_back(scene::coordinates_named(word, "--coordinates"));
    return all;
  }
  if (!scene::is_constrained(scene)) return {scene.coordinates};
  const auto colliding = std::count_if(scene.bodies.begin(), scene.bodies.end(),
                                       [](const scene::BodySpec& body) { return body.collides; });
  if (scene.contact || colliding > 1) return {scene.coordinates};
  return {Coordinates::kMaximal, Coordinates::kReduced};
}

constexpr double kTightest = 1e-12;  // tolerance of everything except the varied part

/// Impacts by another root finder. The framework refines its answer to the last digit, so that the
/// tolerance changes the cost but not the result; tumble cost toi shows the root finders alone.
CostMethod by_impacts(const std::string& word, const scene::Scene& scene, const Laws& laws) {
  const RootMethod& root = root_method_named(word);
  CostMethod method;
  method.name = "impacts by " + root.name;
  method.word = word;
  method.controlled = true;
  method.laws = laws;
  method.counted = "gap_evaluations";
  if (cost::goes_in_closed_form(scene)) {
    method.propagator = "auto";
  } else {
    method.step_function = [](double) { return step_of(method_named("fehlberg78"), kTightest); };
    method.steps_in_units = true;
  }
  method.tuned = [find = root.find](double tolerance, Laws& tuned) {
    tuned.find_impact_time =
        [find, tolerance](const ScalarFunction& gap, const ScalarFunction& rate, double low,
                          double high, double) { return find(gap, rate, low, high, tolerance); };
  };
  return method;
}

CostMethod by_solver(const std::string& word, const scene::Scene& scene, const Laws& laws) {
  const bool linked = scene::is_constrained(scene);
  CostMethod method = method_by_integrator(method_named("fehlberg78"), laws);
  method.step_function = [](double) { return step_of(method_named("fehlberg78"), kTightest); };
  method.word = word;
  method.order = kUnset;
  if (word == "gradients" && linked) {
    method.name = "links by conjugate gradients";
    method.tuned = solve_links_by_gradients;
  } else if (word == "sweeps" && scene.contact) {
    method.name = "contacts by sweeps";
    method.tuned = solve_contacts_by_sweeps;
    method.counted = "contact_sweeps";
  } else if (word == "newton" && scene.contact) {
    method.name = "contacts by Newton's method";
    method.tuned = solve_contacts_by_newton;
    method.counted = "contact_sweeps";
  } else if (word == "gradients") {
    throw UserError("--solvers " + word, scene.name + " has no rods and no joints",
                    "Take a scene such as chain_8.");
  } else if (word == "sweeps" || word == "newton") {
    throw UserError("--solvers " + word, scene.name + " has no persistent contacts",
                    "Take a scene such as stack_of_10.");
  } else {
    refuse_solver(word);
  }
  return method;
}

std::vector<std::string> methods_for(const scene::Scene& scene, const CostWords& words) {
  if (!words.methods.empty())
    return is_none(words.methods) ? std::vector<std::string>{} : words.methods;
  std::vector<std::string> chosen = {"euler",  "symplectic", "midpoint",      "rk4",
                                     "dopri5", "fehlberg78", "bulirsch-stoer"};
  if (scene::asks_for(scene, [](const scene::Traits& traits) { return traits.may_be_stiff; }))
    chosen.push_back("rosenbrock4");
  return chosen;
}

/// Engines that suit the scene; those left out are listed in `not_run`.
std::vector<std::string> engines_for(const CostWords& words, CostSubject& subject) {
  if (!words.engines.empty())
    return is_none(words.engines) ? std::vector<std::string>{} : words.engines;
  std::vector<std::string> chosen;
  const bool sleeps = subject.scene.contact && subject.scene.contact->sleep;
  for (const char* word : {"ca", "tw"}) {
    if (sleeps)
      subject.not_run.push_back(fmt::format(
          "{}: bodies at rest fall asleep in this scene, which only rd supports", word));
    else if (std::string(word) == "tw" && !engines::fast_timewarp())
      subject.not_run.push_back("tw: this tree holds no timewarp of its own");
    else
      chosen.emplace_back(word);
  }
  if (cost::goes_in_closed_form(subject.scene)) chosen.push_back("auto");
  return chosen;
}

void add_engines(const CostWords& words, const Laws& laws, CostSubject& subject) {
  const bool in_closed_form = cost::goes_in_closed_form(subject.scene);
  for (const std::string& word : engines_for(words, subject))
    subject.methods.push_back(method_by_engine(word, laws, in_closed_form));
}

/// How a module's methods are called: the reference is nobody's own.
std::string whose(const std::string& word) { return word == "reference" ? "reference" : "your"; }

/// A module's own methods of integration, each with these laws.
void add_methods(const Context& context, const modules::ModuleKind& kind, const std::string& word,
                 bool is_subject, const Laws& laws, CostSubject& subject) {
  modules::AnyModule module;
  if (word == "student" || word == "reference") {
    module = load_word(context, kind, word);
  } else {
    const SandboxedModule sandboxed =
        load_sandboxed(context, kind, module_file(context, kind, word));
    module = sandboxed.step.module;
    subject.connections.push_back(sandboxed.step.connection);
  }
  for (const modules::NamedMethod& named : kind.methods) {
    CostMethod method;
    method.name = fmt::format("{} {}", whose(word), named.name);
    method.is_subject = is_subject;
    method.word = named.name;
    method.step_function = [step = named.step(module)](double) { return step; };
    method.order = named.order;
    method.laws = laws;
    method.laws.integrator_source = fmt::format("{} ({})", named.name, word);
    method.laws.step_function = named.name;
    subject.methods.push_back(std::move(method));
  }
}

/// A module's own methods of integration, where it has some; else the scene run by all its laws.
void add_module(const Context& context, const modules::ModuleKind& kind, const std::string& word,
                bool is_subject, const Laws& laws, const scene::Scene& scene,
                CostSubject& subject) {
  if (kind.methods.empty()) {
    const ChosenLaws chosen =
        choose_laws(context, scene, parse_module_words(kind.id + "=" + word, context.registry));
    CostMethod method = method_by_integrator(method_named("rk4"), chosen.laws);
    method.name = fmt::format("{} {}", whose(word), kind.id);
    method.is_subject = is_subject;
    subject.methods.push_back(std::move(method));
    subject.connections.insert(subject.connections.end(), chosen.connections.begin(),
                               chosen.connections.end());
    return;
  }
  add_methods(context, kind, word, is_subject, laws, subject);
  // Steps alone do not test the module's other laws of motion: the derivative, the renormalisation.
  const ChosenLaws chosen =
      choose_laws(context, scene, parse_module_words(kind.id + "=" + word, context.registry));
  CostMethod whole;
  whole.name = fmt::format("{} {} as a whole", whose(word), kind.id);
  whole.is_subject = is_subject;
  whole.word = kind.id;
  whole.order = kind.methods.back().order;
  whole.laws = chosen.laws;
  subject.methods.push_back(std::move(whole));
  subject.connections.insert(subject.connections.end(), chosen.connections.begin(),
                             chosen.connections.end());
}

/// The word of a chosen module that integrates; empty: none. The reference's methods equal the
/// library's, so they are included only by name.
std::string named_motion(const ModuleWords& words, const modules::ModuleKind& kind) {
  if (const auto own = words.find(kind.id); own != words.end())
    return own->second == "library" ? "" : own->second;
  const auto all = words.find("");
  return all == words.end() || all->second == "library" || all->second == "reference" ? ""
                                                                                      : all->second;
}

/// Where a module that integrates was chosen by word, its methods are measured too.
void add_named_methods(const Context& context, const CostWords& words, const Laws& laws,
                       CostSubject& subject) {
  if (is_none(words.methods)) return;
  const ModuleWords named = parse_module_words(words.modules, context.registry);
  for (const modules::ModuleKind* kind : context.registry.all()) {
    const std::string word = kind->methods.empty() ? "" : named_motion(named, *kind);
    if (!word.empty()) add_methods(context, *kind, word, word != "reference", laws, subject);
  }
}

CostSubject of_scene(const Context& context, const CostWords& words) {
  CostSubject subject;
  subject.scene = find_scene(context, words.scene, words.n);
  const ChosenLaws chosen =
      choose_laws(context, subject.scene, parse_module_words(words.modules, context.registry));
  for (const auto& notice : chosen.notices) fmt::print(stderr, "{}\n", notice);
  subject.title = subject.scene.title;
  subject.truth_laws = chosen.laws;
  subject.connections = chosen.connections;
  // Closed forms first: they cost little, and are complete where a budget ends early.
  const bool in_closed_form = cost::goes_in_closed_form(subject.scene);
  if (in_closed_form) add_engines(words, chosen.laws, subject);
  add_named_methods(context, words, chosen.laws, subject);
  for (const scene::Coordinates coordinates : coordinates_for(subject.scene, words))
    for (const std::string& word : methods_for(subject.scene, words)) {
      CostMethod method = method_by_integrator(method_named(word), chosen.laws);
      method.coordinates = coordinates;
      const bool reduced = coordinates == scene::Coordinates::kReduced;
      subject.methods.push_back(reduced ? in_joint_coordinates(std::move(method))
                                        : std::move(method));
    }
  if (!in_closed_form) add_engines(words, chosen.laws, subject);
  for (const std::string& word : words.stabilisations)
    subject.methods.push_back(by_stabilisation(word, subject.scene, chosen.laws));
  for (const std::string& word : words.impacts)
    subject.methods.push_back(by_impacts(word, subject.scene, chosen.laws));
  for (const std::string& word : words.solvers)
    subject.methods.push_back(by_solver(word, subject.scene, chosen.laws));
  if (subject.methods.empty())
    throw UserError("tumble cost " + words.scene,
                    "--methods, --engines and the other axes leave nothing to run",
                    "Leave one of them out.");
  return subject;
}

CostSubject of_assignment(const Context& context, const modules::ModuleKind& kind,
                          const CostWords& words) {
  CostSubject subject;
  const std::string word = words.modules.empty() ? "student" : words.modules;
  if (word == "library")
    refuse_library(
        kind, "functions of " + kind.id + " to measure",
        kind.methods.empty()
            ? ""
            : "Its own methods: tumble cost SCENE --modules library --methods rk4,dopri5");
  if (words.on.empty() && kind.note<cost::CostShowcase>().scene.empty())
    throw UserError("tumble cost " + kind.id,
                    "no scene is known on which this assignment is measured",
                    "Name one: --on SCENE.");
  subject.scene = find_scene(
      context, words.on.empty() ? kind.note<cost::CostShowcase>().scene : words.on, words.n);
  if (words.on.empty()) subject.duration_s = kind.note<cost::CostShowcase>().duration_s;
  const bool has_reference =
      std::filesystem::exists(context.build / "modules" / (kind.id + "_reference.so"));
  const ChosenLaws right =
      choose_laws(context, subject.scene,
                  parse_module_words(has_reference          ? "reference"
                                     : kind.methods.empty() ? ""
                                                            : kind.id + "=library",
                                     context.registry));
  subject.truth_laws = right.laws;
  subject.connections = right.connections;
  subject.title = fmt::format("{} ({}) on: {}", kind.id, word, subject.scene.title);
  // Without a reference in the tree, laws that the library lacks are the student's in the reference
  // solution too.
  if (!has_reference && kind.methods.empty())
    subject.note = "This tree holds no reference of " + kind.id +
                   ": the reference solution is computed with your own laws, so the integration of "
                   "the motion is judged here, not the laws.";
  else if (word != "student" && word != "reference")
    subject.note =
        "This module runs in the sandbox, where each call and each derivative costs some "
        "microseconds more: compare its force evaluations, not its CPU time.";
  add_module(context, kind, word, true, right.laws, subject.scene, subject);
  if (has_reference && word != "reference")
    add_module(context, kind, "reference", false, right.laws, subject.scene, subject);
  if (!kind.methods.empty())
    subject.methods.push_back(method_by_integrator(method_named("dopri5"), right.laws));
  return subject;
}

}  // namespace

std::vector<double> CostWords::steps_s() const {
  std::vector<double> all;
  for (const std::string& text : steps) {
    const std::size_t slash = text.find('/');
    char* end = nullptr;
    const std::string above = text.substr(0, slash),
                      below = slash == std::string::npos ? "1" : text.substr(slash + 1);
    const double numerator = std::strtod(above.c_str(), &end);
    const bool is_number = !above.empty() && *end == '\0';
    const double denominator = std::strtod(below.c_str(), &end);
    if (!is_number || below.empty() || *end != '\0' || !(numerator / denominator > 0) ||
        !std::isfinite(numerator / denominator))
      throw UserError("--steps " + text, "this is no time in seconds",
                      "Give numbers or fractions: 1/30,1/60,0.001");
    all.push_back(numerator / denominator);
  }
  std::sort(all.rbegin(), all.rend());
  return all;
}

std::string CostWords::name() const { return std::filesystem::path(scene).stem().string(); }

void check_known(const CostWords& words) {
  if (!is_none(words.methods))
    for (const std::string& word : words.methods) method_named(word);
  if (!is_none(words.engines))
    for (const std::string& word : words.engines) method_by_engine(word, Laws(), true);
  for (const std::string& word : words.stabilisations)
    if (word != "none" && word != "baumgarte" && word != "projection") refuse_stabilisation(word);
  for (const std::string& word : words.impacts) root_method_named(word);
  for (const std::string& word : words.solvers)
    if (word != "gradients" && word != "sweeps" && word != "newton") refuse_solver(word);
  for (const std::string& word : words.coordinates) scene::coordinates_named(word, "--coordinates");
}

CostSubject find_subject(const Context& context, const CostWords& words) {
  for (const modules::ModuleKind* kind : context.registry.all())
    if (kind->id == words.scene) return of_assignment(context, *kind, words);
  std::string known;
  for (const modules::ModuleKind* kind : context.registry.all())
    known += (known.empty() ? "" : ", ") + kind->id;
  if (words.scene.size() == 2 && words.scene[0] == 'a' &&
      std::isdigit(static_cast<unsigned char>(words.scene[1])) != 0)
    throw UserError(words.scene, "there is no such assignment", "Known: " + known + ".");
  if (!words.on.empty())
    throw UserError("--on " + words.on,
                    "goes with an assignment (" + known + "), and '" + words.scene + "' is none",
                    "Give the scene itself: tumble cost " + words.on);
  return of_scene(context, words);
}

}  // namespace tumble::cli
