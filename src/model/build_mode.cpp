#include "model/build_mode.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "linalg/constraint_basis.hpp"
#include "linalg/factorisations.hpp"
#include "model/guard_noise.hpp"
#include "model/modal_form.hpp"
#include "model/mode_inputs.hpp"
#include "model/tolerances.hpp"
#include "model/valves.hpp"

namespace pwlsim::model {

namespace {

using linalg::product;
using linalg::Wide;
using linalg::wide_clean_product;
using linalg::wide_clean_sum;
using linalg::wide_cleaned;
using linalg::WideMatrix;
using linalg::WideVector;

/// Of A, 1/s: its square has to be a number.
constexpr double fastest_rate = 1e150;

class ModeMaker {
 public:
  ModeMaker(const System& system, const IndexSet& active) : s_(system), inputs_(system, active) {
    noise_per_condition_ = system.unrounded ? tolerance::wide_noise_per_condition : tolerance::noise_per_condition;
    mode_ = std::make_unique<Mode>();
    mode_->active = active;
    mode_->input_unique.assign(static_cast<std::size_t>(system.ports), 1);
  }

  std::unique_ptr<Mode> run() {
    mode_->regular = inputs_.solve(*mode_);
    return finish();
  }

  /// Null where the mode leaves no fast decays.
  std::unique_ptr<Mode> run_slow(const Mode& whole, const Cut& cut, ShiftedSystems& shifted) {
    manifold_ = slow_manifold(s_, whole, cut, inputs_.ports(), shifted);
    if (!manifold_) return nullptr;
    mode_->regular = true;
    inputs_.take(*manifold_, *mode_);
    auto mode = finish();
    if (!mode->regular) return nullptr;
    add_decays(whole, *mode);
    if (const std::optional<Matrix> guards = guards_at_other_shift(*mode, shifted)) measure_guard_noise(s_, *mode, *guards);
    return mode;
  }

 private:
  std::unique_ptr<Mode> finish() {
    if (!mode_->regular) return std::move(mode_);
    mode_->noise = std::max(tolerance::noise_floor, noise_per_condition_ * inputs_.condition());
    spread_inputs();
    reduce_coordinates();
    mode_->regular = build_flow();
    if (mode_->regular) build_rows();
    return std::move(mode_);
  }

  void spread_inputs();
  void reduce_coordinates();
  bool build_flow();
  [[nodiscard]] Matrix mode_rows(const Mode& m, Eigen::Index outputs);
  [[nodiscard]] Matrix guards_of(const Mode& m, const Matrix& rows) const;
  [[nodiscard]] std::optional<Matrix> guards_at_other_shift(const Mode& m, ShiftedSystems& shifted);
  void build_rows();
  void add_decays(const Mode& whole, Mode& slow) const;
  template <class Input>
  void add_inputs(WideMatrix& rows, Eigen::Index row, const Input& input, Wide rounding);
  void take_port_rows(const Mode& m, WideMatrix& rows) const;
  void clean_control_rows(Matrix& rows) const;
  [[nodiscard]] Matrix in_mode(const Mode& m, const WideMatrix& full) const;
  void bound_guard_noise() const;

