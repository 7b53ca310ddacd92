// The player's page in a real browser: bodies are drawn at their positions, data are restored, keys
// work, and without WebGL it says so.
#include <cmath>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "framework/render/camera.h"
#include "framework/report/virtual_times_panel.h"
#include "tests/report/browser.h"
#include "tests/report/player_fixtures.h"

namespace tumble::testing {
namespace {

using report::player_page;

class PlayerInBrowser : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!Browser::is_installed())
      GTEST_SKIP() << "chromium is not installed, so no page is tested: apt-get install chromium";
  }
  Browser browser;
};

struct Spot {
  double x = 0, y = 0, pixels = 0;
};

/// Centre and area of the pixels for which `is(r, g, b)`.
template <class Is>
Spot spot_of(const Screen& screen, const Is& is) {
  Spot spot;
  for (int y = 0; y < screen.height; ++y)
    for (int x = 0; x < screen.width; ++x) {
      const std::uint8_t* p = screen.at(x, y);
      if (is(p[0], p[1], p[2])) spot.x += x + 0.5, spot.y += y + 0.5, spot.pixels += 1;
    }
  spot.x /= spot.pixels;
  spot.y /= spot.pixels;
  return spot;
}

bool is_red(int r, int g, int b) { return r > g + 60 && r > b + 60; }
bool is_blue(int r, int g, int b) { return b > r + 50 && b > g + 50; }

TEST_F(PlayerInBrowser, BodiesAreDrawnAtTheirPositions) {
  constexpr int kWidth = 640, kHeight = 480;
  const scene::Scene scene = thrown_ball();
  const std::string address = browser.serve(player_page(scene, {{thrown_run(), ""}}));
  const render::View view = render::view_of(scene.camera);
  for (const double t : {0.1, 0.65}) {
    const Screen screen =
        browser.screenshot(address + "#bare&t=" + std::to_string(t), kWidth, kHeight);
    ASSERT_EQ(screen.width, kWidth);
    const Spot ball = spot_of(screen, is_red), box = spot_of(screen, is_blue);
    const auto expected = render::project(view, kWidth, kHeight, ball_place(t)),
               box_expected = render::project(view, kWidth, kHeight, box_pose(t).com_world);
    // 21 pixels
    const double radius = 0.25 / render::metres_per_pixel(view, kHeight, ball_place(t));
    // The image of a ball away from the centre of the picture is an ellipse; its centre is some
    // percent of its radius from the image of the ball's centre. Linear interpolation between
    // frames: 0.3 mm.
    EXPECT_NEAR(ball.x, expected->x(), 0.1 * radius) << t;
    EXPECT_NEAR(ball.y, expected->y(), 0.1 * radius) << t;
    // a polygon of 20 corners has 0.984 of the circle's area
    EXPECT_NEAR(ball.pixels, M_PI * radius * radius, 0.08 * M_PI * radius * radius) << t;
    EXPECT_NEAR(box.x, box_expected->x(), 4.0) << t;
    EXPECT_NEAR(box.y, box_expected->y(), 4.0) << t;
  }
}

