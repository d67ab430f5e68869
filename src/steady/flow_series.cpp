#include "steady/flow_series.hpp"

#include <algorithm>
#include <cmath>

namespace pwlsim::steady {
namespace {

using linalg::Matrix;

constexpr double slow_turn = 0.25;  ///< of a radian
constexpr int turn_terms = 12;      ///< of the turn: 0.25¹²/12!/13 is 1e-17
constexpr double brief_flow = 0.5;  ///< ‖A‖h
constexpr int flow_terms = 18;      ///< of its series: 0.5¹⁸/18! is 1e-21

}  // namespace

bool FlowSeries::is_slow(double omega, double length) { return std::abs(omega) * length <= slow_turn; }

FlowSeries::FlowSeries(const Matrix& a, double length) : length_(length) {
  const Eigen::Index n = a.rows();
  const double norm = n > 0 ? a.cwiseAbs().rowwise().sum().maxCoeff() * length : 0.0;
  const int doublings = norm > brief_flow ? static_cast<int>(std::ceil(std::log2(norm / brief_flow))) : 0;
  const Matrix step = a * std::ldexp(length, -doublings);
  // Σ_j (Ah)^j / (j! k! (j + k + 1))
  std::vector<double> inverse_factorial{1.0};
  for (int k = 1; k <= turn_terms; ++k) inverse_factorial.push_back(inverse_factorial.back() / k);
  n_.assign(turn_terms + 1, Matrix::Zero(n, n));
  Matrix flow = Matrix::Zero(n, n), power = Matrix::Identity(n, n);
  for (int j = 0; j <= flow_terms; ++j) {
    flow += power;
    for (int k = 0; k <= turn_terms; ++k)
      n_[static_cast<std::size_t>(k)] += power * (inverse_factorial[static_cast<std::size_t>(k)] / (j + k + 1));
    power = step * power / static_cast<double>(j + 1);
  }
  for (int doubling = 0; doubling < doublings; ++doubling) {
    std::vector<Matrix> behind;
    for (const Matrix& own : n_) behind.emplace_back(flow * own);
    for (int k = turn_terms; k >= 0; --k) {
      Matrix sum = n_[static_cast<std::size_t>(k)];
      for (int i = 0; i <= k; ++i) sum += inverse_factorial[static_cast<std::size_t>(k - i)] * behind[static_cast<std::size_t>(i)];
      n_[static_cast<std::size_t>(k)] = std::ldexp(1.0, -k - 1) * sum;
    }
    flow = flow * flow;
  }
}

Eigen::MatrixXcd FlowSeries::integral(double omega) const {
  const std::complex<double> turn(0.0, -omega * length_);
  Eigen::MatrixXcd sum = n_[turn_terms - 1].cast<std::complex<double>>();
  for (int k = turn_terms - 2; k >= 0; --k) sum = sum * turn + n_[static_cast<std::size_t>(k)].cast<std::complex<double>>();
  return length_ * sum;
}

Eigen::MatrixXcd FlowSeries::moment(double omega) const {
  const std::complex<double> turn(0.0, -omega * length_);
  Eigen::MatrixXcd sum = turn_terms * n_[turn_terms].cast<std::complex<double>>();
  for (int k = turn_terms - 1; k >= 1; --k) sum = sum * turn + k * n_[static_cast<std::size_t>(k)].cast<std::complex<double>>();
  return length_ * length_ * sum;
}

}  // namespace pwlsim::steady
