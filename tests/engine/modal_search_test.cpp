/// Roots of sums of exponentials, against the flow itself: e^{Aτ} y by the series and by squaring (linalg/exponential.hpp), sampled.
#include "engine/exact/modal_search.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "model/build_mode.hpp"
#include "model/handmade_systems.hpp"
#include "support/circuit.hpp"
#include "support/random.hpp"

namespace {

using namespace pwlsim;
using engine::ModalSearch;
using linalg::Matrix;
using linalg::Vector;
using model::Mode;

constexpr double noise = 1e-13;       ///< of guards, against the terms they are sums of
constexpr double agreement = 1e-8;    ///< of guards, against the largest state so far: squaring loses ‖A‖τ units of its last place
constexpr double beside_root = 1e-5;  ///< against its time

/// Rates of both kinds from 1 to 10⁶ 1/s, a few of them growing (not far within the seconds looked at), in mixed coordinates.
Matrix random_flow(test::Random& random, int n) {
  Matrix rates = Matrix::Zero(n, n);
  for (int i = 0; i < n; ++i) {
    const double rate = std::pow(10.0, random.between(0.0, 6.0)), angle = random.between(0.0, 1.5);
    rates(i, i) = random.chance(0.1) ? random.between(0.0, 5.0) : -rate;
    if (i + 1 == n || random.chance(0.5)) continue;
    rates(i + 1, i + 1) = rates(i, i) = -rate * std::sin(angle);
    rates(i, i + 1) = rate * std::cos(angle);
    rates(i + 1, i) = -rates(i, i + 1);
    ++i;
  }
  const Matrix mix = Matrix::NullaryExpr(n, n, [&] { return random.between(-1.0, 1.0); }) + 1.5 * Matrix::Identity(n, n);
  return mix * rates * mix.inverse();
}

void begin_sources(const model::Exosystem& exosystem, double* zeta) {
  auto phase = exosystem.start();
  exosystem.advance(phase, 0.0, 0.0);
  exosystem.evaluate(phase, 0.0, zeta);
}

/// Guards are the rows of C: the diodes of the system take no part.
struct Scene {
  model::System system;
  std::unique_ptr<Mode> mode;
  Vector y;
  std::vector<ModalSearch::Guard> guards;

  Scene(test::Random& random, int n, int guards_count, bool with_sources) {
    std::vector<model::SourceFunction> sources;
    if (with_sources) {
      sources.emplace_back(model::Sin{.offset = 0.3, .amplitude = 1.0, .frequency = std::pow(10.0, random.between(0.0, 4.0))});
      sources.emplace_back(model::Pwl{.points = {{0.0, random.between(-1.0, 1.0)}, {100.0, random.between(-1e4, 1e4)}}});
    }
    const model::Exosystem exosystem(sources, true);
    const int size = n + exosystem.size();
    Matrix a = Matrix::Zero(size, size);
    a.topLeftCorner(n, n) = random_flow(random, n);
    a.bottomRightCorner(exosystem.size(), exosystem.size()) = exosystem.a();
    const Matrix inputs = Matrix::NullaryExpr(n, exosystem.rows().rows(), [&] { return random.between(-1e3, 1e3); });
    a.topRightCorner(n, exosystem.size()) = inputs * exosystem.rows();
    Matrix c = Matrix::NullaryExpr(guards_count, size, [&] { return random.chance(0.3) ? 0.0 : random.between(-1.0, 1.0); });
    c.col(0).setConstant(0.5);
    system = test::handmade(a, Matrix::Zero(size, guards_count), c, Matrix::Zero(guards_count, guards_count), sources, true);
    mode = model::build_mode(system, model::IndexSet(guards_count));
    Vector x = Vector::NullaryExpr(size, [&] { return random.between(-1.0, 1.0); });
    begin_sources(*system.exosystem, x.data() + n);
    y.resize(mode->ny);
    model::to_mode(system, *mode, x.data(), y.data());
    for (int row = 0; row < guards_count; ++row) {
      const double value = linalg::row_times(mode->guards, row, y.data());
      if (value <= 0.0) mode->guards.row(row) *= -1.0;
      guards.push_back({row, std::abs(value), noise * size_of(row, y), false});
    }
  }

