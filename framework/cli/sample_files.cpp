#include "framework/cli/sample_files.h"

#include <nlohmann/json.hpp>

#include "framework/cli/json_output.h"
#include "framework/core/files.h"
#include "framework/core/version.h"
#include "framework/sampling/kept_chain.h"

namespace tumble::cli {
namespace {

using nlohmann::ordered_json;
using sampling::Answers;

ordered_json json_of(const Answer& answer) {
  ordered_json json;
  json["mean"] = answer.mean;
  json["deviation"] = answer.deviation;
  json["effective_samples"] = answer.effective_samples;
  json["standard_error"] = answer.standard_error;
  return json;
}

}  // namespace

ordered_json json_of(const Answers& answers) {
  ordered_json json;
  json["samples"] = answers.samples;
  json["done"] = answers.done;
  json["simulations"] = answers.simulations;
  json["broken"] = answers.broken;
  json["acceptance"] = answers.acceptance;
  json["worst_r_hat"] = answers.worst_r_hat;
  json["share_done"] = json_of(answers.share);
  json["numbers"] = ordered_json::array();
  for (const sampling::Estimate& estimate : answers.estimates) {
    ordered_json one = json_of(estimate.answer);
    one["r_hat"] = estimate.r_hat;
    one["name"] = estimate.name;
    json["numbers"].push_back(one);
  }
  return json;
}

ordered_json times_of(const Answers& answers) {
  ordered_json json;
  json["cpu_s"] = answers.cpu_s;
  json["samples_a_second"] = answers.samples / answers.cpu_s;
  json["simulations_a_second"] = answers.simulations / answers.cpu_s;
  json["effective_samples_a_second"] = answers.least_effective / answers.cpu_s;
  return json;
}

void write_sample_files(const Context& context, const Sampled& sampled,
                        const std::filesystem::path& folder) {
  const scene::Scene& scene = sampled.worlds.scene;
  ordered_json answers{{"version", kProgramVersion},
                       {"scene", scene.name},
                       {"scene_digest", scene.digest},
                       {"seed", sampled.options.seed},
                       {"functions", sampled.source},
                       {"impulse_source", sampled.chosen.laws.impulse_source},
                       {"integrator_source", sampled.chosen.laws.integrator_source},
                       {"constraint_source", sampled.chosen.laws.constraint_source},
                       {"chains", sampled.chains.size()},
                       {"lost", ordered_json::array()},
                       {"answers", json_of(sampled.growing.back())},
                       {"doubts", sampling::doubts(sampled.growing.back(), sampled.chains.size())}};
  for (const farm::Lost& lost : sampled.outcome.lost) answers["lost"].push_back(lost.name);
  ordered_json times{{"command", context.command_line},
                     {"version", kProgramVersion},
                     {"times", times_of(sampled.growing.back())}};
  if (sampled.prior) {
    answers["prior"] = json_of(sampled.prior_growing.back());
    times["times_of_prior"] = times_of(sampled.prior_growing.back());
  }
  write_whole(folder / "answers.json", json_text(answers, 1) + '\n');
  write_whole(folder / "times.json", json_text(times, 1) + '\n');
  write_whole(folder / "chains.csv", sampling::csv_of(sampled.names, sampled.chains));
}

}  // namespace tumble::cli
