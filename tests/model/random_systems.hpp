#pragma once
/// Random linear complementarity systems of small integers with given relative degrees.

#include <cstdint>
#include <random>
#include <vector>

#include "model/exact_modes.hpp"

namespace pwlsim::test {

struct RandomSystem {
  IntegerSystem system;
  linalg::Vector x;
  std::vector<int> degrees;  ///< relative degree of each port; empty: no structure was asked for
};

class SystemMaker {
 public:
  explicit SystemMaker(std::uint64_t seed) : engine_(seed) {}

  /// Three of four in the normal form of chains of integrators, y_i^(ρ_i) = N_i u + …, with more states of their own, coordinates mixed; the
  /// fourth with matrices of small integers and nothing more.
  RandomSystem make() { return below(4) > 0 ? of_chains() : unstructured(); }

 private:
  int below(int count) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(count)); }
  /// 0 with probability 1/2, else −size … size.
  int entry(int size = 2) { return below(2) == 0 ? 0 : below(2 * size + 1) - size; }
  linalg::Matrix matrix(int rows, int columns, int size = 2) {
    return linalg::Matrix::NullaryExpr(rows, columns, [&] { return static_cast<double>(entry(size)); });
  }
  linalg::Matrix leading(int k);
  std::vector<int> draw_degrees(int k);
  RandomSystem of_chains();
  RandomSystem unstructured();
  void mix_coordinates(RandomSystem& r);

  std::mt19937_64 engine_;
};

}  // namespace pwlsim::test
