#include "engine/sparse/port_solver.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string_view>

#include "base/arithmetic.hpp"
#include "engine/sparse/interior_point.hpp"
#include "engine/sparse/resting_parts.hpp"
#include "engine/sparse/tolerances.hpp"
#include "lcp/solve.hpp"

namespace pwlsim::engine::sparse {

namespace {

/// What ε alone holds does not go away when it is taken out: after these corrections it is still this part of what it was.
constexpr int most_corrections = 3;
constexpr double far_away = 1e3;
constexpr int most_settling_steps = 8;
constexpr int most_decisions = 32;
constexpr std::size_t few_disputed = 12;  ///< decided by a dense matrix of their own

std::size_t hash_of(const Position& on) { return std::hash<std::string_view>()({on.data(), on.size()}); }

}  // namespace

void PortSolver::note_scale(const std::vector<double>& z, const std::vector<double>& w) {
  present_input_ = present_slack_ = 0.0;
  for (const DescriptorPort& p : descriptor_.ports()) {
    const double input = std::abs(z[static_cast<std::size_t>(p.row)]);
    present_input_ = std::max(present_input_, input);
    scale_.input = std::max(scale_.input, input);
    present_slack_ = std::max(present_slack_, std::abs(p.slack.value(z.data(), w.data())));
  }
  scale_.slack = std::max(scale_.slack, present_slack_);
}

PortSolver::PortSolver(const Descriptor& descriptor, Factors& factors, double voltage)
    : descriptor_(descriptor),
      factors_(factors),
      passive_(descriptor.passive()),
      voltage_(voltage),
      scale_{0.0, voltage},
      held_voltage_(voltage) {}

PortSolver::~PortSolver() = default;

double PortSolver::input_size(std::size_t port, const Position& on, double most, double voltage) const {
  const double largest = std::max({most, present_input_, tolerance::cross_scale * std::max(held_voltage_, present_slack_)});
  return std::min(largest, tolerance::lost_terms * voltage * descriptor_.leaks_at(port, on));
}

/// In a network of two-terminal parts no current that a voltage at the port drives is larger than the one at the port itself, so that reciprocity makes this
/// a bound for voltages anywhere. Where nothing can flow, all others being blocked, what resistors bring to the port's nodes still cancels to rounding only: that
/// of the sources' voltages, not of the present ones, which rounding that counts as a current may drive up.
double PortSolver::rounding_of_input(double shift, const Position& on, std::size_t port, double voltage) {
  probe_.clear();
  const Factor* factor = factors_.at(shift, on);
  if (!factor) return 0.0;
  const auto row = static_cast<std::size_t>(descriptor_.ports()[port].row);
  probe_.assign(static_cast<std::size_t>(descriptor_.size()), 0.0);
  probe_[row] = 1.0;
  factor->solve(probe_);
  if (!factor->open().empty()) {
    const auto& ports = descriptor_.ports();
    linalg::Vector values(static_cast<Eigen::Index>(ports.size()));
    for (std::size_t i = 0; i < ports.size(); ++i) values[static_cast<Eigen::Index>(i)] = ports[i].response(on[i] != 0, probe_.data());
    take_out_open(on, *factor, values, {&probe_});
  }
  return std::max(tolerance::voltage_rounding * voltage * std::abs(probe_[row]), rounding_at_nodes(port, on));
}

/// What the currents of resistors leave where they cancel at a port's nodes.
double PortSolver::rounding_at_nodes(std::size_t port, const Position& on) const {
  const double conductance = std::min(descriptor_.conductance_at(port), tolerance::lost_terms * descriptor_.leaks_at(port, on));
  return tolerance::node_rounding * voltage_ * conductance;
}

/// Sizes of the terms of each row of a stage's equations, in row_sizes_.
void PortSolver::measure_rows(const Stage& stage, const Position& on, const std::vector<double>& z) {
  row_sizes_.resize(z.size());
  sizes_.resize(z.size());
  residual_.resize(z.size());
  for (std::size_t i = 0; i < z.size(); ++i) residual_[i] = z[i] - stage.from[i];
  descriptor_.memory_sizes(residual_.data(), row_sizes_.data());
  for (double& size : row_sizes_) size *= stage.shift;
  const auto add = [&] {
    for (std::size_t i = 0; i < z.size(); ++i) row_sizes_[i] += sizes_[i];
  };
  descriptor_.conduct_sizes(residual_.data(), sizes_.data());
  add();
  if (stage.disputed == nullptr) {
    descriptor_.rate_sizes(stage.from.data(), stage.w.data(), sizes_.data());
    add();
  }
  for (std::size_t i = 0; i < on.size(); ++i) {
    const DescriptorPort& port = descriptor_.ports()[i];
    row_sizes_[static_cast<std::size_t>(port.row)] =
        on[i] != 0 ? std::max(stage.slack_size(port, z.data()), stage.slack_size(port, stage.from.data())) : 0.0;
  }
}

/// What the rounding of the terms of all rows makes of an input: of each row as much as the input's own response has there, by reciprocity (which passive networks
/// have).
double PortSolver::rounding_by_rows(const Stage& stage, const Position& on, std::size_t port, const std::vector<double>& z) {
  const double anywhere = rounding_of_input(stage.shift, on, port, std::max(largest_voltage(z), largest_voltage(stage.from)));
  if (probe_.empty()) return anywhere;
  const double of_rows = tolerance::voltage_rounding * descriptor_.largest_product(probe_, row_sizes_);
  return std::min(anywhere, std::max(of_rows, rounding_at_nodes(port, on)));
}

double PortSolver::largest_voltage(const std::vector<double>& z) const {
  return largest(std::span(z).first(static_cast<std::size_t>(descriptor_.nodes())));
}

/// Whether a port that is on carries nothing but rounding, as no current can flow through it.
bool PortSolver::is_idle(std::size_t port, const Position& on) {
  if (idle_on_ != on) {
    if (!resting_) resting_ = std::make_unique<RestingParts>(descriptor_);
    idle_on_ = on;
    idle_ = resting_->idle_ports(on);
  }
  return idle_[port] != 0;
}

/// An input is judged against the largest of all, or what meets it, a slack against the voltages it is a difference of and the largest of the run.
std::vector<int> PortSolver::violated(const Stage& stage, const Position& on, const std::vector<double>& z, double tolerance) {
  const auto diodes = static_cast<std::size_t>(descriptor_.first_switch());
  std::vector<int> negative;
  double most = 0.0;
  for (std::size_t i = 0; i < diodes; ++i) {
    const DescriptorPort& port = descriptor_.ports()[i];
    if (port.blocks(on)) continue;
    const double value = stage.free_variable(port, on[i] != 0, z.data());
    if (on[i] != 0) most = std::max(most, std::abs(value));
    if (value < 0.0 && stage.may_change(i, port, on)) negative.push_back(static_cast<int>(i));
  }
  if (negative.empty()) return negative;
  const double voltage = std::max(largest_voltage(z), largest_voltage(stage.from));
  if (by_rows_) measure_rows(stage, on, z);
  const auto within = [&](int port) {
    const auto i = static_cast<std::size_t>(port);
    const DescriptorPort& p = descriptor_.ports()[i];
    const double size = on[i] != 0 ? input_size(i, on, most, voltage) : std::max(scale_.slack, stage.slack_size(p, z.data()));
    const double beyond = stage.free_variable(p, on[i] != 0, z.data()) + tolerance * size;
    if (beyond >= 0.0) return true;
    return on[i] != 0 &&
           (is_idle(i, on) || beyond >= -(by_rows_ ? rounding_by_rows(stage, on, i, z) : rounding_of_input(stage.shift, on, i, voltage)));
  };
  negative.erase(std::remove_if(negative.begin(), negative.end(), within), negative.end());
  return negative;
}

/// Closing rows of a right-hand side: what they miss at z, those of the position or others.
void PortSolver::close(const Stage& stage, const Position& on, const std::vector<double>& z, const Descriptor::Closing* closing,
                       std::vector<double>& right) const {
  for (std::size_t i = 0; i < on.size(); ++i) {
    const DescriptorPort& port = descriptor_.ports()[i];
    const auto row = static_cast<std::size_t>(port.row);
    right[row] = closing ? -closing->of_slack[i] * stage.free_variable(port, false, z.data()) - closing->of_input[i] * z[row]
                         : -stage.free_variable(port, on[i] == 0, z.data());
  }
}

Solved PortSolver::solve_at(const Stage& stage, const Position& on, std::vector<double>& step, std::vector<double>& z) {
  const Factor* factor = factors_.at(stage.shift, on);
  if (!factor) return Solved::singular;
  step = stage.right;
  close(stage, on, stage.from, factor->closing() ? &*factor->closing() : nullptr, step);
  const bool refined = is_noisy(stage.shift) && factor->is_as_it_stands();
  if (refined) right_ = step;
  factor->solve(step);
  if (refined) correct(stage.shift, on, *factor, step);
  z.resize(step.size());
  for (std::size_t i = 0; i < z.size(); ++i) z[i] = stage.from[i] + step[i];
  contradicted_ = false;
  if (factor->closing()) refine(stage, on, *factor, step, z);
  if (!factor->ties().empty()) examine_ties(stage, on, *factor, step, z);
  if (factor->is_as_it_stands()) block(on, stage.from, step, z);
  return Solved::yes;
}

/// Whether the rounding of a voltage times C/h is a current that counts, once any is known.
bool PortSolver::is_noisy(double shift) const {
  const double noise = tolerance::voltage_rounding * scale_.slack * shift * descriptor_.largest_capacitance();
  return scale_.input > 0.0 && noise > tolerance::noisy_current * scale_.input;
}

/// One refinement, from the residual of every row, where that makes the worst of them smaller against its own terms (Skeel, Math. Comp. 35, 1980). `right_`:
/// the right-hand side.
void PortSolver::correct(double shift, const Position& on, const Factor& factor, std::vector<double>& step) {
  descriptor_.matrix(shift, descriptor_.closing(shift, on, 0.0), 1.0, values_);
  const double before = backward_error(step, residual_);
  if (before <= tolerance::good_backward_error) return;
  factor.solve(residual_);
  for (std::size_t i = 0; i < step.size(); ++i) residual_[i] += step[i];
  if (backward_error(residual_, refined_) < before) step.swap(residual_);
}

/// max |b − A x| / (|A| |x| + |b|) over the rows, A in values_ and b in right_.
double PortSolver::backward_error(const std::vector<double>& x, std::vector<double>& residual) {
  residual.resize(x.size());
  sizes_.resize(x.size());
  linalg::multiply(descriptor_.pattern(), values_, x.data(), residual.data());
  linalg::multiply_absolute(descriptor_.pattern(), values_, x.data(), sizes_.data());
  double worst = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    residual[i] = right_[i] - residual[i];
    const double size = sizes_[i] + std::abs(right_[i]);
    if (size > 0.0) worst = std::max(worst, std::abs(residual[i]) / size);
  }
  return worst;
}

