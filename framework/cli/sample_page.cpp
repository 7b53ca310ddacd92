#include "framework/cli/sample_page.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/cli/record.h"
#include "framework/cli/spread_words.h"
#include "framework/render/picture.h"
#include "framework/report/html.h"
#include "framework/report/player.h"
#include "framework/sampling/overlay.h"

namespace tumble::cli {
namespace {

namespace fs = std::filesystem;
using report::Curve;
using report::Plot;
using report::Scale;
using sampling::Answers;
using sampling::Chain;

constexpr std::size_t kOverlaid = 8;     // runs of worlds that do what is asked
constexpr std::size_t kOverlaidNot = 3;  // and of worlds that do not
const Vector3d kDone(0.02, 0.35, 0.28), kNotDone(0.75, 0.62, 0.55);  // linear RGB

/// Samples of all chains, evenly spaced, that do what is asked or do not.
std::vector<VectorXd> chosen(const std::vector<Chain>& chains, bool is_done, std::size_t most) {
  std::vector<VectorXd> all;
  for (const Chain& chain : chains)
    for (Eigen::Index i = 0; i < chain.x.rows(); ++i) {
      const bool is_new = i == 0 || chain.x.row(i) != chain.x.row(i - 1);
      if (is_new && std::isfinite(chain.violation[i]) && (chain.violation[i] == 0.0) == is_done)
        all.push_back(chain.x.row(i).transpose());
    }
  std::vector<VectorXd> few;
  for (std::size_t i = 0; i < std::min(most, all.size()); ++i)
    few.push_back(all[i * all.size() / std::min(most, all.size())]);
  return few;
}

/// None where every world that the chains kept broke.
std::vector<sampling::OverlaidRun> overlaid(const Sampled& sampled) {
  std::vector<sampling::OverlaidRun> runs;
  for (const bool is_done : {true, false})
    for (const VectorXd& x : chosen(sampled.chains, is_done, is_done ? kOverlaid : kOverlaidNot))
      runs.push_back({sampling::run_of(sampled.worlds, sampled.chosen.laws, sampled.run, x),
                      is_done ? kDone : kNotDone});
  return runs;
}

Plot trace_of(const Sampled& sampled, const std::string& name, const std::string& unit,
              const std::function<double(const Chain&, Eigen::Index)>& value) {
  Plot plot{"Trace: " + name, {"step"}, {name, unit}, {}, {}};
  for (const Chain& chain : sampled.chains) {
    Curve curve{fmt::format("chain {}", chain.number + 1), {}, {}};
    for (Eigen::Index i = 0; i < chain.x.rows(); ++i) {
      curve.x.push_back(static_cast<double>(i + 1));
      curve.y.push_back(value(chain, i));
    }
    if (plot.curves.size() < 8) plot.curves.push_back(std::move(curve));
  }
  return plot;
}

Plot error_against_time(const Sampled& sampled, std::size_t number) {
  Plot plot{"What accuracy costs: " + sampled.names[number],
            {"CPU time", "s", Scale::kLog},
            {"standard error of the mean", "-", Scale::kLog},
            {},
            {}};
  const auto curve_of = [&](const std::string& name, const std::vector<Answers>& growing) {
    Curve curve{name, {}, {}, true};
    for (const Answers& answers : growing) {
      curve.x.push_back(answers.cpu_s);
      curve.y.push_back(answers.estimates[number].answer.standard_error);
    }
    plot.curves.push_back(std::move(curve));
  };
  curve_of("chains", sampled.growing);
  if (sampled.prior) curve_of("worlds of the prior, those kept that do it", sampled.prior_growing);
  plot.caption =
      "Standard error of the mean among worlds that do what is asked, by the first 1/32, 1/16, ... "
      "of all samples. One digit more costs a hundred times as much.";
  return plot;
}

report::Table estimates(const Sampled& sampled) {
  report::Table table;
  table.caption = "Means among the worlds that do what is asked, with their Monte Carlo errors.";
  table.columns = {{"Number"},
                   {"Prior", true},
                   {"Mean", true},
                   {"Deviation", true},
                   {"Effective samples", true},
                   {"R-hat", true}};
  if (sampled.prior) {
    table.columns.push_back({"By the prior alone", true});
    table.columns.push_back({"Errors apart", true});
  }
  const std::vector<Prior> priors = sampling::priors_of(sampled.worlds);
  const Answers& answers = sampled.growing.back();
  for (std::size_t i = 0; i < sampled.names.size(); ++i) {
    const sampling::Estimate& estimate = answers.estimates[i];
    const Prior& prior = priors[i];
    std::vector<report::Cell> row = {
        {sampled.names[i]},
        {prior.kind == PriorKind::kNormal
             ? fmt::format("{:.4g} \u00b1 {:.2g}", prior.mean, prior.deviation)
             : fmt::format("{:.4g} to {:.4g}", prior.low, prior.high)},
        {with_error(estimate.answer)},
        {fmt::format("{:.3g}", estimate.answer.deviation)},
        {fmt::format("{:.0f}", estimate.answer.effective_samples)},
        {fmt::format("{:.3f}", estimate.r_hat), "",
         estimate.r_hat < 1.05 ? report::Look::kPlain : report::Look::kWarning}};
    if (sampled.prior) {
      const Answer& other = sampled.prior_growing.back().estimates[i].answer;
      const double apart = errors_apart(estimate.answer, other);
      row.push_back({with_error(other)});
      row.push_back({fmt::format("{:.1f}", apart), "",
                     apart <= 3.0 ? report::Look::kPlain : report::Look::kWarning});
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// The answer that the chains know worst, relative to its deviation.
std::size_t hardest(const Answers& answers) {
  std::size_t worst = 0;
  for (std::size_t i = 0; i < answers.estimates.size(); ++i)
    if (answers.estimates[i].answer.effective_samples <
        answers.estimates[worst].answer.effective_samples)
      worst = i;
  return worst;
}

}  // namespace

std::string with_error(const Answer& answer) {
  if (!std::isfinite(answer.mean)) return "unknown";
  if (!std::isfinite(answer.standard_error))
    return fmt::format("{:.4g}, error unknown", answer.mean);
  const int digits =
      answer.standard_error > 0.0
          ? std::clamp(1 - static_cast<int>(std::floor(std::log10(answer.standard_error))), 0, 12)
          : 6;
  return fmt::format("{:.{}f} \u00b1 {:.{}f}", answer.mean, digits, answer.standard_error, digits);
}

double errors_apart(const Answer& a, const Answer& b) {
  return std::abs(a.mean - b.mean) / std::hypot(a.standard_error, b.standard_error);
}

void write_sample_page(const Context& context, const Sampled& sampled, const fs::path& folder) {
  fs::create_directories(folder);
  const Answers& answers = sampled.growing.back();
  report::Page page(sampled.worlds.scene.title, sampled.worlds.scene.about);
  page.tiles({{"worlds that do it", {fmt::format("{} of {}", answers.done, answers.samples)}},
              {"proposals accepted", {fmt::format("{:.0f} %", 100 * answers.acceptance)}},
              {"effective samples a second",
               {fmt::format("{:.3g}", answers.least_effective / answers.cpu_s)}},
              {"largest R-hat", {fmt::format("{:.3f}", answers.worst_r_hat)}}});
  page.paragraph(
      fmt::format("{} chains by the functions of {}; {} simulations in {:.3g} s of CPU time{}.",
                  sampled.chains.size(), sampled.source, answers.simulations, answers.cpu_s,
                  answers.broken > 0 ? fmt::format(", of which {} broke", answers.broken) : ""));
  if (const std::string lost = lost_in_words(sampled.outcome, "chain"); !lost.empty())
    page.paragraph(lost, report::Look::kBad);
  for (const std::string& doubt : sampling::doubts(answers, sampled.chains.size()))
    page.paragraph(doubt, report::Look::kWarning);
  if (const auto runs = overlaid(sampled); runs.empty()) {
    page.paragraph("No world of these chains ran to its end: there is none to show.",
                   report::Look::kWarning);
  } else {
    const sampling::Overlay overlay = sampling::overlay_of(sampled.worlds.scene, runs);
    render::PictureOptions options;
    options.root = context.root;
    options.marks = false;
    const double end = overlay.run.frames.back().time;
    render::write_picture(folder / "worlds.png", overlay.scene, overlay.run, end, options);
    report::PlayerOptions player;
    player.root = context.root;
    report::write_player(folder / "worlds.html", overlay.scene, {{overlay.run, "worlds"}}, player);
    page.heading("Worlds");
    page.figures({{"worlds.png", "",
                   fmt::format("Runs of up to {} sampled worlds that do what is asked (green), and "
                               "up to {} that do not (pale), at their end; a click plays them",
                               kOverlaid, kOverlaidNot),
                   "", report::link_to("worlds.html")}});
  }
  page.heading("Answers");
  page.table(estimates(sampled));
  const std::size_t number = hardest(answers);
  page.heading("What accuracy costs");
  page.plot(error_against_time(sampled, number));
  page.heading("Traces");
  page.plot(trace_of(sampled, sampled.names[number], "-", [&](const Chain& chain, Eigen::Index i) {
    return chain.x(i, static_cast<Eigen::Index>(number));
  }));
  page.plot(trace_of(sampled, "ln of the target", "-",
                     [](const Chain& chain, Eigen::Index i) { return chain.log_target[i]; }));
  page.record(record_of(context, sampled.worlds.scene));
  page.write(folder / "index.html");
}

}  // namespace tumble::cli
