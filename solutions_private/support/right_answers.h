/// Runs all tests of a module against the functions linked into this program, and takes the x-ray
/// of each call on the way. These are the reference's: an x-ray that finds something is wrong.
#pragma once

#include <gtest/gtest.h>

#include "framework/grading/test_program/test_program.h"
#include "framework/grading/verdicts/xray.h"

namespace tumble::grading {

namespace detail {

// A function argument that notes what it is asked, as the judge does (worker_connection.cpp).
template <class R, class... A>
std::function<R(A...)> noted(const std::function<R(A...)>& asked, std::uint32_t number) {
  return [asked, number](A... arguments) -> R {
    modules::Writer question, answer;
    question.value(number);
    (question.value(std::decay_t<A>(arguments)), ...);
    R result = asked(arguments...);
    answer.value(result);
    last_call().asked.emplace_back(question.bytes, answer.bytes);
    return result;
  };
}

template <class T>
std::decay_t<T> noted_argument(const T& argument, std::uint32_t& number, modules::Writer& writer) {
  if constexpr (modules::is_function<std::decay_t<T>>::value) {
    writer.value(number);
    return noted(argument, number++);
  } else {
    writer.value(argument);
    return argument;
  }
}

template <class R, class... A>
std::function<R(A...)> with_xray(const char* name, std::function<R(A...)> function) {
  return [name, function](A... arguments) -> R {
    begin_call_to_show();
    last_call() = {};
    modules::Writer writer;
    std::uint32_t number = 0;
    std::tuple<std::decay_t<A>...> told{noted_argument(arguments, number, writer)...};
    R result = std::apply([&](auto&... a) { return function(a...); }, told);
    modules::Writer answer;
    answer.value(result);
    LastCall& call = last_call();
    call.function = name;
    call.arguments = writer.bytes;
    call.answer = answer.bytes;
    const std::string words = xray_of_last_call();
    EXPECT_EQ(words, "") << "an x-ray of a right answer of " << name;
    return result;
  };
}

}  // namespace detail

template <class Module>
int run_with_xrays(int argc, char** argv) {
  Module right = Module::of(Module::linked());
  Module::visit(right,
                [](const char* name, auto& field) { field = detail::with_xray(name, field); });
  static const Module module = observed(right);
  modules::UnderTest<Module>::table = &module;
  return run_check_program(names_of_functions(module), argc, argv);
}

}  // namespace tumble::grading
