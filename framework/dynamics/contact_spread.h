/// Loads that statics does not tell, spread over the contacts that may carry them. Internal to
/// dynamics.
///
/// A bar that hangs on a ball joint and lies on the floor may be carried by its far corners, or by
/// those near the joint on a short lever, with many times the force: the bar moves alike, but for
/// friction, which goes with the force. In exact arithmetic rows that fit each other leave all
/// these impulses possible; errors of places and of the step make one of them the answer, another
/// one in the next step, and a warm start keeps it. Among the normal impulses p_n that hold the
/// same contacts closed, this takes those of least norm,
///   min |p_n|^2,   p_n >= 0,   J_n^T p_n + J_rows^T lambda as the motion asks,           (C.11)
/// with friction bounded by them: the limit of surfaces that yield alike, v_n = -c p_n, c -> 0,
/// between bodies and links that do not. It depends on no warm start, no order and no coordinates,
/// and it is what Newton's method finds from zero where bodies are free (solve_contacts.cpp).
///
/// Contacts that an answer leaves nearly closed are taken as closed, with the velocities that it
/// gives them, which fit each other. The problem with compliance is solved from that answer, which
/// often is even already, else from zero, else through softer ones; and then about its own answer,
/// which takes out what the surfaces have yielded. What sticks shares its friction in many ways
/// still: that moves nothing.
/// Source: the least norm as limit of compliances: A. Tikhonov, Soviet Math. Dokl. 4, 1963 (of
/// regularised problems), here with the law (C.1), (C.2) in place of a linear one.
#pragma once

#include "framework/dynamics/contact_newton.h"

namespace tumble::contacts {

/// Spreads the load of contacts that may carry it in more than one way. Where links leave
/// none open, or there is no friction, or the spread one is not found, nothing changes but counts.
/// @param indistinct  what opens or approaches with less is closed; so is what does with less than
///   a tenth of the speed with which its bodies would come together [m/s]
/// @return what tells the load of `progress`
LoadSharing spread(const Goal& goal, double indistinct, Progress& progress);

}  // namespace tumble::contacts