// At 2e6 m single precision is 0.125 m, half of the ball's radius.
TEST_F(PlayerInBrowser, FarFromTheOriginBodiesAreDrawnWhereTheyAre) {
  const Vector3d far(1e6, -2e6, 3e5);  // m
  scene::Scene scene = thrown_ball();
  scene.camera.eye_m += far;
  scene.camera.target_m += far;
  Trajectory run = thrown_run();
  for (Frame& frame : run.frames) {
    for (BodyPose& pose : frame.poses) pose.com_world += far;
    for (ContactPoint& contact : frame.contacts) contact.point_world += far;
  }
  for (Event& event : run.events) event.point_world += far;
  // As the same run near the origin.
  constexpr int kWidth = 640, kHeight = 480;
  const std::string where = "#bare&t=0.3";
  const Screen near_by = browser.screenshot(
      browser.serve(player_page(thrown_ball(), {{thrown_run(), ""}})) + where, kWidth, kHeight);
  const Screen far_away =
      browser.screenshot(browser.serve(player_page(scene, {{run, ""}})) + where, kWidth, kHeight);
  const Spot ball = spot_of(far_away, is_red), same = spot_of(near_by, is_red);
  // The rounding of places is 8e-6 m, a thousandth of a pixel: only pixels at the edge may change.
  EXPECT_NEAR(ball.x, same.x, 0.2);
  EXPECT_NEAR(ball.y, same.y, 0.2);
  EXPECT_NEAR(ball.pixels, same.pixels, 0.02 * same.pixels);
  // What is read is in the world.
  const std::string script = R"(
    const wait = () => { if (!document.body.dataset.ready) return setTimeout(wait, 20);
      const { player, files } = tumble, run = player.runs[0];
      player.choose(0);
      const lines = files.tableText(player).trim().split('\n'), head = lines[0].split(',');
      document.body.dataset.found = ['x [m]', 'y [m]', 'z [m]'].map(name =>
        lines[31].split(',')[head.indexOf('ball <1>: ' + name)]).join(' ');
      document.body.dataset.read = run.placeInWords(run.moving.get(0).slice(0, 3).map(c => c[30]))
        .join(' '); };
    wait();)";
  const std::string elements =
      browser.elements(browser.serve(player_page(scene, {{run, ""}}), script) + "#t=0");
  EXPECT_EQ(body_data(elements, "error"), "");
  for (const char* name : {"found", "read"}) {
    std::istringstream found(body_data(elements, name));
    for (int i = 0; i < 3; ++i) {
      double value = std::nan("");
      found >> value;
      EXPECT_NEAR(value, run.frames[30].poses[0].com_world[i], 1e-4) << name;  // eleven digits
    }
  }
}

TEST_F(PlayerInBrowser, DataAreRestored) {
  const std::string script = R"(
    const wait = () => { if (!document.body.dataset.ready) return setTimeout(wait, 20);
      const run = tumble.player.runs[0], place = new THREE.Vector3(), turn = new THREE.Quaternion(),
        found = [];
      for (const [body, t] of [[0, 0], [0, 0.5], [1, 0.5]]) { run.pose(body, run.frameAt(t), place,
        turn); found.push(...place.toArray(), turn.x, turn.y, turn.z, turn.w); }
      found.push(run.events.time[0], run.events.impulse[0], run.events.before[0],
        Number.isNaN(run.events.before[1]) ? 1 : 0,
        run.series.find(s => s.name === 'total').values[30], run.contacts[7][0]);
      document.body.dataset.found = found.join(' '); };
    wait();)";
  const std::string elements = browser.elements(
      browser.serve(player_page(thrown_ball(), {{thrown_run(), ""}}), script) + "#t=0");
  EXPECT_EQ(body_data(elements, "error"), "");
  std::istringstream found(body_data(elements, "found"));
  const Trajectory run = thrown_run();
  const auto expect = [&](double value, double tolerance, const char* what) {
    double number = std::nan("");
    found >> number;
    EXPECT_NEAR(number, value, tolerance) << what;
  };
  // a millionth of the distance to the target, 8.06 m; 1/32768. Tolerance: half of it, and float32.
  constexpr double kPlaceQuantum = 8.1e-6, kTurnQuantum = 3.1e-5;
  for (const auto& [body, k] : {std::pair{0u, 0u}, {0u, 30u}, {1u, 30u}}) {
    const BodyPose& pose = run.frames[k].poses[body];
    for (int i = 0; i < 3; ++i) expect(pose.com_world[i], kPlaceQuantum, "place");
    for (int i = 0; i < 4; ++i)
      expect(pose.world_from_body.coeffs()[i], kTurnQuantum, "orientation");
  }
  expect(0.4, 1e-6, "time of the event");
  expect(6.0, 6e-6, "impulse");
  expect(-3.0, 3e-6, "velocity before");
  expect(1, 0, "an unknown velocity stays unknown");
  expect(run.frames[30].kinetic_energy + run.frames[30].potential_energy, 1.3e-5, "energy");
  expect(kGravity, 1e-2, "contact force");
}