  [[nodiscard]] double size_of(int row, const Vector& at) const { return linalg::absolute_row_times(mode->guards, row, at.data()); }
  [[nodiscard]] Vector at(double tau) const {
    Vector state = y, work(2 * y.size());
    mode->flow.apply_once(tau, state.data(), work.data());
    return state;
  }
};

struct Tally {
  int positive = 0, root = 0, undecided = 0, without_form = 0;
};

void compare(const Scene& scene, double h, Tally& tally) {
  const auto form = model::modal_form(scene.system, *scene.mode, INFINITY);
  if (!form) {
    ++tally.without_form;
    return;
  }
  ModalSearch search;
  const ModalSearch::Found found = search.search(*form, scene.guards, scene.y.data(), h);
  if (found.verdict == ModalSearch::Verdict::undecided) {
    ++tally.undecided;
    return;
  }
  const bool has_root = found.verdict == ModalSearch::Verdict::root;
  ++(has_root ? tally.root : tally.positive);
  const double end = has_root ? found.at : h;
  CHECK(end <= h);
  double largest = scene.y.norm();
  for (int k = 1; k < 400; ++k) {
    const double tau = end * (1.0 - beside_root) * (k < 200 ? std::pow(10.0, -(200 - k) / 25.0) : k / 400.0);
    const Vector y = scene.at(tau);
    largest = std::max(largest, y.norm());
    for (const auto& guard : scene.guards) {
      const double value = linalg::row_times(scene.mode->guards, guard.row, y.data());
      if (value < -agreement * largest) {
        CAPTURE(tau, end, guard.row, value, has_root);
        CHECK(value >= -agreement * largest);
        return;
      }
    }
  }
  if (!has_root) return;
  const int row = scene.guards[found.guard].row;
  CHECK(std::abs(linalg::row_times(scene.mode->guards, row, scene.at(found.at).data())) <= agreement * largest);
  CHECK(found.lower <= found.at);
  CHECK(found.at <= found.upper);
  CHECK(linalg::row_times(scene.mode->guards, row, scene.at(found.upper).data()) <= 0.0);
}

}  // namespace

TEST_CASE("roots by eigenvectors: as the flow has them, with rates over six decades", "[property]") {
  Tally tally;
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    CAPTURE(seed);
    test::Random random(seed);
    Scene scene(random, random.whole(1, 6), random.whole(1, 4), random.chance(0.5));
    compare(scene, std::pow(10.0, random.between(-6.0, 0.5)), tally);
  }
  CAPTURE(tally.positive, tally.root, tally.undecided, tally.without_form);
  CHECK(tally.positive > 300);
  CHECK(tally.root > 1000);
  CHECK(tally.undecided + tally.without_form < 60);  // guards that decay to less than their noise
}

TEST_CASE("roots by eigenvectors: guards that leave zero", "[property]") {
  Tally tally;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    CAPTURE(seed);
    test::Random random(seed);
    const int n = random.whole(2, 6);
    Scene scene(random, n, 2, random.chance(0.5));
    // The first guard begins at zero: the constant state, which the row reads, takes away what it is.
    auto& guard = scene.guards[0];
    const int constant = scene.mode->n1 + scene.system.exosystem->constant();
    scene.mode->guards(0, constant) -= guard.value / scene.y[constant];
    Vector slope(scene.y.size());
    linalg::multiply(scene.mode->flow.a(), scene.y.data(), slope.data());
    if (linalg::row_times(scene.mode->guards, 0, slope.data()) < 0.0) scene.mode->guards.row(0) *= -1.0;
    guard = {0, linalg::row_times(scene.mode->guards, 0, scene.y.data()), noise * scene.size_of(0, scene.y), true};
    compare(scene, std::pow(10.0, random.between(-6.0, 0.5)), tally);
  }
  CAPTURE(tally.positive, tally.root, tally.undecided, tally.without_form);
  CHECK(tally.positive > 100);
  CHECK(tally.root > 300);
  CHECK(tally.undecided + tally.without_form < 50);
}

