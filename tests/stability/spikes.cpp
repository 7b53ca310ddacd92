// Of row 13: points on points, points in cracks, edges over edges, after K. Erleben's set of hard
// meetings. Source of the set: K. Erleben, "Methodology for assessing mesh-based contact point
// methods", ACM Trans. Graph. 37 (2018) 39.
#include <algorithm>

#include <fmt/format.h>

#include "framework/core/files.h"
#include "tests/stability/cases.h"
#include "tests/stability/support.h"

namespace tumble::battery {
namespace {

constexpr double kMu = 0.3;

/// A pyramid of height 1 on a square of 0.4, point up; half a turn about x brings it down.
TriangleMesh pyramid() {
  constexpr double r = 0.2;
  return {{{-r, -r, 0}, {r, -r, 0}, {r, r, 0}, {-r, r, 0}, {0, 0, 1}},
          {{0, 2, 1}, {0, 3, 2}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}};
}

class Pieces {
 public:
  explicit Pieces(const std::filesystem::path& folder)
      : spike_(folder / "spike.3ds"), wedge_(folder / "wedge.3ds") {
    write_model(pyramid(), spike_);
    // a blunt ridge along y
    write_prism({{-0.3, 0.0}, {0.3, 0.0}, {0.05, 0.8}, {-0.05, 0.8}}, 0.5, wedge_);
  }

  scene::BodySpec spike(const std::string& name, const Vector3d& com, bool point_down) const {
    scene::BodySpec body = rough(box(name, Vector3d::Ones(), 1.0, com), kMu);
    body.shape = scene::ModelSpec{spike_.string(), "", 1.0};
    return point_down ? turned(body, 3.14159265358979323846, Vector3d::UnitX()) : body;
  }
  scene::BodySpec ridge(const std::string& name, const Vector3d& com) const {
    scene::BodySpec body = rough(box(name, Vector3d::Ones(), 1.0, com), kMu);
    body.shape = scene::ModelSpec{wedge_.string(), "", 1.0};
    return body;
  }
  static scene::BodySpec held(scene::BodySpec body) {
    body.mass_kg.reset();
    body.immovable = true;
    return body;
  }

 private:
  std::filesystem::path spike_, wedge_;
};

struct Meeting {
  std::string name;
  std::vector<scene::BodySpec> bodies;
};

/// A pyramid's centre of mass is a quarter of its height above its base, a ridge's 0.8 (0.6 + 2 x
/// 0.1) / (3 (0.6 + 0.1)).
std::vector<Meeting> meetings(const Pieces& pieces) {
  constexpr double kRidge = 0.8 * 0.8 / 2.1;
  std::vector<Meeting> all;
  all.push_back({"spike on spike",
                 {pieces.spike("above", {0.003, 0.002, 2.0 - 0.25 + 0.05}, true),
                  Pieces::held(pieces.spike("below", {0, 0, 0.25}, false))}});
  all.push_back({"spike in a crack",
                 {pieces.spike("spike", {0.01, 0, 0.75 + 0.4}, true),
                  Pieces::held(pieces.ridge("left", {-0.31, 0, kRidge})),
                  Pieces::held(pieces.ridge("right", {0.31, 0, kRidge}))}});
  all.push_back({"ridge across a ridge",
                 {turned(pieces.ridge("above", {0.02, 0, 1.6 - kRidge + 0.05}),
                         3.14159265358979323846, Vector3d(1, 1, 0).normalized()),
                  Pieces::held(pieces.ridge("below", {0, 0, kRidge}))}});
  all.push_back(
      {"box half over a cliff",
       {rough(box("box", Vector3d(0.25, 0.2, 0.1), 1.0, Vector3d(0.05, 0, 1.0 + 0.1 + 0.05)), kMu),
        Pieces::held(
            rough(box("cliff", Vector3d(0.5, 0.5, 0.5), 1.0, Vector3d(-0.5, 0, 0.5)), kMu))}});
  for (Meeting& meeting : all) meeting.bodies.push_back(floor_of(kMu));
  return all;
}

}  // namespace

void spikes(const Given& given, Findings& findings) {
  const PrivateFolder folder;
  const Pieces pieces(folder.path());
  for (Meeting& meeting : meetings(pieces)) {
    const std::string name = meeting.name;
    findings.part(name, [&] {
      const double duration = given.is_long ? 3.0 : 1.0;
      const Trajectory run = run_by_steps(with_contact(name, std::move(meeting.bodies)), given.laws,
                                          duration, 1.0 / 240, 200);
      findings.at_least(name + fmt::format(", {:g} s: smallest gap", duration), smallest_gap(run),
                        0.0, "m", "nothing interpenetrates");
      findings.at_most(name + ": rise of the energy", energy_rise(run), 1e-6, "",
                       "plastic impacts and friction only take; truncation of a step");
      findings.at_least(
          name + ": way down",
          run.frames.front().poses[0].com_world.z() - run.frames.back().poses[0].com_world.z(),
          0.04, "m", "it has met what lies below: 0.05 m of free fall, less where it is held");
    });
  }
}

}  // namespace tumble::battery
