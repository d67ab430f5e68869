#include "engine/sparse/port_solver.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "lcp/solve.hpp"

namespace pwlsim::engine::sparse {

namespace {

/// A sign is wrong beyond this fraction of the largest quantity of its kind; where positions repeat, beyond the next: ties of zero with zero, and
/// the rounding of long chains.
constexpr double sign_tolerance = 1e-10;
/// In a network that is not passive a port may drive what is integrated twice before it answers: its margin counts to the last digit.
constexpr double active_sign_tolerance = 1e-12;
constexpr double tie_tolerance = 1e-8;
/// Where there are only voltages as yet, currents are judged against this part of them over R0.
constexpr double cross_scale = 1e-3;
/// What a position forces to zero may be this part of the largest: more, and the ε of its closing rows is all that holds it.
constexpr double forced_tolerance = 1e-6, forced_cross_scale = 1e-9;
constexpr int most_iterations = 24;
constexpr int most_decisions = 32;

std::size_t hash_of(const Position& on) { return std::hash<std::string_view>()({on.data(), on.size()}); }

}  // namespace

double PortSolver::free_variable(std::size_t port, bool on, const std::vector<double>& z, const std::vector<double>& w) const {
  const Port& p = descriptor_.ports()[port];
  return on ? z[static_cast<std::size_t>(p.row)] : p.slack.value(z.data(), w.data());
}

void PortSolver::note_scale(const std::vector<double>& z, const std::vector<double>& w) {
  for (const Port& p : descriptor_.ports()) {
    scale_.input = std::max(scale_.input, std::abs(z[static_cast<std::size_t>(p.row)]));
    scale_.slack = std::max(scale_.slack, std::abs(p.slack.value(z.data(), w.data())));
  }
}

std::vector<int> PortSolver::violated(const Position& on, const std::vector<double>& z, const std::vector<double>& w, double tolerance) {
  const auto diodes = static_cast<std::size_t>(descriptor_.first_switch());
  std::vector<double> value(diodes);
  double forced_slack = 0.0, forced_input = 0.0;
  PortScale scale = scale_;
  for (std::size_t i = 0; i < diodes; ++i) {
    value[i] = free_variable(i, on[i] != 0, z, w);
    const double forced = std::abs(free_variable(i, on[i] == 0, z, w));
    (on[i] != 0 ? forced_slack : forced_input) = std::max(on[i] != 0 ? forced_slack : forced_input, forced);
    double& largest = on[i] != 0 ? scale.input : scale.slack;
    largest = std::max(largest, std::abs(value[i]));
  }
  forced_ = std::max(forced_slack > 0.0 ? forced_slack / std::max(scale.slack, forced_cross_scale * scale.input) : 0.0,
                     forced_input > 0.0 ? forced_input / std::max(scale.input, forced_cross_scale * scale.slack) : 0.0);
  scale.input = std::max(scale.input, cross_scale * scale.slack);
  std::vector<int> result;
  for (std::size_t i = 0; i < diodes; ++i) {
    const double largest = on[i] != 0 ? scale.input : scale.slack;
    if (!(value[i] < 0.0)) continue;
    if (value[i] < -tolerance * largest) result.push_back(static_cast<int>(i));
  }
  return result;
}

Solved PortSolver::solve_at(double shift, const std::vector<double>& memory, const std::vector<double>& w, const Position& on,
                            std::vector<double>& z) {
  const Factor* factor = factors_.at(shift, on);
  if (!factor) return Solved::singular;
  z.resize(static_cast<std::size_t>(descriptor_.size()));
  descriptor_.input(w.data(), on, z.data());
  for (std::size_t i = 0; i < z.size(); ++i) z[i] += memory[i];
  factor->solve(z);
  return Solved::yes;
}

Solved PortSolver::respond(double shift, const Position& on, std::vector<double>& r) {
  const Factor* factor = factors_.at(shift, on);
  if (!factor) return Solved::singular;
  factor->solve(r);
  return Solved::yes;
}

void PortSolver::dispute(const std::vector<int>& ports) {
  disputed_.insert(disputed_.end(), ports.begin(), ports.end());
  std::sort(disputed_.begin(), disputed_.end());
  disputed_.erase(std::unique(disputed_.begin(), disputed_.end()), disputed_.end());
}

/// Whether what the position forces to zero is zero. In a passive network nothing else can be.
bool PortSolver::held() const { return passive_ || forced_ <= forced_tolerance; }

Solved PortSolver::solve(double shift, const std::vector<double>& memory, const std::vector<double>& w, Position& on,
                         std::vector<double>& z) {
  disputed_.clear();
  for (const double tolerance : {passive_ ? sign_tolerance : active_sign_tolerance, tie_tolerance}) {
    std::unordered_set<std::size_t> visited;
    for (int iteration = 0; iteration < most_iterations && visited.insert(hash_of(on)).second; ++iteration) {
      if (const Solved solved = solve_at(shift, memory, w, on, z); solved != Solved::yes) return solved;
      const std::vector<int> wrong = violated(on, z, w, tolerance);
      if (wrong.empty()) return held() ? Solved::yes : Solved::no_position;
      dispute(wrong);
      for (const int i : wrong) on[static_cast<std::size_t>(i)] ^= 1;
    }
  }
  return settle_dispute(shift, memory, w, on, z);
}

/// All that ever changed sides decide together; whoever they push over joins them.
Solved PortSolver::settle_dispute(double shift, const std::vector<double>& memory, const std::vector<double>& w, Position& on,
                                  std::vector<double>& z) {
  for (int round = 0; round < most_decisions; ++round) {
    if (const Solved solved = solve_at(shift, memory, w, on, z); solved != Solved::yes) return solved;
    const std::vector<int> wrong = violated(on, z, w, tie_tolerance);
    if (wrong.empty()) return held() ? Solved::yes : Solved::no_position;
    dispute(wrong);
    if (!decide(shift, on, z, w)) return Solved::no_position;
  }
  return Solved::no_position;
}

/// The ports in dispute settle among themselves, the others staying where they are. w = M z + q with z the variable that the position
/// forces to zero and w the one it leaves free.
bool PortSolver::decide(double shift, Position& on, const std::vector<double>& z, const std::vector<double>& w) {
  const std::size_t k = disputed_.size();
  if (k > most_disputed) return false;
  const Factor* factor = factors_.at(shift, on);
  if (!factor) return false;
  linalg::Matrix m(k, k);
  linalg::Vector q(k);
  const std::vector<double> nothing(w.size(), 0.0);
  for (std::size_t j = 0; j < k; ++j) {
    right_.assign(static_cast<std::size_t>(descriptor_.size()), 0.0);
    right_[static_cast<std::size_t>(descriptor_.ports()[static_cast<std::size_t>(disputed_[j])].row)] = 1.0;
    factor->solve(right_);
    for (std::size_t i = 0; i < k; ++i) {
      const auto port = static_cast<std::size_t>(disputed_[i]);
      const double constant = on[port] != 0 ? 0.0 : descriptor_.ports()[port].slack.constant;  // the response has no part of it
      m(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = free_variable(port, on[port] != 0, right_, nothing) - constant;
    }
  }
  for (std::size_t i = 0; i < k; ++i) {
    const auto port = static_cast<std::size_t>(disputed_[i]);
    q[static_cast<Eigen::Index>(i)] = free_variable(port, on[port] != 0, z, w);
  }
  const lcp::Answer answer = lcp::solve(m, q);
  pivots_ += static_cast<std::uint64_t>(answer.pivots);
  if (answer.status != lcp::Status::solved) return false;
  for (const int i : answer.basis) on[static_cast<std::size_t>(disputed_[static_cast<std::size_t>(i)])] ^= 1;
  return true;
}

}  // namespace pwlsim::engine::sparse
