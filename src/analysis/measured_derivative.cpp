#include "analysis/measured_derivative.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace pwlsim::analysis {
namespace {

using circuit::Measurement;
using measure::ExpressionGradient;
using measure::GradientValue;
using Kind = Measurement::Kind;

constexpr const char* only_fixed_derivatives = "DERIV has a derivative here only of sums of signals at a fixed time";

MeasuredFunctional failed_functional(std::string why) {
  MeasuredFunctional functional;
  functional.failure = std::move(why);
  return functional;
}

}  // namespace

MeasuredFunctionals::MeasuredFunctionals(const MeasuredPass& run, const steady::Sensitivity& sensitivity)
    : run_(run), sensitivity_(sensitivity), known_(run.measurements->list.size()), signals_(run.measurements->probe_signals) {}

const MeasuredFunctional& MeasuredFunctionals::of(std::size_t measurement) {
  if (known_[measurement]) return *known_[measurement];
  std::string failure;
  if (!run_.record.failures[measurement].empty()) failure = "the measurement failed: " + run_.record.failures[measurement];
  for (const int other : circuit::results_read(run_.measurements->list[measurement]))
    if (const MeasuredFunctional& needed = of(static_cast<std::size_t>(other)); failure.empty()) failure = needed.failure;
  known_[measurement] = failure.empty() ? compute(measurement) : failed_functional(failure);
  return *known_[measurement];
}

/// What other results and numbers of cards add to the derivative of an expression.
void MeasuredFunctionals::add_results(double weight, const GradientValue& gradient, MeasuredFunctional& sum) {
  for (std::size_t k = 0; k < gradient.results.size(); ++k)
    if (gradient.results[k] != 0.0) sum.add(weight * gradient.results[k], of(k));
  MeasuredSum own;
  own.numbers = gradient.numbers;
  sum.sum.add(weight, own);
}

MeasuredFunctional MeasuredFunctionals::of_constant(const circuit::MeasuredExpression& expression) {
  MeasuredFunctional functional;
  add_results(1.0, ExpressionGradient(expression).at({}, run_.record.values, 0.0), functional);
  return functional;
}

MeasuredFunctionals::Jet MeasuredFunctionals::jet_of(const circuit::MeasuredExpression& expression, double time, Side side) {
  const ExpressionGradient gradient(expression);
  std::vector<int> signals;
  for (const int probe : gradient.probes()) signals.push_back(signals_[static_cast<std::size_t>(probe)]);
  const std::vector<steady::SignalJet> jets = sensitivity_.signals_at(signals, time, side);
  std::vector<double> values;
  for (const steady::SignalJet& jet : jets) values.push_back(jet.value);
  const GradientValue at = gradient.at(values, run_.record.values, time);
  Jet jet;
  jet.value = at.value;
  jet.rate = at.time;
  steady::Functional::Point point{time, side, std::vector<double>(signals_.size(), 0.0), {}};
  for (std::size_t k = 0; k < jets.size(); ++k) {
    jet.rate += at.signals[k] * jets[k].rate;
    point.moved[static_cast<std::size_t>(gradient.probes()[k])] += at.signals[k];
  }
  jet.moved.sum.run.points.push_back(point);
  if (at.has_kink) jet.moved.failure = fmt::format("a function of '{}' has a corner at its value of t = {} s", expression.text, time);
  add_results(1.0, at, jet.moved);
  jet.moved_rate.run.points.push_back({time, side, {}, std::move(point.moved)});
  return jet;
}

/// The instant at that time, where there is one.
std::optional<std::size_t> MeasuredFunctionals::instant_at(double time) const {
  const auto& instants = sensitivity_.orbit().instants();
  const double near = same_place * std::max(run_.stop, time);
  const auto found =
      std::lower_bound(instants.begin(), instants.end(), time - near, [](const steady::LinearInstant& i, double t) { return i.time < t; });
  if (found == instants.end() || found->time > time + near) return std::nullopt;
  return static_cast<std::size_t>(found - instants.begin());
}

MeasuredFunctional MeasuredFunctionals::from_moves(const Measurement& measurement) {
  if (measurement.when && measurement.when->delay) return of_constant(*measurement.when->delay);
  if (measurement.from) return of_constant(*measurement.from);
  MeasuredFunctional moves;
  moves.sum.start_moves = 1.0;
  return moves;
}