// Their channels are kept once, and hold the distance between the two, which is a curve of one.
TEST_F(PlayerInBrowser, TheSameMotionIsReadForBothRuns) {
  const std::string script = R"(
    const wait = () => { if (!document.body.dataset.ready) return setTimeout(wait, 20);
      const [a, b] = tumble.player.runs, place = new THREE.Vector3(), turn = new THREE.Quaternion();
      b.pose(0, b.frameAt(0.5), place, turn);
      document.body.dataset.found = [b.label, a.series.filter(s => s.plot === 'apart').length,
        b.series.filter(s => s.plot === 'apart').length, a.series.length - b.series.length,
        place.x.toFixed(3), b.events.impulse[0]].join(' '); };
    wait();)";
  const std::string elements = browser.elements(browser.serve(
      player_page(thrown_ball(), {{thrown_run(), "submission"}, {thrown_run(), "reference"}}),
      script));
  EXPECT_EQ(body_data(elements, "error"), "");
  EXPECT_EQ(
      body_data(elements, "found"),
      fmt::format("reference 1 0 1 {:.3f} 6", thrown_run().frames[30].poses[0].com_world.x()));
}

TEST_F(PlayerInBrowser, BodyIsAtTheWallWhenItHitsIt) {
  Trajectory bullet = thrown_run(2 / kRate);
  // m/s: between the first two frames it moves 3 m forward and 2 m back
  const double hit = 0.6 / kRate, speed = 300.0;
  for (Frame& frame : bullet.frames) {
    const bool flies_back = frame.time > hit;
    frame.poses[0].com_world = {speed * (flies_back ? 2 * hit - frame.time : frame.time), 0, 1};
    frame.poses[0].velocity_world = {flies_back ? -speed : speed, 0, 0};
  }
  bullet.events = {{hit, EventKind::kCollision, 0, 2, {3, 0, 1}, {-1, 0, 0}, 6.0, -speed, speed}};
  const std::string script = R"(
    const wait = () => { if (!document.body.dataset.ready) return setTimeout(wait, 20);
      const run = tumble.player.runs[0], place = new THREE.Vector3(), turn = new THREE.Quaternion();
      document.body.dataset.found = [0.3, 0.6, 0.8].map(k => (run.pose(0, run.frameAt(k / 60),
        place, turn), place.x)).join(' '); };
    wait();)";
  std::istringstream found(body_data(
      browser.elements(browser.serve(player_page(thrown_ball(), {{bullet, ""}}), script) + "#t=0"),
      "found"));
  // Times are stored to 5e-7 s, 1.5e-4 m at this speed; speeds to a relative 1.5e-5, 5e-5 m over a
  // frame. A straight line would be wrong by 2.4 m.
  for (const double expected : {1.5, 3.0, 2.0}) {
    double x = std::nan("");
    found >> x;
    EXPECT_NEAR(x, expected, 4e-4);
  }
}

TEST_F(PlayerInBrowser, KeysPlayStepAndJump) {
  const std::string script = R"(
    const key = (k, shiftKey = false) => window.dispatchEvent(new KeyboardEvent('keydown', { key: k,
      shiftKey })), said = [];
    const say = () => { const p = tumble.player; said.push(p.time.toFixed(4), p.isPlaying, p.speed);
      };
    const wait = () => { if (!document.body.dataset.ready) return setTimeout(wait, 20);
      for (const [k, shift] of [['Home'], ['ArrowRight'], ['ArrowRight', true], ['ArrowLeft'],
        ['n'], ['p'], ['End'], ['ArrowDown'], [' ']]) { key(k, shift); say(); }
      document.body.dataset.said = said.join(' '); };
    wait();)";
  const std::string elements = browser.elements(
      browser.serve(player_page(thrown_ball(), {{thrown_run(), ""}}), script) + "#t=0.3&speed=1");
  EXPECT_EQ(body_data(elements, "said"),
            "0.0000 false 1 "    // Home
            "0.0167 false 1 "    // one frame forward
            "0.1833 false 1 "    // ten frames forward
            "0.1667 false 1 "    // one frame back
            "0.4000 false 1 "    // next event
            "0.4000 false 1 "    // there is none before it
            "0.8000 false 1 "    // End
            "0.8000 false 0.5 "  // slower
            "0.0000 true 0.5");  // plays from the start
}

