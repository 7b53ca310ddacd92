#include "framework/cli/cost_ways.h"

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
#include "framework/engines/cost/showcase.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "framework/scene/words.h"

namespace tumble::cli {
namespace {

using engines::CostWay;

}  // namespace

CostWay way_by_method(const Method& method, const Laws& laws) {
  CostWay way;
  way.name = method.name;
  way.word = method.word;
  way.method = [method](double tolerance) { return step_of(method, tolerance); };
  way.order = method.order;
  way.controlled = method.controlled;
  way.laws = laws;
  way.laws.integrator_source = method.name + " of the library";
  return way;
}

CostWay way_by_engine(const std::string& word, const Laws& laws, bool in_closed_form) {
  CostWay way;
  way.laws = laws;
  if (!in_closed_form) way = way_by_method(method_named("rk4"), laws);
  way.word = word;
  if (word == "auto") {
    way.name = in_closed_form ? "rd, closed form" : "rd, closed form in flight";
    way.propagator = "auto";
    return way;
  }
  way.engine = word;
  way.has_ladder = !in_closed_form;
  way.name.clear();
  for (const auto& [known, meaning] : engines::engine_words())
    if (known == word) way.name = word + ", " + meaning;
  if (way.name.empty() || word == "rd") throw UserError("--engines " + word, "expected auto, ca, tw, ordered or none", "rd runs with every method of --methods.");
  if (!in_closed_form) way.name = word + ", RK4";   // by which bodies move that do not fly freely
  return way;
}

namespace {

bool is_none(const std::vector<std::string>& words) { return words.size() == 1 && words.front() == "none"; }

CostWay by_stabilisation(const std::string& word, const scene::Scene& scene, const Laws& laws) {
  if (!scene.stabilisation) throw UserError("--stabilisations " + word, scene.name + " has no rods and no joints", "Leave the flag out, or take a scene such as double_pendulum.");
  CostWay way = way_by_method(method_named("rk4"), laws);
  way.stabilisation = *scene.stabilisation;
  if (word == "none") way.stabilisation->kind = scene::StabilisationKind::kNone;
  else if (word == "baumgarte") way.stabilisation->kind = scene::StabilisationKind::kBaumgarte;
  else if (word == "projection") way.stabilisation->kind = scene::StabilisationKind::kProjection;
  else throw UserError("--stabilisations " + word, "expected none, baumgarte or projection", "For example --stabilisations baumgarte,projection.");
  way.name = word == "none" ? "RK4, no stabilisation" : word == "baumgarte" ? fmt::format("RK4, Baumgarte {:g} s", way.stabilisation->time_constant_s) : "RK4, projection";
  way.word = word;
  way.order = kUnset;   // the stabilisation may set it
  return way;
}

constexpr double kTightest = 1e-12;   // tolerance of what is not looked at, so that only the axis shows

/// Where impacts come from another root finder. The framework goes on from its answer to the last digit, so that a tolerance changes what is
/// paid and not what comes out; tumble cost toi shows the finders alone.
CostWay by_impacts(const std::string& word, const scene::Scene& scene, const Laws& laws) {
  const RootMethod& root = root_method_named(word);
  CostWay way;
  way.name = "impacts by " + root.name;
  way.word = word;
  way.controlled = true;
  way.laws = laws;
  way.counted = "gap_evaluations";
  if (engines::goes_in_closed_form(scene)) way.propagator = "auto";
  else way.method = [](double) { return step_of(method_named("fehlberg78"), kTightest); };
  way.tuned = [find = root.find](double tolerance, Laws& tuned) {
    tuned.find_impact_time = [find, tolerance](const ScalarFunction& gap, const ScalarFunction& rate, double low, double high, double) { return find(gap, rate, low, high, tolerance); };
  };
  return way;
}

CostWay by_solver(const std::string& word, const scene::Scene& scene, const Laws& laws) {
  const bool linked = scene::is_constrained(scene);
  CostWay way = way_by_method(method_named("fehlberg78"), laws);
  way.method = [](double) { return step_of(method_named("fehlberg78"), kTightest); };
  way.word = word;
  way.order = kUnset;
  if (word == "gradients" && linked) {
    way.name = "links by conjugate gradients";
    way.tuned = solve_links_by_gradients;
  } else if (word == "sweeps" && scene.contact) {
    way.name = "contacts by sweeps";
    way.tuned = solve_contacts_by_sweeps;
    way.counted = "contact_sweeps";
  } else if (word == "newton" && scene.contact) {
    way.name = "contacts by Newton's method";
    way.tuned = solve_contacts_by_newton;
    way.counted = "contact_sweeps";
  } else if (word == "gradients") {
    throw UserError("--solvers " + word, scene.name + " has no rods and no joints", "Take a scene such as chain_8.");
  } else if (word == "sweeps" || word == "newton") {
    throw UserError("--solvers " + word, scene.name + " has no lasting contacts", "Take a scene such as stack_of_10.");
  } else {
    throw UserError("--solvers " + word, "expected gradients (of rods and joints), sweeps or newton (of lasting contacts)", "For example --solvers sweeps,newton.");
  }
  return way;
}

std::vector<std::string> methods_for(const scene::Scene& scene, const CostWords& words) {
  if (!words.methods.empty()) return is_none(words.methods) ? std::vector<std::string>{} : words.methods;
  std::vector<std::string> chosen = {"euler", "symplectic", "midpoint", "rk4", "dopri5", "fehlberg78", "bulirsch-stoer"};
  if (scene::asks_for(scene, [](const scene::Traits& traits) { return traits.may_be_stiff; })) chosen.push_back("rosenbrock4");
  return chosen;
}

/// What suits the scene; what is left out is said in `not_run`.
std::vector<std::string> engines_for(const CostWords& words, CostSubject& subject) {
  if (!words.engines.empty()) return is_none(words.engines) ? std::vector<std::string>{} : words.engines;
  std::vector<std::string> chosen;
  const bool sleeps = subject.scene.contact && subject.scene.contact->sleep;
  for (const char* word : {"ca", "tw"}) {
    if (sleeps) subject.not_run.push_back(fmt::format("{}: bodies that rest fall asleep in this scene, which rd alone follows", word));
    else if (std::string(word) == "tw" && !engines::fast_timewarp()) subject.not_run.push_back("tw: this tree holds no timewarp of its own");
    else chosen.emplace_back(word);
  }
  if (engines::goes_in_closed_form(subject.scene)) chosen.push_back("auto");
  return chosen;
}

void add_engines(const CostWords& words, const Laws& laws, CostSubject& subject) {
  const bool in_closed_form = engines::goes_in_closed_form(subject.scene);
  for (const std::string& word : engines_for(words, subject)) subject.ways.push_back(way_by_engine(word, laws, in_closed_form));
}

/// A module's own methods of integration, each with these laws.
void add_methods(const Context& context, const modules::ModuleKind& kind, const std::string& word, const std::string& whose, const Laws& laws, CostSubject& subject) {
  modules::AnyModule module;
  if (word == "student" || word == "reference") {
    module = load_word(context, kind, word);
  } else {
    std::filesystem::path file = word;
    if (std::filesystem::is_directory(file)) file /= kind.folder + ".cpp";
    const SandboxedModule sandboxed = load_sandboxed(context, kind, file);
    module = sandboxed.step.module;
    subject.connections.push_back(sandboxed.step.connection);
  }
  for (const modules::NamedMethod& named : kind.methods) {
    CostWay way;
    way.name = fmt::format("{} {}", whose, named.name);
    way.word = named.name;
    way.method = [step = named.step(module)](double) { return step; };
    way.order = named.order;
    way.laws = laws;
    way.laws.integrator_source = fmt::format("{} ({})", named.name, word);
    subject.ways.push_back(std::move(way));
  }
}

/// A module's own methods of integration, where it has some; else the scene run by all its laws.
void add_module(const Context& context, const modules::ModuleKind& kind, const std::string& word, const std::string& whose, const Laws& laws, const scene::Scene& scene, CostSubject& subject) {
  if (kind.methods.empty()) {
    const ChosenLaws chosen = choose_laws(context, scene, parse_module_words(kind.id + "=" + word, context.registry));
    CostWay way = way_by_method(method_named("rk4"), chosen.laws);
    way.name = fmt::format("{} {}", whose, kind.id);
    subject.ways.push_back(std::move(way));
    subject.connections.insert(subject.connections.end(), chosen.connections.begin(), chosen.connections.end());
    return;
  }
  add_methods(context, kind, word, whose, laws, subject);
  // Steps alone leave the module's other laws of motion unseen: the derivative, the renormalisation.
  const ChosenLaws chosen = choose_laws(context, scene, parse_module_words(kind.id + "=" + word, context.registry));
  CostWay whole;
  whole.name = fmt::format("{} whole {}", whose, kind.id);
  whole.word = kind.id;
  whole.order = kind.methods.back().order;
  whole.laws = chosen.laws;
  subject.ways.push_back(std::move(whole));
  subject.connections.insert(subject.connections.end(), chosen.connections.begin(), chosen.connections.end());
}

/// Whose methods of integration a scene's words name; empty: nobody's. The reference's are the library's over again, unless they are asked for by name.
std::string named_motion(const ModuleWords& words, const modules::ModuleKind& kind) {
  if (const auto own = words.find(kind.id); own != words.end()) return own->second == "library" ? "" : own->second;
  const auto all = words.find("");
  return all == words.end() || all->second == "library" || all->second == "reference" ? "" : all->second;
}

/// Where a module that integrates was chosen by word, what it integrates by is looked at too.
void add_named_methods(const Context& context, const CostWords& words, const Laws& laws, CostSubject& subject) {
  if (is_none(words.methods)) return;
  const ModuleWords named = parse_module_words(words.modules, context.registry);
  for (const modules::ModuleKind* kind : context.registry.all()) {
    const std::string word = kind->methods.empty() ? "" : named_motion(named, *kind);
    if (!word.empty()) add_methods(context, *kind, word, word == "reference" ? "reference" : "your", laws, subject);
  }
}

CostSubject of_scene(const Context& context, const CostWords& words) {
  CostSubject subject;
  subject.scene = find_scene(context, words.scene, words.n);
  const ChosenLaws chosen = choose_laws(context, subject.scene, parse_module_words(words.modules, context.registry));
  for (const auto& notice : chosen.notices) fmt::print(stderr, "{}\n", notice);
  subject.title = subject.scene.title;
  subject.truth_laws = chosen.laws;
  subject.connections = chosen.connections;
  // Closed forms first: they cost little, and stand where a budget ends early.
  const bool in_closed_form = engines::goes_in_closed_form(subject.scene);
  if (in_closed_form) add_engines(words, chosen.laws, subject);
  add_named_methods(context, words, chosen.laws, subject);
  for (const std::string& word : methods_for(subject.scene, words)) subject.ways.push_back(way_by_method(method_named(word), chosen.laws));
  if (!in_closed_form) add_engines(words, chosen.laws, subject);
  for (const std::string& word : words.stabilisations) subject.ways.push_back(by_stabilisation(word, subject.scene, chosen.laws));
  for (const std::string& word : words.impacts) subject.ways.push_back(by_impacts(word, subject.scene, chosen.laws));
  for (const std::string& word : words.solvers) subject.ways.push_back(by_solver(word, subject.scene, chosen.laws));
  if (subject.ways.empty()) throw UserError("tumble cost " + words.scene, "--methods, --engines and the other axes leave nothing to run", "Leave one of them out.");
  return subject;
}

CostSubject of_assignment(const Context& context, const modules::ModuleKind& kind, const CostWords& words) {
  CostSubject subject;
  if (words.on.empty() && kind.note<engines::CostShowcase>().scene.empty()) throw UserError("tumble cost " + kind.id, "no scene is known on which this assignment is measured", "Name one: --on SCENE.");
  subject.scene = find_scene(context, words.on.empty() ? kind.note<engines::CostShowcase>().scene : words.on, words.n);
  if (words.on.empty()) subject.duration_s = kind.note<engines::CostShowcase>().duration_s;
  const bool has_reference = std::filesystem::exists(context.build / "modules" / (kind.id + "_reference.so"));
  const ChosenLaws right = choose_laws(context, subject.scene, parse_module_words(has_reference ? "reference" : kind.methods.empty() ? "" : kind.id + "=library", context.registry));
  subject.truth_laws = right.laws;
  subject.connections = right.connections;
  const std::string word = words.modules.empty() ? "student" : words.modules;
  subject.title = fmt::format("{} ({}) on: {}", kind.id, word, subject.scene.title);
  // The course's own modules stay with the instructor: then laws that no library has are the student's in the truth too.
  if (!has_reference && kind.methods.empty())
    subject.note = "This tree holds no reference of " + kind.id + ": the truth is computed with your own laws, so what is judged here is how the motion is integrated, not whether they are right.";
  else if (word != "student" && word != "reference")
    subject.note = "This module runs in the sandbox, where each call and each derivative asked for costs some microseconds more: compare its force evaluations, not its CPU time.";
  add_module(context, kind, word, "your", right.laws, subject.scene, subject);
  if (has_reference && word != "reference") add_module(context, kind, "reference", "reference", right.laws, subject.scene, subject);
  if (!kind.methods.empty()) subject.ways.push_back(way_by_method(method_named("dopri5"), right.laws));
  return subject;
}

}  // namespace

std::vector<double> CostWords::steps_s() const {
  std::vector<double> all;
  for (const std::string& text : steps) {
    const std::size_t slash = text.find('/');
    char* end = nullptr;
    const std::string above = text.substr(0, slash), below = slash == std::string::npos ? "1" : text.substr(slash + 1);
    const double numerator = std::strtod(above.c_str(), &end);
    const bool is_number = !above.empty() && *end == '\0';
    const double denominator = std::strtod(below.c_str(), &end);
    if (!is_number || below.empty() || *end != '\0' || !(numerator / denominator > 0) || !std::isfinite(numerator / denominator)) throw UserError("--steps " + text, "this is no time in seconds", "Give numbers or fractions: 1/30,1/60,0.001");
    all.push_back(numerator / denominator);
  }
  std::sort(all.rbegin(), all.rend());
  return all;
}

std::string CostWords::name() const { return std::filesystem::path(scene).stem().string(); }

CostSubject find_subject(const Context& context, const CostWords& words) {
  for (const modules::ModuleKind* kind : context.registry.all())
    if (kind->id == words.scene) return of_assignment(context, *kind, words);
  std::string known;
  for (const modules::ModuleKind* kind : context.registry.all()) known += (known.empty() ? "" : ", ") + kind->id;
  if (words.scene.size() == 2 && words.scene[0] == 'a' && std::isdigit(static_cast<unsigned char>(words.scene[1])) != 0) throw UserError(words.scene, "there is no such assignment", "Known: " + known + ".");
  if (!words.on.empty()) throw UserError("--on " + words.on, "goes with an assignment (" + known + "), and '" + words.scene + "' is none", "Give the scene itself: tumble cost " + words.on);
  return of_scene(context, words);
}

}  // namespace tumble::cli
