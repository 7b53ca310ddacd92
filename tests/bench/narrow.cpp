// What one question to the collision folder costs: gaps, near points, bounds on impacts, pairs of
// boxes.
//   bench_narrow [WORD]   only the lines that hold the word
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "tests/support/places.h"
#include "framework/collision/contact_patch.h"
#include "framework/collision/first_impact.h"
#include "framework/collision/manifold_points.h"
#include "framework/collision/sweep.h"
#include "framework/geometry/solid.h"
#include "tests/collision/hulls.h"

namespace tumble::testing {
namespace {

using collision::CollisionShape;
using collision::Motion;
using collision::MotionState;
using collision::Pose;

constexpr std::size_t kPlaces = 24;  // each figure is a mean over this many relative positions
constexpr double kStep = 1.0 / 240, kEndless = std::numeric_limits<double>::infinity();

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// CPU time of one call, the least of several batches: the best one was not disturbed by other
/// programs. [us]
double microseconds(std::size_t calls_a_round, const std::function<void()>& round) {
  round();
  double least = 1e9;
  for (int batch = 0; batch < 7; ++batch) {
    const double begin = cpu_seconds();
    int rounds = 0;
    do {
      round();
      ++rounds;
    } while (cpu_seconds() - begin < 0.01);
    least = std::min(least, (cpu_seconds() - begin) / rounds / static_cast<double>(calls_a_round));
  }
  return 1e6 * least;
}

struct Places {
  const CollisionShape& a;
  const CollisionShape& b;
  std::vector<std::pair<Pose, Pose>> poses;
  double size;
};

class Bench {
 public:
  explicit Bench(std::string only) : only_(std::move(only)) {}

  template <class Arrange>
  void pair(const std::string& name, const Shape& shape_a, const Shape& shape_b,
            Arrange&& arrange) {
    if (name.find(only_) == std::string::npos) return;
    const CollisionShape a(shape_a), b(shape_b);
    Places places{a, b, {}, std::min(a.bounding_radius(), b.bounding_radius())};
    std::mt19937_64 random(7);
    for (std::size_t k = 0; k < kPlaces; ++k) places.poses.push_back(arrange(a, b, random));
    time(name, places);
  }

  void sweep(int n) {
    const std::string name = "broad phase of " + std::to_string(n);
    if (name.find(only_) == std::string::npos) return;
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> place(0.0, std::cbrt(n)), half(0.4, 0.6);
    std::vector<collision::SweptBox> boxes{
        {Vector3d::Constant(-kEndless), Vector3d::Constant(kEndless), false}};
    for (int i = 1; i < n; ++i) {
      const Vector3d middle(place(random), place(random), place(random)),
          reach = Vector3d::Constant(half(random));
      boxes.push_back({middle - reach, middle + reach, true});
    }
    std::size_t pairs = 0;
    const double cost =
        microseconds(1, [&] { pairs = collision::overlapping_pairs(boxes).size(); });
    std::printf("%-34s %9.2f us  (%zu pairs)\n", name.c_str(), cost, pairs);
  }

 private:
  template <class Ask>
  double ask(const Places& places, Ask&& one) {
    return microseconds(kPlaces, [&] {
      for (const auto& [p, q] : places.poses) one(p, q);
    });
  }

