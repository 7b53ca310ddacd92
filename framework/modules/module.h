/// The narrow waist: what a student module is.
///
/// A module is a header of plain functions in one namespace that ends with one line
///     TUMBLE_MODULE(a1, intersect_ray_triangle, wrench_of_point_force, ...)
/// which defines `a1::Module`, a table with one std::function for each function, of the same name.
/// Callers hold a table and do not know which of three implementations it has: the student's file
/// linked in (`Module::linked`), a shared object loaded at run time (load.h), or a sandboxed
/// process that answers over a channel (proxy.h).
///
/// A file that implements the header is compiled with TUMBLE_BUILDING_MODULE. It exports plain
/// addresses and sees no table: a std::function for each function takes the compiler 0.2 s.
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

#define TUMBLE_MODULE_ADDRESS(NS, NAME) decltype(&::tumble::NS::NAME) NAME;
#define TUMBLE_MODULE_LINK(NS, NAME) &::tumble::NS::NAME,
#define TUMBLE_MODULE_FIELD(NS, NAME) std::function<decltype(::tumble::NS::NAME)> NAME;
#define TUMBLE_MODULE_VISIT(NS, NAME) visitor(#NAME, module.NAME);
#define TUMBLE_MODULE_COPY(NS, NAME) functions.NAME,

#define TUMBLE_MODULE_FUNCTIONS(NS, ...)                                                           \
  namespace tumble::NS {                                                                           \
  /** Their addresses, in header order. */                                                         \
  struct Functions {                                                                               \
    TUMBLE_FOR_EACH(TUMBLE_MODULE_ADDRESS, NS, __VA_ARGS__)                                        \
  };                                                                                               \
  /** Those that this program or shared object defines. */                                         \
  inline const Functions& linked_functions() {                                                     \
    static constexpr Functions functions = {TUMBLE_FOR_EACH(TUMBLE_MODULE_LINK, NS, __VA_ARGS__)}; \
    return functions;                                                                              \
  }                                                                                                \
  }

/// Ends a module's header, at global scope.
/// @param NS  the module's namespace inside `tumble`, which is also its id ("a1"); then the
///            functions, in header order.
#ifdef TUMBLE_BUILDING_MODULE
// A shared object exports the addresses under one name per module. Weak: a module of several files
// exports them once.
#define TUMBLE_MODULE(NS, ...)                                  \
  TUMBLE_MODULE_FUNCTIONS(NS, __VA_ARGS__)                      \
  extern "C" __attribute__((weak, used, visibility("default"))) \
  const void* tumble_functions_##NS() {                         \
    return &::tumble::NS::linked_functions();                   \
  }                                                             \
  static_assert(true, "a semicolon may follow")
#else
#define TUMBLE_MODULE(NS, ...)                                              \
  TUMBLE_MODULE_FUNCTIONS(NS, __VA_ARGS__)                                  \
  namespace tumble::NS {                                                    \
  /** The module as one value: one field per function, of the same name. */ \
  struct Module {                                                           \
    using Addresses = Functions;                                            \
    static constexpr const char* kId = #NS;                                 \
    TUMBLE_FOR_EACH(TUMBLE_MODULE_FIELD, NS, __VA_ARGS__)                   \
    /** A template: a file that makes no table does not pay for one. */     \
    template <class Same>                                                   \
    static Module of(const Same& functions) {                               \
      return {TUMBLE_FOR_EACH(TUMBLE_MODULE_COPY, NS, __VA_ARGS__)};        \
    }                                                                       \
    /** Those that this program is linked with. */                          \
    static const Functions& linked() { return linked_functions(); }         \
    /** Calls visitor(name, field) for each function, in header order. */   \
    template <class Self, class Visitor>                                    \
    static void visit(Self& module, Visitor&& visitor) {                    \
      TUMBLE_FOR_EACH(TUMBLE_MODULE_VISIT, NS, __VA_ARGS__)                 \
    }                                                                       \
  };                                                                        \
  }                                                                         \
  static_assert(true, "a semicolon may follow")
#endif
