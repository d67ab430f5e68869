/// Networks small enough to know their poles, their jumps and their energy by hand.
#include "model/extraction.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "model/build_mode.hpp"
#include "support/circuit.hpp"

using namespace pwlsim;
using namespace pwlsim::test;
using model::Matrix;
using model::Vector;

namespace {

constexpr double tight = 1e-12;  ///< relative, of eigenvalues that are well conditioned

struct Extracted {
  std::vector<model::Island> islands;
  std::optional<model::Extraction> largest;
  Diagnostics diagnostics;

  [[nodiscard]] const model::System& system() const { return largest->system; }
};

/// The island with the most energy stores, ports and resistors: sources to ground may stand alone.
Extracted extract(const TestCircuit& circuit) {
  Extracted result;
  result.islands = model::split_islands(circuit.network());
  const auto size = [](const model::Island& island) {
    const model::Network& n = island.network;
    return n.capacitors.size() + n.inductors.size() + n.diodes.size() + n.resistors.size();
  };
  const auto largest =
      std::max_element(result.islands.begin(), result.islands.end(), [&](const auto& a, const auto& b) { return size(a) < size(b); });
  result.largest = model::extract(*largest, result.diagnostics);
  return result;
}

std::string first_id(const Extracted& extracted) {
  return extracted.diagnostics.all().empty() ? "" : extracted.diagnostics.all().front().id;
}

/// Eigenvalues in 1/s, by real part, then imaginary part.
std::vector<std::complex<double>> eigenvalues(const Matrix& a) {
  const Vector::Index n = a.rows();
  const Eigen::EigenSolver<Matrix> solver(a, false);
  std::vector<std::complex<double>> values(static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) values[static_cast<std::size_t>(i)] = solver.eigenvalues()[i];
  std::sort(values.begin(), values.end(), [](const auto& x, const auto& y) {
    return std::abs(x.real() - y.real()) > 1e-9 * std::abs(x) ? x.real() < y.real() : x.imag() < y.imag();
  });
  return values;
}

/// Of the energy states in the mode with the given active ports, sources left out.
std::vector<std::complex<double>> poles(const model::System& system, const std::vector<int>& active = {}) {
  model::IndexSet set(system.ports);
  for (const int port : active) set.set(port, true);
  const auto mode = model::build_mode(system, set);
  REQUIRE(mode->regular);
  return eigenvalues(mode->flow.a().topLeftCorner(mode->n1, mode->n1));
}

/// Ports in the position that lets no current pass (`conducting` false) or no voltage.
std::vector<int> active_when(const model::System& system, bool conducting) {
  std::vector<int> active;
  for (int i = 0; i < system.ports; ++i)
    if (system.port[static_cast<std::size_t>(i)].input_is_current == conducting) active.push_back(i);
  return active;
}

}  // namespace

TEST_CASE("R and C: one pole at -1/RC", "[unit]") {
  TestCircuit c;
  c.r("a", "0", 2e3);
  c.c("a", "0", 3e-6);
  const auto p = poles(extract(c).system());
  REQUIRE(p.size() == 1);
  CHECK(p[0].real() == Approx(-1.0 / (2e3 * 3e-6)).epsilon(tight));
}

TEST_CASE("a series resonance: s² + sR/L + 1/LC", "[unit]") {
  const double r = 10.0, l = 1e-3, cap = 1e-6;
  TestCircuit c;
  c.r("a", "b", r);
  c.l("b", "d", l);
  c.c("d", "a", cap);
  c.r("a", "0", 1.0);  // ties the loop to ground without a part in it
  const auto p = poles(extract(c).system());
  REQUIRE(p.size() == 2);
  const double damping = r / (2 * l), frequency = std::sqrt(1.0 / (l * cap) - damping * damping);
  for (const auto& pole : p) CHECK(pole.real() == Approx(-damping).epsilon(1e-10));
  CHECK(p[1].imag() == Approx(frequency).epsilon(tight));
}

TEST_CASE("the tank with resistor and diode, in both positions of the diode", "[unit]") {
  const double r = 1e3, l = 10e-3, cap = 1e-6;
  TestCircuit c;
  c.c("1", "0", cap);
  c.l("1", "0", l);
  c.r("1", "2", r);
  c.d("2", "0");
  const Extracted extracted = extract(c);
  const double resonance = 1.0 / std::sqrt(l * cap), damping = 1.0 / (2 * r * cap);
  const auto blocking = poles(extracted.system(), active_when(extracted.system(), false));
  REQUIRE(blocking.size() == 2);
  CHECK(std::abs(blocking[1].real()) <= tight * resonance);
  CHECK(blocking[1].imag() == Approx(resonance).epsilon(tight));
  const auto conducting = poles(extracted.system(), active_when(extracted.system(), true));
  REQUIRE(conducting.size() == 2);
  CHECK(conducting[1].real() == Approx(-damping).epsilon(1e-10));
  CHECK(conducting[1].imag() == Approx(std::sqrt(resonance * resonance - damping * damping)).epsilon(tight));
}

