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
                  {"gap_evaluations", collision.gap_evaluations},
                  {"root_findings", collision.root_findings},
                  {"rollbacks", rollbacks},
                  {"impacts", impacts},
                  {"impulses", impulses},
                  {"micro_impacts", micro_impacts},
                  {"nudges", nudges},
                  {"bodies_put_to_rest", bodies_put_to_rest},
                  {"bodies_woken", bodies_woken},
                  {"gravity_calls", gravity_calls},
                  {"point_force_calls", point_force_calls}};
  named.stage_seconds = {{"integration", integration_seconds},
                         {"collision", collision_seconds},
                         {"impacts", impact_seconds},
                         {"recording", record_seconds}};
  return named;
}

}  // namespace tumble::engines