TEST_CASE("roots by eigenvectors: a fast transient beside a slow guard costs no intervals", "[unit]") {
  // g = 1 + 1e-3·e^{−10⁹ t} − t/2, from two states that decay and a ramp: one interval for the three of them, and the root at 2 s.
  const std::vector<model::SourceFunction> sources{model::Pwl{.points = {{0.0, 0.0}, {100.0, -50.0}}}};
  const model::Exosystem exosystem(sources, true);
  const int size = 1 + exosystem.size();
  Matrix flow = Matrix::Zero(size, size), c = Matrix::Zero(1, size);
  flow(0, 0) = -1e9;
  flow.bottomRightCorner(size - 1, size - 1) = exosystem.a();
  c(0, 0) = 1e-3;
  c.rightCols(size - 1) = exosystem.rows();
  c(0, 1 + exosystem.constant()) += 1.0;
  const model::System system = test::handmade(flow, Matrix::Zero(size, 1), c, Matrix::Zero(1, 1), sources, true);
  const auto mode = model::build_mode(system, model::IndexSet(1));
  Vector y = Vector::Zero(size);
  y[0] = 1.0;
  begin_sources(*system.exosystem, y.data() + 1);
  const auto form = model::modal_form(system, *mode, INFINITY);
  REQUIRE(form);
  const std::vector<ModalSearch::Guard> guards{{0, linalg::row_times(mode->guards, 0, y.data()), noise, false}};
  ModalSearch search;
  CHECK(search.search(*form, guards, y.data(), 1.9).verdict == ModalSearch::Verdict::positive);
  const ModalSearch::Found found = search.search(*form, guards, y.data(), 10.0);
  CHECK(found.verdict == ModalSearch::Verdict::root);
  CHECK(found.at == Approx(2.0).epsilon(1e-13));
  CHECK(search.intervals() <= 6);
}

// 1/2 + cos τ, whose first root is 2π/3, with the rest of a long run before it; then from where it is zero, until it is so again.
TEST_CASE("how far there is to go does not count before an event", "[unit]") {
  Matrix a = Matrix::Zero(3, 3), c(1, 3);
  a(0, 1) = 1.0;
  a(1, 0) = -1.0;
  c << 1.0, 0.0, 0.5;
  const model::System system = test::handmade(a, Matrix::Zero(3, 1), c, Matrix::Zero(1, 1));
  const auto mode = model::build_mode(system, model::IndexSet(1));
  const auto form = model::modal_form(system, *mode, INFINITY);
  REQUIRE(form);
  const Vector y = (Vector(3) << 1.0, 0.0, 1.0).finished();
  const std::vector<ModalSearch::Guard> guards{{0, 1.5, noise, false}};
  ModalSearch search;
  for (const double rest : {10.0, 1e3, 1e6, 1e9}) {
    const std::uint64_t before = search.intervals();
    const ModalSearch::Found found = search.search(*form, guards, y.data(), rest);
    CHECK(found.verdict == ModalSearch::Verdict::root);
    CHECK(found.at == Approx(2.0 * std::numbers::pi / 3.0).epsilon(1e-13));
    CHECK(search.intervals() - before <= 8);
  }
}

// a e^{−τ} + b e^{−λτ} − c falls throughout; from the secant through its ends Chebyshev's iteration comes to a place far from the root at which
// its step is nothing.
TEST_CASE("a root beside which Chebyshev's iteration stands still", "[unit]") {
  struct Case {
    double a, b, rate, c, h;
  };
  for (const Case& k : {Case{0.7229219511326379, 1.152914965710954, 10.0, 0.874123282742411, 1.0},
                        Case{0.6929184284242083, 2.7080980412368794, 10.0, 0.821161865254852, 4.0},
                        Case{0.5923054657990292, 2.7308717236257123, 10.0, 0.6371561744005414, 4.0},
                        Case{0.23913734127520847, 0.8390689801984391, 40.0, 0.2536282442286415, 4.0}}) {
    Matrix a = Matrix::Zero(3, 3), c(1, 3);
    a(0, 0) = -1.0;
    a(1, 1) = -k.rate;
    c << k.a, k.b, -k.c;
    const model::System system = test::handmade(a, Matrix::Zero(3, 1), c, Matrix::Zero(1, 1));
    const auto mode = model::build_mode(system, model::IndexSet(1));
    const auto form = model::modal_form(system, *mode, INFINITY);
    REQUIRE(form);
    const Vector y = Vector::Ones(3);
    const std::vector<ModalSearch::Guard> guards{{0, k.a + k.b - k.c, noise, false}};
    ModalSearch search;
    const ModalSearch::Found found = search.search(*form, guards, y.data(), k.h);
    REQUIRE(found.verdict == ModalSearch::Verdict::root);
    long double low = 0.0L, high = k.h;
    for (int i = 0; i < 100; ++i) {
      const long double middle = (low + high) / 2;
      (k.a * std::exp(-middle) + k.b * std::exp(-k.rate * middle) > static_cast<long double>(k.c) ? low : high) = middle;
    }
    CHECK(found.at == Approx(static_cast<double>(low)).epsilon(1e-12));
  }
}

