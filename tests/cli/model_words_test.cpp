// Models on the command line: inspected, dropped at once, poked.

#include <nlohmann/json.hpp>

#include "framework/core/files.h"
#include "tests/cli/command_line.h"
#include "tests/support/places.h"

namespace tumble::testing {
namespace {

TEST_F(CommandLine, AMissingModelIsReportedByName) {
  const Said said = type("inspect nowhere.3ds");
  EXPECT_EQ(said.code, 2);
  EXPECT_TRUE(holds(said.err, "nowhere.3ds")) << said.err;
}

TEST_F(CommandLine, InspectWeighsABox) {
  const Said said = type("inspect box --density 2 --json");
  EXPECT_EQ(said.code, 0) << said.err;
  const nlohmann::json page = nlohmann::json::parse(said.out);
  const auto& object = page.at("objects").at(0);
  EXPECT_TRUE(object.at("closed").get<bool>());
}

// Known facts of a box: every line of the output, with its number.
TEST_F(CommandLine, InspectPrintsEveryLineOfAGoodModel) {
  const Said said = type("inspect box --density 1200");
  EXPECT_EQ(said.code, 0) << said.err;
  const nlohmann::json object =
      nlohmann::json::parse(type("inspect box --density 1200 --json").out).at("objects").at(0);
  for (const char* line :
       {"1 object ", "density 1200 kg/m^3", "closed, convex", "vertices, faces 8, 12",
        "bounding box", "size", "volume", "mass", "centre of mass", "inertia",
        "about the centre of mass", "principal axes"})
    EXPECT_TRUE(holds(said.out, line)) << line << "\n" << said.out;
  EXPECT_FALSE(holds(said.out, "wrong") || holds(said.out, "remedy")) << said.out;
  // For any size of the box: mass is density times volume, volume is that of the bounding box, and
  // a box's moment about an axis is m (b^2 + c^2) / 12. Its corners are float32 in the file: 1e-6
  // relative.
  const auto low = object.at("bounding_box_m").at("low"),
             high = object.at("bounding_box_m").at("high");
  double size[3], volume = 1.0;
  for (int i = 0; i < 3; ++i)
    size[i] = high.at(i).get<double>() - low.at(i).get<double>(), volume *= size[i];
  const double mass = object.at("mass_kg");
  EXPECT_NEAR(object.at("volume_m3").get<double>(), volume, 1e-6 * volume);
  EXPECT_NEAR(mass, 1200 * volume, 1e-6 * mass);
  for (int i = 0; i < 3; ++i) {
    const double b = size[(i + 1) % 3], c = size[(i + 2) % 3], moment = mass * (b * b + c * c) / 12;
    EXPECT_NEAR(object.at("inertia_com_mesh_kg_m2").at(i).at(i).get<double>(), moment,
                1e-6 * moment);
    EXPECT_NEAR(object.at("com_mesh_m").at(i).get<double>(),
                0.5 * (low.at(i).get<double>() + high.at(i).get<double>()), 1e-6 * size[i]);
  }
  EXPECT_EQ(object.at("principal_moments_kg_m2").size(), 3u);
}

TEST_F(CommandLine, InspectOfABrokenModelKeepsWhatIsKnownAndSaysWhatToDo) {
  const Said said = type("inspect broken/lampshade");
  for (const char* line : {"not a solid", "vertices, faces", "bounding box", "wrong", "remedy"})
    EXPECT_TRUE(holds(said.out, line)) << line << "\n" << said.out;
  EXPECT_FALSE(holds(said.out, "centre of mass")) << "what is no solid has no weight: " << said.out;
}

TEST_F(CommandLine, InspectOfAnOpenSurfaceSaysWhereAndExitsWith1) {
  const Said said = type("inspect broken/lampshade");
  EXPECT_EQ(said.code, 1) << said.err;
  EXPECT_TRUE(holds(said.out, "thick") || holds(said.out, "open")) << said.out;
}

TEST_F(CommandLine, AModelThatIsNotClosedIsRefusedInTheLoadersWords) {
  for (const std::string verb : {"run", "explain"}) {
    const Said said = type(verb + " '" + test::source_dir() + "/models/broken/missing_face.3ds'");
    EXPECT_EQ(said.code, 2) << verb;
    EXPECT_TRUE(holds(said.err, "open edge")) << said.err;
    EXPECT_FALSE(holds(said.err, "JSON")) << said.err;
  }
  EXPECT_EQ(type("run nowhere.3ds").code, 2);
}

TEST_F(CommandLine, WordsAboutAModelAreRefusedOfAScene) {
  const Said said = type("run t_handle --scale 2");
  EXPECT_EQ(said.code, 2);
  EXPECT_TRUE(holds(said.err, "is a scene")) << said.err;
}

TEST_F(CommandLine, InspectSaysHowToSeeAModelMove) {
  const Said said = type("inspect t_handle --scale 0.5");
  EXPECT_TRUE(holds(said.out, "tumble run") && holds(said.out, "t_handle.3ds --scale 0.5"))
      << said.out;
  EXPECT_FALSE(
      holds(type("inspect '" + test::source_dir() + "/models/broken/missing_face.3ds'").out,
            "tumble run"));
}

#ifdef TUMBLE_HAS_REFERENCE
// 40 N for 0.2 s along y on a free body: momentum 8 kg m/s, for any point of the force.
TEST_F(CommandLine, APokeGivesMomentumForceTimesTime) {
  const Said said = type(
      "poke poked_box --modules reference --ray -0.6,-10,0.85,0,1,0 --force 0,40,0 --duration-s "
      "0.2");
  EXPECT_EQ(said.code, 0) << said.out << said.err;
  EXPECT_TRUE(holds(said.out + said.err, "face")) << said.out;
}

// Drag takes momentum out and a spring to the world exchanges it: a right run is not judged as one
// of a closed system, in which the push alone changes it. Between two bodies a spring keeps it.
TEST_F(CommandLine, APokeIsJudgedByMomentumWhereNothingFromOutsideActs) {
  const std::string head =
      R"({"title": "t", "duration_s": 1, "bodies": [{"name": "a", "mass_kg": 1, )"
      R"("shape": {"sphere": {"radius_m": 0.1}}, "velocity_m_s": [1, 0, 0]}, {"name": "b", )"
      R"("mass_kg": 1, "shape": {"sphere": {"radius_m": 0.1}}, "position_m": [3, 0, 0]}], )";
  const auto judged = [&](const std::string& effects) {
    write_whole(folder_ / "poked.json", head + effects + "}");
    const Said said =
        type("poke poked.json --modules reference --point a,0,0,0 --force 0,5,0 --duration-s 0.2");
    EXPECT_EQ(said.code, 0) << effects << said.out << said.err;
    return holds(said.out, "angular_momentum");
  };
  EXPECT_FALSE(judged(R"("drag": [{"body": "a", "linear_n_s_m": 1}])"));
  EXPECT_FALSE(judged(
      R"("springs": [{"a": {"body": "a"}, "b": {"point_world_m": [0, 0, 1]}, "stiffness_n_m": 5}])"));
  EXPECT_TRUE(
      judged(R"("springs": [{"a": {"body": "a"}, "b": {"body": "b"}, "stiffness_n_m": 5}])"));
}

// The pixel of the first example in README and handout.
TEST_F(CommandLine, ThePixelOfTheReadmeHitsTheBox) {
  EXPECT_TRUE(holds(contents_of(test::source_dir() + "/README.md"),
                    "poke poked_box --pixel 200,250 --force 0,40,0"));
  EXPECT_TRUE(holds(contents_of(test::source_dir() + "/handouts/a1_impulse.md"),
                    "poke poked_box --pixel 200,250 --force 0,40,0"));
  const Said said =
      type("poke poked_box --modules reference --pixel 200,250 --force 0,40,0 --duration-s 0.2");
  EXPECT_EQ(said.code, 0) << said.out << said.err;
}

TEST_F(CommandLine, APokeThatHitsNothingSaysWhatTheRayCameNearestTo) {
  const Said said = type(
      "poke poked_box --modules reference --ray -0.6,-10,90,0,1,0 --force 0,40,0 --duration-s 0.2");
  EXPECT_EQ(said.code, 2) << said.out;
  EXPECT_TRUE(holds(said.err, "box")) << said.err;
}

TEST_F(CommandLine, PokeWantsOneWayToPoint) {
  EXPECT_EQ(type("poke poked_box --force 0,40,0 --duration-s 0.2").code, 2);
  EXPECT_EQ(type("poke poked_box --pixel 320 --force 0,40,0 --duration-s 0.2").code, 2);
  EXPECT_EQ(type("poke poked_box --pixel 320,240 --force up --duration-s 0.2").code, 2);
}

TEST_F(CommandLine, RunAndPokeTakeAModelAtOnce) {
  const Said free = type("run t_handle.3ds --modules reference"),
             dropped = type("run wedge.3ds --drop --scale 0.5 --modules reference");
  EXPECT_EQ(free.code, 0) << free.out << free.err;
  EXPECT_TRUE(holds(free.out, "free in space")) << free.out;
  EXPECT_TRUE(holds(free.out, "angular_momentum")) << free.out;
  EXPECT_EQ(dropped.code, 0) << dropped.out << dropped.err;
  EXPECT_TRUE(holds(dropped.out, "dropped on a floor")) << dropped.out;
  const Said poked =
      type("poke t_handle.3ds --pixel 320,240 --force 0,40,0 --duration-s 0.2 --modules reference");
  EXPECT_EQ(poked.code, 0) << poked.out << poked.err;
  EXPECT_TRUE(holds(poked.out, "hit body")) << poked.out;
  EXPECT_EQ(type("explain t_handle.3ds").code, 0);
}
#endif

}  // namespace
}  // namespace tumble::testing
