// An effect that asks a function of an assignment: all that is known of its law stands here, beside
// the effect, and what binds, refuses, guards and records laws works for it without knowing it.
#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "framework/effects/listed_effect.h"
#include "framework/effects/registry.h"
#include "framework/modules/bind_laws.h"
#include "tests/engines/scenes.h"

namespace tumble::effects {
namespace {

/// Drag of a plate: F = what the law plate_drag says, on the centre of mass.
struct PlateSpec {
  std::string body;
  double area_m2 = 1.0;
  std::string pointer{};
};
struct Plate {
  int body;
  double area;  // [m^2]
};
struct PlateDrag {
  using Function = Vector3d(const Vector3d& velocity_world, double area);
  static constexpr LawWords kWords{.function = "plate_drag",
                                   .effect = "drag of plates",
                                   .what = "the drag of a plate",
                                   .assignment = "a6"};
  static std::string fault(const Vector3d& drag, const Vector3d& velocity_world, double) {
    return drag.dot(velocity_world) > 0 ? "a drag that drives the plate" : "";
  }
};

class PlateTerms final : public GroupTerms {
 public:
  PlateTerms(const Acting& acting, const std::vector<int>& entries, GroupPlaces& places)
      : drag_(acting.laws.of<PlateDrag>()), calls_(acting.calls) {
    for (const int entry : entries) {
      const Plate& plate = acting.world.effects.of<Plate>()[static_cast<std::size_t>(entry)];
      plates_.push_back({places.place_of(plate.body), plate.area});
    }
  }
  void add_forces(const std::vector<Body>& bodies, std::vector<Wrench>& wrenches) override {
    for (const Plate& plate : plates_) {
      ++calls_;
      const auto place = static_cast<std::size_t>(plate.body);
      wrenches[place].force_world += drag_(bodies[place].velocity_world, plate.area);
    }
  }

 private:
  const LawFunction<PlateDrag>& drag_;
  std::uint64_t& calls_;
  std::vector<Plate> plates_;
};

class PlateEffect final : public ListedEffect<PlateSpec, Plate> {
 public:
  std::string name() const override { return "plate"; }
  std::string key() const override { return "plates"; }
  std::string stage() const override { return "forces"; }
  std::string counter() const override { return "plate_calls"; }
  std::string schema() const override { return "{}"; }
  Traits traits() const override { return {.ties = true}; }
  void read(scene::Entry&, scene::Scene&) const override {}
  void check(const scene::Scene&, const scene::Refuse&) const override {}
  std::string describe(const PlateSpec& spec) const override { return spec.body; }
  void build(const scene::Scene& scene, const BodyIndex& index, World& world) const override {
    for (const PlateSpec& spec : specs(scene))
      world.effects.of<Plate>().push_back({index.of(spec.body, "plate"), spec.area_m2});
  }
  std::vector<int> ends_of(const Plate& plate) const override { return {plate.body}; }
  void rename_ends(Plate& plate, const std::function<int(int)>& other) const override {
    plate.body = other(plate.body);
  }
  std::unique_ptr<GroupTerms> group_terms(const Acting& acting, const std::vector<int>& entries,
                                          GroupPlaces& places) const override {
    return std::make_unique<PlateTerms>(acting, entries, places);
  }
  std::vector<NeededLaw> needed_laws(const scene::Scene&, const Laws& laws) const override {
    return {needed_law<PlateDrag>(laws)};
  }
};

}  // namespace

// In the place of the course's own list: this program has this one effect.
const std::vector<const Effect*>& all() {
  static const PlateEffect plate;
  static const std::vector<const Effect*> all = {&plate};
  return all;
}

}  // namespace tumble::effects

