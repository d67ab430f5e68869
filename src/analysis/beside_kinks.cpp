#include "analysis/beside_kinks.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "model/moved_network.hpp"

namespace pwlsim::analysis {
namespace {

using circuit::Compiled;
using circuit::MeasuredExpression;
using circuit::SensitivityAnalysis;

constexpr double step_beside = 1e-6;  ///< of a parameter
constexpr double one_side = 1e-9;     ///< of two derivatives: they are one
constexpr double same_branch = 1e-3;  ///< of a measurement, which must not have jumped

double part(const std::vector<double>& gradient, int number) {
  return number >= 0 && static_cast<std::size_t>(number) < gradient.size() ? gradient[static_cast<std::size_t>(number)] : 0.0;
}

class Mover {
 public:
  Mover(int number, double by) : number_(number), by_(by) {}

  void move(circuit::TimeValue& time) const {
    const double moves = part(time.gradient, number_);
    if (moves == 0.0) return;
    time.seconds += by_ * moves;
    time.decimal.clear();
  }
  void move(circuit::Measurements& measurements) const {
    for (circuit::Measurement& each : measurements.list) {
      move(each.expression);
      move(each.from);
      move(each.to);
      move(each.at);
      if (!each.when) continue;
      move(each.when->left);
      move(each.when->right);
      move(each.when->delay);
    }
  }

 private:
  void move(MeasuredExpression& expression) const {
    for (MeasuredExpression::Step& step : expression.steps) step.number += by_ * part(step.gradient, number_);
  }
  void move(std::optional<MeasuredExpression>& expression) const {
    if (expression) move(*expression);
  }
  int number_;
  double by_;
};

/// 2·d(h) − d(2h) of each measurement; NaN where it is not known.
std::vector<double> beside(const Compiled& compiled, const std::function<DerivativeTable(const Compiled&)>& derivatives,
                           const std::vector<Derivative*>& wanted, std::size_t parameter, double step) {
  std::vector<double> values(wanted.size(), 0.0);
  for (const double weight : {2.0, -1.0}) {
    const DerivativeTable there = derivatives(moved_deck(compiled, parameter, weight > 0.0 ? step : 2.0 * step));
    for (std::size_t k = 0; k < values.size(); ++k) {
      const bool is_known =
          k < there.size() && there.size() == wanted.size() && there[k].failure.empty() &&
          std::abs(there[k].measured - wanted[k]->measured) <= same_branch * (std::abs(there[k].measured) + std::abs(wanted[k]->measured));
      values[k] += is_known ? weight * there[k].value : std::nan("");
    }
  }
  return values;
}

void settle(Derivative& entry, double left, double right, double parameter) {
  if (!std::isfinite(left) || !std::isfinite(right)) return;
  const bool is_one = std::abs(left - right) <= one_side * (std::abs(left) + std::abs(right));
  entry.left = is_one ? 0.5 * (left + right) : left;
  entry.value = entry.right = is_one ? entry.left : right;
  entry.normalised = entry.measured != 0.0 ? entry.value * parameter / entry.measured : std::nan("");
  entry.kink = is_one ? "" : std::move(entry.failure);
  entry.failure.clear();
}

}  // namespace

Compiled moved_deck(const Compiled& compiled, std::size_t parameter, double by) {
  Compiled moved = compiled;
  SensitivityAnalysis& card = *moved.analyses.sensitivities;
  const SensitivityAnalysis::Parameter own = card.parameters[parameter];
  card.parameters = {own};
  card.parameters.front().value += by;
  model::move(moved.network, own.moves, by);
  const Mover mover(own.number, by);
  mover.move(moved.measurements);
  mover.move(moved.orbit_measurements);
  if (moved.analyses.transient) {
    mover.move(moved.analyses.transient->start);
    mover.move(moved.analyses.transient->stop);
  }
  return moved;
}

void resolve_kinks(const Compiled& compiled, const std::function<DerivativeTable(const Compiled&)>& derivatives, DerivativeTable& table) {
  const auto& parameters = compiled.analyses.sensitivities->parameters;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const double step = step_beside * std::abs(parameters[p].value);
    std::vector<Derivative*> entries;
    for (Derivative& each : table)
      if (each.parameter == parameters[p].name) entries.push_back(&each);
    const auto is_open = [](const Derivative* each) { return each->is_kink && !each->failure.empty(); };
    if (!(step > 0.0) || std::none_of(entries.begin(), entries.end(), is_open)) continue;
    const std::vector<double> left = beside(compiled, derivatives, entries, p, -step),
                              right = beside(compiled, derivatives, entries, p, step);
    for (std::size_t k = 0; k < entries.size(); ++k)
      if (is_open(entries[k])) settle(*entries[k], left[k], right[k], parameters[p].value);
  }
}

}  // namespace pwlsim::analysis
