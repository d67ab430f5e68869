/// Bounds in modes of systems that are not passive are those of a balanced norm (model/mode.hpp, S).
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "model/build_mode.hpp"
#include "model/handmade_systems.hpp"

using namespace pwlsim;
using model::Matrix;
using model::Vector;

namespace {

/// x1' = −x1 + ω² x2, x2' = −x2 − x1: a ring of frequency ω that decays, 2000 times as large in x1 as in x2. Its symmetric part has an eigenvalue of ω²/2.
constexpr double omega = 2000.0;

model::System lopsided_ring(bool passive) {
  Matrix a(2, 2), c = Matrix::Zero(1, 2);
  a << -1.0, omega * omega, -1.0, -1.0;
  c(0, 0) = 1.0;
  model::System system = test::handmade(a, Matrix::Zero(2, 1), c, Matrix::Identity(1, 1));
  system.passive = passive;
  return system;
}

}  // namespace

TEST_CASE("a lopsided ring is balanced: its bounds grow no faster than its frequency", "[unit]") {
  const model::System system = lopsided_ring(false);
  const auto mode = model::build_mode(system, model::IndexSet(1));
  REQUIRE(mode->regular);
  REQUIRE(mode->scale.size() == 2);
  // Powers of two: the two gains differ by at most a factor of two.
  CHECK(mode->growth == Approx(0.5 * (omega * omega - 1.0) - 1.0).epsilon(1e-12));
  CHECK(mode->scaled_growth <= omega);
  CHECK(mode->scale[0] / mode->scale[1] == Approx(omega).epsilon(0.5));
  CHECK(mode->scaled_guard_c_norm[0] == mode->scale[0]);

  // |y1| ≤ ‖row S‖ e^{μt} ‖S⁻¹c(0)‖, beside the closed form e^{−t}(x1 cos ωt + ω x2 sin ωt).
  const std::vector<double> x{3.0, -0.002};
  const double start = std::hypot(x[0] / mode->scale[0], x[1] / mode->scale[1]);
  for (const double t : {1e-5, 1e-4, 1e-3, 1e-2}) {
    const double value = std::exp(-t) * (x[0] * std::cos(omega * t) + omega * x[1] * std::sin(omega * t));
    CHECK(std::abs(value) <= mode->scaled_guard_c_norm[0] * std::exp(mode->scaled_growth * t) * start);
  }
}

TEST_CASE("in a passive system the norm is that of the energy", "[unit]") {
  const auto mode = model::build_mode(lopsided_ring(true), model::IndexSet(1));
  CHECK(mode->scale.size() == 0);
}
