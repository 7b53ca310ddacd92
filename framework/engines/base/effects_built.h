/// Which of the effects that are no folder under framework/effects the engines are built with: all
/// of them, except where tests/bench/absent_effects.sh leaves one out (-DTUMBLE_WITHOUT="spring")
/// to show that an effect that a scene does not ask for costs what an effect that is not there
/// costs: nothing.
#pragma once

#include <string_view>

#ifndef TUMBLE_WITHOUT
#define TUMBLE_WITHOUT ""
#endif

namespace tumble::engines::built {

constexpr std::string_view kWithout = TUMBLE_WITHOUT;

constexpr bool kCollision = kWithout != "collision";
constexpr bool kContact = kCollision && kWithout != "contact";  // begins where bodies collide
constexpr bool kFriction = kWithout != "friction";
constexpr bool kSleep = kWithout != "sleep";
constexpr bool kCallback = kWithout != "callback";

}  // namespace tumble::engines::built
