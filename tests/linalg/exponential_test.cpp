/// e^{Aτ} against closed forms.
#include "linalg/exponential.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

using namespace pwlsim::linalg;

namespace {

constexpr double exponential_rounding = 1e-15;

Vector applied(const Exponential& exponential, double tau, Vector y) {
  std::vector<double> work(2 * static_cast<std::size_t>(y.size()));
  exponential.apply(tau, y.data(), work.data());
  return y;
}

Vector vector(std::initializer_list<double> values) {
  Vector v(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), v.data());
  return v;
}

}  // namespace

TEST_CASE("rotation", "[unit]") {
  const double omega = 3.0;
  Matrix a(2, 2);
  a << 0, -omega, omega, 0;
  const Exponential exponential(a, omega);
  for (const double tau : {1e-9, 0.01, 0.3, 1.0, 7.7, 1234.5}) {
    INFO("tau " << tau);
    const Vector y = applied(exponential, tau, vector({1, 0}));
    // The phase ωτ itself is known to one rounding.
    const double bound = 4 * exponential_rounding * (1.0 + omega * tau);
    CHECK(std::abs(y[0] - std::cos(omega * tau)) <= bound);
    CHECK(std::abs(y[1] - std::sin(omega * tau)) <= bound);
  }
}

TEST_CASE("the series goes on from derivatives that are known", "[unit]") {
  const double omega = 3.0;
  Matrix a(2, 2);
  a << 0, -omega, omega, 0;
  const Exponential exponential(a, omega);
  // y, Ay, A²y, A³y of y = (1, 0).
  const std::vector<double> powers{1, 0, 0, omega, -omega * omega, 0, 0, -omega * omega * omega};
  for (const int known : {1, 2, 3})
    for (const double tau : {1e-9, 0.01, 0.1, 0.33}) {
      INFO("known " << known << ", tau " << tau);
      double y[2];
      REQUIRE(exponential.continue_series(powers.data(), known, tau, y));
      CHECK(std::abs(y[0] - std::cos(omega * tau)) <= 2 * exponential_rounding);
      CHECK(std::abs(y[1] - std::sin(omega * tau)) <= 2 * exponential_rounding);
    }
  double y[2] = {5.0, 7.0};
  CHECK_FALSE(exponential.continue_series(powers.data(), 3, 1.0, y));
  CHECK(y[0] == 5.0);
}

TEST_CASE("a Jordan block", "[unit]") {
  Matrix a(3, 3);
  a << -1, 1, 0, 0, -1, 1, 0, 0, -1;
  const Exponential exponential(a, norm_bound(a));
  for (const double tau : {1e-6, 0.5, 3.0, 40.0}) {
    INFO("tau " << tau);
    const Vector y = applied(exponential, tau, vector({0, 0, 1}));
    const double decay = std::exp(-tau);
    // Rounding is that of the vector at the start, of length one.
    CHECK(std::abs(y[0] - 0.5 * tau * tau * decay) <= 2 * exponential_rounding);
    CHECK(std::abs(y[1] - tau * decay) <= 2 * exponential_rounding);
    CHECK(std::abs(y[2] - decay) <= 2 * exponential_rounding);
  }
}

TEST_CASE("stiff: nine decades of decay rates side by side", "[unit]") {
  const Vector rates = vector({-1.0, -1e3, -1e6, -1e9});
  const Matrix a = rates.asDiagonal();
  const Exponential exponential(a, norm_bound(a));
  for (const double tau : {1e-10, 1e-7, 1e-4, 0.1, 2.0}) {
    INFO("tau " << tau);
    const Vector y = applied(exponential, tau, Vector::Ones(4));
    for (Eigen::Index i = 0; i < 4; ++i) CHECK(y[i] == Approx(std::exp(rates[i] * tau)).epsilon(1e-12).margin(1e-30));
  }
}

// e^{Aτ} of [[−1, g], [0, −2]] is [[e^−τ, g(e^−τ − e^−2τ)], [0, e^−2τ]]: squaring e^{Aτ} itself loses g·rounding in the entry of one.
TEST_CASE("a gain of 1e5 costs no digits", "[unit]") {
  const double gain = 1e5;
  Matrix a(2, 2);
  a << -1, gain, 0, -2;
  const Exponential exponential(a, norm_bound(a));
  for (const double tau : {1e-8, 1e-3, 1.0, 10.0}) {
    INFO("tau " << tau);
    const Vector from_second = applied(exponential, tau, vector({0, 1}));
    CHECK(from_second[0] == Approx(-gain * std::exp(-tau) * std::expm1(-tau)).epsilon(1e-13));
    CHECK(std::abs(from_second[1] - std::exp(-2 * tau)) <= exponential_rounding);
    const Vector from_first = applied(exponential, tau, vector({1, 0}));
    CHECK(std::abs(from_first[0] - std::exp(-tau)) <= exponential_rounding);
    CHECK(from_first[1] == 0.0);
  }
}

