#include "engine/sparse/stepper.hpp"
#include "engine/sparse/tolerances.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pwlsim::engine::sparse {

namespace {

constexpr double d = diagonal;
constexpr double b = step_weight;
/// Weights of TR-BDF2 less those of the method of order 3 with its stages.
constexpr double error_weights[3] = {(4.0 * b - 1.0) / 3.0, -1.0 / 3.0, 2.0 * d / 3.0};
/// The local error of SDIRK2 on z' = λ z is (3d² − 2d³ − 1/6) h³ z'''.
constexpr double error_of_sdirk2 = (3.0 * d * d - 2.0 * d * d * d - 1.0 / 6.0) / d;

}  // namespace

void StateScale::note(const std::vector<double>& z) {
  const auto& states = descriptor_.states();
  for (std::size_t i = 0; i < states.size(); ++i) take(i, states[i].measure(z.data()));
  if (!counts_nodes_) return;
  for (int node = 0; node < descriptor_.nodes(); ++node) voltage_ = std::max(voltage_, std::abs(z[static_cast<std::size_t>(node)]));
}

void StateScale::note_values(const std::vector<double>& states) {
  for (std::size_t i = 0; i < states.size(); ++i) take(i, states[i]);
}

void StateScale::take(std::size_t i, double value) {
  largest_[i] = std::max(largest_[i], std::abs(value));
  double& kind = descriptor_.states()[i].is_current ? current_ : voltage_;
  kind = std::max(kind, largest_[i]);
}

double StateScale::size(std::size_t i, const std::vector<double>& z) const {
  const State& state = descriptor_.states()[i];
  const double own = state.is_current ? current_ : voltage_, other = state.is_current ? voltage_ : current_;
  const double kind = std::max(own, tolerance::least_of_kind * other);
  return std::max({largest_[i], std::abs(state.measure(z.data())), tolerance::least_of_kind * kind});
}

double StateScale::norm(const std::vector<double>& error, const std::vector<double>& z) const {
  const auto& states = descriptor_.states();
  double worst = 0.0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const double e = std::abs(states[i].measure(error.data()));
    if (e > 0.0) worst = std::max(worst, e / size(i, z));
  }
  return worst;
}

Stepper::Stepper(const Descriptor& descriptor, PortSolver& ports, const Sources& sources)
    : descriptor_(descriptor), ports_(ports), sources_(sources) {
  const auto n = static_cast<std::size_t>(descriptor.size());
  memory_.assign(n, 0.0);
  rates_.resize(n);
  right_.resize(n);
}

void Stepper::start_from(const Point& from) { descriptor_.rates_without_sources(from.z.data(), rates_.data()); }

/// The inputs of ports that are off are zero, and no rounding of the solution: a latch that follows the current of its own thyristor would see it.
void Stepper::clear_inputs(Point& at) {
  for (std::size_t i = 0; i < at.on.size(); ++i) {
    const auto row = static_cast<std::size_t>(descriptor_.ports()[i].row);
    if (at.on[i] == 0) step_[row] -= std::exchange(at.z[row], 0.0);
  }
}

/// (shift·E + G) (z − z0) = m − (G z0 + H w + g)  at at.time, from the position in `at`.
Solved Stepper::stage(const Point& from, double shift, Search search, Point& at) {
  const std::size_t n = memory_.size();
  sources_.evaluate(at.time, at.w);
  right_ = rates_;
  descriptor_.add_sources(at.w.data(), right_.data());
  for (std::size_t i = 0; i < n; ++i) right_[i] += memory_[i];
  const Stage stage{shift, from.z, right_, at.w};
  const Solved solved =
      search == Search::none ? ports_.solve_in(stage, at.on, step_, at.z) : ports_.solve(stage, at.on, step_, at.z, search);
  if (solved != Solved::yes) return solved;
  clear_inputs(at);
  at.k.resize(n);
  descriptor_.memory(step_.data(), at.k.data());
  for (std::size_t i = 0; i < n; ++i) at.k[i] = shift * at.k[i] - memory_[i];
  return Solved::yes;
}

