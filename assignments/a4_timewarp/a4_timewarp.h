/// Assignment 4, Timewarp: what you write. Theory, hints and points: handouts/a4_timewarp.md. Your
/// file: a4_timewarp.cpp.
///
/// The decisions of an optimistic scheduler. Every body is a logical process that advances by
/// itself, at its own local virtual time, as if nothing would hit it; what proves wrong is rolled
/// back. The framework holds the queue, the histories of states, the integration and the search for
/// impacts. You decide: which event is first? what to do with it? which processes roll back, and
/// how far? which effects on others are cancelled? up to when is everything certain? what may be
/// discarded?
///
/// Terms, symbols and sources: handouts/notation.md.
/// All functions are pure: the same data in, the same answer out. No state between calls.
/// Times are virtual times [s]. Walls have no process: they are never among `receivers` or
/// `processes`.
/// Types: framework/dynamics/scheduling.h.
/// Sources, cited below by name:
///   Jefferson  D. Jefferson, "Virtual time", ACM Transactions on Programming Languages and Systems
///              7, 1985
///   Mirtich    B. Mirtich, "Timewarp rigid body simulation", SIGGRAPH 2000
#pragma once

#include <cstdint>
#include <vector>

#include "framework/core/not_implemented.h"
#include "framework/dynamics/scheduling.h"
#include "framework/modules/module.h"

