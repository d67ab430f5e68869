#include "model/slow_part.hpp"

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>

namespace pwlsim::model {

namespace {

using linalg::Wide;
using linalg::WideMatrix;

constexpr double gap = 8.0;             ///< ratio of neighbouring rates that makes a cut
constexpr double least_damping = 0.02;  ///< −Re λ/|λ| of what is dropped
constexpr int largest_part = 64;        ///< states; beyond, the search would cost more than it saves
constexpr int most_parts = 4;
constexpr int most_iterations = 120;
constexpr Wide converged = 1e-17L;
constexpr Wide largest_condition = 1e5L;  ///< of [N M]
constexpr double invariance = 1e-10;      ///< ‖A₁N − N A_s‖ against ‖A_s‖: a part that is not one is not used
constexpr double rounding_level = 1e-15;  ///< of f against c

WideMatrix orthonormal(const WideMatrix& m) {
  Eigen::HouseholderQR<WideMatrix> qr(m);
  return qr.householderQ() * WideMatrix::Identity(m.rows(), m.cols());
}

/// Orthonormal basis of the invariant subspace that repeated application of `step` turns everything to. From eigenvectors that takes one
/// or two; where those are nearly parallel, as many as the gap asks for.
template <class Step>
WideMatrix dominant_subspace(const WideMatrix& eigenvectors, const Step& step) {
  if (eigenvectors.cols() == 0) return eigenvectors;
  WideMatrix basis = orthonormal(eigenvectors);
  for (int k = 0; k < most_iterations; ++k) {
    const WideMatrix next = orthonormal(step(basis));
    const Wide change = (next - basis * (basis.transpose() * next)).norm();
    basis = next;
    if (change <= converged) break;
  }
  return basis;
}

/// G of f_quasi-static = G ζ:  A_f G − G S = −R, by fixed-point iteration (the sources are slow beside A_f).
WideMatrix quasi_static(const WideMatrix& fast, const WideMatrix& sources, const WideMatrix& forced) {
  const Eigen::PartialPivLU<WideMatrix> lu(fast);
  WideMatrix g = -lu.solve(forced);
  for (int k = 0; k < most_iterations; ++k) {
    const WideMatrix next = lu.solve(WideMatrix(g * sources - forced));
    const Wide change = (next - g).norm();
    g = next;
    if (change <= converged * g.norm()) break;
  }
  return g;
}

/// Eigenvalues, the slowest first, and their eigenvectors; of a complex pair the real and the imaginary part.
struct Spectrum {
  std::vector<std::complex<Wide>> rates;  ///< empty: not found
  WideMatrix vectors;
};

Spectrum spectrum_of(const WideMatrix& a) {
  Spectrum spectrum;
  const Eigen::EigenSolver<WideMatrix> solver(a);
  if (solver.info() != Eigen::Success) return spectrum;
  const auto& values = solver.eigenvalues();
  std::vector<Eigen::Index> order(static_cast<std::size_t>(a.rows()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index i, Eigen::Index j) { return std::abs(values[i]) < std::abs(values[j]); });
  const WideMatrix vectors = solver.pseudoEigenvectors();
  spectrum.vectors = vectors(Eigen::all, order);
  for (const Eigen::Index i : order) spectrum.rates.push_back(values[i]);
  return spectrum;
}

std::unique_ptr<SlowPart> part_at(const System& system, const Mode& mode, const WideMatrix& a, const WideMatrix& e,
                                  const WideMatrix& vectors, Eigen::Index slow, Wide cut) {
  const Eigen::Index n = a.rows();
  const WideMatrix shifted = a - cut * WideMatrix::Identity(n, n);
  const Eigen::PartialPivLU<WideMatrix> lu(shifted);
  const WideMatrix near = dominant_subspace(vectors.leftCols(slow), [&](const WideMatrix& m) { return WideMatrix(lu.solve(m)); });
  const WideMatrix far = dominant_subspace(vectors.rightCols(n - slow), [&](const WideMatrix& m) { return WideMatrix(shifted * m); });
  WideMatrix both(n, n);
  both << near, far;
  const WideMatrix inverse = Eigen::PartialPivLU<WideMatrix>(both).inverse();
  if (!(inverse.norm() < largest_condition)) return nullptr;
  const WideMatrix w = inverse.topRows(slow);
  const WideMatrix w_fast = inverse.bottomRows(n - slow);
  const WideMatrix own = w * a * near;
  if (static_cast<double>((a * near - near * own).norm()) > invariance * static_cast<double>(own.norm() + std::abs(cut) / gap))
    return nullptr;

  auto part = std::make_unique<SlowPart>();
  part->basis = near.cast<double>();
  part->coordinates = w.cast<double>();
  const WideMatrix s = system.exosystem->a().cast<Wide>();
  const WideMatrix lift = far * quasi_static(w_fast * a * far, s, w_fast * e);
  part->lift = lift.cast<double>();

  Mode& m = part->mode;
  m.active = mode.active;
  m.regular = true;
  m.n1 = static_cast<int>(slow);
  m.ny = m.n1 + system.n_zeta;
  m.noise = mode.noise;
  Matrix flow = Matrix::Zero(m.ny, m.ny);
  flow.topLeftCorner(m.n1, m.n1) = own.cast<double>();
  flow.topRightCorner(m.n1, system.n_zeta) = (w * e).cast<double>();
  flow.bottomRightCorner(system.n_zeta, system.n_zeta) = system.exosystem->a();
  const WideMatrix rows = mode.guards.leftCols(n).cast<Wide>();
  const WideMatrix on_sources = mode.guards.rightCols(system.n_zeta).cast<Wide>();
  m.guards.resize(mode.guards.rows(), m.ny);
  m.guards << linalg::wide_clean_product(rows, near).cast<double>(),
      linalg::wide_cleaned(rows * lift + on_sources, rows.cwiseAbs() * lift.cwiseAbs() + on_sources.cwiseAbs()).cast<double>();
  // What is left of a guard that reads the fast part alone is rounding.
  for (Eigen::Index i = 0; i < m.guards.rows(); ++i)
    if (m.guards.row(i).norm() <= rounding_level * mode.guard_norm[i]) m.guards.row(i).setZero();
  finish_mode(system, m, std::move(flow));
  return part;
}

}  // namespace

bool SlowPart::enter(const double* whole, double* slow) const {
  const auto n = basis.rows();
  const auto nz = lift.cols();
  linalg::multiply(coordinates, whole, slow);
  std::copy(whole + n, whole + n + nz, slow + basis.cols());
  double rest = 0.0;
  double size = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double quasi = linalg::row_times(lift, i, whole + n);
    const double own = linalg::row_times(basis, i, slow);
    const double fast = whole[i] - own - quasi;
    rest += fast * fast;
    size += whole[i] * whole[i] + quasi * quasi;
  }
  return rest <= rounding_level * rounding_level * size;
}