  void time(const std::string& name, const Places& places) {
    const auto& [a, b, poses, size] = places;
    std::size_t found = 0;
    const double gap =
        ask(places, [&](const Pose& p, const Pose& q) { collision::compute_gap(a, p, b, q); });
    const double reach = 1e-2 * size;
    const double near = ask(places, [&](const Pose& p, const Pose& q) {
      collision::manifold_points(a, p, b, q, reach);
    });
    for (const auto& [p, q] : poses) found += collision::manifold_points(a, p, b, q, reach).size();
    // Queried again with the cached data of the pair, as in persistent contacts.
    std::vector<collision::PairCache> caches(kPlaces);
    const double kept = microseconds(kPlaces, [&] {
      for (std::size_t k = 0; k < kPlaces; ++k)
        collision::manifold_points(a, poses[k].first, b, poses[k].second, reach, &caches[k]);
    });
    const double kept_gap = microseconds(kPlaces, [&] {
      for (std::size_t k = 0; k < kPlaces; ++k)
        collision::compute_gap(a, poses[k].first, b, poses[k].second, &caches[k]);
    });
    const double tight = ask(places, [&](const Pose& p, const Pose& q) {
      collision::manifold_points(a, p, b, q, 1e-7 * size);
    });
    // One falls towards the other and rotates, by 1e-2 of its size in the step; the other is fixed.
    int hits = 0;
    const auto impact = [&](const Pose& p, const Pose& q) {
      const Vector3d velocity = 1e-2 * size / kStep * (q.com_world - p.com_world).normalized(),
                     omega(0.4, -0.3, 0.2);
      Motion falling{
          [&](double t) {
            const double angle = omega.norm() * t;
            MotionState state{
                {p.com_world + t * velocity,
                 Quaterniond(Eigen::AngleAxisd(angle, omega.normalized())) * p.world_from_body},
                velocity,
                omega};
            return state;
          },
          {}};
      falling.bounds.angular_speed = omega.norm();
      const Motion still{[&](double) {
                           return MotionState{q, Vector3d::Zero(), Vector3d::Zero()};
                         },
                         {}};
      return collision::first_impact(a, falling, b, still, 0.0, kStep).has_value();
    };
    const double first = ask(places, impact);
    for (const auto& [p, q] : poses) hits += impact(p, q);
    std::printf(
        "%-34s gap %8.2f kept %7.2f   near %8.2f kept %7.2f (%4.1f points)   near 1e-7 %8.2f   "
        "impact %8.2f (%2d hit)  us\n",
        name.c_str(), gap, kept_gap, near, kept, static_cast<double>(found) / kPlaces, tight, first,
        hits);
    std::fflush(stdout);
  }