// Hard case 24: one state, −1/(R(C1+C2)); a step of the source moves v(m) by C1/(C1+C2) of it, charge conserved.
TEST_CASE("a loop of a source and two capacitors has one state, and the source reaches the node", "[unit]") {
  const double r = 1e6, c1 = 1e-12, c2 = 3e-12;
  TestCircuit c;
  c.v("s", "0", model::Dc{1.0});
  c.c("s", "m", c1);
  c.c("m", "0", c2);
  c.r("m", "0", r);
  c.save_v("m");
  const Extracted extracted = extract(c);
  const model::System& system = extracted.system();
  CHECK(system.n == 1);
  const auto p = poles(system);
  CHECK(p[0].real() == Approx(-1.0 / (r * (c1 + c2))).epsilon(tight));
  REQUIRE(system.outputs.size() == 1);
  CHECK(system.outputs[0].state[1] == Approx(c1 / (c1 + c2)).epsilon(tight));
}

TEST_CASE("two inductors in series are one state", "[unit]") {
  TestCircuit c;
  c.l("a", "b", 1.0);
  c.l("b", "d", 3.0);
  c.r("d", "a", 8.0);
  c.r("a", "0", 1.0);
  const auto p = poles(extract(c).system());
  REQUIRE(p.size() == 1);
  CHECK(p[0].real() == Approx(-2.0).epsilon(tight));
}

TEST_CASE("parallel capacitors and capacitors in series", "[unit]") {
  TestCircuit parallel;
  parallel.c("a", "0", 1.0);
  parallel.c("a", "0", 3.0);
  parallel.r("a", "0", 0.5);
  const auto p = poles(extract(parallel).system());
  REQUIRE(p.size() == 1);
  CHECK(p[0].real() == Approx(-0.5).epsilon(tight));

  TestCircuit series;  // the charge of the middle node never changes: a pole at zero
  series.c("a", "b", 1.0);
  series.c("b", "0", 3.0);
  series.r("a", "0", 2.0);
  const auto q = poles(extract(series).system());
  REQUIRE(q.size() == 2);
  CHECK(q[0].real() == Approx(-1.0 / (2.0 * 0.75)).epsilon(tight));
  CHECK(std::abs(q[1]) <= tight);
}

// Perfect coupling: L1 i1 + √(L1 L2) i2 is the one flux. With a load R across each winding it decays at 1/(L1/R1 + L2/R2).
TEST_CASE("coupled inductors", "[unit]") {
  const double l1 = 4.0, l2 = 9.0, r1 = 2.0, r2 = 3.0;
  const double k = GENERATE(1.0, -1.0, 0.5);
  TestCircuit c;
  const int a = c.l("a", "0", l1);
  const int b = c.l("b", "0", l2);
  c.k(a, b, k);
  c.r("a", "0", r1);
  c.r("b", "0", r2);
  c.r("a", "b", 1e9);  // keeps it one island whatever the coupling is taken for
  const auto p = poles(extract(c).system());
  if (std::abs(k) == 1.0) {
    REQUIRE(p.size() == 1);
    CHECK(p[0].real() == Approx(-1.0 / (l1 / r1 + l2 / r2)).epsilon(1e-7));
    return;
  }
  // R⁻¹… : det(s L + R) = 0 with L = [[4, m], [m, 9]], m = k·6, R = diag(2, 3).
  const double m = k * 6.0, da = l1 * l2 - m * m, db = l1 * r2 + l2 * r1, dc = r1 * r2;
  REQUIRE(p.size() == 2);
  CHECK(p[0].real() == Approx((-db - std::sqrt(db * db - 4 * da * dc)) / (2 * da)).epsilon(1e-7));
  CHECK(p[1].real() == Approx((-db + std::sqrt(db * db - 4 * da * dc)) / (2 * da)).epsilon(1e-7));
}

