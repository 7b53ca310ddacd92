/// The known modules. Each assignment registers once; the framework never names one.
#pragma once

#include <any>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <typeindex>
#include <utility>
#include <vector>

#include "framework/dynamics/laws.h"
#include "framework/modules/call_counts.h"
#include "framework/modules/load.h"
#include "framework/modules/names.h"
#include "framework/modules/connection.h"
#include "framework/modules/serve.h"
#include "framework/modules/watched.h"

namespace tumble::modules {

/// A method of integration of a module, to be measured beside others.
struct NamedMethod {
  std::string name;  // of its function
  double order;      // nominal order of convergence
  std::function<std::function<VectorXd(const OdeFunction&, double, const VectorXd&, double)>(
      const AnyModule&)>
      step;
};

/// Everything that the framework can do with a module without its header.
struct ModuleKind : ModuleName {
  std::vector<std::string> functions;  // in header order
  // sets laws of a world to the module's functions
  std::function<void(const AnyModule&, Laws&)> bind;
  std::function<void(const AnyModule&, Channel&)> serve;  // on the worker's side
  std::function<AnyModule(Connection&)> make_proxy;       // on the judge's side
  std::function<AnyModule(const void*)> module_of;        // of loaded functions
  // the same module with watched calls
  std::function<AnyModule(const AnyModule&, CallWatcher&)> watched;
  std::vector<NamedMethod> methods;  // empty where the module has no integration
  // it decides the order in which logical processes run, not their physics: bound only where the
  // user names it
  bool is_scheduler = false;

  /// Data about a module for a room above this one, of a type of that room (truths::ModuleTruths,
  /// cost::CostShowcase), which is stored here without knowledge of the type.
  /// Default-constructed where nothing was set.
  template <class Note>
  Note note() const {
    const auto found = notes.find(typeid(Note));
    return found == notes.end() ? Note{} : *std::any_cast<Note>(&found->second);
  }
  std::map<std::type_index, std::any> notes;

  // those functions that become laws: only these can the run of a scene ask
  std::function<std::vector<std::string>()> functions_of_laws;
};

/// @param file  a shared object built from a file that implements the module's header
/// @throws UserError as load_functions does
inline AnyModule load_module(const ModuleKind& kind, const std::filesystem::path& file) {
  return kind.module_of(load_functions(kind, file));
}

class Registry {
 public:
  /// Registers an assignment.
  /// @param bind  sets the laws that this module implements
  /// @pre assignment_names() has it
  template <class Module>
  void add(void (*bind)(const Module&, Laws&)) {
    ModuleKind kind;
    static_cast<ModuleName&>(kind) = find_name(assignment_names(), Module::kId);
    Module names;
    Module::visit(names, [&](const char* name, auto&) { kind.functions.push_back(name); });
    kind.functions_of_laws = [bind] { return modules::functions_of_laws<Module>(bind); };
    kind.bind = [bind](const AnyModule& module, Laws& laws) {
      bind(*static_cast<const Module*>(module.get()), laws);
    };
    kind.serve = [](const AnyModule& module, Channel& channel) {
      modules::serve(*static_cast<const Module*>(module.get()), channel);
    };
    kind.make_proxy = [](Connection& connection) -> AnyModule {
      return std::make_shared<const Module>(modules::make_proxy<Module>(connection));
    };
    kind.module_of = modules::module_of<Module>;
    kind.watched = [](const AnyModule& module, CallWatcher& watcher) -> AnyModule {
      return std::make_shared<const Module>(
          modules::watched(*static_cast<const Module*>(module.get()), watcher));
    };
    kinds_[kind.id] = std::move(kind);
  }

  /// See ModuleKind::note.
  /// @pre the module is registered
  template <class Note>
  void set_note(const std::string& id, Note note) {
    kinds_.at(id).notes[typeid(Note)] = std::move(note);
  }

  /// Registers one of a module's functions as a method of integration.
  template <class Module, class Member>
  void add_method(const std::string& name, double order, Member Module::*function) {
    kinds_.at(Module::kId).methods.push_back({name, order, [function](const AnyModule& module) {
                                                return static_cast<const Module*>(module.get())
                                                           ->*function;
                                              }});
  }

  /// Marks a registered module as a scheduler.
  void mark_scheduler(const std::string& id) { kinds_.at(id).is_scheduler = true; }

  /// @throws UserError naming the known ids
  const ModuleKind& find(const std::string& id) const;
  std::vector<const ModuleKind*> all() const;

 private:
  std::map<std::string, ModuleKind> kinds_;
};

}  // namespace tumble::modules

namespace tumble {
/// Registers each assignment of the tree by its aN_binding.h (assignments/CMakeLists.txt).
void register_assignments(modules::Registry& registry);
}  // namespace tumble
