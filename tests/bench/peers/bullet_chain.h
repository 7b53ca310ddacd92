/// Bullet's other way to joints: bodies in reduced coordinates (btMultiBody, Featherstone's
/// method). For chains of hinges.
#pragma once

#include "tests/bench/peers/harness.h"

namespace tumble::peers {

/// @pre bodies hang on those before them by hinges (chains of cases.cpp), and nothing collides
std::unique_ptr<PeerWorld> make_bullet_chain(const BenchCase& bench, const World& world);

}  // namespace tumble::peers
