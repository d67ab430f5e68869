#include "property/independent.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "property/resistive_network.hpp"

namespace pwlsim::test {
namespace {

using Kind = NetworkPart::Kind;
using Real = ResistiveNetwork::Real;

constexpr Real one = 1;

constexpr double diode_slack = 1e-18;  ///< of a diode's voltage or current, relative to the terms it is the sum of
constexpr double widest_slack = 1e-6;  ///< where no position solves a step with less: potentials of floating parts while a current jumps
/// Two positions within the slack σ lead to states whose distance has an energy below h·σ·v·i: relative to all energy, √σ in the states.
constexpr double same_states = 1e-5;
constexpr double typical_voltage = 10.0, typical_current = 0.01;  ///< of the sources and initial states of random networks
constexpr int most_diodes_examined = 8;
constexpr int examined_every = 16;
constexpr int doublings = 8;  ///< of the steps after an edge until they are as long as all others
constexpr int samples_in_segment = 3;

/// Value at t, by the piece of the function in which `inside` lies: at an edge, the limit from its side.
double value_at(const model::Dc& dc, double, double) { return dc.value; }

double value_at(const model::Sin& sine, double t, double) {
  return sine.offset + sine.amplitude * std::sin(2.0 * std::numbers::pi * sine.frequency * t);
}

double value_at(const model::Pulse& pulse, double t, double inside) {
  if (inside < pulse.delay) return pulse.initial;
  const double begin = pulse.delay + std::floor((inside - pulse.delay) / pulse.period) * pulse.period;
  const double top = begin + pulse.rise, down = top + pulse.width, bottom = down + pulse.fall;
  const double swing = pulse.pulsed - pulse.initial;
  if (inside < top) return pulse.initial + swing * (t - begin) / pulse.rise;
  if (inside < down) return pulse.pulsed;
  if (inside < bottom) return pulse.pulsed - swing * (t - down) / pulse.fall;
  return pulse.initial;
}

double value_at(const model::Pwl&, double, double) { return std::nan(""); }
double value_at(const model::Exp&, double, double) { return std::nan(""); }

double value_at(const model::SourceFunction& function, double t, double inside) {
  return std::visit([&](const auto& f) { return value_at(f, t, inside); }, function);
}

void add_edges(const NetworkPart& part, double stop, std::vector<double>& edges) {
  const auto* pulse = std::get_if<model::Pulse>(&part.function);
  if (pulse == nullptr) return;
  for (int n = 0; pulse->delay + n * pulse->period < stop; ++n) {
    const double begin = pulse->delay + n * pulse->period, top = begin + pulse->rise, down = top + pulse->width;
    for (const double t : {begin, top, down, down + pulse->fall}) edges.push_back(t);
    if (part.kind == Kind::switch_)
      for (const double t : {begin + clock_threshold * pulse->rise, down + clock_threshold * pulse->fall}) edges.push_back(t);
  }
}

/// The network of one step.
class Step {
 public:
  explicit Step(const RandomNetwork& network) : network_(network), parts_(states_of(network)) {
    frame_.nodes = network.nodes + 1;
    for (const NetworkPart& part : network.parts)
      if (part.kind == Kind::diode) add_diode(part);
  }

  /// x at t + h from x at t, in the piece of the sources in which `inside` lies. False where no position of the diodes solves it.
  bool advance(std::vector<double>& x, double end, Real h, double inside) {
    ResistiveNetwork step = frame_;
    fill(step, x, end, h, inside);
    const auto before = position_;
    auto e = step.solve(position_, diode_slack);
    for (double wider = diode_slack; e.empty() && wider < widest_slack; wider *= 1e3) e = step.solve(position_, wider * 1e3);
    if (e.empty()) return false;
    const bool changed = position_ != before;
    if (examine_all && (changed || ++unexamined_ >= examined_every)) {
      unexamined_ = 0;
      examine(step, x, e, h);
    }
    x = states(e, x, h);
    return true;
  }

  bool examine_all = false;
  double worst_difference = 0.0;  ///< between the states to which two positions lead, in the norm of energy, relative

 private:
  void add_diode(const NetworkPart& part) {
    int inner = part.n;
    if (part.value > 0.0) {
      inner = frame_.nodes++;
      frame_.conductances.push_back({inner, part.n, one / part.value, 0});
    }
    if (part.leak > 0.0) frame_.conductances.push_back({part.p, part.n, one / part.leak, 0});
    frame_.diodes.push_back({part.p, inner});
  }

  void fill(ResistiveNetwork& step, const std::vector<double>& x, double end, Real h, double inside) const {
    std::size_t state = 0;
    for (const NetworkPart& part : network_.parts) switch (part.kind) {
        case Kind::resistor:
          step.conductances.push_back({part.p, part.n, one / part.value, 0});
          break;
        case Kind::capacitor:
          step.conductances.push_back({part.p, part.n, part.value / h, -part.value / h * x[state++]});
          break;
        case Kind::inductor:
          step.conductances.push_back({part.p, part.n, h / part.value, x[state++]});
          break;
        case Kind::diode:
          break;
        case Kind::switch_:
          if (value_at(part.function, inside, inside) > clock_threshold) step.rigid.push_back({part.p, part.n, 0.0});
          break;
        case Kind::voltage: {
          const Real voltage = value_at(part.function, end, inside);
          if (part.value > 0.0)
            step.conductances.push_back({part.p, part.n, one / part.value, -voltage / part.value});
          else
            step.rigid.push_back({part.p, part.n, voltage});
          break;
        }
        case Kind::current:
          step.conductances.push_back({part.p, part.n, 0.0, value_at(part.function, end, inside)});
          break;
      }
  }

