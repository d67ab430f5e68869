/// Coupled inductors in coordinates of their own.
#include "engine/sparse/windings.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "support/circuit.hpp"

using namespace pwlsim;
using namespace pwlsim::engine::sparse;

namespace {

constexpr double winding_rounding = 1e-12;

model::Network windings(const std::vector<double>& henries, const std::vector<model::Coupling>& couplings) {
  model::Network network;
  for (const double henry : henries) {
    model::Inductor inductor{};
    inductor.inductance = henry;
    network.inductors.push_back(inductor);
  }
  network.couplings = couplings;
  return network;
}

double product(const Windings::Sum& sum, const std::vector<double>& x) {
  double result = 0.0;
  for (const auto& share : sum) result += share.weight * x[static_cast<std::size_t>(share.index)];
  return result;
}

/// iᵀ L i
double twice_energy(const model::Network& network, const std::vector<double>& i) {
  double result = 0.0;
  for (std::size_t k = 0; k < i.size(); ++k) result += network.inductors[k].inductance * i[k] * i[k];
  for (const auto& k : network.couplings) {
    const auto a = static_cast<std::size_t>(k.inductor_a), b = static_cast<std::size_t>(k.inductor_b);
    result += 2.0 * k.coefficient * std::sqrt(network.inductors[a].inductance * network.inductors[b].inductance) * i[a] * i[b];
  }
  return result;
}

}  // namespace

TEST_CASE("coordinates of coupled inductors keep the energy, and give the currents back", "[unit]") {
  const auto network = windings({1e-3, 4e-6, 9.0, 2e-3}, {{{}, 0, 1, 0.7}, {{}, 1, 2, -0.5}, {{}, 0, 2, -0.8}});
  const Windings w(network);
  CHECK(w.possible());
  const std::vector<double> current = {0.3, -20.0, 0.01, 5.0};
  std::vector<double> m;
  double energy = 0.0;
  for (int j = 0; j < 4; ++j) {
    m.push_back(product(w.coordinate(j), current));
    energy += w.inductance(j) * m.back() * m.back();
  }
  CHECK(energy == Approx(twice_energy(network, current)).epsilon(winding_rounding));
  for (int i = 0; i < 4; ++i) CHECK(product(w.current(i), m) == Approx(current[static_cast<std::size_t>(i)]).epsilon(winding_rounding));
  // flux of the first: L1 i1 + M12 i2 + M13 i3
  const double flux = 1e-3 * 0.3 - 20.0 * 0.7 * std::sqrt(1e-3 * 4e-6) - 0.01 * 0.8 * std::sqrt(1e-3 * 9.0);
  CHECK(1e-3 * product(w.flux(0), m) == Approx(flux).epsilon(winding_rounding));
}

// L2 (1 − k²) of k = 1 − 2⁻²¹ is 2⁻²⁰ (1 − 2⁻²²) L2.
TEST_CASE("the leakage of a close coupling has its digits, and that of a perfect one is zero", "[unit]") {
  const double rest = std::ldexp(1.0, -20);
  const Windings close(windings({1e-3, 2e-3}, {{{}, 0, 1, 1.0 - 0.5 * rest}}));
  CHECK(close.inductance(0) == 1e-3);
  CHECK(close.inductance(1) == Approx(2e-3 * rest * (1.0 - rest / 4.0)).epsilon(winding_rounding));
  const Windings perfect(windings({1e-3, 4e-3, 9e-3}, {{{}, 0, 1, 1.0}, {{}, 0, 2, -1.0}, {{}, 1, 2, -1.0}}));
  CHECK(perfect.possible());
  CHECK(perfect.inductance(1) == 0.0);
  CHECK(perfect.inductance(2) == 0.0);
  CHECK(product(perfect.coordinate(0), {1.0, 1.0, 1.0}) == Approx(1.0 + 2.0 - 3.0).margin(winding_rounding));
  CHECK_FALSE(Windings(windings({1e-3, 4e-3, 9e-3}, {{{}, 0, 1, 1.0}, {{}, 0, 2, 1.0}, {{}, 1, 2, -1.0}})).possible());
}