MeasuredFunctional MeasuredFunctionals::to_moves(const Measurement& measurement) {
  if (measurement.to) return of_constant(*measurement.to);
  MeasuredFunctional moves;
  moves.sum.stop_moves = 1.0;
  return moves;
}

MeasuredFunctional MeasuredFunctionals::compute(std::size_t number) {
  const Measurement& measurement = run_.measurements->list[number];
  switch (measurement.kind) {
    case Kind::parameter:
      return of_constant(measurement.expression);
    case Kind::period: {
      MeasuredFunctional period;
      period.sum.stop_moves = 1.0;
      return period;
    }
    case Kind::value:
    case Kind::derivative:
    case Kind::time:
      return of_place(number);
    default:
      return of_window(number);
  }
}

MeasuredFunctional MeasuredFunctionals::of_place(std::size_t number) {
  const Measurement& measurement = run_.measurements->list[number];
  const measure::Place& place = run_.record.places[number];
  MeasuredFunctional moves = measurement.at ? of_constant(*measurement.at) : crossing_moves(*measurement.when, place.at);
  if (measurement.kind == Kind::time || !moves.failure.empty()) return moves;
  const Side side = place.at - place.piece_from <= place.piece_to - place.at ? Side::right : Side::left;
  Jet jet = jet_of(measurement.expression, place.at, side);
  if (measurement.kind == Kind::derivative) {
    if (!measure::Program(measurement.expression).is_linear()) return failed_functional(only_fixed_derivatives);
    MeasuredFunctional result;
    result.sum = std::move(jet.moved_rate);
    if (const auto instant = instant_at(place.at))
      result.obstacles.push_back({shift_of(*instant), moves.sum, fmt::format("the slope may jump there: {}", event_at(*instant))});
    if (!moves.sum.is_empty()) result.obstacles.push_back({std::move(moves.sum), {}, only_fixed_derivatives});
    return result;
  }
  const auto instant = measurement.at ? instant_at(place.at) : std::nullopt;
  if (!instant) {
    jet.moved.add(jet.rate, moves);
    return std::move(jet.moved);
  }
  // The instant and the time move apart: what lies at the time is what was on the side that the instant leaves behind.
  Jet left = jet_of(measurement.expression, place.at, Side::left), right = jet_of(measurement.expression, place.at, Side::right);
  const bool jumps = std::abs(left.value - right.value) > same_value * (std::abs(left.value) + std::abs(right.value));
  MeasuredFunctional result = std::move(jumps && side == Side::left ? left.moved : right.moved);
  result.add(jumps && side == Side::left ? left.rate : right.rate, moves);
  MeasuredSum apart = shift_of(*instant);
  apart.add(-1.0, moves.sum);
  if (jumps)
    result.obstacles.push_back(
        {shift_of(*instant), std::move(moves.sum), fmt::format("the value jumps exactly at that time: {}", event_at(*instant))});
  else
    result.kinks.push_back({std::move(apart), right.rate - left.rate, 1, event_at(*instant)});
  return result;
}

/// dt/dp of a passage.
MeasuredFunctional MeasuredFunctionals::crossing_moves(const circuit::Crossing& crossing, double time) {
  circuit::MeasuredExpression difference = crossing.left;
  difference.steps.insert(difference.steps.end(), crossing.right.steps.begin(), crossing.right.steps.end());
  difference.steps.push_back({.kind = circuit::StepKind::operation, .operation = "-"});
  const auto instant = instant_at(time);
  // Left of the begin of a period lies its end.
  const double before = instant && sensitivity_.is_settled() && time <= same_place * run_.stop ? run_.stop : time;
  Jet left = jet_of(difference, before, instant ? Side::left : Side::right);
  if (instant) {
    const Jet right = jet_of(difference, time, Side::right);
    const double size = std::abs(left.value) + std::abs(right.value);
    constexpr double jumps = 1e-9;
    const double scale =
        std::max(std::abs(jet_of(crossing.left, before, Side::left).value), std::abs(jet_of(crossing.right, before, Side::left).value));
    if (left.value * right.value <= 0.0 && size > jumps * scale) {
      MeasuredFunctional moves;
      moves.sum = shift_of(*instant);
      return moves;
    }
  }
  if (left.rate == 0.0) return failed_functional("the crossing signal has no slope there");
  MeasuredFunctional moves;
  moves.add(-1.0 / left.rate, left.moved);
  if (!instant) return moves;
  // Where it crosses after the instant, it does so with the slope behind it.
  const double rate = jet_of(difference, time, Side::right).rate;
  if (rate * left.rate <= 0.0) {
    moves.obstacles.push_back({moves.sum, shift_of(*instant), fmt::format("the crossing signal turns back there: {}", event_at(*instant))});
  } else {
    MeasuredSum behind = moves.sum;
    behind.add(-1.0, shift_of(*instant));
    moves.kinks.push_back({std::move(behind), left.rate / rate - 1.0, 1, event_at(*instant)});
  }
  return moves;
}