/// What is zero but for rounding.
void PortSolver::block(const Position& on, const std::vector<double>& from, std::vector<double>& step, std::vector<double>& z) const {
  for (std::size_t i = 0; i < on.size(); ++i) {
    if (on[i] != 0) continue;
    const auto row = static_cast<std::size_t>(descriptor_.ports()[i].row);
    z[row] = 0.0;
    step[row] = -from[row];
  }
}

/// The largest of the run and of z. Where only currents flow as yet, voltages are judged against them.
PortSolver::Sizes PortSolver::sizes(const std::vector<double>& z) const {
  const auto nodes = static_cast<std::size_t>(descriptor_.nodes());
  const double current = std::max(scale_.input, largest(std::span(z).subspan(nodes)));
  return {std::max({scale_.slack, largest(std::span(z).first(nodes)), tolerance::cross_scale * current}), current};
}

/// What a tie carries must be nothing. Then what it settles is chosen: of all currents and voltages the least squares. Else the position contradicts
/// the network, and z goes far to where the ties push it, so that signs show who must give way.
void PortSolver::examine_ties(const Stage& stage, const Position& on, const Factor& factor, std::vector<double>& step,
                              std::vector<double>& z) {
  const auto& ports = descriptor_.ports();
  const auto nodes = static_cast<std::size_t>(descriptor_.nodes());
  const Sizes size = sizes(z);
  const double rounding = tolerance::sum_rounding * factor.stiffest() * largest(std::span(step).first(nodes));
  right_.assign(z.size(), 0.0);
  for (const int tie : factor.ties()) {
    const auto i = static_cast<std::size_t>(tie);
    const bool is_on = on[i] != 0;
    const double forced = stage.free_variable(ports[i], !is_on, z.data());
    const double nothing = is_on ? tolerance::held_port * size.voltage : std::max(tolerance::held_port * size.current, rounding);
    if (!(std::abs(forced) > nothing)) continue;
    right_[static_cast<std::size_t>(ports[i].row)] = -forced;
    contradicted_ = true;
  }
  if (contradicted_) {
    factor.solve(right_);
    const double volts = largest(std::span(right_).first(nodes)), amperes = largest(std::span(right_).subspan(nodes));
    const double far = far_away * std::max(volts > 0.0 ? size.voltage / volts : 0.0, amperes > 0.0 ? size.current / amperes : 0.0);
    strain_ = right_;
    for (std::size_t i = 0; i < z.size(); ++i) z[i] += far * right_[i];
    return;
  }
  if (factor.open().empty()) return;
  linalg::Vector values(static_cast<Eigen::Index>(ports.size()));
  for (std::size_t i = 0; i < ports.size(); ++i) values[static_cast<Eigen::Index>(i)] = stage.free_variable(ports[i], on[i] != 0, z.data());
  take_out_open(on, factor, values, {&z, &step});
}