  const System& s_;
  ModeInputs inputs_;
  std::unique_ptr<Mode> mode_;
  WideVector input_;  ///< of the active ports into the row at hand
  bool sources_constrain_ = false;
  WideMatrix embedding_;  ///< x = embedding·y, unrounded: [N R; 0 1]
  std::optional<SlowManifold> manifold_;
  double noise_per_condition_ = 0.0;
  Matrix flow_;  ///< of y' = A y
};

void ModeMaker::spread_inputs() {
  mode_->k = Matrix::Zero(s_.ports, s_.size());
  for (std::size_t a = 0; a < inputs_.ports().size(); ++a)
    mode_->k.row(inputs_.ports()[a]) = inputs_.k().row(static_cast<Eigen::Index>(a)).cast<double>();
}

void ModeMaker::reduce_coordinates() {
  Mode& m = *mode_;
  const auto fixed = static_cast<int>(inputs_.constraints().rows());
  m.constrained = fixed > 0;
  m.n1 = s_.n - fixed;
  m.ny = m.n1 + s_.n_zeta;
  if (!m.constrained) return;
  const linalg::ConstraintBasis free(inputs_.constraints().leftCols(s_.n));
  const WideMatrix basis = wide_cleaned(free.null(), WideMatrix::Ones(s_.n, m.n1));
  embedding_ = WideMatrix::Zero(s_.size(), m.ny);
  embedding_.topLeftCorner(s_.n, m.n1) = basis;
  sources_constrain_ = !inputs_.constraints().rightCols(s_.n_zeta).isZero(0);
  if (sources_constrain_) embedding_.topRightCorner(s_.n, s_.n_zeta) = -free.least(inputs_.constraints().rightCols(s_.n_zeta));
  embedding_.bottomRightCorner(s_.n_zeta, s_.n_zeta).setIdentity();
  m.basis = basis.cast<double>();
  m.lift = embedding_.topRightCorner(s_.n, s_.n_zeta).cast<double>();
}

/// False where its rates are beyond computing.
bool ModeMaker::build_flow() {
  Mode& m = *mode_;
  WideMatrix rate =
      manifold_ ? manifold_->rate : wide_clean_sum(inputs_.unrounded().a.topRows(s_.n), inputs_.restricted().b.topRows(s_.n), inputs_.k());
  if (m.constrained) {
    // c' = Nᵀ(ξ' − R ζ').
    rate = wide_clean_product(rate, embedding_);
    if (sources_constrain_)
      rate.rightCols(s_.n_zeta) =
          wide_clean_sum(rate.rightCols(s_.n_zeta), -embedding_.topRightCorner(s_.n, s_.n_zeta), s_.exosystem->a().cast<Wide>());
    rate = wide_clean_product(embedding_.topLeftCorner(s_.n, m.n1).transpose(), rate);
  }
  Matrix a = Matrix::Zero(m.ny, m.ny);
  a.topRows(m.n1) = rate.cast<double>();
  a.bottomRightCorner(s_.n_zeta, s_.n_zeta) = s_.exosystem->a();
  if (!(linalg::norm_bound(a) < fastest_rate)) return false;
  flow_ = std::move(a);
  return true;
}

/// rows(row, ·) += input·K, cleaned.
template <class Input>
void ModeMaker::add_inputs(WideMatrix& rows, Eigen::Index row, const Input& input, Wide rounding) {
  input_.resize(inputs_.k().rows());
  for (std::size_t a = 0; a < inputs_.ports().size(); ++a) input_[static_cast<Eigen::Index>(a)] = input[inputs_.ports()[a]];
  if (input_.isZero(0)) return;
  for (Eigen::Index j = 0; j < rows.cols(); ++j) {
    Wide sum = rows(row, j);
    Wide bound = std::abs(sum);
    for (Eigen::Index a = 0; a < input_.size(); ++a) {
      const Wide term = input_[a] * inputs_.k()(a, j);
      sum += term;
      bound += std::abs(term);
    }
    rows(row, j) = std::abs(sum) <= rounding * bound ? 0 : sum;
  }
}

/// Rows that read x as rows that read y.
Matrix ModeMaker::in_mode(const Mode& m, const WideMatrix& full) const {
  return (m.constrained ? wide_clean_product(full, embedding_) : full).cast<double>();
}

/// factor·u or factor·y of a diode port; port −1: neither.
struct PortReading {
  int port = -1;
  double factor = 0.0;
  bool of_input = false;
};

PortReading port_reading(const System& s, const OutputRow& value) {
  if (!value.reads_ports()) return {};
  Eigen::Index lead = 0;
  const double largest = std::max(value.input.cwiseAbs().maxCoeff(&lead), value.state.size() > 0 ? value.state.cwiseAbs().maxCoeff() : 0.0);
  const bool reads_one = (value.input.array() != 0.0).count() == 1 && value.state.isZero(0.0);
  if (reads_one && lead < s.diodes) return {static_cast<int>(lead), value.input[lead], true};
  for (int i = 0; i < s.diodes; ++i) {
    if (s.d(i, lead) == 0.0) continue;
    const double factor = value.input[lead] / s.d(i, lead);
    if ((value.input.transpose() - factor * s.d.row(i)).cwiseAbs().maxCoeff() > tolerance::row_entry * largest) continue;
    if ((value.state.transpose() - factor * s.c.row(i)).cwiseAbs().maxCoeff() <= tolerance::row_entry * largest) return {i, factor, false};
  }
  return {};
}

/// A control that reads the current or the voltage of a diode reads the port's own row, and zero where the port holds it at zero.
void ModeMaker::take_port_rows(const Mode& m, WideMatrix& rows) const {
  for (std::size_t i = 0; i < s_.controls.size(); ++i) {
    const PortReading reading = port_reading(s_, s_.controls[i].value);
    if (reading.port < 0) continue;
    auto row = rows.row(s_.diodes + static_cast<Eigen::Index>(i));
    if (reading.of_input == m.active.contains(reading.port))
      row = static_cast<Wide>(reading.factor) * rows.row(reading.port);
    else
      row.setZero();
  }
}

/// A control that is nothing but rounding of what it reads, the current of a diode that blocks, say: in proportion to the largest row of a port, as a
/// diode's is.
void ModeMaker::clean_control_rows(Matrix& rows) const {
  double largest = inputs_.k().rows() > 0 ? static_cast<double>(inputs_.k().rowwise().norm().maxCoeff()) : 0.0;
  if (s_.diodes > 0) largest = std::max(largest, rows.topRows(s_.diodes).rowwise().norm().maxCoeff());
  for (std::size_t i = 0; i < s_.controls.size(); ++i) {
    const OutputRow& value = s_.controls[i].value;
    if (!value.reads_ports()) continue;
    auto row = rows.row(s_.diodes + static_cast<Eigen::Index>(i));
    const double size = value.state.norm() + value.input.cwiseAbs().maxCoeff() * largest;
    if (row.norm() <= static_cast<double>(tolerance::output_rounding) * size) row.setZero();
  }
}

/// Of diodes, controls and the first outputs in y.
Matrix ModeMaker::mode_rows(const Mode& m, Eigen::Index outputs) {
  const auto controls = static_cast<Eigen::Index>(s_.controls.size());
  WideMatrix full(s_.diodes + controls + outputs, s_.size());
  for (std::size_t a = 0; a < inputs_.ports().size() && inputs_.ports()[a] < s_.diodes; ++a)
    full.row(inputs_.ports()[a]) = inputs_.k().row(static_cast<Eigen::Index>(a));
  for (int i = 0; i < s_.diodes; ++i) {
    if (m.active.contains(i)) continue;
    full.row(i) = inputs_.unrounded().c.row(i);
    add_inputs(full, i, inputs_.unrounded().d.row(i), manifold_ ? tolerance::manifold_rounding : linalg::wide_clean_tolerance);
  }
  for (Eigen::Index i = 0; i < controls + outputs; ++i) {
    const OutputRow& row =
        i < controls ? s_.controls[static_cast<std::size_t>(i)].value : s_.outputs[static_cast<std::size_t>(i - controls)];
    full.row(s_.diodes + i) = row.state.transpose().cast<Wide>();
    add_inputs(full, s_.diodes + i, row.input, tolerance::output_rounding);
  }
  take_port_rows(m, full);
  for (const int port : blocked_ports(s_, m.active)) full.row(port).setZero();
  Matrix rows = in_mode(m, full);
  clean_control_rows(rows);
  return rows;
}

Matrix ModeMaker::guards_of(const Mode& m, const Matrix& rows) const {
  const auto controls = static_cast<int>(s_.controls.size());
  Matrix guards(s_.diodes + 2 * controls, m.ny);
  guards.topRows(s_.diodes) = rows.topRows(s_.diodes);
  for (int i = 0; i < controls; ++i) {
    const Control& control = s_.controls[static_cast<std::size_t>(i)];
    const int constant = s_.exosystem->constant();
    const int on_row = s_.diodes + 2 * i;
    guards.row(on_row) = rows.row(s_.diodes + i);
    guards.row(on_row + 1) = -rows.row(s_.diodes + i);
    if (constant >= 0) {
      guards(on_row, m.n1 + constant) -= control.off_level;
      guards(on_row + 1, m.n1 + constant) += control.on_level;
    }
  }
  return guards;
}

/// As rows of x; nothing where there is none.
std::optional<Matrix> ModeMaker::guards_at_other_shift(const Mode& m, ShiftedSystems& shifted) {
  std::optional<Feedback> other = feedback_at_other_shift(s_, inputs_.ports(), shifted, *manifold_);
  if (!other) return std::nullopt;
  inputs_.take(*other);
  const WideMatrix& slow = other->slow;
  embedding_.topLeftCorner(s_.n, m.n1) = slow;
  embedding_.topRightCorner(s_.n, s_.n_zeta) = other->lift - product(slow, product(slow.transpose(), other->lift));
  const Matrix guards = guards_of(m, mode_rows(m, 0));
  Matrix rows(guards.rows(), s_.size());
  rows << guards.leftCols(m.n1) * slow.cast<double>().transpose(), guards.rightCols(s_.n_zeta);
  return rows;
}

void ModeMaker::build_rows() {
  Mode& m = *mode_;
  const auto outputs = static_cast<Eigen::Index>(s_.outputs.size());
  const Matrix rows = mode_rows(m, outputs);
  m.guards = guards_of(m, rows);
  m.outputs = rows.bottomRows(outputs);
  finish_mode(s_, m, std::move(flow_));
  if (inputs_.k_error().size() > 0) bound_guard_noise();
}

/// Each diode's guard has the digits of its own row: the small current of a port beside large ones has fewer than they have, and a large one does not
/// lose any to them.
void ModeMaker::bound_guard_noise() const {
  Mode& m = *mode_;
  const WideVector of_input = inputs_.k_error().rowwise().norm();
  std::size_t a = 0;
  for (int i = 0; i < s_.diodes; ++i) {
    const bool is_active = m.active.contains(i);
    Wide error = is_active ? of_input[static_cast<Eigen::Index>(a++)] : 0;
    for (std::size_t j = 0; !is_active && j < inputs_.ports().size(); ++j)
      error += std::abs(inputs_.unrounded().d(i, inputs_.ports()[j])) * of_input[static_cast<Eigen::Index>(j)];
    if (m.guard_norm[i] > 0.0)
      m.guard_noise[i] =
          std::clamp(static_cast<double>(error) / m.guard_norm[i], tolerance::noise_floor, std::max(m.noise, tolerance::largest_row_noise));
  }
}

/// What the decays beside the slow motion add to the guards: in the mode itself they are states like others.
void ModeMaker::add_decays(const Mode& whole, Mode& slow) const {
  auto decays = std::make_unique<Decays>();
  decays->time_constants = manifold_->time_constants;
  decays->slowest = manifold_->slowest;
  decays->are_sharp = manifold_->are_sharp;
  decays->rate_doubt = manifold_->rate_doubt;
  decays->coordinates = manifold_->coordinates;
  decays->slow = slow.basis.transpose() * slow.projector.topRows(s_.n);
  const Matrix fast =
      whole.constrained ? Matrix(whole.basis.transpose() * (whole.projector.topLeftCorner(s_.n, s_.n) * manifold_->fast)) : manifold_->fast;
  decays->guards = whole.guards.leftCols(whole.n1) * fast;
  decays->guard_doubt = static_cast<double>(tolerance::output_rounding) * (whole.absolute_guards.leftCols(whole.n1) * fast.cwiseAbs());
  decays->guard_rounding = whole.guard_noise.cwiseProduct(whole.guard_norm);
  slow.decays = std::move(decays);
}

}  // namespace

Mode::Mode() = default;
Mode::~Mode() = default;

std::unique_ptr<Mode> build_mode(const System& system, const IndexSet& active) {
  IndexSet held = active;
  hold_blocked(system, held);
  return ModeMaker(system, held).run();
}

std::unique_ptr<Mode> build_slow_mode(const System& system, const Mode& whole, const Cut& cut, ShiftedSystems& shifted) {
  if (!whole.regular || whole.ny == 0 || cut.fast == 0) return nullptr;
  return ModeMaker(system, whole.active).run_slow(whole, cut, shifted);
}

}  // namespace pwlsim::model
