/// Which modules there are. Each assignment registers once; the framework never names one.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "framework/dynamics/laws.h"
#include "framework/modules/proxy.h"
#include "framework/modules/serve.h"

namespace tumble::modules {

/// A table of functions of some module, its type known to the registration only.
using AnyModule = std::shared_ptr<const void>;

/// All that the framework can do with a module without knowing its header.
struct ModuleKind {
  std::string id;                          // "a1"
  std::string folder;                      // "a1_impulse": below assignments/, solutions_private/ and tests/
  std::string title;                       // for people
  std::string exported_name;               // C symbol of a shared object that gives the table
  std::vector<std::string> functions;      // in header order
  std::function<void(const AnyModule&, Laws&)> bind;                 // lets the module's functions be laws of a world
  std::function<void(const AnyModule&, Channel&)> serve;             // worker's side
  std::function<AnyModule(Connection&)> make_proxy;                  // judge's side
};

class Registry {
 public:
  /// The one registration line of an assignment.
  /// @param bind  fills the laws that this module is about
  template <class Module>
  void add(const std::string& folder, const std::string& title, void (*bind)(const Module&, Laws&)) {
    ModuleKind kind;
    kind.id = Module::kId;
    kind.folder = folder;
    kind.title = title;
    kind.exported_name = Module::kExportedName;
    Module names;
    Module::visit(names, [&](const char* name, auto&) { kind.functions.push_back(name); });
    kind.bind = [bind](const AnyModule& module, Laws& laws) { bind(*static_cast<const Module*>(module.get()), laws); };
    kind.serve = [](const AnyModule& module, Channel& channel) { modules::serve(*static_cast<const Module*>(module.get()), channel); };
    kind.make_proxy = [](Connection& connection) -> AnyModule {
      return std::make_shared<const Module>(modules::make_proxy<Module>(connection));
    };
    kinds_[kind.id] = std::move(kind);
  }

  /// @throws UserError naming the known ids
  const ModuleKind& find(const std::string& id) const;
  std::vector<const ModuleKind*> all() const;

 private:
  std::map<std::string, ModuleKind> kinds_;
};

}  // namespace tumble::modules

namespace tumble {
/// Defined once, in assignments/register.cpp: one line an assignment.
void register_assignments(modules::Registry& registry);
}  // namespace tumble
