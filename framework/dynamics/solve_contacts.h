/// Solves contacts with Coulomb friction (contact_problem.h): sweeps, Newton's method, and a finish
/// for what neither decides.
#pragma once

#include "framework/dynamics/contact_problem.h"

namespace tumble {

/// Solves (C.1) to (C.3). Deterministic. Does not throw for a problem without solution: see
/// `converged`, which also accepts what is no more than the rounding of the impulses themselves
/// (heavy on light). Bodies jammed by dozens of contacts with friction up to 2 may stay unsolved.
/// Cost: a sweep O(contacts); the direct method factorises a sparse matrix of 6 rows a body or 3 a
/// contact.
ContactSolution solve_contacts(const ContactProblem& problem, const ContactOptions& options = {});

}  // namespace tumble
