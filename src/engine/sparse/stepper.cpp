#include "engine/sparse/stepper.hpp"

#include <algorithm>
#include <cmath>

namespace pwlsim::engine::sparse {

namespace {

constexpr double g = gamma_sdirk;
constexpr double error_constant = (3.0 * g * g - 2.0 * g * g * g - 1.0 / 6.0) / g;
constexpr double least_of_kind = 1e-3;

}  // namespace

void StateScale::note(const std::vector<double>& z) {
  const auto& states = descriptor_.states();
  for (std::size_t i = 0; i < states.size(); ++i) take(i, states[i].measure(z.data()));
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
  const double kind = state.is_current ? std::max(current_, least_of_kind * voltage_) : voltage_;
  return std::max({largest_[i], std::abs(state.measure(z.data())), least_of_kind * kind});
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
  memory_.resize(static_cast<std::size_t>(descriptor.size()));
}

Solved Stepper::stage(double shift, const std::vector<double>& w, bool frozen, Position& on, std::vector<double>& z) {
  return frozen ? ports_.solve_at(shift, memory_, w, on, z) : ports_.solve(shift, memory_, w, on, z);
}

void Stepper::sdirk2(const Point& from, double h, bool frozen, const StateScale& scale, Trial& trial) {
  const double shift = 1.0 / (g * h);
  const std::size_t n = memory_.size();
  Point& end = trial.end;
  std::vector<double>& rate = trial.stage_k;
  rate.resize(n);
  end.time = from.time + h;
  end.on = from.on;
  end.y.resize(n);
  end.k.resize(n);
  for (std::size_t i = 0; i < n; ++i) memory_[i] = shift * from.y[i];
  sources_.evaluate(from.time + g * h, stage_w_);
  trial.solved = stage(shift, stage_w_, frozen, end.on, trial.stage);
  if (trial.solved != Solved::yes) return;
  descriptor_.memory(trial.stage.data(), rate.data());
  for (std::size_t i = 0; i < n; ++i) {
    rate[i] = shift * (rate[i] - from.y[i]);  // K1
    memory_[i] = shift * (from.y[i] + (1.0 - g) * h * rate[i]);
  }
  sources_.evaluate(end.time, end.w);
  trial.solved = stage(shift, end.w, frozen, end.on, end.z);
  if (trial.solved != Solved::yes) return;
  descriptor_.memory(end.z.data(), end.y.data());
  for (std::size_t i = 0; i < n; ++i) {
    end.k[i] = shift * end.y[i] - memory_[i];  // K2
    memory_[i] = shift * error_constant * h * ((end.k[i] - rate[i]) / (1.0 - g) - (rate[i] - from.k[i]) / g);
  }
  trial.solved = ports_.respond(shift, end.on, memory_);
  if (trial.solved == Solved::yes) trial.error = scale.norm(memory_, end.z);
}

Solved Stepper::euler(const Point& from, double h, Point& end) {
  const double shift = 1.0 / h;
  end.time = from.time + h;
  end.on = from.on;
  end.y.resize(memory_.size());
  end.k.resize(memory_.size());
  for (std::size_t i = 0; i < memory_.size(); ++i) memory_[i] = shift * from.y[i];
  sources_.evaluate(end.time, end.w);
  if (const Solved solved = stage(shift, end.w, false, end.on, end.z); solved != Solved::yes) return solved;
  descriptor_.memory(end.z.data(), end.y.data());
  for (std::size_t i = 0; i < memory_.size(); ++i) end.k[i] = shift * (end.y[i] - from.y[i]);
  return Solved::yes;
}

double Stepper::euler_error(const Point& a, const Point& b, double h, const StateScale& scale) {
  for (std::size_t i = 0; i < memory_.size(); ++i) memory_[i] = 0.5 * (b.k[i] - a.k[i]);
  return ports_.respond(1.0 / h, b.on, memory_) == Solved::yes ? scale.norm(memory_, b.z) : model::forever;
}

}  // namespace pwlsim::engine::sparse
