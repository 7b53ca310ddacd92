/// How often functions of a module are called, and which of them a world's laws are: what a run
/// asks of a module is found, and listed nowhere.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "framework/dynamics/laws.h"
#include "framework/modules/watched.h"

namespace tumble::modules {

/// Counts the calls of a module's functions, from any thread.
class CallCounts final : public CallWatcher {
 public:
  /// @param functions  of the module, in header order
  explicit CallCounts(std::vector<std::string> functions)
      : functions_(std::move(functions)), counts_(functions_.size()) {}

  const char* begin(const char* function) override {
    for (std::size_t k = 0; k < functions_.size(); ++k)
      if (functions_[k] == function) counts_[k].fetch_add(1, std::memory_order_relaxed);
    return nullptr;
  }
  void end(const char*) override {}
  void threw(const char*, const std::exception&) override {}

  const std::vector<std::string>& functions() const { return functions_; }
  std::uint64_t count(std::size_t function) const {
    return counts_[function].load(std::memory_order_relaxed);
  }
  void clear() {
    for (auto& count : counts_) count.store(0, std::memory_order_relaxed);
  }

 private:
  std::vector<std::string> functions_;
  std::deque<std::atomic<std::uint64_t>> counts_;  // an atomic number cannot be moved
};

namespace detail {

/// A function that holds a token and is never called.
template <class R, class... A>
void hold(const std::shared_ptr<int>& token, std::function<R(A...)>& function) {
  function = [token](A...) -> R {
    throw std::logic_error("called while it is bound" + std::to_string(*token));
  };
}

}  // namespace detail

/// Those functions of a module that become laws of a world, in header order: only these can a run
/// of a scene ask. Each function holds a token, and what binding has copied holds it once more.
/// @param bind  sets the laws that the module implements
template <class Module>
std::vector<std::string> functions_of_laws(void (*bind)(const Module&, Laws&)) {
  Module module;
  std::vector<std::shared_ptr<int>> tokens;
  Module::visit(module, [&](const char*, auto& field) {
    tokens.push_back(std::make_shared<int>(0));
    detail::hold(tokens.back(), field);
  });
  std::vector<long> before;
  for (const auto& token : tokens) before.push_back(token.use_count());
  Laws laws;
  bind(module, laws);
  std::vector<std::string> bound;
  std::size_t at = 0;
  Module::visit(module, [&](const char* name, const auto&) {
    if (tokens[at].use_count() > before[at]) bound.push_back(name);
    ++at;
  });
  return bound;
}

}  // namespace tumble::modules