// The part of the time that slider and curves show, a curve that is hidden, values under the
// pointer, views, a body found by its name.
TEST_F(PlayerInBrowser, AReaderLooksCloser) {
  const std::string script = R"(
    const wait = () => { if (!document.body.dataset.ready) return setTimeout(wait, 20);
      const { player, picture } = tumble, said = [], byId = id => document.getElementById(id);
      player.zoom(0.25, 0.4);
      said.push(player.from.toFixed(3), player.until.toFixed(3),
        Number(byId('scrub').min).toFixed(3));
      player.goTo(0.7);
      said.push(player.until >= 0.7 && player.until - player.from < 0.2001);
      player.zoom(Infinity);
      said.push(player.isZoomed);
      const plot = document.querySelector('.curve'),
        count = () => plot.querySelectorAll('svg.plot path').length;
      said.push(count());
      plot.querySelector('.entry').click();
      said.push(count());
      const box = plot.querySelector('svg.plot').getBoundingClientRect();
      plot.querySelector('svg.plot').dispatchEvent(new PointerEvent('pointermove',
        { clientX: box.left + box.width * (66 + 404 / 2) / 480, clientY: box.top + 20 }));
      said.push(plot.querySelector('.tip').textContent.split(' ')[0]);
      picture.look('top');
      said.push(picture.camera.position.clone().sub(picture.orbit.target).normalize().z.toFixed(3));
      picture.look('right');
      said.push(picture.camera.position.clone().sub(picture.orbit.target).normalize().x.toFixed(3));
      player.shown.xray = true; picture.draw();
      const material = picture.stages[0].groups[0].mesh.material;
      said.push(material.opacity < 0.5 && !material.depthWrite);
      player.shown.xray = false; player.shown.wires = true; picture.draw();
      said.push(material.opacity === 1 && material.wireframe);
      window.dispatchEvent(new KeyboardEvent('keydown', { key: '/' }));
      const field = document.activeElement;
      field.value = 'BO'; field.dispatchEvent(new Event('input'));
      said.push(document.querySelector('.found').textContent);
      field.dispatchEvent(new KeyboardEvent('keydown', { key: 'Enter' }));
      said.push(player.about.bodies[player.chosen].name);
      document.body.dataset.said = said.join(' '); };
    wait();)";
  const std::string elements = browser.elements(
      browser.serve(player_page(thrown_ball(), {{thrown_run(), ""}}), script) + "#t=0.3");
  EXPECT_EQ(body_data(elements, "error"), "");
  EXPECT_EQ(body_data(elements, "said"),
            "0.300 0.500 0.300 true "  // a quarter of 0.8 s, with 0.4 s where it was
            "false "                   // all of it
            "3 2 0.4 "                 // of three curves one is hidden; the middle of 0.8 s
            "1.000 1.000 true true "   // from above, from the right; seen through; edges
            "box box");
}