TEST_CASE("nilpotent parts need no rate", "[unit]") {
  Matrix a = Matrix::Zero(3, 3);
  a(0, 1) = a(1, 2) = 1.0;
  const Exponential exponential(a, 0.0);
  const double tau = 1e6;
  const Vector y = applied(exponential, tau, vector({1, 2, 3}));
  CHECK(y[0] == 1.0 + 2.0 * tau + 1.5 * tau * tau);
  CHECK(y[1] == 2.0 + 3.0 * tau);
  CHECK(y[2] == 3.0);
}

TEST_CASE("an oscillator of high frequency keeps its energy over many periods", "[unit]") {
  const double omega = 1e9;
  Matrix a(2, 2);
  a << 0, -omega, omega, 0;
  const Exponential exponential(a, omega);
  Vector y = vector({1, 0});
  const int steps = 20000;
  std::vector<double> work(4);
  for (int i = 0; i < steps; ++i) exponential.apply(3.21e-7, y.data(), work.data());
  CHECK(std::abs(y.norm() - 1.0) <= 1e-15 * steps * 321);  // a rounding for each radian: 321 a step
}

TEST_CASE("intervals that come again differ from a first one by nothing", "[unit]") {
  std::mt19937_64 engine(5);
  const auto number = [&] { return static_cast<double>(engine() >> 11U) * 0x1p-53 - 0.5; };
  const Matrix a = Matrix::NullaryExpr(5, 5, number);
  const Exponential used(a, norm_bound(a));
  const Vector start = Vector::NullaryExpr(5, number);
  for (const double tau : {0.1, 0.7, 3.0, 12.0})
    for (int repeat = 0; repeat < 12; ++repeat) {
      const double jittered = tau * (1.0 + repeat * 1e-16);
      const Exponential fresh(a, norm_bound(a));
      INFO("tau " << tau << ", repeat " << repeat);
      const Vector expected = applied(fresh, jittered, start);
      CHECK((applied(used, jittered, start) - expected).norm() <= 1e-14 * (1.0 + tau) * expected.norm());
    }
}

TEST_CASE("an interval that comes again among others that do not", "[unit]") {
  std::mt19937_64 engine(7);
  const auto number = [&] { return static_cast<double>(engine() >> 11U) * 0x1p-53 - 0.5; };
  for (const int n : {2, 7, 14}) {
    const Matrix a = Matrix::NullaryExpr(n, n, number);
    const Exponential used(a, norm_bound(a));
    const Vector start = Vector::NullaryExpr(n, number);
    for (int round = 0; round < 60; ++round)
      // Two that drift by less than what is made up for to first order, one for a while only, and two others.
      for (const double tau :
           {0.7 * (1.0 + 1e-10 * round), 3.0 * (1.0 - 1e-10 * round), round < 30 ? 0.3 : 0.31, 1.0 + number(), 2.0 + number()}) {
        const Exponential fresh(a, norm_bound(a));
        INFO(n << " states, tau " << tau << ", round " << round);
        const Vector expected = applied(fresh, tau, start);
        CHECK((applied(used, tau, start) - expected).norm() <= 1e-14 * (1.0 + n * tau) * expected.norm());
      }
  }
}

TEST_CASE("vector and matrix forms agree, and add up", "[unit]") {
  std::mt19937_64 engine(9);
  const auto number = [&] { return static_cast<double>(engine() >> 11U) * 0x1p-53 - 0.5; };
  const Eigen::Index n = GENERATE(4, 13, 30);  // in registers, and beyond them
  for (int trial = 0; trial < 20; ++trial) {
    const Matrix a = Matrix::NullaryExpr(n, n, number) * std::sqrt(4.0 / static_cast<double>(n));
    const Exponential exponential(a, norm_bound(a));
    const Vector start = Vector::NullaryExpr(n, number);
    const double s = 0.3 + trial * 0.2, t = 1.7;
    const Vector direct = applied(exponential, s + t, start);
    const Vector in_two = applied(exponential, t, applied(exponential, s, start));
    const Vector by_matrix = start + exponential.minus_identity(s + t) * start;
    const double bound = 1e-13 * (1.0 + std::min(start.norm() * std::exp(norm_bound(a) * (s + t)), 1e2 * direct.norm()));
    CHECK((direct - in_two).norm() <= bound);
    CHECK((direct - by_matrix).norm() <= bound);
  }
}

TEST_CASE("nothing happens in no time, and to nothing", "[unit]") {
  const Matrix a = Matrix::Constant(2, 2, 5.0);
  const Exponential exponential(a, norm_bound(a));
  CHECK(applied(exponential, 0.0, vector({1, -2})) == vector({1, -2}));
  CHECK(applied(exponential, 3.0, vector({0, 0})).isZero(0.0));
  CHECK(applied(Exponential(Matrix(0, 0), 0.0), 3.0, Vector(0)).size() == 0);
}

TEST_CASE("the cheap norm bound is a norm's", "[unit]") {
  Matrix m(2, 2);
  m << 1, -2, 3, 4;  // ∞-norm 7, 1-norm 6, Frobenius norm √30
  CHECK(norm_bound(m) == Approx(std::sqrt(30.0)));
  m << 5, 0, 5, 0;  // ∞-norm 5, 1-norm 10, Frobenius norm √50
  CHECK(norm_bound(m) == 5.0);
  CHECK(norm_bound(Matrix(0, 0)) == 0.0);
}