namespace tumble::a4 {

// ---- Events and their order ---------------------------------------------------------------------

/// Whether x comes before y, in one total order of all events:
///   by time, then microstep, then kind, then body_a, then body_b; the smaller first         (A4.1)
/// The queue's front, the order of what is committed, and "at a stamp and later" all mean this
/// order. It makes the result independent of the order in which impacts are found. The microstep
/// (of superdense time) comes before the bodies: at one instant an effect follows its cause.
/// @param x, y  stamps without NaN
/// @return false for x == y
/// Source: Jefferson, section 3; Mirtich, section 3.   Tests: ComesBefore.*
/// Hints: handouts/a4_timewarp.md#hint-order
bool comes_before(const Stamp& x, const Stamp& y);

/// No check waits longer than so many steps: its safe time holds global virtual time back.
inline constexpr double kMostStepsAhead = 10;

/// When a disjoint pair is checked next.
///   t' = t + min( 10 h, max( h, s ) ),   gap = v s + a s^2 / 2,
///       s = 2 gap / ( v + sqrt( v^2 + 2 a gap ) )                                           (A4.2)
/// They cannot touch before t + s. A check sooner than a step h ahead would not pay: an optimistic
/// method rolls back instead.
/// @param now                   t [s]
/// @param gap                   >= 0 [m]
/// @param closing_speed         v >= 0 [m/s]
/// @param closing_acceleration  a >= 0 [m/s^2]
/// @param step                  h > 0 [s]
/// @return t' [s]; t + h where gap = 0; t + 10 h where they can never touch (v = a = 0 < gap).
///         Never NaN
/// Source: Mirtich, section 4.   Tests: NextCheckTime.*   Hints: handouts/a4_timewarp.md#hint-check
double next_check_time(double now, double gap, double closing_speed, double closing_acceleration,
                       double step);

// ---- What to do with an event -------------------------------------------------------------------

/// A collision check was at the front of the queue; its receivers have come to its time, and
/// [safe_time, time] was searched.
///   no impact:        safe_time' = time,      time' = next_check_time( time, ... ),   no rollback
///   impact at tc:     safe_time' = time' = tc,
///       every receiver rolls back to the impact's stamp                                     (A4.3)
/// The interval begins at the safe time, so an impact usually lies in the receivers' past. The
/// check returns to the queue in either case: they may meet again.
/// @param event    kind kCollision; safe_time <= stamp.time
/// @param finding  what was found; contact->time is in the interval
/// @param step     h of (A4.2)
/// @return collides: whether there is an impact;  rollbacks: by body, ascending;  next: event with
///         its two times replaced
/// Source: Mirtich, section 4.   Tests: OnCollisionCheck.*
/// Hints: handouts/a4_timewarp.md#hint-check
CheckDecision on_collision_check(const ScheduledEvent& event, const CheckFinding& finding,
                                 double step);

/// Contact groups (islands): the connected components of the contact graph.                  (A4.4)
/// @param bodies    ascending, each once
/// @param contacts  of two of them, or of one of them and a wall (a body that is not among
///                  `bodies`), in any order. A wall connects no bodies: a hundred boxes on one
///                  floor are a hundred groups. `opens` is ignored
/// @return a partition of `bodies`: each group ascending, groups by their lowest member; a body
///         without contact is a group alone
/// Source: Mirtich, section 5.   Tests: ContactGroups.*
/// Hints: handouts/a4_timewarp.md#hint-groups
std::vector<std::vector<std::int32_t>> contact_groups(const std::vector<std::int32_t>& bodies,
                                                      const std::vector<GroupContact>& contacts);

/// A group check was at the front of the queue: does a contact within the group open in [safe_time,
/// time]?
///   none:             safe_time' = time,      time' = time + h,   the group stays, no rollback
///   the first at tc:  safe_time' = time' = tc,
///       every member rolls back to tc, and the group becomes the components of
///       the contacts that are still closed after tc                                         (A4.5)
/// Contacts that open later are ignored: after tc everything is different.
/// @param event     kind kGroup; receivers: the members, ascending
/// @param contacts  the group's; `opens` at or after safe_time
/// @param step      h > 0 [s]
/// @return changes; groups (A4.4), empty where nothing changes; rollbacks, by body, each to
///         event.stamp with tc for its time; next: event with its two times replaced
/// Source: Mirtich, section 5.   Tests: OnGroupCheck.*   Hints: handouts/a4_timewarp.md#hint-groups
GroupDecision on_group_check(const ScheduledEvent& event, const std::vector<GroupContact>& contacts,
                             double step);

/// A callback (a control law, a kick) was at the front of the queue, and may change its receivers
/// from its time on. Receivers that are later must roll back; the others need not.           (A4.6)
/// @param event        kind kCallback
/// @param local_times  of all processes, in any order
/// @return a rollback to event.stamp for each receiver whose local virtual time is later than the
///         callback; by body, ascending
/// Source: Mirtich, section 3.   Tests: OnCallback.*   Hints: handouts/a4_timewarp.md#hint-callback
std::vector<Rollback> on_callback(const ScheduledEvent& event,
                                  const std::vector<LocalTime>& local_times);

// ---- Rollback -----------------------------------------------------------------------------------

/// The anti-messages of a rollback: the body discards its effects at the rollback's stamp and
/// later, so every process that shares one of them must discard it too.
///   for each effect of the body with not (effect.stamp before rollback.stamp):
///       each other process of it rolls back to effect.stamp                                 (A4.7)
/// @param effects   executed and not committed, in any order
/// @param rollback  of one body
/// @return the anti-messages, in the order of `effects`; only the direct ones
/// Source: Jefferson, section 4.   Tests: AntiMessages.*
/// Hints: handouts/a4_timewarp.md#hint-rollback
std::vector<Rollback> anti_messages(const std::vector<Effect>& effects, const Rollback& rollback);

/// All rollbacks, and how far: the first ones, their anti-messages, the anti-messages of these, and
/// so on.                                                                                    (A4.8)
/// A body with several goes to the earliest of its stamps; a body that no chain of effects reaches
/// stays as it is.
/// @param effects  as above
/// @param first    in any order; a body may be in it more than once
/// @return by body, ascending, each once
/// Cost: a chain of 2,000 bodies within a tenth of a second
/// Source: Jefferson, section 4.   Tests: PlanRollback.*
/// Hints: handouts/a4_timewarp.md#hint-rollback
std::vector<Rollback> plan_rollback(const std::vector<Effect>& effects,
                                    const std::vector<Rollback>& first);

/// What becomes of a pending event when bodies roll back. With r the earliest time to which one of
/// its receivers rolls back:
///   a check with r < safe_time:   safe_time' = time' = r   (what was verified is void)
///   any other event:              stays as it is                                            (A4.9)
/// A rollback between safe time and time needs nothing: that interval is searched later. Callbacks
/// and redraws have fixed times, which no rollback moves.
/// @return event, with its two times replaced or not
/// Source: Mirtich, section 4.   Tests: AfterRollback.*   Hints: handouts/a4_timewarp.md#hint-after
ScheduledEvent after_rollback(const ScheduledEvent& event, const std::vector<Rollback>& rollbacks);

// ---- Global virtual time ------------------------------------------------------------------------

/// The time before which nothing can change any more.
///   GVT = min( all local virtual times, all safe times )                                   (A4.10)
/// A check may find an impact as early as its safe time, however far its bodies have advanced:
/// local times alone are not enough.
/// @return GVT [s]; +infinity where there is neither process nor event
/// Source: Jefferson, section 4; Mirtich, section 3.   Tests: GlobalVirtualTime.*
/// Hints: handouts/a4_timewarp.md#hint-gvt
double global_virtual_time(const std::vector<LocalTime>& local_times,
                           const std::vector<ScheduledEvent>& events);

/// Whether an executed event may be committed: an impact recorded, a frame shown. That cannot be
/// undone.
///   stamp.time < GVT                                                                       (A4.11)
/// At GVT itself an impact may still be found.
/// Source: Jefferson, section 4.   Tests: MayCommit.*   Hints: handouts/a4_timewarp.md#hint-gvt
bool may_commit(const Stamp& stamp, double global_virtual_time);

/// How many of a body's oldest states can be discarded (fossil collection): all before the last one
/// earlier than GVT.                                                                        (A4.12)
/// That one stays: a rollback to GVT restarts from it. A state at GVT itself may be undone.
/// @param state_times  ascending, equal ones allowed [s]
/// @return 0 where no state is earlier than GVT; never all of them
/// Source: Jefferson, section 4.   Tests: StatesToPurge.*
/// Hints: handouts/a4_timewarp.md#hint-purge
std::uint32_t states_to_purge(const std::vector<double>& state_times, double global_virtual_time);

}  // namespace tumble::a4

TUMBLE_MODULE(a4, comes_before, next_check_time, on_collision_check, contact_groups, on_group_check,
              on_callback, anti_messages, plan_rollback, after_rollback, global_virtual_time,
              may_commit, states_to_purge);