TEST_F(PlayerInBrowser, AReaderTakesTheCurvesTheMotionAndThePictureAlong) {
  const std::string script = R"(
    const wait = async () => { if (!document.body.dataset.ready) return setTimeout(wait, 20);
      const { player, picture, files } = tumble, said = [];
      player.choose(0);
      const lines = files.tableText(player).trim().split('\n'), head = lines[0].split(','),
        value = (line, name) => Number(lines[line].split(',')[head.indexOf(name)]).toFixed(3);
      said.push(lines.length, value(31, 'ball <1>: x [m]'), value(31, 'energy: total [J]'));
      const bytes = await files.gltfBytes(player, picture),
        words = new Uint32Array(bytes.slice(0, 16)), length = words[3],
        text = new TextDecoder().decode(bytes.slice(20, 20 + length));
      const file = JSON.parse(text), data = bytes.slice(28 + length), numbers = i => {
        const a = file.accessors[i], v = file.bufferViews[a.bufferView];
        return new Float32Array(data, (v.byteOffset || 0) + (a.byteOffset || 0),
          a.count * { SCALAR: 1, VEC3: 3, VEC4: 4 }[a.type]); };
      const { channels, samplers } = file.animations[0];
      said.push(words[0].toString(16), words[2] === bytes.byteLength,
        file.nodes.filter(n => n.mesh !== undefined).length, channels.length);
      const ball = file.nodes.findIndex(n => n.name && n.name.startsWith('ball')),
        move = channels.find(c => c.target.node === ball && c.target.path === 'translation'),
        sampler = samplers[move.sampler], places = numbers(sampler.output);
      said.push(numbers(sampler.input)[30].toFixed(3),
        [0, 1, 2].map(i => places[90 + i].toFixed(3)).join(' '));
      const picked = await files.pictureBlob(picture);
      said.push(picked.type, picked.size > 2000);
      document.body.dataset.said = said.join(' '); };
    wait().catch(error => { document.body.dataset.said = error.message; });)";
  const std::string elements = browser.elements(
      browser.serve(player_page(thrown_ball(), {{thrown_run(), ""}}), script) + "#t=0.3");
  EXPECT_EQ(body_data(elements, "error"), "");
  const Frame frame = thrown_run().frames[30];
  const Vector3d place = frame.poses[0].com_world;
  EXPECT_EQ(
      body_data(elements, "said"),
      // a line a frame and the head; glTF (the bytes "glTF"), three bodies, of which two move
      fmt::format("50 {:.3f} {:.3f} 46546c67 true 3 4 {:.3f} {:.3f} {:.3f} {:.3f} image/png true",
                  place.x(), frame.kinetic_energy + frame.potential_energy, frame.time, place.x(),
                  place.y(), place.z()));
}

TEST_F(PlayerInBrowser, TwoRunsNameTheirFirstDifference) {
  Trajectory wrong = thrown_run();
  wrong.events[0].impulse = 9.0;
  const std::string elements =
      browser.elements(browser.serve(player_page(
                           thrown_ball(), {{wrong, "submission"}, {thrown_run(), "reference"}})) +
                       "#t=0.4");
  EXPECT_EQ(body_data(elements, "error"), "");
  // beside the picture of one run,
  EXPECT_NE(elements.find("ball &lt;1&gt; – box: 9 N s, -3 → 1.5 m/s"), std::string::npos);
  // and of the other
  EXPECT_NE(elements.find("ball &lt;1&gt; – box: 6 N s, -3 → 1.5 m/s"), std::string::npos);
  EXPECT_NE(elements.find("First difference at 0.4 s: collision of ball &lt;1&gt; and box: impulse "
                          "9 N s in submission, 6 N s in reference."),
            std::string::npos);
}

TEST_F(PlayerInBrowser, TwoRunsAreDrawnToOneScale) {
  Trajectory wrong = thrown_run();
  wrong.events[0].impulse = 9.0;
  wrong.frames.back().poses[0].com_world.z() = -5.0;
  const std::string script = R"(
    const wait = () => { if (!document.body.dataset.ready) return setTimeout(wait, 20);
      const stages = tumble.picture.stages;
      document.body.dataset.found = [...stages.map(s => s.marks.strongest.impulse.toFixed(3)),
        ...stages.map(s => s.lowest.toFixed(3))].join(' '); };
    wait();)";
  const std::string elements = browser.elements(browser.serve(
      player_page(thrown_ball(), {{wrong, "submission"}, {thrown_run(), "reference"}}), script));
  EXPECT_EQ(body_data(elements, "error"), "");
  // the stronger impulse; the lower end, less the ball's radius
  EXPECT_EQ(body_data(elements, "found"), "9.000 9.000 -5.250 -5.250");
}

