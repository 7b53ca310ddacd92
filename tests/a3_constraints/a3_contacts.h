/// Contact problems with known properties, for the tests of a3.
#pragma once

#include "tests/a3_constraints/a3_fixtures.h"

namespace tumble::a3_testing {

/// What contact_forces gets.
struct Contacts {
  MatrixXd A;
  VectorXd b;
};

/// The module's forces; a vector of NaN where their number is wrong.
VectorXd forces_of(const MatrixXd& A, const VectorXd& b);

/// n cubes of 1 kg and 1 m on each other, each on four corners: contact 4 i + c below box i. Rank 3
/// n.
Contacts stack_of_boxes(int n);
/// m contacts among bodies with random normals: A = G G^T of random rank, rows repeated or in whole
/// numbers now and then, and b = G u plus something that parts, so that a solution exists.
Contacts random_contacts(Random& random, int m);

/// (A3.9) to 1e-10 of the largest |b| (and, for f . a, of the largest force), or the story of what
/// does not hold.
void expect_complementary(const Contacts& contacts, const std::string& scene);

/// "No force" is an answer only from a function that can give one: asked first. @return false when
/// nothing came, and the test should end
bool something_is_held();

}  // namespace tumble::a3_testing
