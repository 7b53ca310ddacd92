/// From the numbers of a chain to worlds and back: what is believed of them, the scene that they
/// make, and how far the end of its run is from what is asked.
#pragma once

#include "framework/core/random.h"
#include "framework/dynamics/sampling.h"
#include "framework/engines/base/run_options.h"
#include "framework/scene/sampling_spec.h"
#include "framework/scene/scene.h"
#include "framework/trajectory/trajectory.h"

namespace tumble::sampling {

/// A scene, and in what its worlds differ.
struct SampledScene {
  scene::Scene scene;
  scene::SamplingSpec sampling;
};

/// By number, in the order of the scene's entries.
std::vector<Prior> priors_of(const SampledScene& sampled);
Proposal proposal_of(const SampledScene& sampled);
/// "slab 2 restitution", by number.
std::vector<std::string> names_of(const SampledScene& sampled);

/// A world that the prior says, by inverse distributions: one uniform number each.
VectorXd drawn_from_prior(const std::vector<Prior>& priors, Random& random);

/// The scene with these numbers.
/// @pre one number for each entry, inside its bounds
scene::Scene world_of(const SampledScene& sampled, const VectorXd& x);

/// How far a last frame is from what is asked: the root of the sum of squares of what each
/// condition lacks, in multiples of its softness [-]; 0 where all are met.
double violation_of(const SampledScene& sampled, const Frame& last);

/// A world's run to its end.
struct WorldEnd {
  double violation = kUnset;  // NaN: the run broke
  std::string stopped_by;     // why; empty: it did not
};

/// Runs the world of these numbers.
/// @param options  frames but the last are not asked for
WorldEnd end_of(const SampledScene& sampled, const Laws& laws, engines::RunOptions options,
                const VectorXd& x);
/// The same with every frame kept, for pictures.
Trajectory run_of(const SampledScene& sampled, const Laws& laws, const engines::RunOptions& options,
                  const VectorXd& x);

}  // namespace tumble::sampling