TEST_F(PlayerInBrowser, ARunThatStoppedIsNotCalledTheSame) {
  Trajectory stopped = thrown_run();
  stopped.frames.resize(13);
  // The arguments stand below the picture, not on it.
  stopped.stopped_by = "SIGSEGV in hit\n  called with: x = 3";
  std::erase_if(stopped.events, [](const Event& event) { return event.time > 0.2; });
  const std::string elements = browser.elements(browser.serve(
      player_page(thrown_ball(), {{stopped, "submission"}, {thrown_run(), "reference"}})));
  EXPECT_EQ(body_data(elements, "error"), "");
  EXPECT_NE(
      elements.find("submission stopped at 0.2 s of 0.8 s; both runs are the same until then."),
      std::string::npos);
  EXPECT_EQ(elements.find("class=\"same\""), std::string::npos);
  EXPECT_NE(elements.find("stopped: SIGSEGV in hit</span>"), std::string::npos);
  EXPECT_NE(elements.find("<pre>SIGSEGV in hit\n  called with: x = 3</pre>"), std::string::npos);
}

// A runs ahead to 0.4 s; B is found to hit it at 0.2 s: A rolls back alone, then both are
// committed.
VirtualTimes one_rollback() {
  return {{"A", "B"},
          {{0, 0, 0.4, 0},
           {1, 0, 0.2, 0.2},
           {0, 0.4, 0.2, 0.2},
           {0, 0.2, 0.5, 0.2},
           {1, 0.2, 0.6, 0.5}}};
}

TEST_F(PlayerInBrowser, VirtualTimesShowTheMoveThatCommittedTheCursor) {
  report::PlayerOptions options;
  options.panels = {report::virtual_times_panel(one_rollback())};
  const std::string address =
      browser.serve(player_page(thrown_ball(), {{thrown_run(), ""}}, options));
  const std::string early = browser.elements(address + "#t=0.1&tab=virtual"),
                    late = browser.elements(address + "#t=0.45&tab=virtual");
  EXPECT_EQ(body_data(early, "error"), "");
  EXPECT_NE(early.find(
                "Move 2 of 5: B on from 0 to 0.2 s; global virtual time 0.2 s; 0 rollbacks so far"),
            std::string::npos);
  EXPECT_NE(
      late.find(
          "Move 5 of 5: B on from 0.2 to 0.6 s; global virtual time 0.5 s; 1 rollback so far"),
      std::string::npos);
}

TEST_F(PlayerInBrowser, VirtualTimesOfWhichOnlyTheFirstAreRecordedSayIt) {
  VirtualTimes times = one_rollback();
  times.is_cut = true;
  report::PlayerOptions options;
  options.panels = {report::virtual_times_panel(times)};
  const std::string elements =
      browser.elements(browser.serve(player_page(thrown_ball(), {{thrown_run(), ""}}, options)) +
                       "#t=0.45&tab=virtual");
  EXPECT_EQ(body_data(elements, "error"), "");
  EXPECT_NE(elements.find("Move 5 of the first 5: B on from 0.2 to 0.6 s; global virtual time 0.5 "
                          "s; 1 rollback so far; later moves are not recorded"),
            std::string::npos);
}

TEST_F(PlayerInBrowser, DamagedDataLeaveTheStaticPlots) {
  std::string page = player_page(thrown_ball(), {{thrown_run(), ""}});
  page.replace(page.find("id=\"run0\">") + 10, 40, std::string(40, 'A'));
  const std::string elements = browser.elements(browser.serve(page));
  EXPECT_NE(body_data(elements, "error").find("the data in this page are damaged"),
            std::string::npos);
  EXPECT_EQ(body_data(elements, "ready"), "");
  EXPECT_EQ(elements.find("class=\"alive\""), std::string::npos);  // which hides them
  EXPECT_NE(elements.find("<svg class=\"plot\""), std::string::npos);
}

TEST_F(PlayerInBrowser, WithoutWebglItSaysSoAndKeepsCurvesAndEvents) {
  const std::string elements = browser.elements(
      browser.serve(player_page(thrown_ball(), {{thrown_run(), ""}})) + "#t=0.4&tab=events",
      "--disable-3d-apis");
  EXPECT_NE(elements.find("The motion cannot be drawn here"), std::string::npos);
  EXPECT_NE(body_data(elements, "ready"), "");
  // a row of the list of events
  EXPECT_NE(elements.find("ball &lt;1&gt; – box"), std::string::npos);
  EXPECT_NE(elements.find("Change of the total energy"), std::string::npos);
}

}  // namespace
}  // namespace tumble::testing