MeasuredFunctional MeasuredFunctionals::of_window(std::size_t number) {
  const Measurement& measurement = run_.measurements->list[number];
  const measure::Place& place = run_.record.places[number];
  if (place.to > run_.stop * (1.0 + same_place)) return failed_functional("its window reaches beyond the period");
  MeasuredFunctional result;
  const bool is_range = measurement.kind == Kind::peak_to_peak;
  if (measurement.kind == Kind::maximum || is_range) add_extreme(1.0, number, true, result);
  if (measurement.kind == Kind::minimum || is_range) add_extreme(is_range ? -1.0 : 1.0, number, false, result);
  if (measurement.kind == Kind::maximum || measurement.kind == Kind::minimum || is_range) return result;
  if (measurement.kind == Kind::time_of_maximum || measurement.kind == Kind::time_of_minimum)
    return of_extreme_time(number, measurement.kind == Kind::time_of_maximum);
  if (run_.record.impulses[number] != 0) return failed_functional("an impulse lies in its window");
  const bool squares = measurement.kind == Kind::rms;
  const double length = place.to - place.from, value = run_.record.values[number];
  const double scale = measurement.kind == Kind::integral ? 1.0 : squares ? 1.0 / (2.0 * value * length) : 1.0 / length;
  add_integral(measurement, place, squares, scale, result);
  add_instants(measurement, place, squares, scale, result);
  if (measurement.kind != Kind::integral) {
    const double on_length = -(squares ? value * value : value) * scale;
    result.add(on_length, to_moves(measurement));
    result.add(-on_length, from_moves(measurement));
  }
  return result;
}

/// (y⁻ − y⁺)·t_p of what jumps within the window. An instant at an end of it counts on the side of the parameter on which it comes to lie inside.
void MeasuredFunctionals::add_instants(const Measurement& measurement, const measure::Place& place, bool squares, double scale,
                                       MeasuredFunctional& sum) {
  const auto& instants = sensitivity_.orbit().instants();
  const double near = same_place * run_.stop;
  std::vector<int> read;
  const ExpressionGradient gradient(measurement.expression);
  for (const int probe : gradient.probes()) read.push_back(signals_[static_cast<std::size_t>(probe)]);
  for (std::size_t k = 0; k < instants.size(); ++k) {
    const double time = instants[k].time;
    if (time < place.from - near || time > place.to + near) continue;
    if (time > near && !sensitivity_.may_jump(k, read)) continue;
    const bool is_wrap = time <= near, at_from = std::abs(time - place.from) <= near, at_to = std::abs(time - place.to) <= near;
    if (is_wrap && !sensitivity_.is_settled()) {
      sum.obstacles.push_back({shift_of(k), {}, "an edge at t = 0 moves"});
      continue;
    }
    const double left = jet_of(measurement.expression, is_wrap ? run_.stop : time, Side::left).value,
                 right = jet_of(measurement.expression, time, Side::right).value;
    const double weight = scale * (squares ? left * left - right * right : left - right);
    if (std::abs(left - right) <= same_value * (std::abs(left) + std::abs(right))) continue;
    MeasuredSum moved = shift_of(k);
    // The begin of the period is its end, too.
    if ((is_wrap && place.to >= run_.stop - near) || !(at_from || at_to)) {
      sum.sum.add(weight, moved);
      continue;
    }
    moved.add(-1.0, (at_from ? from_moves(measurement) : to_moves(measurement)).sum);
    sum.kinks.push_back({std::move(moved), weight, at_from ? 1 : -1, fmt::format("{}, an end of its window", event_at(k))});
  }
}

}  // namespace pwlsim::analysis
