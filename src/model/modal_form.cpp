#include "model/modal_form.hpp"

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <algorithm>

namespace pwlsim::model {

namespace {

using linalg::Wide;
using linalg::WideMatrix;
using Places = std::vector<Eigen::Index>;

constexpr Eigen::Index largest_form = 24;  ///< states; beyond, the search would cost more than it saves
constexpr Wide largest_condition = 1e7L;   ///< ‖V‖‖V⁻¹‖: what extended precision has to spare goes into it
constexpr Wide invariance = 1e-14L;        ///< ‖M V − V Λ‖ against ‖M‖‖V‖

/// Of y, what moves by a rate of its own, and levels and ramps.
void sort_places(const System& system, const Mode& mode, Places& moved, Places& given) {
  for (Eigen::Index i = 0; i < mode.n1; ++i) moved.push_back(i);
  for (const auto& block : system.exosystem->blocks()) {
    Places& places = block.is_curved() ? moved : given;
    for (int i = 0; i < block.size(); ++i) places.push_back(mode.n1 + block.first + i);
  }
}

}  // namespace

std::unique_ptr<ModalForm> modal_form(const System& system, const Mode& mode) {
  Places moved, given;
  sort_places(system, mode, moved, given);
  const auto n = static_cast<Eigen::Index>(moved.size());
  if (n == 0 || n > largest_form) return nullptr;
  const WideMatrix a = mode.flow.a().cast<Wide>();
  const WideMatrix m = a(moved, moved), on_given = a(moved, given), given_rates = a(given, given);
  const Eigen::EigenSolver<WideMatrix> solver(m);
  if (solver.info() != Eigen::Success) return nullptr;
  // Of a pair λ, λ* the columns are the real and the imaginary part of one eigenvector, and Λ has a block (Re λ, Im λ; −Im λ, Re λ).
  const WideMatrix v = solver.pseudoEigenvectors(), lambda = solver.pseudoEigenvalueMatrix();
  if (!((m * v - v * lambda).norm() <= invariance * m.norm() * v.norm())) return nullptr;
  const WideMatrix w = Eigen::PartialPivLU<WideMatrix>(v).inverse();
  if (!(w.norm() * v.norm() < largest_condition)) return nullptr;

  WideMatrix velocities = WideMatrix::Zero(n, mode.ny), pushes = velocities;
  velocities(Eigen::all, moved) = lambda * w;
  velocities(Eigen::all, given) = w * on_given;
  pushes(Eigen::all, given) = w * on_given * given_rates;
  const WideMatrix guards = mode.guards.cast<Wide>();
  const WideMatrix weights = guards(Eigen::all, moved) * v;

  auto form = std::make_unique<ModalForm>();
  form->drift = Matrix::Zero(guards.rows(), mode.ny);
  form->drift(Eigen::all, given) = (guards(Eigen::all, given) * given_rates).cast<double>();
  Places first;  // columns at which a coordinate's real part stands
  for (Eigen::Index i = 0; i < n; ++i) {
    const bool pair = i + 1 < n && lambda(i, i + 1) != 0.0L;
    first.push_back(i);
    form->rates.emplace_back(static_cast<double>(lambda(i, i)), pair ? static_cast<double>(lambda(i, i + 1)) : 0.0);
    if (pair) ++i;
  }
  const auto count = static_cast<Eigen::Index>(first.size());
  form->velocities = form->pushes = Matrix::Zero(2 * count, mode.ny);
  form->weights = Matrix::Zero(2 * count, guards.rows());
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index i = first[static_cast<std::size_t>(k)];
    form->velocities.row(2 * k) = velocities.row(i).cast<double>();
    form->pushes.row(2 * k) = pushes.row(i).cast<double>();
    form->weights.row(2 * k) = weights.col(i).transpose().cast<double>();
    if (form->rates[static_cast<std::size_t>(k)].imag() == 0.0) continue;
    // With coordinates s, t of the two columns z = s − i t, and p·(Re v s + Im v t) = Re (p·v) z.
    form->velocities.row(2 * k + 1) = -velocities.row(i + 1).cast<double>();
    form->pushes.row(2 * k + 1) = -pushes.row(i + 1).cast<double>();
    form->weights.row(2 * k + 1) = weights.col(i + 1).transpose().cast<double>();
  }
  form->absolute_velocities = form->velocities.cwiseAbs();
  return form;
}

}  // namespace pwlsim::model
