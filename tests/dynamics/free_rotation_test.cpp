// Exact free rotation: against truths computed elsewhere, and against the laws that it must keep.
#include "tests/support/places.h"
#include "framework/dynamics/free_rotation.h"

#include <filesystem>

#include <gtest/gtest.h>

#include "tests/collision/truth_reader.h"
#include "tests/dynamics/tops.h"

namespace tumble::testing {
namespace {

Quaterniond quaternion(const nlohmann::json& value) {
  return {number(value[0]), number(value[1]), number(value[2]), number(value[3])};
}

std::vector<std::string> free_tops() {
  std::vector<std::string> ids;
  for (const auto& entry :
       std::filesystem::directory_iterator(test::source_dir() + "/tests/truths")) {
    std::string name = entry.path().stem();
    if (!name.starts_with("free_top_")) continue;
    ids.push_back(name.replace(name.find("__"), 2, "/"));
  }
  std::sort(ids.begin(), ids.end());
  return ids;
}

TEST(FreeRotation, AgreesWithEveryTruth) {
  ASSERT_GE(free_tops().size(), 9u);
  for (const std::string& id : free_tops()) {
    const nlohmann::json truth = read_truth(id);
    const FreeRotation rotation(vector(input(truth, "I_principal")).asDiagonal());
    const Spin start{quaternion(input(truth, "q0")), vector(input(truth, "omega0_body"))};
    for (const nlohmann::json& time : input(truth, "times")) {
      const std::string t = "t" + time.get<std::string>();
      const Spin found = rotation.after(start, number(time));
      EXPECT_LE(difference(found.world_from_body, quaternion(output(truth, "q_" + t))),
                pass_mark(truth, "q_" + t))
          << id << " q_" << t;
      EXPECT_LE((found.omega_body - vector(output(truth, "omega_body_" + t))).cwiseAbs().maxCoeff(),
                pass_mark(truth, "omega_body_" + t))
          << id << " " << t;
    }
  }
}

// Rounding of inputs is carried along by the motion itself: neighbouring spins part by about |w| t
// times as much, and by |w| t again where their energies differ. 1000 eps (1 + |w| t)^2 leaves a
// margin of 100; a wrong term shows in the first digits.
double allowed(const Spin& start, double t) {
  return 1000 * kEps * std::pow(1 + start.omega_body.norm() * std::abs(t), 2);
}

TEST(FreeRotation, GoesInTwoStridesWhereItGoesInOne) {
  Random random(11);
  for (int i = 0; i < 50; ++i) {
    const FreeRotation rotation(random_moments(random).asDiagonal());
    const Spin start{random_rotation(random), random_vector(random, 3)};
    const double t1 = random.between(0, 20), t2 = random.between(-20, 20);
    const Spin once = rotation.after(start, t1 + t2),
               twice = rotation.after(rotation.after(start, t1), t2);
    EXPECT_LE(difference(once.world_from_body, twice.world_from_body), allowed(start, 40))
        << "top " << i;
  }
}

TEST(FreeRotation, KeepsEnergyAndAngularMomentum) {
  Random random(12);
  for (int i = 0; i < 50; ++i) {
    const Vector3d moments = random_moments(random);
    const FreeRotation rotation(moments.asDiagonal());
    const Spin start{random_rotation(random), random_vector(random, 3)};
    const auto energy = [&](const Spin& s) {
      return 0.5 * s.omega_body.dot(moments.cwiseProduct(s.omega_body));
    };
    const auto momentum = [&](const Spin& s) -> Vector3d {
      return s.world_from_body * moments.cwiseProduct(s.omega_body);
    };
    for (const double t : {0.1, 7.0, 1000.0}) {
      const Spin later = rotation.after(start, t);
      // Conserved exactly by the motion: only the last rounding to double and the angle's (below
      // 1e-16 |w| t) are left.
      const double round_off = 20 * kEps + 2e-16 * start.omega_body.norm() * t;
      EXPECT_NEAR(energy(later), energy(start), round_off * energy(start))
          << "top " << i << " at " << t;
      EXPECT_LE((momentum(later) - momentum(start)).norm(), round_off * momentum(start).norm() * 10)
          << "top " << i << " at " << t;
    }
  }
}

TEST(FreeRotation, DoesNotCareForTheAxesOfTheBodyFrame) {
  Random random(13);
  for (int i = 0; i < 20; ++i) {
    const Vector3d moments = random_moments(random);
    const Quaterniond body_from_principal = random_rotation(random);
    const Matrix3d A = body_from_principal.toRotationMatrix();
    const Matrix3d tensor = A * moments.asDiagonal() * A.transpose();
    const FreeRotation principal(moments.asDiagonal()), tilted(0.5 * (tensor + tensor.transpose()));
    const Spin start{random_rotation(random), random_vector(random, 3)};
    const Spin expected = principal.after(start, 5.0);
    const Spin found = tilted.after({start.world_from_body * body_from_principal.conjugate(),
                                     body_from_principal * start.omega_body},
                                    5.0);
    // Diagonalising a tensor leaves its moments with a few eps of the largest: a needle's least one
    // loses up to 100 times as much.
    EXPECT_LE(difference(found.world_from_body * body_from_principal, expected.world_from_body),
              100 * allowed(start, 5.0))
        << "top " << i;
  }
}

TEST(FreeRotation, TurnsABallEvenly) {
  const FreeRotation rotation(0.4 * Matrix3d::Identity());
  // a quarter of a turn about z
  const Spin later = rotation.after({Quaterniond::Identity(), {0, 0, M_PI}}, 0.5);
  EXPECT_LE(difference(later.world_from_body, Quaterniond(std::sqrt(0.5), 0, 0, std::sqrt(0.5))),
            4 * kEps);
  EXPECT_EQ(later.omega_body, Vector3d(0, 0, M_PI));
}

TEST(AdvanceFreely, MovesStraightAndLeavesMomentaBitForBit) {
  const Inertia inertia = finite_inertia(2.0, Vector3d(1, 2, 3).asDiagonal());
  const RigidBodyState state{
      {1, 2, 3}, Quaterniond(0.5, 0.5, 0.5, 0.5), {4, -2, 1}, {0.3, 2.0, -0.1}};
  const RigidBodyState later = advance_freely(state, inertia, 3.0);
  EXPECT_LE((later.com_world - Vector3d(7, -1, 4.5)).norm(), 10 * kEps);
  EXPECT_EQ(later.momentum_world, state.momentum_world);
  EXPECT_EQ(later.angular_momentum_world, state.angular_momentum_world);
  EXPECT_NEAR(later.world_from_body.norm(), 1.0, 2 * kEps);
}

}  // namespace
}  // namespace tumble::testing
