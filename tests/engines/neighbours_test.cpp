// A body in free flight, at rest or asleep costs the same beside a pile as alone: it pays nothing
// for its neighbours' contacts.
//
// Retroactive detection (rd) takes all bodies to a common time at every discontinuity, by its
// definition: a body in flight costs one integration for each start from that time and one for each
// stop at it, and nothing else. The same holds for conservative advancement (ca), which moves all
// bodies to every event. Timewarp (tw) has no common times.
#include <algorithm>

#include <gtest/gtest.h>

#include "framework/dynamics/solve_contacts.h"
#include "framework/engines/timewarp/fast_timewarp.h"
#include "tests/engines/reference_laws.h"

namespace tumble::testing {
namespace {

using Counts = std::map<std::string, std::uint64_t>;
enum class Others { kNone, kFlying, kLying };
constexpr int kOthers = 4;
constexpr double kMassOfOthers = 3.0;  // kg: identifies them in calls of laws

/// Five boxes that tumble onto a floor and onto each other, and slide: impacts, and contacts that
/// begin, open and stop sliding.
void add_pile(scene::Scene& scene, double height, double apart) {
  for (int i = 0; i < 5; ++i) {
    scene.bodies.push_back(box("crate " + std::to_string(i), {0.2, 0.2, 0.2}, 1.0,
                               {0.1 * i, 0.05 * i, height + apart * i}, {1.0, 0, 0}));
    scene.bodies.back().omega_world_rad_s = {0.3 * i, 0.2, 0.1};
    scene.bodies.back().restitution = 0.3;
  }
}

/// A hundred metres from the pile.
void add_others(scene::Scene& scene, Others others) {
  if (others == Others::kNone) return;
  for (int i = 0; i < kOthers; ++i) {
    const Vector3d place(100.0 + 10 * i, 0, others == Others::kFlying ? 1000.0 : 0.2);
    scene.bodies.push_back(
        box("other " + std::to_string(i), {0.1, 0.2, 0.2}, kMassOfOthers, place, Vector3d::Zero()));
    if (others == Others::kFlying) scene.bodies.back().omega_world_rad_s = {0.1, 0.2, 0.3};
  }
}

scene::Scene scene_with(bool pile, Others others, double height = 0.5, double apart = 0.6,
                        bool sleep = false) {
  scene::Scene scene =
      scene_of({plane("floor", Vector3d::Zero(), Vector3d::UnitZ())}, 1.2, Vector3d(0, 0, -9.81));
  if (pile) add_pile(scene, height, apart);
  add_others(scene, others);
  for (scene::BodySpec& body : scene.bodies) body.friction = 0.4;
  scene.contact.emplace();
  scene.contact->sleep = sleep;
  return scene;
}

Counts counts_of(const scene::Scene& scene, const std::string& engine,
                 const Laws& laws = reference_laws()) {
  TrajectoryRecorder recorder;
  engines::RunOptions options;
  options.engine = engine;
  options.timewarp = engines::fast_timewarp();
  engines::run_scene(scene, laws, options, recorder);
  EXPECT_EQ(recorder.trajectory().stopped_by, "");
  return recorder.trajectory().counters.counts;
}

/// Counters of common times and of the largest number of states: an engine pays them per body of
/// the world.
bool is_of_the_world(const std::string& counter) {
  return counter == "steps" || counter == "synchronisations" || counter == "states_kept" ||
         counter == "most_states_of_a_body";
}

/// 0 for a counter that was never used.
std::uint64_t count_in(const Counts& counts, const std::string& name) {
  const auto found = counts.find(name);
  return found == counts.end() ? 0 : found->second;
}

/// Every count of `both` is the sum of the pile's and the others', except those named.
void expect_sum(const Counts& pile, const Counts& alone, const Counts& both,
                const std::vector<std::string>& except, const std::string& story) {
  for (const auto& [name, count] : both)
    if (!is_of_the_world(name) && std::find(except.begin(), except.end(), name) == except.end()) {
      EXPECT_EQ(count, count_in(pile, name) + count_in(alone, name)) << name << ", " << story;
    }
  EXPECT_GT(pile.at("contacts_begun"), 0u);
  EXPECT_GT(pile.at("impacts"), 0u);
}

// Counts of both add up exactly. The engine chooses the distance of an advance, and with it the
// number of checks, by the mean distance of all bodies, which far bodies enlarge: half the distance
// costs 10 %.
TEST(Neighbours, InTimewarpABodyInFlightOrAtRestPaysNothingForAPile) {
  constexpr double kOfLengths = 0.1;
  const std::vector<std::string> looks = {"integrations", "pair_checks", "gap_evaluations"};
  const Counts pile = counts_of(scene_with(true, Others::kNone), "tw");
  for (const Others others : {Others::kFlying, Others::kLying}) {
    const std::string story = others == Others::kFlying ? "in flight" : "at rest";
    const Counts alone = counts_of(scene_with(false, others), "tw"),
                 both = counts_of(scene_with(true, others), "tw");
    expect_sum(pile, alone, both, looks, story);
    for (const std::string& look : looks) {
      const double sum = static_cast<double>(pile.at(look) + alone.at(look));
      EXPECT_LE(static_cast<double>(both.at(look)), (1 + kOfLengths) * sum)
          << look << ", " << story;
    }
  }
}

// In conservative advancement a body costs one position per event.
TEST(Neighbours, InConservativeAdvancementABodyPaysItsPlaceAtEveryEventAndNothingElse) {
  const Counts pile = counts_of(scene_with(true, Others::kNone), "ca");
  for (const Others others : {Others::kFlying, Others::kLying}) {
    const Counts alone = counts_of(scene_with(false, others), "ca"),
                 both = counts_of(scene_with(true, others), "ca");
    const std::string story = others == Others::kFlying ? "in flight" : "at rest";
    expect_sum(pile, alone, both, {"integrations"}, story);
    const std::uint64_t places =
        both.at("integrations") - pile.at("integrations") - alone.at("integrations");
    EXPECT_EQ(places % kOthers, 0u) << story;
    EXPECT_LE(places / kOthers, pile.at("discontinuities") + pile.at("steps")) << story;
  }
}

TEST(Neighbours, InRetroactiveDetectionABodyInFlightPaysForCommonTimesAndNothingElse) {
  const Counts pile = counts_of(scene_with(true, Others::kNone), "rd"),
               alone = counts_of(scene_with(false, Others::kFlying), "rd"),
               both = counts_of(scene_with(true, Others::kFlying), "rd");
  const std::vector<std::string> paid = {"integrations", "undone_integrations",
                                         "derivative_evaluations", "gravity_calls"};
  expect_sum(pile, alone, both, paid, "in flight");
  for (const char* same : {"steps", "synchronisations"})
    EXPECT_EQ(both.at(same), pile.at(same)) << same;
  // From every common time once to the end of the step, if its position there is needed; where the
  // pile stops it, once to that time. Contacts that repeat a step need nothing of it.
  const std::uint64_t integrations = both.at("integrations") - pile.at("integrations");
  EXPECT_LE(integrations, kOthers * (both.at("steps") + both.at("synchronisations")));
  EXPECT_GE(integrations, kOthers * both.at("steps"));
  // a step of Runge and Kutta
  EXPECT_EQ(both.at("gravity_calls") - pile.at("gravity_calls"), 4 * integrations);
  EXPECT_EQ(alone.at("integrations"), kOthers * alone.at("steps"));
  EXPECT_EQ(alone.at("synchronisations"), 0u);
  // the pile has repeated steps
  EXPECT_GT(both.at("contact_activations") + both.at("contacts_begun"), 10u);
}

// They rest and fall asleep while the crates are still high above the floor.
TEST(Neighbours, ABodyAsleepPaysNothingForAPile) {
  // m: 0.8 s, during which no crate's box touches another's
  constexpr double kHigh = 3.5, kApart = 0.8;
  const auto counts = [&](bool pile, Others others) {
    scene::Scene scene = scene_with(pile, others, kHigh, kApart, true);
    scene.duration_s = 1.5;
    return counts_of(scene, "rd");
  };
  const Counts pile = counts(true, Others::kNone), alone = counts(false, Others::kLying),
               both = counts(true, Others::kLying);
  EXPECT_EQ(alone.at("bodies_put_to_sleep"), static_cast<std::uint64_t>(kOthers));
  expect_sum(pile, alone, both, {}, "asleep");
}

/// Reference laws that count their calls for the others, recognised by their mass.
Laws counting(std::uint64_t& derivatives, std::uint64_t& contact_rows) {
  Laws laws = reference_laws();
  laws.state_derivative = [&derivatives, ask = laws.state_derivative](const RigidBodyState& state,
                                                                      const Inertia& inertia,
                                                                      const Wrench& wrench) {
    if (inertia.mass == kMassOfOthers) ++derivatives;
    return ask(state, inertia, wrench);
  };
  laws.friction_impulses = [&contact_rows](const ContactProblem& problem,
                                           const ContactOptions& options) {
    for (const PushingContact& contact : problem.contacts)
      for (const int body : {contact.body_a, contact.body_b})
        if (problem.bodies[body].inverse_mass == 1.0 / kMassOfOthers) ++contact_rows;
    return solve_contacts(problem, options);
  };
  return laws;
}

// The pile's common times are their steps too. A repeated step within the pile (impacts, ends of
// sliding) does not solve their contacts again; a resting box has a rotation of rounding size, so
// that its path is sampled four times per step, as for any body that may collide.
TEST(Neighbours, InRetroactiveDetectionABodyAtRestPaysForCommonTimesOnly) {
  constexpr std::uint64_t kCorners = 4, kStages = 4, kLooks = 4;
  std::uint64_t derivatives = 0, rows = 0;
  const Counts both =
      counts_of(scene_with(true, Others::kLying), "rd", counting(derivatives, rows));
  const std::uint64_t begun = both.at("steps"), stopped = both.at("synchronisations");
  EXPECT_GE(rows, kOthers * kCorners * begun / 2);  // it is in contact
  EXPECT_LE(rows, kOthers * kCorners * (begun + stopped));
  EXPECT_LE(derivatives, kOthers * kStages * (begun * (1 + kLooks) + stopped));
}

}  // namespace
}  // namespace tumble::testing