TEST_CASE("eigenvectors that are one have no modal form", "[unit]") {
  Matrix a(2, 2);
  a << -1.0, 1.0, 0.0, -1.0;
  const model::System system = test::handmade(a, Matrix::Zero(2, 1), Matrix::Ones(1, 2), Matrix::Zero(1, 1));
  CHECK_FALSE(model::modal_form(system, *model::build_mode(system, model::IndexSet(1)), INFINITY));
}

// x' = T Λ T x, T a reflection: rounding of 10¹² 1/s is more than 10⁻¹⁰ of 300 1/s, but moves nothing in a microsecond. The guard e^{−300 τ} − (1 − 10⁻⁴) has its root at −ln(1 − 10⁻⁴)/300; a rate known to
// 10⁻⁴ 1/s, the rounding of the matrix, tells it to 10⁻⁶.
TEST_CASE("rates that rounding of a far larger one hides have a modal form for as long as that moves nothing", "[unit]") {
  constexpr double fast = 1e12, slow = 300.0, longest = 1e-6, fallen = 1e-4, known = 1e-5;
  const Eigen::Vector3d v = Eigen::Vector3d(1.0, 2.0, 2.0) / 3.0;
  const Eigen::Matrix3d t = Eigen::Matrix3d::Identity() - 2.0 * v * v.transpose();
  const Matrix a = t * Eigen::Vector3d(-fast, -slow, 0.0).asDiagonal() * t;
  const Matrix c = (t * Eigen::Vector3d(0.0, 1.0, fallen - 1.0)).transpose();
  const model::System system = test::handmade(a, Matrix::Zero(3, 1), c, Matrix::Zero(1, 1));
  const auto mode = model::build_mode(system, model::IndexSet(1));
  CHECK_FALSE(model::modal_form(system, *mode, INFINITY));
  const auto form = model::modal_form(system, *mode, longest);
  REQUIRE(form);
  CHECK(form->velocity_errors.maxCoeff() > 0.0);
  const Vector y = t * Eigen::Vector3d::Ones();
  ModalSearch search;
  const std::vector<ModalSearch::Guard> guards{{0, fallen, noise, false}};
  const ModalSearch::Found found = search.search(*form, guards, y.data(), longest);
  REQUIRE(found.verdict == ModalSearch::Verdict::root);
  CHECK(found.at == Approx(-std::log1p(-fallen) / slow).epsilon(known));
}

// x_k' = x_{k−1} − 2 x_k + x_{k+1} between ends at zero has the motions sin(jkπ/(n+1)) e^{−λ_j τ}, λ_j = 4 sin²(jπ/(2(n+1))). Two of them, 2 sin(3·) e^{−λ₃τ} − sin(1·) e^{−λ₁τ}, cancel where e^{(λ₃−λ₁)τ} is twice the
// ratio of their sines. Forty states are more than have eigenvectors in extended precision.
TEST_CASE("a chain of forty stores has a modal form, and the root that its sines give", "[unit]") {
  constexpr int n = 40, node = 4;
  const auto sine = [](int j, int k) { return std::sin(j * k * std::numbers::pi / (n + 1)); };
  const auto rate = [](int j) { return 4.0 * std::pow(std::sin(j * std::numbers::pi / (2 * (n + 1))), 2); };
  Matrix a = -2.0 * Matrix::Identity(n, n), c = Matrix::Zero(1, n);
  for (int k = 0; k + 1 < n; ++k) a(k, k + 1) = a(k + 1, k) = 1.0;
  c(0, node - 1) = 1.0;
  const model::System system = test::handmade(a, Matrix::Zero(n, 1), c, Matrix::Zero(1, 1));
  const auto mode = model::build_mode(system, model::IndexSet(1));
  const auto form = model::modal_form(system, *mode, INFINITY);
  REQUIRE(form);
  CHECK(form->rates.size() == n);
  const Vector y = Vector::NullaryExpr(n, [&](Eigen::Index k) {
    const int at = static_cast<int>(k) + 1;
    return 2.0 * sine(3, at) - sine(1, at);
  });
  const double root = std::log(2.0 * sine(3, node) / sine(1, node)) / (rate(3) - rate(1));
  ModalSearch search;
  const std::vector<ModalSearch::Guard> guards{{0, y[node - 1], noise, false}};
  const ModalSearch::Found found = search.search(*form, guards, y.data(), 10.0 * root);
  REQUIRE(found.verdict == ModalSearch::Verdict::root);
  CHECK(found.at == Approx(root).epsilon(1e-11));
  CHECK(search.search(*form, guards, y.data(), 0.9 * root).verdict == ModalSearch::Verdict::positive);
}

