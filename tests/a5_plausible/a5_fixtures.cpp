#include "tests/a5_plausible/a5_fixtures.h"

#include "framework/core/normal.h"

namespace tumble::a5_testing {

Mistake likely(double found, const Slips& slips, const Mistake& otherwise) {
  for (const auto& [gives, words] : slips)
    if (std::abs(found - gives) <= 1e-9 * (1 + std::abs(gives)) || found == gives)
      return shown(words);
  return otherwise;
}

void expect_impossible(double log_density, const Story& story) {
  expect_true(log_density == -kInfinity, "-infinity: ln of the density 0", show(log_density),
              story);
}

void expect_unknown(double found, const Story& story) {
  expect_true(std::isnan(found), "NaN: nothing is known", show(found), story);
}

Draws draws_of(Random& random, Eigen::Index n) {
  Draws draws;
  draws.choice = random.unit();
  draws.normals = independent(random, n);
  draws.uniform = random.unit();
  return draws;
}

Draws draws_with(const VectorXd& normals, double choice, double uniform) {
  return {choice, normals, uniform};
}

LogDensity noting(Calls& calls, LogDensity density) {
  return [&calls, density = std::move(density)](const VectorXd& x) {
    calls.places.push_back(x);
    return density(x);
  };
}

Mistake acceptance_slip(const Mistake& otherwise) {
  const auto a = [](double from, double to, double forth, double back) {
    return student().log_acceptance(from, to, forth, back);
  };
  const double downhill = a(0, -1, 0, 0), uphill = a(-1, 0, 0, 0), hard_back = a(0, 0, 0, -1),
               hard_forth = a(0, 0, -1, 0);
  const auto is = [](double found, double expected) { return std::abs(found - expected) < 1e-9; };
  if (is(downhill, std::exp(-1.0)))
    return shown("the probability itself is returned where its logarithm belongs");
  if (is(downhill, 0) && is(uphill, -1))
    return shown("pi(x) and pi(x') are exchanged: what is more probable is to be accepted");
  if (is(uphill, 1)) return shown("the min with 0 is forgotten: no probability is above 1");
  if (is(downhill, -0.5)) return shown("a square-root rule: ln a is the whole difference");
  if (is(downhill, -std::log1p(std::exp(1.0))))
    return shown("Barker's rule, pi' / (pi + pi'): ln a is the difference, and never above 0");
  if (is(hard_back, 0) && is(hard_forth, 0))
    return shown("Hastings' correction is forgotten: ln q(x | x') - ln q(x' | x)");
  if (is(hard_back, 0) && is(hard_forth, -1))
    return shown(
        "Hastings' correction has the wrong sign: the way back counts up, the way forth down");
  if (is(hard_forth, 0) && is(a(0, -1, -1, 0), -1))
    return shown("the way forth is forgotten: ln q(x' | x) is subtracted");
  if (is(hard_back, 0)) return shown("the way back is forgotten: ln q(x | x') is added");
  return otherwise;
}

VectorXd independent(Random& random, Eigen::Index length) {
  VectorXd numbers(length);
  for (double& x : numbers) x = normal_number(random);
  return numbers;
}

VectorXd ar1(Random& random, double phi, Eigen::Index length) {
  VectorXd chain = independent(random, length);
  for (Eigen::Index i = 1; i < length; ++i)
    chain[i] = phi * chain[i - 1] + std::sqrt(1 - phi * phi) * chain[i];
  return chain;
}

std::vector<VectorXd> ar1_chains(std::uint64_t seed, double phi, int chains, Eigen::Index length) {
  Random random(seed);
  std::vector<VectorXd> all;
  for (int i = 0; i < chains; ++i) all.push_back(ar1(random, phi, length));
  return all;
}

std::vector<VectorXd> mapped(std::vector<VectorXd> chains,
                             const std::function<double(double)>& function) {
  for (VectorXd& chain : chains)
    for (double& x : chain) x = function(x);
  return chains;
}

std::vector<VectorXd> short_chains() {
  return {vector({0, 1, 3, 2, 4, 3, 5, 2}), vector({1, 2, 2, 4, 6, 5, 3, 4})};
}

double chi_square(const std::vector<int>& found, const std::vector<double>& expected) {
  double sum = 0.0;
  for (std::size_t i = 0; i < found.size(); ++i)
    sum += (found[i] - expected[i]) * (found[i] - expected[i]) / expected[i];
  return sum;
}

bool gives_numbers(double found, const std::string& scene, int equation_number) {
  expect_true(
      std::isfinite(found), "a number", show(found),
      {.scene = "this test's own answer is \"nothing\", so this is asked before it: " + scene,
       .slip = "the function gives no number (NaN or infinity) where there is one",
       .handout = equation(equation_number)});
  return std::isfinite(found);
}

}  // namespace tumble::a5_testing
