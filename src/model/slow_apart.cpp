#include "model/slow_apart.hpp"

#include <utility>

#include "linalg/fast_decays.hpp"
#include "model/tolerances.hpp"

namespace pwlsim::model {

namespace {

using Eigen::Index;
using linalg::product;
using linalg::Wide;
using linalg::WideMatrix;

/// A leak would read rounding of states that have no part in it.
WideMatrix without_rounding(const WideMatrix& basis) { return (basis.array().abs() <= tolerance::basis_rounding).select(Wide(0), basis); }

}  // namespace

std::unique_ptr<Mode> with_slow_apart(const System& system, const Mode& whole, const Mode& slow) {
  const Index n = system.n, nz = system.n_zeta, n_slow = slow.n1, n_fast = whole.n1 - slow.n1;
  auto mode = std::make_unique<Mode>();
  Mode& m = *mode;
  m.active = whole.active;
  m.regular = true;
  m.unique_inputs = whole.unique_inputs;
  m.input_unique = whole.input_unique;
  m.free_inputs = whole.free_inputs;
  m.constrained = true;
  m.n1 = whole.n1;
  m.ny = whole.ny;
  m.k = whole.k;
  m.noise = whole.noise;
  m.slow = whole.slow;

  // F in the mode's own coordinates, and in ξ.
  // In extended precision, as x, y and x again must be the same: entries of 10⁻¹⁷ read stores of 10⁶ beside decays of 10⁻⁹.
  const WideMatrix slow_basis = slow.basis.cast<Wide>();
  const WideMatrix to_own = whole.constrained ? WideMatrix(whole.basis.transpose().cast<Wide>()) : WideMatrix::Identity(n, n);
  const WideMatrix in_own = product(to_own, slow_basis), beside = without_rounding(linalg::complement(in_own));
  const Matrix own = in_own.cast<double>(), fast = beside.cast<double>();
  m.basis.resize(n, m.n1);
  m.basis << slow.basis, product(to_own.transpose(), beside).cast<double>();
  m.lift = whole.constrained ? whole.lift : Matrix::Zero(n, nz);
  m.projector = whole.constrained ? whole.projector : Matrix::Identity(n + nz, n + nz);
  const Matrix held = m.basis.rightCols(n_fast).transpose() * slow.lift;  // R_F

  const Matrix turned = whole.flow.a().topLeftCorner(m.n1, m.n1) * fast;
  const Matrix across = own.transpose() * turned, decay = fast.transpose() * turned;  // X and Λ
  const Matrix& sources = system.exosystem->a();
  Matrix a = Matrix::Zero(m.ny, m.ny);
  a.topLeftCorner(n_slow, n_slow) = slow.flow.a().topLeftCorner(n_slow, n_slow);
  a.block(0, n_slow, n_slow, n_fast) = across;
  a.topRightCorner(n_slow, nz) = slow.flow.a().topRightCorner(n_slow, nz) - across * held;
  a.block(n_slow, n_slow, n_fast, n_fast) = decay;
  a.block(n_slow, m.n1, n_fast, nz) = held * sources - decay * held;
  a.bottomRightCorner(nz, nz) = sources;

  const auto rows_of = [&](const Matrix& of_slow, const Matrix& of_whole) {
    const Matrix of_fast = of_whole.leftCols(m.n1) * fast;
    Matrix rows(of_slow.rows(), m.ny);
    rows << of_slow.leftCols(n_slow), of_fast, of_whole.rightCols(nz);
    return rows;
  };
  m.guards = rows_of(slow.guards, whole.guards);
  m.outputs = rows_of(slow.outputs, whole.outputs);
  finish_mode(system, m, std::move(a));
  m.guard_noise = whole.guard_noise;
  if (slow.guard_error.size() > 0 && whole.guard_error.size() > 0) {
    m.guard_error.resize(m.guards.rows(), m.ny);
    m.guard_error << slow.guard_error.leftCols(n_slow), whole.guard_error.leftCols(m.n1) * fast.cwiseAbs(), whole.guard_error.rightCols(nz);
  }
  if (whole.decays) {
    m.decays = std::make_unique<Decays>(*whole.decays);
    m.decays->slow = m.basis.transpose() * m.projector.topRows(n);
  }
  m.apart = std::make_unique<FastCoordinates>();
  m.apart->first = static_cast<int>(n_slow);
  const Matrix reads = m.basis.rightCols(n_fast).transpose().cwiseAbs();
  m.apart->terms.resize(n_fast, m.ny);
  m.apart->terms << reads * m.basis.cwiseAbs(), reads * m.lift.cwiseAbs() + held.cwiseAbs();
  m.apart->terms.array() += tolerance::basis_rounding / m.noise;  // the rest of entries that count as zero
  m.apart->terms_norm = m.apart->terms.norm();
  m.apart->guard_norm = m.guards.middleCols(n_slow, n_fast).rowwise().norm();
  m.apart->slow_guard_norm = m.guards.leftCols(n_slow).rowwise().norm();
  m.apart->source_guard_norm = m.guards.rightCols(nz).rowwise().norm();
  return mode;
}

}  // namespace pwlsim::model
