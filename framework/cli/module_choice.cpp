#include "framework/cli/module_choice.h"

#include <algorithm>

#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "framework/modules/load.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;
using modules::AnyModule;
using modules::ModuleKind;

fs::path built(const Context& context, const std::string& id, const std::string& word) {
  return context.build / "modules" / (id + '_' + word + ".so");
}

/// A folder that is gone at the end of the scope: a loaded object stays mapped without its file.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "tumble-module-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw UserError(name, "this folder cannot be made", "Free some space, or set TMPDIR.");
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Compiles as the build does (assignments/CMakeLists.txt: tumble_module_object). The compiler's words go to stderr.
void compile(const Context& context, const fs::path& source, const fs::path& object) {
  std::vector<std::string> words = {"g++", "-std=c++20", "-O2", "-fPIC", "-shared", "-ffp-contract=off", "-fno-gnu-unique", "-Wl,-z,defs",
                                    "-DTUMBLE_BUILDING_MODULE", "-I", context.root.string(), "-isystem", TUMBLE_EIGEN_INCLUDE,
                                    source.string(), "-o", object.string()};
  std::vector<char*> argv;
  for (auto& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t child = 0;
  int status = 0;
  if (::posix_spawnp(&child, "g++", nullptr, nullptr, argv.data(), environ) != 0) throw UserError("g++", "the compiler cannot be started", "Install g++.");
  while (::waitpid(child, &status, 0) < 0) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw UserError(source.string(), "does not compile; the compiler says why above", "Correct it, or name another file after --modules.");
}

}  // namespace

AnyModule load_word(const Context& context, const ModuleKind& kind, const std::string& word) {
  if (word == "student" || word == "reference") {
    const fs::path file = built(context, kind.id, word);
    if (!fs::exists(file) && word == "reference")
      throw UserError("--modules " + kind.id + "=reference", "this tree holds no reference solution of " + kind.id,
                      "Use " + kind.id + "=student, or name a file of your own.");
    if (!fs::exists(file))
      throw UserError("--modules " + kind.id + "=student", file.string() + " is not built", "Run ./tumble, which builds it, or: ninja -C " + context.build.string() + " " + kind.id + "_student");
    return modules::load_module(kind, file);
  }
  const fs::path file = word;
  if (file.extension() != ".cpp" && file.extension() != ".so")
    throw UserError("--modules " + kind.id + "=" + word, "this is none of student, reference, library, PATH.so, PATH.cpp", "Give one of these.");
  if (!fs::exists(file)) throw UserError("--modules " + kind.id + "=" + word, "there is no such file", "Check the path.");
  if (file.extension() == ".so") return modules::load_module(kind, file);
  const TemporaryFolder folder;
  const fs::path object = folder.path() / (kind.id + ".so");
  compile(context, file, object);
  return modules::load_module(kind, object);
}

namespace {

void bind_module(const ModuleKind& kind, const AnyModule& module, const std::string& source, Laws& laws) {
  kind.bind(module, laws);
  Laws alone;   // shows which laws this module is about
  kind.bind(module, alone);
  if (alone.collision_impulse) laws.impulse_source = kind.id + ' ' + source;
  if (alone.integrate_step) laws.integrator_source = kind.id + ' ' + source;
}

/// Reference where this tree has one, else the student's.
std::string best_available(const Context& context, const std::string& id) {
  return fs::exists(built(context, id, "reference")) ? "reference" : "student";
}

bool is_own(const scene::Scene& scene, const ModuleKind& kind) {
  const fs::path scenes = fs::absolute(scene.file).parent_path();
  return scenes.filename() == "scenes" && scenes.parent_path().filename() == kind.folder;
}

/// The word for a module that nobody named; empty: the scene does not need it.
std::string default_word(const Context& context, const scene::Scene& scene, const ModuleKind& kind, bool scene_has_home) {
  if (is_own(scene, kind)) return "student";
  if (std::find(scene.needs.begin(), scene.needs.end(), kind.id) == scene.needs.end()) return "";
  return scene_has_home ? best_available(context, kind.id) : "student";
}

}  // namespace

ModuleWords parse_module_words(const std::string& text, const modules::Registry& registry) {
  ModuleWords words;
  std::size_t start = 0;
  while (start < text.size()) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    const std::string part = text.substr(start, end - start);
    start = end + 1;
    const std::size_t equals = part.find('=');
    const std::string id = equals == std::string::npos ? "" : part.substr(0, equals);
    const std::string word = equals == std::string::npos ? part : part.substr(equals + 1);
    if (!id.empty()) registry.find(id);   // throws, naming the known ids
    if (word.empty()) throw UserError("--modules " + text, "nothing stands after '" + id + "='", "Give student, reference, library, PATH.so or PATH.cpp.");
    if (!words.emplace(id, word).second) throw UserError("--modules " + text, id.empty() ? "more than one word for all modules" : id + " is named twice", "Name each module once: a1=student,a2=library");
  }
  return words;
}

ChosenLaws choose_laws(const Context& context, const scene::Scene& scene, const ModuleWords& words) {
  const auto kinds = context.registry.all();
  const bool has_home = std::any_of(kinds.begin(), kinds.end(), [&](const ModuleKind* kind) { return is_own(scene, *kind); });
  std::map<std::string, std::string> chosen;   // by id
  for (const ModuleKind* kind : kinds) {
    const auto told = words.contains(kind->id) ? words.find(kind->id) : words.find("");
    chosen[kind->id] = told != words.end() ? told->second : default_word(context, scene, *kind, has_home);
  }

  ChosenLaws result;
  // What the scene does not need may still be asked for (a push by hand): from what is built, if it is.
  for (const ModuleKind* kind : kinds) {
    const std::string word = best_available(context, kind->id);
    if (chosen[kind->id].empty() && fs::exists(built(context, kind->id, word))) bind_module(*kind, load_word(context, *kind, word), word, result.laws);
  }
  // Over these the library's laws of motion, over those what was chosen.
  const Laws library = library_laws();
  result.laws.integrate_step = library.integrate_step;
  result.laws.state_derivative = library.state_derivative;
  result.laws.renormalize = library.renormalize;
  result.laws.find_impact_time = library.find_impact_time;
  result.laws.integrator_source = library.integrator_source;
  for (const ModuleKind* kind : kinds) {
    const std::string& word = chosen[kind->id];
    if (word.empty()) continue;
    result.modules.push_back({kind->id, word});
    if (word != "library") bind_module(*kind, load_word(context, *kind, word), word, result.laws);
  }
  return result;
}

}  // namespace tumble::cli