TEST_CASE("couplings that no windings can have are refused", "[unit]") {
  TestCircuit c;
  const int l1 = c.l("a", "0", 1.0), l2 = c.l("b", "0", 1.0), l3 = c.l("d", "0", 1.0);
  c.k(l1, l2, 1.0);
  c.k(l2, l3, 1.0);
  c.k(l1, l3, -1.0);
  for (const auto* node : {"a", "b", "d"}) c.r(node, "0", 1.0);
  CHECK(first_id(extract(c)) == "E-coupling");
}

TEST_CASE("the stored energy is half the squared length of the state", "[unit]") {
  TestCircuit c;
  c.c("a", "0", 2e-6, 5.0);
  c.l("a", "b", 3e-3, 0.1);
  c.l("d", "0", 1e-3, -0.2);
  c.k(0, 1, 0.5);
  c.r("b", "0", 7.0);
  c.r("d", "a", 5.0);
  const Extracted extracted = extract(c);
  const model::System& system = extracted.system();
  const double mutual = 0.5 * std::sqrt(3e-3 * 1e-3);
  const double energy = 0.5 * 2e-6 * 25.0 + 0.5 * 3e-3 * 0.01 + 0.5 * 1e-3 * 0.04 + mutual * 0.1 * -0.2;
  CHECK(0.5 * system.time_scale * system.x0.squaredNorm() / extracted.largest->equations.r0 == Approx(energy).epsilon(tight));
}

TEST_CASE("passive parts give a dissipative system, active ones do not", "[unit]") {
  TestCircuit passive;
  passive.v("s", "0", sine());
  passive.r("s", "a", 1e2);
  passive.d("a", "b");
  passive.c("b", "0", 1e-6);
  passive.l("b", "d", 1e-3);
  passive.d("d", "0");
  passive.r("d", "0", 1e4);
  const Extracted extracted = extract(passive);
  const model::System& system = extracted.system();
  CHECK(system.passive);
  const Matrix a = system.a.topLeftCorner(system.n, system.n);
  CHECK(linalg::logarithmic_norm(a) <= tight * a.norm());
  CHECK(linalg::logarithmic_norm(-system.d) <= tight);  // D + Dᵀ ⪰ 0

  TestCircuit active;
  active.c("a", "0", 1e-6);
  active.r("a", "0", -50.0);
  active.d("a", "0");
  CHECK_FALSE(extract(active).system().passive);
}

TEST_CASE("diodes in loops, in series, in parallel: well defined ports", "[unit]") {
  TestCircuit c;
  c.v("s", "q", sine());  // floating secondary of a bridge
  c.d("s", "o");
  c.d("q", "o");
  c.d("0", "s");
  c.d("0", "q");
  c.d("o", "x");
  c.d("x", "y");  // series, midpoint x
  c.d("x", "y");  // parallel
  c.d("y", "o");  // closes a ring
  c.c("o", "0", 1e-6);
  c.r("o", "0", 1e3);
  const Extracted extracted = extract(c);
  REQUIRE(extracted.largest);
  const model::System& system = extracted.system();
  CHECK(system.n == 1);
  CHECK(system.ports == 8);
  CHECK(system.d.allFinite());
  CHECK(linalg::logarithmic_norm(-system.d) <= tight);
  CHECK(system.passive);
}

TEST_CASE("what leaves the equations singular is refused by name", "[unit]") {
  SECTION("two sources in parallel that contradict each other") {
    TestCircuit c;
    c.v("a", "b", model::Dc{1.0});
    c.v("a", "b", model::Dc{2.0});
    c.r("a", "0", 1.0);
    c.r("b", "0", 1.0);
    const Extracted extracted = extract(c);
    CHECK_FALSE(extracted.largest);
    REQUIRE(first_id(extracted) == "E-source-loop");
    const std::string& text = extracted.diagnostics.all().front().text;
    CHECK(text.find("V1") != std::string::npos);
    CHECK(text.find("V2") != std::string::npos);
  }
  SECTION("a current source that feeds nothing but another") {
    TestCircuit c;
    c.i("a", "0", model::Dc{1.0});
    c.i("a", "0", model::Dc{2.0});
    const Extracted extracted = extract(c);
    CHECK_FALSE(extracted.largest);
    REQUIRE(first_id(extracted) == "E-source-cutset");
    CHECK(extracted.diagnostics.all().front().text.find("a") != std::string::npos);
  }
  SECTION("a part without any tie to ground") {
    TestCircuit c;
    c.r("a", "b", 1.0);
    c.c("a", "b", 1.0);
    const Extracted extracted = extract(c);
    CHECK_FALSE(extracted.largest);
    CHECK(first_id(extracted) == "E-floating");
  }
}