// x' = −x + unit·sin ωt: in whatever unit the sine is written, its eigenvectors are as far from the state's own.
TEST_CASE("the unit of a source does not decide whether there is a modal form", "[unit]") {
  constexpr double frequency = 50.0, omega = 2 * std::numbers::pi * frequency;
  for (const double unit : {1e-12, 1.0, 1e12}) {
    Matrix a = Matrix::Zero(3, 3), c = Matrix::Zero(1, 3);
    a << -1.0, unit, 0.0, 0.0, 0.0, omega, 0.0, -omega, 0.0;
    c(0, 0) = 1.0;
    const std::vector<model::SourceFunction> sources{model::Sin{.amplitude = 1.0, .frequency = frequency}};
    const model::System system = test::handmade(a, Matrix::Zero(3, 1), c, Matrix::Zero(1, 1), sources);
    REQUIRE(system.n == 1);
    CHECK(model::modal_form(system, *model::build_mode(system, model::IndexSet(1)), INFINITY));
  }
}

// v(a) = t + cos ωt from a lossless tank that rides on a ramp, behind a diode to 5 V: the first t at which it gets there, beside 600,000 periods before.
TEST_CASE("a fast ring beside a diode that blocks is not followed period by period", "[unit]") {
  constexpr long double omega = 0x1p20L, level = 5.0L;
  const auto above = [](long double t) { return t + std::cos(omega * t) - level; };
  const long double period = 2 * std::numbers::pi_v<long double> / omega;
  long double peak = (std::floor((level - 1.01L) / period) * 2 * std::numbers::pi_v<long double> + std::asin(1 / omega)) / omega;
  while (above(peak) < 0) peak += period;
  long double low = peak - period / 2, high = peak;
  for (int i = 0; i < 100; ++i) {
    const long double middle = (low + high) / 2;
    (above(middle) < 0 ? low : high) = middle;
  }
  test::TestCircuit c;
  c.v("s", "0", model::Pwl{.points = {{0.0, 0.0}, {100.0, 100.0}}});
  c.c("a", "s", 0x1p-20, 1.0);
  c.l("a", "s", 0x1p-20);
  c.d("a", "k");
  c.r("k", "m", 1.0);
  c.v("m", "0", model::Dc{5.0});
  c.save_v("a");
  const test::Run run = test::simulate(c.network(), {static_cast<double>(high) + 1e-7, 1, true, true});
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(run.answer.remarks.empty());
  REQUIRE(run.rows.size() > 2);
  // Rounding of the phase, ωt·10⁻¹⁶ rad, over the slope there.
  const auto slope = static_cast<double>(1 - omega * std::sin(omega * high));
  CHECK(std::abs(run.rows[1][0] - static_cast<double>(high)) <= 1e-8 / slope);
  CHECK(run.answer.statistics.steps < 20'000);
}

// x' = 2x + y, y' = 10⁹(x − y): e^{3·400 s} is no number any more, which must not hide that x passes 1 after 0.77 s.
TEST_CASE("a passage in a mode that would grow beyond all numbers", "[unit]") {
  test::TestCircuit c;
  c.c("x", "0", 1.0, 0.1);
  c.r("x", "0", -1.0 / 3.0);
  c.c("y", "0", 1e-9, 1.0);
  c.r("y", "x", 1.0);
  c.d("x", "k");
  c.v("k", "0", model::Dc{1.0});
  c.save_v("x");
  const test::Run run = test::simulate(c.network(), {400.0, 1, true, true});
  REQUIRE(run.answer.outcome == engine::Outcome::completed);
  CHECK(run.answer.remarks.empty());
  const long double trace = 2.0L - 1e9L, root = std::sqrt(trace * trace + 12e9L);
  const long double fast = (trace - root) / 2, slow = -3e9L / fast;  // their product is the determinant
  const long double amplitude = (1.2L - fast * 0.1L) / (slow - fast);
  REQUIRE(run.rows.size() > 2);
  CHECK(run.rows[1][0] == Approx(static_cast<double>(-std::log(amplitude) / slow)).epsilon(1e-12));
  CHECK(run.answer.statistics.steps < 1000);
}
