#pragma once
/// Sums over intervals of many lengths: what each brings is an analytic function of its length.

#include <array>
#include <cmath>
#include <numbers>

#include "linalg/dense.hpp"

namespace pwlsim::steady {

inline constexpr int length_nodes = 12;  ///< of an interpolation in the length
inline constexpr double node_range = 1.0;  ///< lengths times the rate of the motion, over which it is one: its error is 2·(1/4)¹²/12! there

/// Lagrange's polynomials on Chebyshev's points of an interval.
class Interpolation {
 public:
  Interpolation(double begin, double end) : middle_(0.5 * (begin + end)), half_(0.5 * (end - begin)) {}
  [[nodiscard]] double node(int j) const { return middle_ + half_ * place(j); }
  /// Of a value at `length`: the weight of each node.
  [[nodiscard]] std::array<double, length_nodes> weights(double length) const {
    std::array<double, length_nodes> weight{};
    const double x = (length - middle_) / half_;
    double sum = 0.0;
    for (int j = 0; j < length_nodes; ++j) {
      const double apart = x - place(j);
      if (apart == 0.0) {
        weight = {};
        weight[static_cast<std::size_t>(j)] = 1.0;
        return weight;
      }
      sum += weight[static_cast<std::size_t>(j)] = (j % 2 == 0 ? 1.0 : -1.0) * std::sin(angle(j)) / apart;
    }
    for (double& each : weight) each /= sum;
    return weight;
  }

 private:
  static double angle(int j) { return (j + 0.5) * std::numbers::pi / length_nodes; }
  static double place(int j) { return std::cos(angle(j)); }
  double middle_, half_;
};

/// ∫ e^{A′(h − s)} K e^{Y′s} ds over [0, h]. `rate`: of both, as linalg::Exponential has it.
[[nodiscard]] linalg::Matrix moment_of(const linalg::Matrix& a, const linalg::Matrix& y, const linalg::Matrix& k, double h, double rate);

}  // namespace pwlsim::steady
