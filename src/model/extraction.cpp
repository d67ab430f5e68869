#include "model/extraction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "linalg/careful_elimination.hpp"
#include "linalg/constraint_basis.hpp"
#include "linalg/doubled.hpp"
#include "linalg/factorisations.hpp"
#include "linalg/refined_solution.hpp"
#include "model/assembly.hpp"
#include "model/causality.hpp"
#include "model/certificate.hpp"
#include "model/clock.hpp"
#include "model/structure_errors.hpp"
#include "model/tolerances.hpp"

namespace pwlsim::model {

namespace {

using linalg::absolute_product;
using linalg::sparse_absolute_product;
using linalg::sparse_product;
using linalg::Wide;
using linalg::wide_clean_product;
using linalg::wide_clean_sum;
using linalg::wide_cleaned;
using linalg::WideMatrix;
using linalg::WideVector;

constexpr int largest_index = 6;
/// A second weight of the inputs of complementarities, a ratio of no small integers.
constexpr Wide other_input_factor = 0.7548776662466927L;

/// Scales of columns change nothing in left null vectors, but in what counts as one.
WideMatrix with_small_columns_raised(WideMatrix g) {
  for (Eigen::Index j = 0; j < g.cols(); ++j) {
    const Wide largest = g.col(j).cwiseAbs().maxCoeff();
    if (largest < tolerance::small_column && largest > tolerance::rounding_column) g.col(j) *= std::ldexp(1.0L, -std::ilogb(largest));
  }
  return g;
}

/// Left null vectors of G; column j has its 1 at row pivot_rows[j].
struct LeftNull {
  WideMatrix vectors;
  std::vector<Eigen::Index> pivot_rows;
};

bool is_clearly_regular(const WideMatrix& g) {
  const Eigen::ColPivHouseholderQR<WideMatrix> quick(with_small_columns_raised(g));
  const WideVector diagonal = quick.matrixR().diagonal().cwiseAbs();
  return diagonal.size() == 0 || diagonal.minCoeff() > tolerance::regular_network * diagonal.maxCoeff();
}

Wide largest_of(const WideMatrix& m) { return m.size() == 0 ? 0 : m.cwiseAbs().maxCoeff(); }

/// A product in which entries that are rounding are zero.
WideMatrix constraint_entries(const WideMatrix& combinations, const WideMatrix& m) {
  WideMatrix result = sparse_product(combinations, m);
  const WideMatrix bound = sparse_absolute_product(combinations, m);
  for (Eigen::Index i = 0; i < result.size(); ++i)
    if (std::abs(result.data()[i]) <= tolerance::constraint_entry * bound.data()[i]) result.data()[i] = 0.0;
  return result;
}

class Extractor {
 public:
  Extractor(const Island& island, const Assembly& assembly, Diagnostics& diagnostics)
      : island_(island),
        network_(island.network),
        assembly_(assembly),
        diagnostics_(diagnostics),
        g_(assembly.g),
        g_rest_(assembly.g_rest),
        g_data_(assembly.g_data),
        f_(assembly.f),
        ha_(assembly.ha),
        hw_(assembly.hw),
        hw_edge_(WideMatrix::Zero(assembly.hw.rows(), assembly.hw.cols())),
        h_edge_(WideMatrix::Zero(assembly.g.rows(), assembly.stores())),
        row_scale_(WideVector::Ones(assembly.g.rows())) {}

  std::optional<Extraction> run() {
    if (!assembly_.coupling_possible) {
      report_impossible_coupling(network_, diagnostics_);
      return std::nullopt;
    }
    if (!reduce_index()) return std::nullopt;
    solve_constraints();
    choose_causality();
    take_causality();
    solve_unknowns();
    finish();
    return std::move(result_);
  }

 private:
  void equilibrate();
  bool reduce_index();
  [[nodiscard]] LeftNull left_null() const;
  bool take_constraints(const LeftNull& null);
  void report_singular(const LeftNull& null, const WideMatrix& nf, const WideMatrix& nw);
  void solve_constraints();
  void choose_causality();
  void take_causality();
  void solve_unknowns();
  [[nodiscard]] WideMatrix data_bound(const WideMatrix& inverse, const WideMatrix& solution, const WideMatrix& right) const;
  void take_start(const WideMatrix& inverse);
  void finish();
  void add_ports();
  void add_matrices();
  void add_equations();
  [[nodiscard]] OutputRow output(const LinearForm& form) const;

