// Row 11: cards that lean on each other, and houses of them.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/core/files.h"
#include "tests/stability/cases.h"
#include "tests/stability/support.h"

namespace tumble::battery {
namespace {

/// Cards of length 1 m that lean at half-angle a, on each other or on a smooth wall, which is the
/// same by symmetry; they stand on, and touch by, the edges of their inner faces. By moments about
/// a foot: H cos(a) = m g (sin(a) / 2 - t cos(a) / 2), N = m g: they stand from mu = (tan(a) - t) /
/// 2.
constexpr double kThickness = 0.01;
double tent_limit(double a) { return (std::tan(a) - kThickness) / 2; }

scene::Scene tent(double a, double mu, bool wall) {
  // m: so that the two edges have a direction from one to the other
  constexpr double kApart = 1e-9;
  std::vector<scene::BodySpec> bodies;
  for (const double side : {-1.0, 1.0}) {
    if (wall && side < 0) continue;
    // Along the card, up; out of its inner face, towards the other card and down.
    const Vector3d along(-side * std::sin(a), 0, std::cos(a)),
        inner(-side * std::cos(a), 0, -std::sin(a));
    const Vector3d foot(side * (std::sin(a) + 0.5 * kApart), 0, 0);
    bodies.push_back(
        turned(rough(box(side < 0 ? "left" : "right", Vector3d(0.5 * kThickness, 0.5, 0.5), 0.1,
                         foot + 0.5 * along - 0.5 * kThickness * inner),
                     mu),
               -side * a, Vector3d::UnitY()));
  }
  bodies.push_back(floor_of(mu));
  if (wall) bodies.push_back(truths::wall("wall", Vector3d::Zero(), Vector3d::UnitX(), 0.0));
  return with_contact("card tent", std::move(bodies));
}

/// Two loose cards cut so that they stand flat on the floor and meet face to face at x = 0, with
/// corners as a .3ds file keeps them. Statics may put the floor's push at the inner end of the foot
/// and the other card's at the top: they stand from (foot - x_com) / high.
struct CutCard {
  double foot, width, low, high;  // inner end and length of the foot, ends of the upper face [m]
  Vector3d com() const {          // a right-angled triangle without a smaller one
    const double outer = foot + width, whole = outer * high, inner = foot * low;
    return {(whole * outer - inner * foot) / (3 * (whole - inner)), 0.0,
            (whole * high - inner * low) / (3 * (whole - inner))};
  }
  double limit() const { return (foot - com().x()) / high; }
};

CutCard cut_card(double a) {
  const auto kept = [](double v) { return static_cast<double>(static_cast<float>(v)); };
  const double foot = kept(std::sin(a)), outer = kept(std::sin(a) + kThickness / std::cos(a));
  return {foot, outer - foot, kept(foot / std::tan(a)), kept(outer / std::tan(a))};
}

std::filesystem::path write_card(const CutCard& card, const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "card.3ds";
  write_prism({{card.foot, 0.0}, {card.foot + card.width, 0.0}, {0.0, card.high}, {0.0, card.low}},
              0.5, file);
  return file;
}

std::vector<scene::BodySpec> cards_of_tent(const CutCard& card, double mu, const Vector3d& at,
                                           const std::filesystem::path& file,
                                           const std::string& suffix = "") {
  std::vector<scene::BodySpec> bodies;
  for (const double side : {1.0, -1.0}) {
    scene::BodySpec body = rough(box((side > 0 ? "right" : "left") + suffix, Vector3d::Ones(), 0.1,
                                     at + Vector3d(side * card.com().x(), 0, card.com().z())),
                                 mu);
    body.shape = scene::ModelSpec{file.string(), "", 1.0};
    if (side < 0) body.world_from_body = Quaterniond(0, 0, 0, 1);  // half a turn about z
    bodies.push_back(body);
  }
  return bodies;
}

scene::Scene cut_tent(double a, double part, const std::filesystem::path& folder) {
  const CutCard card = cut_card(a);
  std::vector<scene::BodySpec> bodies =
      cards_of_tent(card, part * card.limit(), Vector3d::Zero(), write_card(card, folder));
  bodies.push_back(floor_of(1.0));
  return with_contact("cut tent", std::move(bodies));
}

void two_loose_cards(const Given& given, Findings& findings) {
  const PrivateFolder folder;
  for (const double part : {1.1, 0.9}) {
    const std::string name =
        fmt::format("tent of two loose cards, half-angle 0.4, mu = {:g} of the limit", part);
    findings.part(name, [&] {
      const double duration = part < 1 ? 0.6 : given.is_long ? 10.0 : 2.0;
      const Trajectory run =
          run_by_steps(cut_tent(0.4, part, folder.path()), given.laws, duration, 1.0 / 240, 200);
      const double way = std::max(drift_of(run, 0), drift_of(run, 1));
      if (part > 1)
        findings.at_most(name + ": creep", way, 1e-3, "m",
                         "static: 1e-3 of a card's length in 10 s");
      else
        findings.must_fail(name + ": stands", way, 1e-3, "m", "friction a tenth too small");
    });
  }
  findings.part("fall of the two loose cards, 2 s", [&] {
    const Trajectory run =
        run_by_steps(cut_tent(0.4, 0.9, folder.path()), given.laws, 2.0, 1.0 / 240, 200);
    findings.at_most("fall of the two loose cards, 2 s: rise of the energy", energy_rise(run), 1e-6,
                     "", "plastic impacts and friction only take");
  });
}

/// Tents side by side on each level, one fewer on the next, which stands on a plank that lies on
/// the tops.
scene::Scene card_house(double a, double mu, int levels, const std::filesystem::path& folder) {
  const CutCard card = cut_card(a);
  const std::filesystem::path file = write_card(card, folder);
  const double apart = 2 * (card.foot + card.width) + 0.02, plank = 0.5 * kThickness;
  std::vector<scene::BodySpec> bodies;
  for (int level = 0; level < levels; ++level) {
    const double base = level * (card.high + 2 * plank);
    const int tents = levels - level;
    for (int k = 0; k < tents; ++k)
      for (scene::BodySpec& body :
           cards_of_tent(card, mu, Vector3d((k - 0.5 * (tents - 1)) * apart, 0, base), file,
                         fmt::format(" {}.{}", level + 1, k + 1)))
        bodies.push_back(std::move(body));
    if (tents == 1) break;
    const double half = 0.5 * (tents - 1) * apart + 0.1;
    bodies.push_back(rough(box(fmt::format("plank {}", level + 1), Vector3d(half, 0.5, plank),
                               0.2 * half, Vector3d(0, 0, base + card.high + plank)),
                           mu));
  }
  bodies.push_back(floor_of(1.0));
  return with_contact("card house", std::move(bodies));
}

/// What a house gains where it becomes a large island, over its energy. Bodies of one are kept
/// 1e-4 of the smaller's radius apart (large_island_margin in
/// framework/engines/contact/contact_constants.h): each is lifted by as much for each contact
/// between it and the floor, and nobody pays for that. 1e-6 beside it are roundings.
double lift_into_large_island(const scene::Scene& house, double energy) {
  constexpr std::size_t kFewBodies = 12;
  constexpr double kMargin = 1e-4;
  if (house.bodies.size() - 1 <= kFewBodies) return 0.0;  // without the floor
  const double level = cut_card(0.4).high + kThickness, radius = std::hypot(0.5, 0.5);
  double gained = 0.0;
  for (const scene::BodySpec& body : house.bodies) {
    // a card's centre lies in the lower half of its level, a plank's at the level's end
    const double below = std::ceil(2 * body.position_m.z() / level);
    gained += body.mass_kg.value_or(0.0) * kG * below * kMargin * radius;
  }
  return gained / energy;
}

/// However the load is shared: a card that carries nothing at its top stands from limit(), one that
/// carries any load from foot / high.
void card_house(const Given& given, Findings& findings, int levels) {
  const PrivateFolder folder;
  const CutCard card = cut_card(0.4);
  const double duration = given.is_long ? 10.0 : 0.5;
  const std::string name = fmt::format("house of {} levels, half-angle 0.4, ", levels);
  const auto way = [](const Trajectory& run) {
    double farthest = 0.0;
    for (std::size_t i = 0; i + 1 < run.frames.front().poses.size(); ++i)
      farthest = std::max(farthest, drift_of(run, i));
    return farthest;
  };
  const Trajectory stands =
      run_by_steps(card_house(0.4, 1.1 * card.foot / card.high, levels, folder.path()), given.laws,
                   duration, 1.0 / 240, 100);
  findings.at_most(name + fmt::format("mu = 1.1 foot / height, {:g} s: creep", duration),
                   way(stands), 1e-3, "m",
                   given.is_long ? "static under any load: 1e-3 of a card's length in 10 s"
                                 : "static under any load: 1e-3 of a card's length");
  findings.at_least(name + "smallest gap", smallest_gap(stands), 0.0, "m",
                    "nothing interpenetrates");
  constexpr double fall_s = 0.3;
  // impacts of many cards at once come in another order at every step
  for (const int rate : {240, 333}) {
    const scene::Scene house = card_house(0.4, 0.9 * card.limit(), levels, folder.path());
    const Trajectory falls = run_by_steps(house, given.laws, fall_s, 1.0 / rate, 100);
    const std::string fall =
        name +
        fmt::format("mu = 0.9 of the limit of a free tent, {:g} s at 1/{} s: ", fall_s, rate);
    findings.must_fail(fall + "stands", way(falls), 1e-3, "m",
                       "friction too small for the lightest load");
    findings.at_most(fall + "way of any card", way(falls), 0.5 * kG * fall_s * fall_s, "m",
                     "g t^2 / 2: none is thrown farther than it could fall");
    findings.at_most(
        fall + "rise of the energy", energy_rise(falls),
        1e-6 + lift_into_large_island(house, energy_of(falls.frames.front())), "",
        "friction and plastic impacts only take; where a house becomes a large island, "
        "its bodies are lifted to their margins once");
  }
}

/// Two loose cards that touch by their upper edges alone: the direction between the edges is no
/// more than rounding, and whatever normal follows it lets the tent fold sideways.
void edge_on_edge(const Given& given, Findings& findings) {
  for (const double a : {0.2, 0.4}) {
    for (const double part : {1.1, 0.9}) {
      const std::string name = fmt::format(
          "two loose cards, edge on edge, half-angle {:g}, mu = {:g} of the limit", a, part);
      findings.part(name, [&] {
        const double duration = part < 1 ? 0.6 : given.is_long ? 10.0 : 2.0;
        const Trajectory run = run_by_steps(tent(a, part * tent_limit(a), false), given.laws,
                                            duration, 1.0 / 240, 200);
        const double way = std::max(drift_of(run, 0), drift_of(run, 1));
        if (part > 1)
          findings.at_most(name + ": creep", way, 1e-3, "m",
                           "the same structure as the card on a smooth wall, by symmetry");
        else
          findings.must_fail(name + ": stands", way, 1e-3, "m", "friction a tenth too small");
        findings.at_least(name + ": smallest gap", smallest_gap(run), 0.0, "m",
                          "nothing interpenetrates");
        if (part < 1)
          findings.at_most(name + ": rise of the energy", energy_rise(run), 1e-6, "",
                           "friction and plastic impacts only take");
      });
    }
  }
}

void card_tent(const Given& given, Findings& findings) {
  report::Plot plot{"Card on a smooth wall, half-angle 0.4: way of its foot",
                    {"time", "s"},
                    {"way", "m", report::Scale::kLog},
                    {},
                    {{1e-3, "threshold"}},
                    "A tenth above the limit it stands without creeping, a tenth below it slides."};
  for (const double a : {0.2, 0.4}) {
    for (const double part : {1.1, 0.9}) {
      const std::string name =
          fmt::format("card on a smooth wall, half-angle {:g}, mu = {:g} of the limit", a, part);
      findings.part(name, [&] {
        const Trajectory run = run_by_steps(tent(a, part * tent_limit(a), true), given.laws,
                                            given.is_long ? 10.0 : 2.0, 1.0 / 240, 200);
        const double way = drift_of(run, 0);
        if (part > 1)
          findings.at_most(name + ": creep", way, 1e-3, "m",
                           "static: 1e-3 of a card's length in 10 s");
        else
          findings.at_least(name + ": slides down", way, 0.2, "m",
                            "below the limit the feet go apart until the cards lie");
        if (part < 1)
          findings.must_fail(name + ": stands", way, 1e-3, "m", "friction a tenth too small");
        if (a == 0.4)
          plot.curves.push_back(
              curve_of(fmt::format("{:g} of the limit", part), run, [&](const Frame& f) {
                return std::max(
                    1e-12, (f.poses[0].com_world - run.frames.front().poses[0].com_world).norm());
              }));
      });
    }
  }
  findings.part("two loose cards", [&] { two_loose_cards(given, findings); });
  findings.part("two loose cards, edge on edge", [&] { edge_on_edge(given, findings); });
  findings.plot(std::move(plot));
  findings.part("house of 2 levels", [&] { card_house(given, findings, 2); });
  for (const int levels : {3, 4})
    if (given.is_long)
      findings.part(fmt::format("house of {} levels", levels),
                    [&] { card_house(given, findings, levels); });
}

}  // namespace

void add_cards(std::vector<Case>& cases) {
  cases.push_back(
      {11, "card house",
       "Two cards that lean on each other stand if their friction is at least half the tangent of "
       "their angle. Solvers that correct velocities a little at every step let them creep apart.",
       "a1 a3", card_tent});
}

}  // namespace tumble::battery
