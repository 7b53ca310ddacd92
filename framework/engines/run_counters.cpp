#include "framework/engines/run_counters.h"

namespace tumble::engines {

Counters RunCounters::named() const {
  Counters named;
  named.counts = {{"steps", steps},
                  {"shortened_steps", shortened_steps},
                  {"integrations", integrations},
                  {"undone_integrations", undone_integrations},
                  {"derivative_evaluations", derivative_evaluations},
                  {"candidate_pairs", candidate_pairs},
                  {"pair_checks", pair_checks},
                  {"gap_evaluations", collision.gap_evaluations},
                  {"root_findings", collision.root_findings},
                  {"rollbacks", rollbacks},
                  {"anti_messages", anti_messages},
                  {"states_kept", states_kept},
                  {"discontinuities", discontinuities},
                  {"impacts", impacts},
                  {"impulses", impulses},
                  {"micro_impacts", micro_impacts},
                  {"nudges", nudges},
                  {"bodies_put_to_rest", bodies_put_to_rest},
                  {"bodies_woken", bodies_woken},
                  {"gravity_calls", gravity_calls},
                  {"point_force_calls", point_force_calls},
                  {"spring_calls", spring_calls},
                  {"rod_calls", rod_calls},
                  {"joint_calls", joint_calls},
                  {"drag_calls", drag_calls},
                  {"motor_calls", motor_calls},
                  {"callback_calls", callback_calls},
                  {"constraint_solves", constraint_solves},
                  {"constraint_corrections", constraint_corrections},
                  {"contact_solves", contact_solves},
                  {"contact_points", contact_points},
                  {"contact_sweeps", contact_sweeps},
                  {"contact_factorisations", contact_factorisations},
                  {"contact_unsolved", contact_unsolved},
                  {"contacts_begun", contacts_begun},
                  {"contacts_ended", contacts_ended},
                  {"contact_landings", contact_landings},
                  {"friction_points", friction_points},
                  {"bodies_put_to_sleep", bodies_put_to_sleep},
                  {"body_steps_asleep", body_steps_asleep}};
  named.stage_seconds = {{"integration", integration_seconds},
                         {"collision", collision_seconds},
                         {"impacts", impact_seconds},
                         {"constraints", constraint_seconds},
                         {"contacts", contact_seconds},
                         {"control", control_seconds},
                         {"forces", force_seconds},
                         {"sleep", sleep_seconds},
                         {"recording", record_seconds}};
  named.notices = notices;
  return named;
}

}  // namespace tumble::engines
