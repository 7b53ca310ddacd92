/// What a run says of energy that its step has lost, and what mends it.
#pragma once

#include "framework/dynamics/laws.h"
#include "framework/dynamics/world.h"
#include "framework/engines/base/run_watch.h"
#include "framework/engines/stepping/energy_loss.h"

namespace tumble::engines {

/// The remedy goes by what the bodies are linked by:
///   springs        the largest step at which the method damps their fastest swing by less than
///                  half of what is allowed until the run's end
///   rods, joints   other coordinates where these hold no loop, or where they are reduced ones
///   nothing        closed forms, where no effect names the body
///   what fell asleep while it moved: no sleep
///   what steps in contact have lost: a shorter step
/// and where no step is known, by the size of the loss and the order of the method's damping.
/// @param step  of the run [s]
RunWatch::Size told_of_loss(const LostEnergy& loss, const World& world, const Laws& laws,
                            double step);

/// With which power of the step the energy goes that a method takes from a swing in a given time:
/// 5 of Runge and Kutta's fourth order, 1 of Euler's implicit method; found by asking the method.
/// @return between 1 and kOrderOfMethods, which also stands for methods that take none
double order_of_damping(const Laws& laws);

}  // namespace tumble::engines