void SlowPart::to_whole(const double* slow, double* whole) const {
  const auto n = basis.rows();
  for (Eigen::Index i = 0; i < n; ++i) whole[i] = linalg::row_times(basis, i, slow) + linalg::row_times(lift, i, slow + basis.cols());
  std::copy(slow + basis.cols(), slow + mode.ny, whole + n);
}

std::vector<std::unique_ptr<SlowPart>> slow_parts(const System& system, const Mode& mode) {
  std::vector<std::unique_ptr<SlowPart>> parts;
  const Eigen::Index n = mode.n1;
  if (n == 0 || n > largest_part) return parts;
  const WideMatrix a = mode.flow.a().topLeftCorner(n, n).cast<Wide>();
  const WideMatrix e = mode.flow.a().topRightCorner(n, system.n_zeta).cast<Wide>();
  const Spectrum spectrum = spectrum_of(a);
  const auto& rates = spectrum.rates;
  const Wide fastest_source = gap * system.exosystem->fastest();
  const auto size = static_cast<Eigen::Index>(rates.size());
  for (Eigen::Index slow = size - 1; slow >= 0 && parts.size() < most_parts; --slow) {
    const std::complex<Wide> behind = rates[static_cast<std::size_t>(slow)];
    if (-behind.real() < least_damping * std::abs(behind)) break;
    const Wide before = slow > 0 ? std::abs(rates[static_cast<std::size_t>(slow) - 1]) : 0.0L;
    if (std::abs(behind) < gap * before || std::abs(behind) <= fastest_source) continue;
    const Wide cut = std::sqrt(std::abs(behind) * std::max(before, std::abs(behind) * 1e-3L));
    if (auto part = part_at(system, mode, a, e, spectrum.vectors, slow, cut)) parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace pwlsim::model
