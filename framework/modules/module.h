/// The narrow waist: what a student module is.
///
/// A module is a header of plain functions in one namespace that ends with one line
///     TUMBLE_MODULE(a1, intersect_ray_triangle, wrench_of_point_force, ...)
/// which defines `a1::Module`, a table with one std::function for each function, of the same name.
/// Callers hold a table and do not know which of three implementations it has: the student's file
/// linked in (`linked_module`), a shared object loaded at run time (load.h), or a sandboxed process
/// that answers over a channel (proxy.h).
#pragma once

#include <functional>

// Applies M(namespace, name) to each name, by recursive re-scanning; enough for 60 functions.
#define TUMBLE_PARENS ()
#define TUMBLE_EXPAND(...) \
  TUMBLE_EXPAND3(TUMBLE_EXPAND3(TUMBLE_EXPAND3(TUMBLE_EXPAND3(__VA_ARGS__))))
#define TUMBLE_EXPAND3(...) \
  TUMBLE_EXPAND2(TUMBLE_EXPAND2(TUMBLE_EXPAND2(TUMBLE_EXPAND2(__VA_ARGS__))))
#define TUMBLE_EXPAND2(...) \
  TUMBLE_EXPAND1(TUMBLE_EXPAND1(TUMBLE_EXPAND1(TUMBLE_EXPAND1(__VA_ARGS__))))
#define TUMBLE_EXPAND1(...) __VA_ARGS__
#define TUMBLE_FOR_EACH(M, NS, ...) \
  __VA_OPT__(TUMBLE_EXPAND(TUMBLE_FOR_EACH_STEP(M, NS, __VA_ARGS__)))
#define TUMBLE_FOR_EACH_STEP(M, NS, NAME, ...) \
  M(NS, NAME) __VA_OPT__(TUMBLE_FOR_EACH_AGAIN TUMBLE_PARENS(M, NS, __VA_ARGS__))
#define TUMBLE_FOR_EACH_AGAIN() TUMBLE_FOR_EACH_STEP

#define TUMBLE_MODULE_FIELD(NS, NAME) std::function<decltype(::tumble::NS::NAME)> NAME;
#define TUMBLE_MODULE_VISIT(NS, NAME) visitor(#NAME, module.NAME);
#define TUMBLE_MODULE_LINK(NS, NAME) module.NAME = &::tumble::NS::NAME;

// A shared object exports its table under one name per module. The file that implements the header
// is compiled with TUMBLE_BUILDING_MODULE and needs no line for this. Weak: a module of several
// files exports the table once.
#ifdef TUMBLE_BUILDING_MODULE
#define TUMBLE_MODULE_EXPORT(NS)                                                                   \
  extern "C" __attribute__((weak, used, visibility("default"))) const void* tumble_module_##NS() { \
    static const ::tumble::NS::Module module = ::tumble::NS::linked_module();                      \
    return &module;                                                                                \
  }
#else
#define TUMBLE_MODULE_EXPORT(NS)
#endif

/// Ends a module's header, at global scope.
/// @param NS  the module's namespace inside `tumble`, which is also its id ("a1"); then the
///            functions, in header order.
#define TUMBLE_MODULE(NS, ...)                                              \
  namespace tumble::NS {                                                    \
  /** The module as one value: one field per function, of the same name. */ \
  struct Module {                                                           \
    static constexpr const char* kId = #NS;                                 \
    TUMBLE_FOR_EACH(TUMBLE_MODULE_FIELD, NS, __VA_ARGS__)                   \
    static Module linked();                                                 \
    /** Calls visitor(name, field) for each function, in header order. */   \
    template <class Self, class Visitor>                                    \
    static void visit(Self& module, Visitor&& visitor) {                    \
      TUMBLE_FOR_EACH(TUMBLE_MODULE_VISIT, NS, __VA_ARGS__)                 \
    }                                                                       \
  };                                                                        \
  /** The table of the functions that this program is linked with. */       \
  inline Module linked_module() {                                           \
    Module module;                                                          \
    TUMBLE_FOR_EACH(TUMBLE_MODULE_LINK, NS, __VA_ARGS__)                    \
    return module;                                                          \
  }                                                                         \
  inline Module Module::linked() { return linked_module(); }                \
  }                                                                         \
  TUMBLE_MODULE_EXPORT(NS)                                                  \
  static_assert(true, "a semicolon may follow")