  std::string only_;
};

double in(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
Vector3d any_direction(std::mt19937_64& random) {
  for (;;) {
    const Vector3d v(in(random, -1, 1), in(random, -1, 1), in(random, -1, 1));
    if (v.squaredNorm() <= 1 && v.norm() > 0.1) return v.normalized();
  }
}
Quaterniond any_turn(std::mt19937_64& random) {
  return Quaterniond(in(random, -1, 1), in(random, -1, 1), in(random, -1, 1), in(random, -1, 1))
      .normalized();
}

/// Two solids in any orientation, `gap` apart (relative to the smaller one's size) along a line
/// through their centres.
auto apart_by(double gap) {
  return [gap](const CollisionShape& a, const CollisionShape& b, std::mt19937_64& random) {
    const Vector3d line = any_direction(random);
    Pose p{Vector3d::Zero(), any_turn(random)};
    const Pose q{Vector3d::Zero(), any_turn(random)};
    const double goal = gap * std::min(a.bounding_radius(), b.bounding_radius());
    double low = 0.0, high = 2 * (a.bounding_radius() + b.bounding_radius()) + goal;
    while (high - low > 1e-13 * high) {
      const double middle = 0.5 * (low + high);
      p.com_world = middle * line;
      (collision::compute_gap(a, p, b, q).distance < goal ? low : high) = middle;
    }
    p.com_world = high * line;
    return std::pair(p, q);
  };
}

/// A solid `gap` above another, unrotated one, at (x, y) in a square of half side `spread`.
auto let_down(double gap, double spread, bool upright) {
  return [=](const CollisionShape& a, const CollisionShape& b, std::mt19937_64& random) {
    Pose p{{in(random, -spread, spread), in(random, -spread, spread), 0},
           upright ? Quaterniond(Eigen::AngleAxisd(in(random, 0, 6), Vector3d::UnitZ()))
                   : any_turn(random)};
    const Pose q;
    const double goal = gap * a.bounding_radius();
    double low = -1.0, high = 30.0;
    while (high - low > 1e-13) {
      const double middle = 0.5 * (low + high);
      p.com_world.z() = middle;
      (collision::compute_gap(a, p, b, q).distance < goal ? low : high) = middle;
    }
    p.com_world.z() = high;
    return std::pair(p, q);
  };
}

Shape model(const std::string& name) {
  return load_solid(test::source_dir() + "/models/" + name + ".3ds").solid;
}

/// A slab whose top is a bowl of `cells` x `cells` squares, of two triangles each.
Shape bowl(int cells) {
  TriangleMesh mesh;
  const double half = 10.0;
  const int row = cells + 1;
  for (const bool top : {true, false})
    for (int i = 0; i <= cells; ++i)
      for (int j = 0; j <= cells; ++j) {
        const double x = half * (2.0 * i / cells - 1), y = half * (2.0 * j / cells - 1);
        mesh.vertices.emplace_back(x, y, top ? 0.03 * (x * x + y * y) : -1.0);
      }
  const auto at = [&](bool top, int i, int j) { return (top ? 0 : row * row) + i * row + j; };
  const auto quad = [&](int a, int b, int c, int d) {
    mesh.faces.push_back({a, b, c});
    mesh.faces.push_back({a, c, d});
  };
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j) {
      quad(at(true, i, j), at(true, i + 1, j), at(true, i + 1, j + 1), at(true, i, j + 1));
      quad(at(false, i, j), at(false, i, j + 1), at(false, i + 1, j + 1), at(false, i + 1, j));
    }
  for (int k = 0; k < cells; ++k) {
    quad(at(false, k, 0), at(false, k + 1, 0), at(true, k + 1, 0), at(true, k, 0));
    quad(at(false, k + 1, cells), at(false, k, cells), at(true, k, cells), at(true, k + 1, cells));
    quad(at(false, 0, k + 1), at(false, 0, k), at(true, 0, k), at(true, 0, k + 1));
    quad(at(false, cells, k), at(false, cells, k + 1), at(true, cells, k + 1), at(true, cells, k));
  }
  return MeshSolid{mesh, false};
}

void run(Bench bench) {
  const Shape ball = Sphere{0.5}, box = Box{{0.5, 0.4, 0.3}}, hull = random_hull(20, 1),
              plane = HalfSpace{};
  constexpr double kTouch = 1e-10, kFar = 1.0;
  bench.pair("ball, ball touch", ball, ball, apart_by(kTouch));
  bench.pair("ball, box touch", ball, box, apart_by(kTouch));
  bench.pair("box, plane rests", box, plane, let_down(kTouch, 1, true));
  bench.pair("box, box rests", box, box, let_down(kTouch, 0.3, true));
  bench.pair("box, box touch", box, box, apart_by(kTouch));
  bench.pair("hull20, plane", hull, plane, let_down(kTouch, 1, false));
  bench.pair("hull20, hull20 touch", hull, hull, apart_by(kTouch));
  bench.pair("hull20, hull20 overlap 1e-8", hull, hull, apart_by(-1e-8));
  bench.pair("hull20, hull20 overlap 0.1", hull, hull, apart_by(-0.1));
  bench.pair("hull20, hull20 0.02 apart", hull, hull, apart_by(0.02));
  bench.pair("hull20, hull20 a radius apart", hull, hull, apart_by(kFar));
  bench.pair("rock, rock touch", model("rock_1"), model("rock_2"), apart_by(kTouch));
  bench.pair("t_handle, plane", model("t_handle"), plane, let_down(kTouch, 1, false));
  bench.pair("t_handle, t_handle touch", model("t_handle"), model("t_handle"), apart_by(kTouch));
  bench.pair("torus, torus touch", model("torus"), model("torus"), apart_by(kTouch));
  bench.pair("torus, torus a radius apart", model("torus"), model("torus"), apart_by(kFar));
  bench.pair("torus, l_shape touch", model("torus"), model("l_shape"), apart_by(kTouch));
  bench.pair("l_shape rests on l_shape", model("l_shape"), model("l_shape"),
             let_down(kTouch, 0.1, true));
  bench.pair("ball in a bowl of 20,000", ball, bowl(100), let_down(kTouch, 5, false));
  bench.pair("hull20 in a bowl of 20,000", hull, bowl(100), let_down(kTouch, 5, false));
  bench.pair("t_handle in a bowl of 20,000", model("t_handle"), bowl(100),
             let_down(kTouch, 5, false));
  for (const int n : {200, 1000, 3000}) bench.sweep(n);
}

}  // namespace
}  // namespace tumble::testing

int main(int argc, char** argv) {
  tumble::testing::run(tumble::testing::Bench(argc > 1 ? argv[1] : ""));
  return EXIT_SUCCESS;
}
