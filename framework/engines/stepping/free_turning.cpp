#include "framework/engines/stepping/free_turning.h"

#include <algorithm>

namespace tumble::engines {

FreeTurning::FreeTurning(const Inertia& inertia)
    : inverse_inertia_body_(inertia.inverse_inertia_body), rotation_(inertia.inertia_body) {}

void FreeTurning::step(const RigidBodyState& from, const RigidBodyState& to, double duration,
                       double speed) {
  constexpr double kLookEach = 1.0;  // rad: a series of the exact rotation reaches as far at once
  // never equal at the first step: not a number
  if (from.angular_momentum_world != angular_momentum_world_ ||
      from.world_from_body.coeffs() != reached_.coeffs()) {
    look();
    error_before_ += error_;
    error_ = 0.0;
    exact_ = {from.world_from_body, inverse_inertia_body_ * (from.world_from_body.conjugate() *
                                                             from.angular_momentum_world)};
  }
  angular_momentum_world_ = to.angular_momentum_world;
  reached_ = to.world_from_body;
  since_look_ += duration;
  turned_since_look_ += speed * duration;
  longest_step_ = std::max(longest_step_, duration);
  if (turned_since_look_ >= kLookEach) look();
}

void FreeTurning::look() {
  if (since_look_ == 0.0) return;
  exact_ = rotation_.after(exact_, since_look_);
  error_ = exact_.world_from_body.angularDistance(reached_);
  since_look_ = turned_since_look_ = 0.0;
}

}  // namespace tumble::engines
