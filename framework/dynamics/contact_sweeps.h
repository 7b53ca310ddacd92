/// Block Gauss-Seidel on a contact problem: contact after contact, each solved exactly with the
/// others held. Internal to dynamics.
///
/// Finds most small problems' answers and always the right modes of easy ones; the error falls by a
/// factor a sweep that is near 1 for high stacks and large mass ratios (a stack of N: 2.3 N^2 /
/// pi^2 sweeps a digit), where contact_newton.h takes over.
/// Sources: J. Moreau, "Numerical aspects of the sweeping process", 1999; F. Jourdan, P. Alart, M.
/// Jean, Comput. Methods Appl. Mech. Eng. 155, 1998.
#pragma once

#include "framework/dynamics/contact_cone.h"
#include "framework/dynamics/contact_system.h"

namespace tumble::contacts {

/// The small problems of a system's contacts, prepared once.
std::vector<LocalContact> prepare_locals(const System& system);

/// One sweep, forward or backward (alternate: together they treat no contact as the last). Returns
/// the largest change of an impulse, as a velocity.
double sweep(const System& system, std::vector<LocalContact>& locals, bool forward,
             Impulses& impulses);

}  // namespace tumble::contacts
