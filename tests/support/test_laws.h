/// Impulse laws for tests of the engines, which must not depend on what a student wrote.
///
/// Link with tumble::test_laws, a target that is absent from what students get: a test that needs
/// it stands in CMake under `if(TARGET tumble::test_laws)`.
#pragma once

#include "framework/dynamics/laws.h"

namespace tumble::testing {

/// Frictionless impulses, a force at a point, and the library's integration. Rays are left empty.
Laws test_laws();

}  // namespace tumble::testing
