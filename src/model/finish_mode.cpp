/// A mode whose coordinates and guard rows are set is completed: its flow, and norms and bounds of both.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "linalg/balance.hpp"
#include "model/mode.hpp"
#include "model/tolerances.hpp"

namespace pwlsim::model {

namespace {

/// Entries of c, and of c and ζ, with which what a guard reads is kept apart: a ring takes two of them, and the guard another.
constexpr int fewest_read_apart = 3, most_read_apart = 64;

/// The flow y' = A y and what bounds it.
void set_flow(const System& system, Mode& m, Matrix a) {
  Matrix a1 = a.topLeftCorner(m.n1, m.n1);
  const double own_rate = linalg::norm_bound(a1);
  const double rate = std::max(own_rate, system.exosystem->fastest());
  if (!system.passive) {
    m.growth = std::max(0.0, linalg::logarithmic_norm(a1));
    if (m.growth < tolerance::growth * own_rate) m.growth = 0.0;
    if (m.growth > 0.0 && m.n1 > 1) {
      double scaled = m.growth;
      m.scale = linalg::balance(a1, scaled);
      m.scaled_growth = std::max(0.0, scaled);
    }
  }
  m.piecewise_linear = m.n1 == 0 && !system.exosystem->has_curved();
  m.absolute_a = a.cwiseAbs();
  m.norm_a = a.norm();
  m.flow = linalg::Exponential(std::move(a), rate);
}

/// Ports in series carry one current, and rows that differ by rounding would make one event two.
void find_twins(const System& system, Mode& m) {
  const auto count = m.guards.rows();
  m.guard_twin.resize(static_cast<std::size_t>(count));
  for (Eigen::Index i = 0; i < count; ++i) {
    const bool diode = i < system.diodes;
    Eigen::Index twin = diode ? 0 : system.diodes;
    const auto same = [&] {
      const double tolerance = diode ? tolerance::diode_row_rounding * m.guard_norm[i] : 0.0;
      return (m.guards.row(twin) - m.guards.row(i)).cwiseAbs().maxCoeff() <= tolerance;
    };
    while (twin < i && (m.ny == 0 || !same())) ++twin;
    m.guard_twin[static_cast<std::size_t>(i)] = static_cast<int>(twin);
    if (twin < i) m.guards.row(i) = m.guards.row(twin);
  }
}

/// Bit j of reads[i]: entry (i, j) of the first `columns` is not zero.
void find_entries(const Matrix& m, int columns, std::uint64_t* reads) {
  const double* entry = m.data();
  for (int j = 0; j < columns; ++j)
    for (Eigen::Index i = 0; i < m.rows(); ++i) reads[i] |= static_cast<std::uint64_t>(*entry++ != 0.0) << static_cast<unsigned>(j);
}

/// Entries of c that each guard reads, over all derivatives.
void find_reads(Mode& m) {
  if (m.n1 < fewest_read_apart || m.ny > most_read_apart) return;
  m.guard_reads.assign(static_cast<std::size_t>(m.guards.rows()), 0);
  std::array<std::uint64_t, most_read_apart> rate{};
  find_entries(m.flow.a(), m.n1, rate.data());
  find_entries(m.guards, m.n1, m.guard_reads.data());
  const std::uint64_t all = ~std::uint64_t{0} >> static_cast<unsigned>(64 - m.n1);
  for (std::uint64_t& reads : m.guard_reads) {
    for (std::uint64_t left = reads; left != 0 && reads != all;) {
      const std::uint64_t more = rate[static_cast<std::size_t>(std::countr_zero(left))] & ~reads;
      left &= left - 1;
      reads |= more;
      left |= more;
    }
    if (reads == all) reads = 0;
  }
}

/// Norms and kinds of the guard rows.
void finish_rows(const System& system, Mode& m) {
  const auto& blocks = system.exosystem->blocks();
  const auto count = m.guards.rows();
  m.guard_norm = m.guards.rowwise().norm();
  const double largest = system.diodes > 0 ? m.guard_norm.head(system.diodes).maxCoeff() : 0.0;
  // A diode row that is nothing but rounding of the largest: an indeterminate port.
  for (int i = 0; i < system.diodes; ++i)
    if (m.guard_norm[i] <= tolerance::diode_row_rounding * largest) {
      m.guards.row(i).setZero();
      m.guard_norm[i] = 0.0;
    }
  find_twins(system, m);
  const Matrix slope = m.guards * m.flow.a();
  for (Eigen::Index i = 0; i < count; ++i) m.guard_constant.push_back(m.ny == 0 || slope.row(i).cwiseAbs().maxCoeff() == 0.0);
  m.absolute_guards = m.guards.cwiseAbs();
  m.guard_noise.setConstant(count, m.noise);
  const bool scaled = m.scale.size() > 0;
  m.guard_c_norm = m.guards.leftCols(m.n1).rowwise().norm();
  if (scaled) {
    m.scaled_guard_c_norm = (m.guards.leftCols(m.n1) * m.scale.asDiagonal()).rowwise().norm();
    m.scaled_input_block_norm.resize(static_cast<Eigen::Index>(blocks.size()));
  }
  find_reads(m);
  m.guard_block_norm.resize(count, static_cast<Eigen::Index>(blocks.size()));
  m.input_block_norm.resize(static_cast<Eigen::Index>(blocks.size()));
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    // Of a ramp only the value's column carries a derivative beyond the first slope.
    const int width = blocks[b].kind == Exosystem::Block::Kind::ramp ? 1 : blocks[b].size();
    const int first = m.n1 + blocks[b].first;
    const auto column = static_cast<Eigen::Index>(b);
    m.guard_block_norm.col(column) = m.guards.middleCols(first, width).rowwise().norm();
    const auto inputs = m.flow.a().block(0, first, m.n1, width);
    m.input_block_norm[column] = inputs.norm();
    if (scaled) m.scaled_input_block_norm[column] = (m.scale.cwiseInverse().asDiagonal() * inputs).norm();
  }
}

}  // namespace

void finish_mode(const System& system, Mode& mode, Matrix a) {
  set_flow(system, mode, std::move(a));
  finish_rows(system, mode);
}

}  // namespace pwlsim::model