/// Of the free variables of all ports, `values`, what the open vectors have of them goes, from several vectors of unknowns.
void PortSolver::take_out_open(const Position& on, const Factor& factor, const linalg::Vector& values,
                               std::initializer_list<std::vector<double>*> from) const {
  const auto& ports = descriptor_.ports();
  linalg::Vector moments = linalg::Vector::Zero(static_cast<Eigen::Index>(factor.open().size()));
  for (std::size_t i = 0; i < ports.size(); ++i)
    for (std::size_t j = 0; j < factor.open().size(); ++j)
      moments[static_cast<Eigen::Index>(j)] +=
          values[static_cast<Eigen::Index>(i)] * ports[i].response(on[i] != 0, factor.open()[j].data());
  const linalg::Vector shares = factor.share_out(moments);
  for (std::vector<double>* z : from)
    for (std::size_t j = 0; j < factor.open().size(); ++j)
      for (std::size_t i = 0; i < z->size(); ++i) (*z)[i] -= shares[static_cast<Eigen::Index>(j)] * factor.open()[j][i];
}

Solved PortSolver::solve_in(const Stage& stage, const Position& on, std::vector<double>& step, std::vector<double>& z) {
  const Solved solved = solve_at(stage, on, step, z);
  return solved == Solved::yes ? found(stage, on, z) : solved;
}