  const Island& island_;
  const Network& network_;
  const Assembly& assembly_;
  Diagnostics& diagnostics_;
  WideMatrix g_, g_rest_, g_data_, f_, ha_, hw_;
  WideMatrix hw_edge_;              ///< over an instant G ∫z + H_a ∫a + this·Δζ = 0
  WideMatrix h_edge_;               ///< the same where x and ζ miss the constraints: G ∫z + H_a ∫a + this·x + hw_edge·ζ = 0
  WideMatrix h_, s_zeta_;           ///< H x + S_ζ ζ = 0
  std::vector<Eigen::Index> held_;  ///< stores in which H is regular
  WideMatrix basis_, offset_;       ///< x = basis·ξ + offset·ζ
  WideVector row_scale_;            ///< of the rows of G against the assembly's; zero where a constraint took their place
  WideVector theta_;                ///< causality of the ports: −1 where u is the current
  WideMatrix hu_, hu_data_;         ///< G z + F x + H_u u + H_w ζ = 0, with y in the place of each port's current
  WideMatrix z_xi_, z_u_, z_zeta_;  ///< z = …·ξ, …·u, …·ζ
  WideMatrix z_edge_;               ///< ∫z = …·Δζ over an instant, with no impulse of u
  Matrix edge_;
  WideMatrix start_, start_zeta_;  ///< ξ = start·x + …·ζ of values that may miss the constraints
  WideMatrix a_, b_, e_;           ///< ξ' = a ξ + b u + e ζ
  Extraction result_;
};

void Extractor::equilibrate() {
  for (Eigen::Index i = 0; i < g_.rows(); ++i) {
    const Wide largest = g_.row(i).cwiseAbs().maxCoeff();
    if (largest == 0.0) continue;
    const Wide scale = std::ldexp(1.0L, -std::ilogb(largest));  // exact
    for (WideMatrix* m : {&g_, &g_rest_, &g_data_, &f_, &ha_, &hw_, &hw_edge_, &h_edge_}) m->row(i) *= scale;
    row_scale_[i] *= scale;
  }
}

bool Extractor::reduce_index() {
  h_ = WideMatrix(0, assembly_.stores());
  s_zeta_ = WideMatrix(0, assembly_.exosystem->size());
  if (g_.rows() == 0) return true;
  for (int round = 0; round < largest_index; ++round) {
    equilibrate();
    const LeftNull null = left_null();
    if (null.pivot_rows.empty()) return true;
    if (!take_constraints(null)) return false;
  }
  diagnostics_.error("E-index", network_.nodes.empty() ? SourceSpan{} : network_.nodes.front().span,
                     "the network's equations need more differentiations than those of any passive circuit; try a small resistor in its "
                     "loops of controlled sources");
  return false;
}

LeftNull Extractor::left_null() const {
  if (is_clearly_regular(g_)) return {};
  const linalg::CarefulElimination elimination(g_, g_rest_, tolerance::data_rounding * g_data_);
  return {elimination.left_kernel(), elimination.free_rows()};
}

bool Extractor::take_constraints(const LeftNull& null) {
  const WideMatrix nt = null.vectors.transpose();
  const WideMatrix nf = constraint_entries(nt, f_), na = constraint_entries(nt, ha_), nw = constraint_entries(nt, hw_);
  // In units of each store, so that a picofarad weighs as much as a farad.
  WideMatrix scaled = nf;
  for (Eigen::Index j = 0; j < nf.cols(); ++j)
    if (const Wide unit = largest_of(f_.col(j)); unit > 0.0) scaled.col(j) /= unit;
  if (linalg::CarefulElimination(scaled, {}, tolerance::data_rounding * scaled.cwiseAbs()).rank() < nf.rows()) {
    report_singular(null, nf, nw);
    return false;
  }
  // Waves of passive parts are bounded: what they would be differentiated by is rounding.
  if (na.size() > 0 && na.cwiseAbs().maxCoeff() > 0.0 && !has_passive_parts_only(network_)) {
    report_improper(assembly_.unknowns, na, diagnostics_);
    return false;
  }
  const auto old = h_.rows();
  h_.conservativeResize(old + nf.rows(), Eigen::NoChange);
  s_zeta_.conservativeResize(old + nf.rows(), Eigen::NoChange);
  h_.bottomRows(nf.rows()) = nf;
  s_zeta_.bottomRows(nf.rows()) = nw;
  // The row a null vector was pivoted on depends on the others: the differentiated constraint takes its place.
  for (std::size_t i = 0; i < null.pivot_rows.size(); ++i) {
    const auto row = null.pivot_rows[i];
    const auto k = static_cast<Eigen::Index>(i);
    g_.row(row) = nf.row(k) * assembly_.sx;
    g_rest_.row(row).setZero();
    g_data_.row(row) = nf.row(k).cwiseAbs() * assembly_.sx.cwiseAbs();
    row_scale_[row] = 0.0;
    f_.row(row).setZero();
    ha_.row(row).setZero();
    hw_.row(row) = nw.row(k) * assembly_.exosystem->a().cast<Wide>();
    result_.equations.reads_source_rates = result_.equations.reads_source_rates || !hw_.row(row).isZero(0);
    hw_edge_.row(row) = nw.row(k);
    h_edge_.row(row) = nf.row(k);
  }
  return true;
}

void Extractor::report_singular(const LeftNull& null, const WideMatrix& nf, const WideMatrix& nw) {
  OpenEquations open;
  // Directions of z that nothing determines: right null vectors of G on top of those already used up.
  open.kernel = linalg::CarefulElimination(g_, g_rest_, tolerance::data_rounding * g_data_).kernel();
  // The combination of rows that holds no store: its part in the sources decides between loop and cutset.
  const WideMatrix combination =
      linalg::CarefulElimination(nf.transpose(), {}, tolerance::data_rounding * nf.cwiseAbs().transpose()).kernel();
  open.rows = null.vectors * combination;
  open.is_contradicted = largest_of(combination.transpose() * nw) > 0.0;
  report_open(network_, assembly_.unknowns, open, diagnostics_);
}

void Extractor::solve_constraints() {
  const auto stores = assembly_.stores();
  const auto fixed = h_.rows();
  if (fixed == 0) {
    basis_ = WideMatrix::Identity(stores, stores);
    offset_ = WideMatrix::Zero(stores, s_zeta_.cols());
    return;
  }
  for (Eigen::Index i = 0; i < fixed; ++i) {
    const Wide scale = h_.row(i).norm();
    h_.row(i) /= scale;
    s_zeta_.row(i) /= scale;
  }
  const linalg::ConstraintBasis free(h_);
  held_ = free.pivots();
  basis_ = free.null();
  offset_ = -free.least(s_zeta_);
  basis_ = wide_cleaned(basis_, WideMatrix::Ones(stores, stores - fixed));
  offset_ = wide_cleaned(offset_, WideMatrix::Constant(stores, s_zeta_.cols(), s_zeta_.size() ? s_zeta_.cwiseAbs().maxCoeff() : 0.0));
}

/// b = S a + …;  with p = −v/2-scaled waves the causality of each port follows from one sign (mathematics of wave ports):
/// Θ = diag(±1) with S + Θ nonsingular.
void Extractor::choose_causality() {
  const auto k = assembly_.unknowns.ports();
  theta_ = WideVector::Zero(k);
  if (k == 0) return;
  const auto first = assembly_.unknowns.port(0);
  const WideMatrix z_a = -Eigen::PartialPivLU<WideMatrix>(g_).solve(ha_);
  theta_ = causality(WideMatrix::Identity(k, k) + 2.0 * z_a.middleRows(first, k), theta_, tolerance::same_pivot);
}

/// A port's row d − i − a = 0 (d the voltage beyond its drop and resistance, i its current) becomes d + u = 0 with y = i, or d + y = 0 with
/// u = i: a = −(u + y). The unknowns are then solved for with u given, so that small entries of D are as exact as those of G.
void Extractor::take_causality() {
  const auto k = assembly_.unknowns.ports();
  hu_ = WideMatrix::Zero(g_.rows(), k);
  hu_data_ = WideMatrix::Zero(g_.rows(), k);
  for (int j = 0; j < k; ++j) {
    const auto column = assembly_.unknowns.port(j);
    const Wide scale = -ha_(column, j);
    linalg::Doubled diagonal{g_(column, column), g_rest_(column, column)};
    diagonal.add(scale);
    g_(column, column) = diagonal.value + diagonal.rest;
    g_rest_(column, column) = diagonal.rest - (g_(column, column) - diagonal.value);
    if (theta_[j] > 0.0) {
      hu_(column, j) = scale;
      continue;
    }
    hu_.col(j) = g_.col(column);
    hu_data_.col(j) = g_data_.col(column);
    for (WideMatrix* m : {&g_, &g_rest_, &g_data_}) m->col(column).setZero();
    g_(column, column) = scale;
  }
}

/// What a change of each number of the netlist by its own size does to the unknowns, to first order: a resistor's changes the current through
/// it, not the conductances at its ends one by one. What is exact has the rounding of the residuals only.
WideMatrix Extractor::data_bound(const WideMatrix& inverse, const WideMatrix& solution, const WideMatrix& right) const {
  WideMatrix change = tolerance::residual_rounding * (sparse_absolute_product(g_, solution) + right.cwiseAbs());
  change += sparse_absolute_product(g_data_, solution);
  const auto stores = assembly_.stores();
  change.middleCols(stores, hu_.cols()) += hu_data_;
  change.rightCols(hw_.cols()) += hw_.cwiseAbs();
  WideVector current(solution.cols());
  for (const auto& r : network_.resistors) {
    if (assembly_.has_current(r)) continue;
    const Wide conductance = static_cast<Wide>(assembly_.r0) / std::abs(static_cast<Wide>(r.resistance));
    current.setZero();
    if (r.p != ground) current += solution.row(r.p).transpose();
    if (r.n != ground) current -= solution.row(r.n).transpose();
    for (const NodeIndex node : {r.p, r.n})
      if (node != ground) change.row(node) += row_scale_[node] * conductance * current.cwiseAbs().transpose();
  }
  return absolute_product(inverse, change);
}

void Extractor::solve_unknowns() {
  const auto m = g_.rows();
  const auto stores = assembly_.stores();
  const auto k = assembly_.unknowns.ports();
  const auto nz = hw_.cols();
  WideMatrix right(m, stores + k + nz);
  right << f_, hu_, hw_;
  WideMatrix solution = WideMatrix::Zero(m, right.cols());
  z_edge_ = WideMatrix::Zero(m, nz);
  start_ = basis_.transpose();
  start_zeta_ = WideMatrix::Zero(basis_.cols(), nz);
  if (m > 0) {
    const WideMatrix inverse = Eigen::PartialPivLU<WideMatrix>(g_).inverse();
    solution = linalg::refined_solution(g_, g_rest_, inverse, -right);
    solution = wide_cleaned(solution, data_bound(inverse, solution, right));
    if (!hw_edge_.isZero(0)) z_edge_ = -wide_clean_product(inverse, hw_edge_);
    if (!h_edge_.isZero(0)) take_start(inverse);
  }
  // Of stores that share a constraint one is left out: what reads the others reads them alike, and nothing cancels in H·basis = 0.
  const WideMatrix solved = Eigen::PartialPivLU<WideMatrix>(h_(Eigen::all, held_)).inverse();
  const WideMatrix h = wide_clean_product(solved, h_);
  WideMatrix z_full = solution.leftCols(stores);
  z_u_ = solution.middleCols(stores, k);
  const WideMatrix left_out = -z_full(Eigen::all, held_);
  z_full = wide_clean_sum(z_full, left_out, h);
  z_zeta_ = wide_clean_sum(solution.rightCols(nz), left_out, wide_clean_product(solved, s_zeta_));
  z_zeta_ = wide_clean_sum(z_zeta_, z_full, offset_);
  z_xi_ = wide_clean_product(z_full, basis_);
  const auto rates = [&](const WideMatrix& z) {
    const WideMatrix rate = wide_clean_product(assembly_.sx, z);
    return wide_clean_product(basis_.transpose(), wide_clean_sum(rate, h.transpose(), -rate(held_, Eigen::all)));
  };
  a_ = rates(z_xi_);
  b_ = rates(z_u_);
  e_ = rates(z_zeta_);
}

/// Values that miss the constraints go where the impulses of the network's own laws take them. In a reciprocal network that is at right angles to basis; what a controlled source copies moves
/// alone.
void Extractor::take_start(const WideMatrix& inverse) {
  const auto moved = [&](const WideMatrix& z) { return wide_clean_product(basis_.transpose(), wide_clean_product(assembly_.sx, z)); };
  start_ = wide_clean_sum(start_, WideMatrix::Identity(start_.rows(), start_.rows()), -moved(wide_clean_product(inverse, h_edge_)));
  start_zeta_ = moved(z_edge_);
}

void Extractor::add_ports() {
  System& system = result_.system;
  system.diodes = assembly_.unknowns.first_switch();
  system.ports = assembly_.unknowns.ports();
  for (int i = 0; i < system.ports; ++i) {
    const bool input_is_current = theta_[i] < 0.0;
    const double current = assembly_.current_unit(i), voltage = assembly_.voltage_unit(i);
    system.port.push_back({assembly_.unknowns.port_label(i).name, assembly_.unknowns.port_label(i).span, input_is_current,
                           input_is_current ? current : voltage, input_is_current ? voltage : current});
  }
  for (const auto& s : network_.switches) system.switch_inverted.push_back(s.inverted);
  for (std::size_t i = 0; i < network_.diodes.size(); ++i) {
    const Diode& diode = network_.diodes[i];
    if (diode.enabled_by.empty() && !diode.blocks) continue;
    system.port[i].is_of_leak = diode.is_of_leak;
    Valve valve{static_cast<int>(i), diode.enabled_by};
    for (int& s : valve.switches) s += assembly_.unknowns.first_switch();
    system.valves.push_back(std::move(valve));
  }
  system.switch_number = island_.switch_number;
}

void Extractor::add_matrices() {
  System& system = result_.system;
  const int n = system.n, nz = system.n_zeta, k = system.ports, size = n + nz;
  auto unrounded = std::make_shared<Unrounded>();
  unrounded->a = WideMatrix::Zero(size, size);
  unrounded->a.topLeftCorner(n, n) = a_;
  unrounded->a.topRightCorner(n, nz) = e_;
  unrounded->a.bottomRightCorner(nz, nz) = assembly_.exosystem->a().cast<Wide>();
  unrounded->b = WideMatrix::Zero(size, k);
  unrounded->b.topRows(n) = b_;
  unrounded->c.resize(k, size);
  const auto first = assembly_.unknowns.port(0);
  unrounded->c << z_xi_.middleRows(first, k), z_zeta_.middleRows(first, k);
  unrounded->d = z_u_.middleRows(first, k);
  system.a = unrounded->a.cast<double>();
  system.b = unrounded->b.cast<double>();
  system.c = unrounded->c.cast<double>();
  system.d = unrounded->d.cast<double>();
  system.unrounded = std::move(unrounded);
}

/// The equations before the reduction, and how they give z, x and the first state.
void Extractor::add_equations() {
  System& system = result_.system;
  Equations& equations = result_.equations;
  const int k = system.ports, size = system.n + system.n_zeta, first = assembly_.unknowns.port(0);
  equations.g = assembly_.g.cast<double>();
  equations.f = assembly_.f.cast<double>();
  equations.ha = assembly_.ha.cast<double>();
  equations.hw = assembly_.hw.cast<double>();
  equations.sx = assembly_.sx.cast<double>();
  equations.r0 = assembly_.r0;
  equations.tau0 = assembly_.tau0;
  equations.store_ports = assembly_.store_ports();
  equations.store_sign = assembly_.store_sign();
  // Where y took a current's place the current is u.
  for (int j = 0; j < k; ++j) {
    if (theta_[j] > 0.0) continue;
    for (WideMatrix* z : {&z_xi_, &z_u_, &z_zeta_, &z_edge_}) z->row(first + j).setZero();
    z_u_(first + j, j) = 1.0;
  }
  equations.z_state.resize(assembly_.unknowns.size(), size);
  equations.z_state << z_xi_.cast<double>(), z_zeta_.cast<double>();
  edge_ = z_edge_.cast<double>();
  equations.z_input = z_u_.cast<double>();
  equations.store_state.resize(assembly_.stores(), size);
  equations.store_state << basis_.cast<double>(), offset_.cast<double>();
  equations.reduce = basis_.transpose().cast<double>();
  equations.start = start_.cast<double>();
  equations.start_sources = start_zeta_.cast<double>();
  system.x0 = equations.start * assembly_.initial_state();
}

void Extractor::finish() {
  System& system = result_.system;
  system.name = island_.name;
  system.n = static_cast<int>(basis_.cols());
  system.n_zeta = assembly_.exosystem->size();
  system.exosystem = assembly_.exosystem;
  add_ports();
  add_matrices();
  add_equations();
  for (std::size_t i = 0; i < network_.signals.size(); ++i) {
    system.outputs.push_back(output(network_.signals[i].form));
    system.output_signal.push_back(island_.signal_number[i]);
  }
  for (const auto& form : island_.controls) {
    const Control control{output(form.value), form.driven, form.on_level, form.off_level};
    (Clock::can_drive(system, control) ? system.clocked : system.controls).push_back(control);
  }
  system.time_scale = assembly_.tau0;
  system.kyp_residual = kyp_residual(system);
  const bool positive_energy = assembly_.stores() == 0 || assembly_.store_sign().minCoeff() > 0.0;
  system.passive = system.kyp_residual <= passivity_tolerance || (positive_energy && has_passive_parts_only(network_));
}

OutputRow Extractor::output(const LinearForm& form) const {
  const Assembly::FormRow row = assembly_.row_of(form);
  const Equations& d = result_.equations;
  const Vector z_part = row.z_part.cast<double>();
  OutputRow result{d.z_state.transpose() * z_part, d.z_input.transpose() * z_part, edge_.transpose() * z_part};
  const Vector state_bound = d.z_state.cwiseAbs().transpose() * z_part.cwiseAbs();
  const Vector input_bound = d.z_input.cwiseAbs().transpose() * z_part.cwiseAbs();
  result.state.tail(row.zeta_part.size()) += row.zeta_part.cast<double>();
  for (Eigen::Index i = 0; i < result.state.size(); ++i)
    if (std::abs(result.state[i]) <= linalg::clean_tolerance * state_bound[i]) result.state[i] = 0.0;
  for (Eigen::Index i = 0; i < result.input.size(); ++i)
    if (std::abs(result.input[i]) <= linalg::clean_tolerance * input_bound[i]) result.input[i] = 0.0;
  const Vector edge_bound = edge_.cwiseAbs().transpose() * z_part.cwiseAbs();
  for (Eigen::Index i = 0; i < result.edge.size(); ++i)
    if (std::abs(result.edge[i]) <= linalg::clean_tolerance * edge_bound[i]) result.edge[i] = 0.0;
  return result;
}

}  // namespace

Vector initial_state(const Island& island) {
  const Assembly assembly(island.network, true);
  return assembly.initial_state();
}

std::optional<Extraction> extract(const Island& island, Diagnostics& diagnostics) {
  bool needs_constant = false;
  for (const auto& control : island.controls) needs_constant |= control.on_level != 0.0 || control.off_level != 0.0;
  for (const auto& control : island.controls)
    for (const auto& term : control.value) needs_constant |= term.kind == Term::Kind::one;
  const bool may_retry = !island.network.complementarities.empty();
  Diagnostics first_try;
  const Assembly assembly(island.network, needs_constant);
  auto extraction = Extractor(island, assembly, may_retry ? first_try : diagnostics).run();
  if (extraction || !may_retry) return extraction;
  // A slack of −u cancels against the port's own termination, or another such sum does: at another weight it does not.
  const Assembly other(island.network, needs_constant, other_input_factor);
  return Extractor(island, other, diagnostics).run();
}

}  // namespace pwlsim::model
