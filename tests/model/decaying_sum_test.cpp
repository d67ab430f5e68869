#include "model/decaying_sum.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <random>

using pwlsim::model::DecayingSum;

namespace {

/// Least value over 4,000 points from 1e-4 to 100 times the time constants' unit, and at both ends; with a drift until 40 times the slowest.
double sampled_least(const DecayingSum& sum) {
  double least = INFINITY, slowest = 0.0;
  for (const auto& term : sum.terms) slowest = std::max(slowest, term.time_constant);
  if (sum.drift == 0.0) least = sum.rest;
  for (int i = -1; i < 4000; ++i) {
    const double tau = i < 0 ? 0.0 : std::pow(10.0, -4.0 + 6.0 * i / 4000.0);
    if (sum.drift != 0.0 && tau > 40.0 * slowest) break;
    double f = sum.rest + sum.drift * tau;
    for (const auto& term : sum.terms) f += term.start * std::exp(-tau / term.time_constant);
    least = std::min(least, f);
  }
  return least;
}

}  // namespace

TEST_CASE("a voltage that rises from zero behind decays of both signs stays above it", "[unit]") {
  // e^{-0}: 22 - 11 - 7 - 8 + 4 = 0, and the slope there is 11/4 + 7 + 8 - 4 > 0.
  CHECK(DecayingSum{22.0, 0.0, {{-11.0, 4.0}, {-7.0, 1.0}, {-8.0, 1.0}, {4.0, 1.0}}}.stays_above(-1e-9));
  // A ring of none: 1 - 2 e^{-t} + e^{-4t} is zero with slope -2 at t = 0.
  CHECK_FALSE(DecayingSum{1.0, 0.0, {{-2.0, 1.0}, {1.0, 0.25}}}.stays_above(-1e-9));
  CHECK_FALSE(DecayingSum{-1.0, 0.0, {{3.0, 1.0}}}.stays_above(0.0));
  CHECK(DecayingSum{1.0, 0.0, {}}.stays_above(1.0));
}

// -1 + 2 t + e^{-t} is zero at t = 0, with the slope 1, and convex; with 0.5 t its slope there is -0.5.
TEST_CASE("a current whose slow part begins below zero and rises stays above it while the decay lasts", "[unit]") {
  CHECK_FALSE(DecayingSum{-1.0, 0.0, {{1.0, 1.0}}}.stays_above(-1e-9));
  CHECK(DecayingSum{-1.0, 2.0, {{1.0, 1.0}}}.stays_above(-1e-9));
  CHECK(DecayingSum{-1.0, 2.0, {{0.5, 1.0}, {0.5, 0.1}}}.stays_above(-1e-9) == false);  // slope at 0: 2 - 0.5 - 5
  CHECK_FALSE(DecayingSum{-1.0, 0.5, {{1.0, 1.0}}}.stays_above(-1e-9));
}

// 1 - t/2 - e^{-t} is zero at t = 0, with the slope 1/2, and again at t = 1.594 (the root of 1 - t/2 = e^{-t}); 1 - t/50 - e^{-t} has 0.2 left at t = 40.
TEST_CASE("a current that ends before its decay does not stay above zero", "[unit]") {
  CHECK_FALSE(DecayingSum{1.0, -0.5, {{-1.0, 1.0}}}.stays_above(-1e-9));
  CHECK(DecayingSum{1.0, -0.02, {{-1.0, 1.0}}}.stays_above(-1e-9));
  CHECK_FALSE(DecayingSum{1.0, -0.5, {{1.0, 1.0}}}.keeps_sign());
  CHECK(DecayingSum{1.0, -0.02, {{1.0, 1.0}}}.keeps_sign());
}

TEST_CASE("what is said to stay above does so, and most that does is found", "[property]") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> start(-1.0, 1.0), logarithm(-1.0, 1.0);
  int above = 0, proved = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    DecayingSum sum{0.5 + 0.5 * start(random), trial % 2 == 0 ? 0.0 : std::pow(10.0, logarithm(random)), {}};
    if (trial % 4 == 3) sum.drift *= -0.01;
    for (int k = 0; k < 3; ++k) sum.terms.push_back({start(random), std::pow(10.0, logarithm(random))});
    const bool is_above = sampled_least(sum) >= 0.0;
    above += is_above;
    if (!sum.stays_above(0.0)) continue;
    ++proved;
    CHECK(is_above);
  }
  INFO(proved << " of " << above);
  CHECK(proved >= 0.95 * above);
}