/// Takes the ε of a factor out again. What it only chose (how parallel diodes share a current) stays as it is; what it held, in a position that
/// contradicts the network, stays wrong however often.
void PortSolver::refine(const Stage& stage, const Position& on, const Factor& factor, std::vector<double>& step, std::vector<double>& z) {
  refined_ = z;
  const Sizes size = sizes(z);
  double first = 0.0, last = 0.0;
  for (int round = 0; round <= most_corrections; ++round) {
    right_.assign(z.size(), 0.0);
    close(stage, on, refined_, nullptr, right_);
    last = 0.0;
    for (std::size_t i = 0; i < on.size(); ++i)
      last = std::max(last,
                      std::abs(right_[static_cast<std::size_t>(descriptor_.ports()[i].row)]) / (on[i] != 0 ? size.voltage : size.current));
    if (round == 0) first = last;
    if (!(last > tolerance::held_port) || round == most_corrections) break;
    factor.solve(right_);
    for (std::size_t i = 0; i < z.size(); ++i) refined_[i] += right_[i];
  }
  contradicted_ = last > std::max(tolerance::contradiction * first, tolerance::held_port);
  if (contradicted_) {
    strain_ = refined_;
    for (std::size_t i = 0; i < z.size(); ++i) strain_[i] -= z[i];
    return;
  }
  for (std::size_t i = 0; i < z.size(); ++i) step[i] += refined_[i] - z[i];
  z.swap(refined_);
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

/// All signs are right: a solution, unless the position contradicts the network. Then the ports it strains most are named.
Solved PortSolver::found(const Stage& stage, const Position& on, const std::vector<double>& z) {
  if (!contradicted_) return Solved::yes;
  std::vector<double> strain;
  for (std::size_t i = 0; i < on.size(); ++i) strain.push_back(std::abs(stage.free_variable(descriptor_.ports()[i], on[i] == 0, z.data())));
  const double largest = *std::max_element(strain.begin(), strain.end());
  disputed_.clear();
  for (std::size_t i = 0; i < strain.size(); ++i)
    if (strain[i] >= 0.5 * largest) disputed_.push_back(static_cast<int>(i));
  return Solved::no_position;
}

/// Newton's method for min(u, s) = 0. `no_position` without names in `disputed_` alone: positions repeat.
Solved PortSolver::iterate(const Stage& stage, double tolerance, Position& on, std::vector<double>& step, std::vector<double>& z) {
  std::unordered_set<std::size_t> visited;
  repeated_ = false;
  std::size_t fewest = on.size() + 1;
  for (int iteration = 0; iteration < most_settling_steps; ++iteration) {
    repeated_ = !visited.insert(hash_of(on)).second;
    if (repeated_) break;
    if (const Solved solved = solve_at(stage, on, step, z); solved != Solved::yes) return solved;
    const std::vector<int> wrong = violated(stage, on, z, tolerance);
    if (wrong.empty()) return found(stage, on, z);
    dispute(wrong);
    if (stage.disputed != nullptr && wrong.size() >= fewest && !repeated_ && passive_ && disputed_.size() > few_disputed) break;
    fewest = std::min(fewest, wrong.size());
    for (const int i : wrong) on[static_cast<std::size_t>(i)] ^= 1;
  }
  contradicted_ = false;
  return Solved::no_position;
}

Solved PortSolver::solve(const Stage& stage, Position& on, std::vector<double>& step, std::vector<double>& z, Search search) {
  disputed_.clear();
  descriptor_.hold_blocked(on);
  Solved solved = iterate(stage, passive_ ? tolerance::port_sign : tolerance::active_port_sign, on, step, z);
  if (solved != Solved::no_position || contradicted_ || search == Search::newton) return solved;
  if (passive_ && (!repeated_ || disputed_.size() > few_disputed)) {
    Position guess = on;
    solved = settle_by_interior(stage, guess, step, z);
    if (solved == Solved::yes) on = guess;
    if (solved == Solved::yes || contradicted_) return solved;
  }
  solved = iterate(stage, tolerance::tied_port_sign, on, step, z);
  if (solved != Solved::no_position || contradicted_) return solved;
  return settle_dispute(stage, on, step, z);
}

/// An interior solution, and its position made exact.
Solved PortSolver::settle_by_interior(const Stage& stage, Position& on, std::vector<double>& step, std::vector<double>& z) {
  if (!interior_) interior_ = std::make_unique<InteriorPoint>(descriptor_, factors_.ordering());
  if (!interior_->solve(stage, {std::max(scale_.input, tolerance::cross_scale * scale_.slack), scale_.slack}, on))
    return Solved::no_position;
  return iterate(stage, tolerance::tied_port_sign, on, step, z);
}

/// All that ever changed sides decide together; whoever they push over joins them.
Solved PortSolver::settle_dispute(const Stage& stage, Position& on, std::vector<double>& step, std::vector<double>& z) {
  const auto diodes = static_cast<std::size_t>(descriptor_.first_switch());
  for (int round = 0; round < most_decisions; ++round) {
    if (const Solved solved = solve_at(stage, on, step, z); solved != Solved::yes) return solved;
    const std::vector<int> wrong = violated(stage, on, z, tolerance::tied_port_sign);
    if (wrong.empty()) return found(stage, on, z);
    dispute(wrong);
    if (decide(stage, on, z)) continue;
    if (passive_ || disputed_.size() == diodes) return Solved::no_position;
    std::vector<int> all(diodes);  // one that was right so far may have to give way
    std::iota(all.begin(), all.end(), 0);
    std::erase_if(
        all, [&](int i) { return !stage.may_change(static_cast<std::size_t>(i), descriptor_.ports()[static_cast<std::size_t>(i)], on); });
    dispute(all);
    if (!decide(stage, on, z)) return Solved::no_position;
  }
  return Solved::no_position;
}

/// The ports in dispute settle among themselves, the others staying where they are. w = M z + q with z the variable that the position
/// forces to zero and w the one it leaves free.
bool PortSolver::decide(const Stage& stage, Position& on, const std::vector<double>& z) {
  const std::size_t k = disputed_.size();
  if (k > most_disputed) return false;
  const Factor* factor = factors_.at(stage.shift, on);
  if (!factor) return false;
  linalg::Matrix m(k, k);
  linalg::Vector q(k);
  const auto disputed = [&](std::size_t i) { return static_cast<std::size_t>(disputed_[i]); };
  for (std::size_t j = 0; j < k; ++j) {
    right_.assign(static_cast<std::size_t>(descriptor_.size()), 0.0);
    right_[static_cast<std::size_t>(descriptor_.ports()[disputed(j)].row)] = 1.0;
    factor->solve(right_);
    for (std::size_t i = 0; i < k; ++i)
      m(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          descriptor_.ports()[disputed(i)].response(on[disputed(i)] != 0, right_.data());
  }
  for (std::size_t i = 0; i < k; ++i)
    q[static_cast<Eigen::Index>(i)] = stage.free_variable(descriptor_.ports()[disputed(i)], on[disputed(i)] != 0, z.data());
  const lcp::AssessedSolution answer = lcp::solve(m, q);
  pivots_ += static_cast<std::uint64_t>(answer.pivots);
  if (answer.status != lcp::Status::solved) return false;
  for (const int i : answer.basis) on[disputed(static_cast<std::size_t>(i))] ^= 1;
  return true;
}

}  // namespace pwlsim::engine::sparse