namespace tumble::testing {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

scene::Scene falling_plate() {
  scene::Scene scene = scene_of({ball("plate", 0.1, 2.0, {0, 0, 0}, {3, 0, 0})}, 1.0);
  scene.step_s = 1.0 / 240.0;
  scene.effects.of<effects::PlateSpec>() = {{"plate", 1.0}};
  return scene;
}

Laws laws_with(const LawFunction<effects::PlateDrag>& drag) {
  modules::ModuleKind kind;
  kind.id = "a6";
  kind.bind = [&](const modules::AnyModule&, Laws& laws) { laws.set<effects::PlateDrag>(drag); };
  Laws laws = test_laws();
  modules::bind_laws(kind, nullptr, "a6 student", laws);
  return laws;
}

Vector3d linear_drag(const Vector3d& velocity_world, double area) { return -area * velocity_world; }

// x = v_0 (m / c) (1 - exp(-c t / m)), c = 1 kg/s. A method of fourth order errs by (c h / m)^5 /
// 120 a step: 3e-16, below rounding.
TEST(AskedLaw, MovesBodiesAsItsModuleSays) {
  const Trajectory result = run(falling_plate(), laws_with(linear_drag));
  EXPECT_NEAR(result.frames.back().poses[0].com_world.x(), 3.0 * 2.0 * (1.0 - std::exp(-0.5)),
              1e-12);
  EXPECT_GT(result.counters.counts.at("plate_calls"), 0u);
  EXPECT_EQ(result.stopped_by, "");
}

TEST(AskedLaw, IsRefusedByNameWhereNoModuleProvidesIt) {
  try {
    run(falling_plate());
    ADD_FAILURE() << "runs without its law";
  } catch (const UserError& error) {
    EXPECT_EQ(error.where(), "test");
    EXPECT_EQ(error.problem(), "needs the drag of a plate, and no module provides it");
    EXPECT_EQ(error.remedy(),
              "assignment a6 provides it: fill in that assignment first, or name a file that has "
              "it: --modules a6=PATH");
  }
}

TEST(AskedLaw, IsNotMissedByASceneThatDoesNotAskIt) {
  scene::Scene scene = falling_plate();
  scene.effects.of<effects::PlateSpec>().clear();
  EXPECT_EQ(run(scene).stopped_by, "");
}

// Not a number, an exception, and what the law itself refuses.
TEST(AskedLaw, ThatFailsStopsTheRunWithItsNameAndItsAuthor) {
  const std::vector<std::pair<LawFunction<effects::PlateDrag>, std::string>> wrong = {
      {[](const Vector3d&, double) -> Vector3d {
         return {kNaN, 0, 0};
       },
       "returned a value that is not a number"},
      {[](const Vector3d&, double) -> Vector3d { throw std::runtime_error("no air"); },
       "failed: no air"},
      {[](const Vector3d& velocity, double) -> Vector3d { return velocity; },
       "returned a drag that drives the plate"}};
  for (const auto& [drag, what] : wrong) {
    const Trajectory result = run(falling_plate(), laws_with(drag));
    EXPECT_NE(result.stopped_by.find("drag of plates (plate_drag of a6 student) " + what),
              std::string::npos)
        << result.stopped_by;
    EXPECT_NE(result.stopped_by.find("'plate'"), std::string::npos) << result.stopped_by;
  }
}

TEST(AskedLaw, IsNamedInTheRecordOfARunThatAsksIt) {
  const Laws laws = laws_with(linear_drag);
  EXPECT_EQ(run(falling_plate(), laws).info.constraint_source,
            "none, the drag of a plate by a6 student");
  scene::Scene scene = falling_plate();
  scene.effects.of<effects::PlateSpec>().clear();
  EXPECT_EQ(run(scene, laws).info.constraint_source, "none");
}

// The module is named for its impulses already.
TEST(AskedLaw, OfAModuleThatIsNamedForOtherLawsIsNotNamedAgain) {
  Laws laws = laws_with(linear_drag);
  laws.impulse_source = "a6 student";
  EXPECT_EQ(effects::authors_of_listed_laws(falling_plate(), laws), std::vector<std::string>{});
}

}  // namespace
}  // namespace tumble::testing
