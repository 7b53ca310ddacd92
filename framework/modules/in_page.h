/// A module compiled to WebAssembly, for a page: its functions from bytes to bytes (wire.h), called
/// by number.
///
/// Memory of the module is its own, and it reaches nothing but two functions that the page gives:
///   tumble.threw(kind, text, length)         ends the call: a C++ exception was thrown
///   tumble.callback(which, bytes, length)    calls a function argument; the answer lies in room()
/// A `throw` ends the call, also inside `try`: clang 14 compiles no handlers for WebAssembly.
/// A call: write the arguments to tumble_room(length), then tumble_call(number) gives the length of
/// the answer at tumble_answer().
///
/// Included once, by a file that grading/compiler makes and that ends with TUMBLE_IN_PAGE(a1).
#pragma once

#ifndef __wasm__
#error "in_page.h is compiled to WebAssembly only"
#endif

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <typeinfo>
#include <utility>
#include <vector>

#include "framework/core/not_implemented.h"
#include "framework/modules/wire.h"

namespace tumble::modules::in_page {

enum class Thrown : std::uint32_t { kNotImplemented, kException, kOtherObject, kBadMessage };

extern "C" [[noreturn]] __attribute__((import_module("tumble"), import_name("threw"))) void
tumble_threw(Thrown kind, const char* text, std::size_t length);
extern "C" __attribute__((import_module("tumble"), import_name("callback"))) void tumble_callback(
    std::uint32_t which, const std::uint8_t* arguments, std::size_t length);

/// Ends the call that the page waits for.
[[noreturn]] inline void end_call(Thrown kind, const std::string& text) {
  tumble_threw(kind, text.data(), text.size());
}

/// The bytes of the call, of the answer of a callback, and of the answer.
inline Bytes& room() {
  static Bytes bytes;
  return bytes;
}
inline Bytes& answer() {
  static Bytes bytes;
  return bytes;
}

// A type of wire.h that a function argument is, and what it gives.
template <class T>
struct FromPage {
  static constexpr bool kIsFunction = false;
};
template <class R, class... A>
struct FromPage<std::function<R(A...)>> {
  static constexpr bool kIsFunction = true;
  static std::function<R(A...)> made(std::uint32_t which) {
    return [which](A... arguments) -> R {
      Writer writer;
      (writer.value(static_cast<const std::decay_t<A>&>(arguments)), ...);
      tumble_callback(which, writer.bytes.data(), writer.bytes.size());
      Reader reader(room());
      R result;
      reader.value(result);
      return result;
    };
  }
};

template <class T>
void read_argument(Reader& reader, T& argument) {
  if constexpr (FromPage<T>::kIsFunction) {
    std::uint32_t which = 0;
    reader.value(which);
    argument = FromPage<T>::made(which);
  } else {
    reader.value(argument);
  }
}

template <class R, class... A>
void answer_call(const std::function<R(A...)>& function) {
  const Bytes call = room();  // a callback's answer takes its place
  Reader reader(call);
  std::tuple<std::decay_t<A>...> arguments;
  std::apply([&](auto&... a) { (read_argument(reader, a), ...); }, arguments);
  if (!reader.at_end()) end_call(Thrown::kBadMessage, "bytes left over after the last argument");
  Writer writer;
  writer.value(std::apply(function, arguments));
  answer() = std::move(writer.bytes);
}

/// Answers the call of function `number`, in header order.
/// @return the length of the answer
template <class Module>
std::size_t call(std::uint32_t number) {
  static const Module module = Module::of(Module::linked());
  std::uint32_t at = 0;
  Module::visit(module, [&](const char*, const auto& function) {
    if (at++ == number) answer_call(function);
  });
  if (number >= at) end_call(Thrown::kBadMessage, "there is no function of this number");
  return answer().size();
}

/// Puts the names of the functions into the answer, in header order, each followed by a space.
template <class Module>
std::size_t names() {
  const Module none;
  std::string text;
  Module::visit(none, [&](const char* name, const auto&) { text += std::string(name) + ' '; });
  answer().assign(text.begin(), text.end());
  return answer().size();
}

// What is known of a thrown object: C++ has no way to ask an object of unknown type for its base.
inline const char* what_of(const void* object, const std::type_info& type) {
  const auto is_any_of = [&](const auto&... known) { return ((type == known) || ...); };
  if (is_any_of(typeid(std::logic_error), typeid(std::invalid_argument), typeid(std::domain_error),
                typeid(std::length_error), typeid(std::out_of_range)))
    return static_cast<const std::logic_error*>(object)->what();
  if (is_any_of(typeid(std::runtime_error), typeid(std::range_error), typeid(std::overflow_error),
                typeid(std::underflow_error)))
    return static_cast<const std::runtime_error*>(object)->what();
  return nullptr;
}

[[noreturn]] inline void end_call_with(const void* object, const std::type_info& type) {
  if (type == typeid(NotImplemented))
    end_call(Thrown::kNotImplemented, static_cast<const NotImplemented*>(object)->handout());
  const char* const what = what_of(object, type);
  if (what != nullptr) end_call(Thrown::kException, what);
  end_call(Thrown::kOtherObject, type.name());
}

}  // namespace tumble::modules::in_page

// What clang calls for `throw`. The object is never freed: the page begins with a fresh module.
extern "C" __attribute__((weak)) void* __cxa_allocate_exception(std::size_t size) noexcept {
  return std::malloc(size);
}
extern "C" [[noreturn]] __attribute__((weak)) void __cxa_throw(void* object, std::type_info* type,
                                                               void (*)(void*)) {
  tumble::modules::in_page::end_call_with(object, *type);
}

#define TUMBLE_EXPORTED(NAME) extern "C" __attribute__((export_name(#NAME)))
#define TUMBLE_IN_PAGE(NS)                                                     \
  TUMBLE_EXPORTED(tumble_room) void* tumble_room(std::size_t length) {         \
    tumble::modules::in_page::room().resize(length);                           \
    return tumble::modules::in_page::room().data();                            \
  }                                                                            \
  TUMBLE_EXPORTED(tumble_call) std::size_t tumble_call(std::uint32_t number) { \
    return tumble::modules::in_page::call<tumble::NS::Module>(number);         \
  }                                                                            \
  TUMBLE_EXPORTED(tumble_names) std::size_t tumble_names() {                   \
    return tumble::modules::in_page::names<tumble::NS::Module>();              \
  }                                                                            \
  TUMBLE_EXPORTED(tumble_answer) const void* tumble_answer() {                 \
    return tumble::modules::in_page::answer().data();                          \
  }                                                                            \
  static_assert(true, "a semicolon may follow")
