/// Laws by their types: each stands in the folder of the effect that asks it, and what holds laws,
/// binds, guards and names them knows none of these types. A law is a struct with its words and the
/// type of its function:
///
///   struct PlateDrag {
///     using Function = Vector3d(const Vector3d& velocity_world, double area);
///     static constexpr LawWords kWords{.function = "plate_drag", .effect = "drag of plates",
///                                      .what = "the drag of a plate", .assignment = "a6"};
///     // Where finite numbers are not enough. What is wrong with an answer, behind "returned";
///     // empty: nothing.
///     static std::string fault(const Vector3d& drag, const Vector3d& velocity_world, double area);
///   };
///
/// An assignment's `bind` sets it, laws.set<PlateDrag>(module.plate_drag); the effect names it in
/// needed_laws, needed_law<PlateDrag>(laws), and asks it, laws.of<PlateDrag>(), once: the function
/// stays where it is, so that a call of it costs what any std::function costs.
#pragma once

#include <any>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "framework/dynamics/law_guard.h"

namespace tumble {

/// What a law is called where it is told of.
struct LawWords {
  const char* function;  // in the header of the assignment: "plate_drag"
  const char* effect;    // what does not go on without it, in front of a failure: "drag of plates"
  const char* what;      // what it gives: "the drag of a plate"
  const char* assignment;  // that provides it: "a6"
};

template <class Law>
using LawFunction = std::function<typename Law::Function>;

/// "needs the drag of a plate, and no module provides it", with what to do about that.
/// @param where  the scene  @throws UserError
[[noreturn]] void refuse_without_law(const std::string& where, const std::string& what,
                                     const std::string& assignment);

class LawList {
 public:
  template <class Law>
  bool has() const {
    return find(kKind<Law>) != nullptr;
  }
  /// The function, for as long as no law is set; where no module provides it, one that says so when
  /// it is called (UserError).
  template <class Law>
  const LawFunction<Law>& of() const {
    static const LawFunction<Law> absent = refusal<Law>(LawFunction<Law>());
    const Listed* listed = find(kKind<Law>);
    return listed == nullptr ? absent : *std::any_cast<LawFunction<Law>>(&listed->function);
  }
  /// Which module provides it: "a3 student"; "none" where that was not said.
  template <class Law>
  const std::string& source_of() const {
    const Listed* listed = find(kKind<Law>);
    return listed == nullptr ? kNoSource : listed->source;
  }

  /// Sets the function, and leaves the source as it is. An empty one: no module provides it.
  template <class Law>
  void set(LawFunction<Law> function) {
    if (function)
      at(kKind<Law>).function = std::move(function);
    else
      remove(kKind<Law>);
  }
  /// Sets all laws that another list has, as this source's.
  void take_listed(const LawList& other, const std::string& source);
  /// Puts each under its guard (law_guard.h).
  void guard_listed();

  inline static const std::string kNoSource = "none";

 private:
  // What is done with a law without its type. Its address is the law's identity.
  struct Kind {
    LawWords words;
    std::any (*guarded)(const std::any& function, LawGuard guard);
  };
  struct Listed {
    const Kind* kind;
    std::any function;  // a LawFunction of the law
    std::string source = kNoSource;
  };

  template <class Law, class Answer, class... A>
  static void check(const LawGuard& guard, const Answer& answer, const A&... arguments) {
    constexpr bool has_fault = requires { Law::fault(answer, arguments...); };
    constexpr bool has_numbers = requires { is_number(answer); };
    static_assert(has_fault || has_numbers,
                  "write  bool is_number(const ANSWER&)  beside the type of the law's answer");
    if constexpr (has_numbers) guard.need_number(answer);
    if constexpr (has_fault)
      if (const std::string fault = Law::fault(answer, arguments...); !fault.empty())
        guard.refuse(fault);
  }
  template <class Law>
  static std::any guarded(const std::any& function, LawGuard guard) {
    return guarded_function(std::move(guard), std::any_cast<const LawFunction<Law>&>(function),
                            [](const LawGuard& by, const auto& answer, const auto&... arguments) {
                              check<Law>(by, answer, arguments...);
                            });
  }
  template <class Law, class R, class... A>
  static std::function<R(A...)> refusal(const std::function<R(A...)>&) {
    return
        [](A...) -> R { refuse_without_law("the run", Law::kWords.what, Law::kWords.assignment); };
  }
  template <class Law>
  static constexpr Kind kKind{Law::kWords, guarded<Law>};

  const Listed* find(const Kind& kind) const {
    for (const Listed& listed : listed_)
      if (listed.kind == &kind) return &listed;
    return nullptr;
  }
  Listed& at(const Kind& kind);
  void remove(const Kind& kind);

  std::vector<Listed> listed_;  // a handful
};

}  // namespace tumble