/// `memory_` holds the local error of E z times the shift.
double Stepper::estimate(double shift, const Position& on, const StateScale& scale, const std::vector<double>& z) {
  return ports_.respond(shift, on, memory_) == Solved::yes ? scale.norm(memory_, z) : model::forever;
}

void Stepper::tr_bdf2(const Point& from, double h, const StateScale& scale, Trial& trial) {
  const double shift = 1.0 / (d * h);
  const std::size_t n = memory_.size();
  trial.error = model::forever;
  trial.stage.time = from.time + first_stage * h;
  trial.end.time = from.time + h;
  trial.stage.on = trial.end.on = from.on;
  start_from(from);
  memory_ = from.k;
  trial.solved = stage(from, shift, Search::none, trial.stage);
  if (trial.solved != Solved::yes) return;
  for (std::size_t i = 0; i < n; ++i) memory_[i] = b / d * (from.k[i] + trial.stage.k[i]);
  trial.solved = stage(from, shift, Search::none, trial.end);
  if (trial.solved != Solved::yes) return;
  for (std::size_t i = 0; i < n; ++i)
    memory_[i] = h * shift * (error_weights[0] * from.k[i] + error_weights[1] * trial.stage.k[i] + error_weights[2] * trial.end.k[i]);
  trial.error = estimate(shift, trial.end.on, scale, trial.end.z);
}

/// `memory_` holds the estimate e:  (shift·E + G) c = shift·E e  is what goes, and  G c = shift·E (e − c)  comes to the rates.
Solved Stepper::improve(double h, Trial& trial) {
  const double shift = 1.0 / (d * h);
  step_ = memory_;
  descriptor_.memory(step_.data(), right_.data());
  for (double& value : right_) value *= shift;
  const Solved solved = ports_.respond(shift, trial.end.on, right_);
  if (solved != Solved::yes) return solved;
  for (std::size_t i = 0; i < trial.end.on.size(); ++i)
    if (trial.end.on[i] == 0) right_[static_cast<std::size_t>(descriptor_.ports()[i].row)] = 0.0;
  for (std::size_t i = 0; i < step_.size(); ++i) {
    step_[i] -= right_[i];
    trial.end.z[i] -= right_[i];
  }
  descriptor_.memory(step_.data(), memory_.data());
  for (std::size_t i = 0; i < step_.size(); ++i) trial.end.k[i] += shift * memory_[i];
  return Solved::yes;
}

void Stepper::sdirk2(const Point& from, double h, const StateScale& scale, Trial& trial) {
  const double shift = 1.0 / (d * h);
  const std::size_t n = memory_.size();
  trial.error = model::forever;
  trial.stage.time = from.time + d * h;
  trial.end.time = from.time + h;
  trial.stage.on = from.on;
  start_from(from);
  std::fill(memory_.begin(), memory_.end(), 0.0);
  trial.solved = stage(from, shift, Search::newton, trial.stage);
  if (trial.solved != Solved::yes) return;
  trial.end.on = trial.stage.on;
  for (std::size_t i = 0; i < n; ++i) memory_[i] = (1.0 - d) / d * trial.stage.k[i];
  trial.solved = stage(from, shift, Search::newton, trial.end);
  if (trial.solved != Solved::yes) return;
  for (std::size_t i = 0; i < n; ++i)
    memory_[i] = shift * error_of_sdirk2 * h * ((trial.end.k[i] - trial.stage.k[i]) / (1.0 - d) - (trial.stage.k[i] - from.k[i]) / d);
  trial.error = estimate(shift, trial.end.on, scale, trial.end.z);
}

Solved Stepper::euler(const Point& from, double h, Point& end, const std::vector<double>& more) {
  end.time = from.time + h;
  end.on = from.on;
  start_from(from);
  std::fill(memory_.begin(), memory_.end(), 0.0);
  for (std::size_t i = 0; i < more.size(); ++i) memory_[i] = more[i] / h;
  return stage(from, 1.0 / h, Search::all, end);
}

}  // namespace pwlsim::engine::sparse