  std::vector<double> states(const std::vector<Real>& e, const std::vector<double>& before, Real h) const {
    std::vector<double> x;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const Real v = e[at(parts_[i].p)] - e[at(parts_[i].n)];
      x.push_back(static_cast<double>(parts_[i].kind == Kind::capacitor ? v : before[i] + h / parts_[i].value * v));
    }
    return x;
  }

  void examine(const ResistiveNetwork& step, const std::vector<double>& x, const std::vector<Real>& e, Real h) {
    if (step.diodes.size() > at(most_diodes_examined)) return;
    const auto chosen = states(e, x, h);
    for (ResistiveNetwork::Position position = 0; position < step.positions(); ++position) {
      if (position == position_) continue;
      const auto other = step.potentials(position, diode_slack);
      if (other.empty()) continue;
      const auto next = states(other, x, h);
      double difference = 0.0, energy = 0.0;
      for (std::size_t i = 0; i < parts_.size(); ++i) {
        difference += parts_[i].value * (next[i] - chosen[i]) * (next[i] - chosen[i]);
        energy += parts_[i].value * (x[i] * x[i] + chosen[i] * chosen[i] + typical_state(parts_[i]) * typical_state(parts_[i]));
      }
      worst_difference = std::max(worst_difference, std::sqrt(difference / energy));
    }
  }

  const RandomNetwork& network_;
  const std::vector<NetworkPart> parts_;
  ResistiveNetwork frame_;  ///< what does not change from step to step
  ResistiveNetwork::Position position_ = 0;
  int unexamined_ = 0;
};

}  // namespace

std::vector<NetworkPart> states_of(const RandomNetwork& network) {
  std::vector<NetworkPart> states;
  std::copy_if(network.parts.begin(), network.parts.end(), std::back_inserter(states),
               [](const NetworkPart& part) { return part.is_state(); });
  return states;
}

double typical_state(const NetworkPart& part) { return part.kind == Kind::capacitor ? typical_voltage : typical_current; }

std::vector<double> initial_states(const RandomNetwork& network) {
  std::vector<double> x;
  for (const NetworkPart& part : states_of(network)) x.push_back(part.initial);
  return x;
}

std::vector<double> edges_of(const RandomNetwork& network, double stop) {
  std::vector<double> edges;
  for (const NetworkPart& part : network.parts) add_edges(part, stop, edges);
  std::sort(edges.begin(), edges.end());
  std::erase_if(edges, [&](double t) { return t <= 0.0 || t >= stop; });
  const auto same = [&](double a, double b) { return b - a <= 1e-12 * stop; };
  edges.erase(std::unique(edges.begin(), edges.end(), same), edges.end());
  return edges;
}

StepGrid make_grid(const RandomNetwork& network, double start, double stop, int steps) {
  std::vector<double> corners{start};
  for (const double t : edges_of(network, stop))
    if (t > start) corners.push_back(t);
  corners.push_back(stop);
  StepGrid grid;
  grid.times.push_back(start);
  for (std::size_t k = 0; k + 1 < corners.size(); ++k) {
    const double a = corners[k], length = corners[k + 1] - a;
    const int count = std::max(2 * samples_in_segment, static_cast<int>(std::ceil(steps * length / (stop - start))));
    const double h = length / count;
    for (int j = doublings; j > 0; --j) grid.times.push_back(a + std::ldexp(h, -j));
    const std::size_t first = grid.times.size();
    for (int j = 1; j < count; ++j) grid.times.push_back(a + j * h);
    for (int j = 1; j <= samples_in_segment; ++j) grid.samples.push_back(first - 1 + at(j * count / (samples_in_segment + 1)));
    grid.times.push_back(corners[k + 1]);
  }
  return grid;
}

Trajectory implicit_euler(const RandomNetwork& network, const StepGrid& grid, std::vector<double> initial, int division, bool examine_all) {
  Trajectory trajectory;
  Step step(network);
  step.examine_all = examine_all;
  std::vector<double> x = std::move(initial);
  auto sample = grid.samples.begin();
  for (std::size_t k = 0; k + 1 < grid.times.size(); ++k) {
    if (sample != grid.samples.end() && *sample == k) {
      trajectory.states.push_back(x);
      ++sample;
    }
    const double a = grid.times[k], b = grid.times[k + 1], h = (b - a) / division;
    for (int j = 1; j <= division; ++j) {
      if (step.advance(x, j == division ? b : a + j * h, h, 0.5 * (a + b))) continue;
      trajectory.problem = fmt::format("no position of the diodes solves the step to t = {}", a + j * h);
      return trajectory;
    }
  }
  if (step.worst_difference > same_states) trajectory.problem = fmt::format("positions lead to states {} apart", step.worst_difference);
  return trajectory;
}

}  // namespace pwlsim::test
