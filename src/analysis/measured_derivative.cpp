#include "analysis/measured_derivative.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "linalg/legendre.hpp"
#include "measure/piece_view.hpp"

namespace pwlsim::analysis {
namespace {

using circuit::Measurement;
using measure::ExpressionGradient;
using measure::GradientValue;
using Kind = Measurement::Kind;

constexpr double same_shift = 1e-9;  ///< of two shifts: they are one
constexpr double same_side = 1e-7;   ///< of the derivatives to both sides: they are one
constexpr double tie_noise = 1e-9;   ///< of values that tie: what derivatives by all of a parameter hold of their being not quite equal

bool integrates(Kind kind) { return kind == Kind::average || kind == Kind::integral || kind == Kind::rms; }

engine::Piece piece_of(const KeptPiece& kept) { return {kept.from, kept.to, kept.begin, kept.length, kept.values}; }

/// The gradient to the probes at these values, where nothing but signals moves the expression; else empty.
std::vector<double> gradient_by_signals(const ExpressionGradient& gradient, const std::vector<double>& signals,
                                        const std::vector<double>& results) {
  const GradientValue at = gradient.at(signals, results, 0.0);
  const auto moves = [](const std::vector<double>& list) {
    return std::any_of(list.begin(), list.end(), [](double x) { return x != 0.0; });
  };
  return moves(at.results) || moves(at.numbers) || at.has_kink ? std::vector<double>() : at.signals;
}

bool reads_time(const circuit::MeasuredExpression& expression) {
  using StepKind = circuit::MeasuredExpression::Step::Kind;
  return std::any_of(expression.steps.begin(), expression.steps.end(), [](const auto& step) { return step.kind == StepKind::time; });
}

/// Values of which no sum or product is another one's, nor zero.
std::vector<double> some_values(std::size_t count) {
  std::vector<double> values;
  for (std::size_t k = 0; k < count; ++k) values.push_back(std::sin(static_cast<double>(k) + 1.0));
  return values;
}

/// What the expression takes of each of its probes, where that is the same at all times and nothing but signals moves it; else empty.
std::vector<double> even_weights(const circuit::MeasuredExpression& expression, const std::vector<double>& results) {
  if (reads_time(expression) || !measure::Program(expression).is_linear()) return {};
  const ExpressionGradient gradient(expression);
  const std::vector<double> at_zero = gradient_by_signals(gradient, std::vector<double>(gradient.probes().size(), 0.0), results);
  const std::vector<double> elsewhere = gradient_by_signals(gradient, some_values(gradient.probes().size()), results);
  return at_zero == elsewhere ? at_zero : std::vector<double>();
}

/// Whether its derivative is read of pieces of the run.
bool needs_pieces(const Measurement& measurement, const std::vector<double>& results) {
  return integrates(measurement.kind) && (measurement.kind == Kind::rms || even_weights(measurement.expression, results).empty());
}

}  // namespace

/// Keeps the pieces of integrals, and looks for all places of extremes.
class PieceKeeper : public engine::PieceSink {
 public:
  explicit PieceKeeper(MeasuredPass& run) : run_(run), view_(run.measurements->probe_signals.size()) {
    for (std::size_t k = 0; k < run.measurements->list.size(); ++k) {
      if (!run.record.failures[k].empty()) continue;
      const Measurement& measurement = run.measurements->list[k];
      if (is_extreme(measurement.kind)) finders_.push_back({k, ExtremeFinder(measurement, run.record.places[k])});
      if (!needs_pieces(measurement, run.record.values)) continue;
      from_ = to_ > from_ ? std::min(from_, run.record.places[k].from) : run.record.places[k].from;
      to_ = std::max(to_, run.record.places[k].to);
    }
  }
  void before_start(std::span<const double>) override {}
  void take(const engine::Piece& piece) override {
    if (piece.to > from_ && piece.from < to_)
      run_.pieces.push_back({piece.from, piece.to, piece.begin, piece.length, {piece.values.begin(), piece.values.end()}});
    if (finders_.empty()) return;
    view_.set(piece);
    for (auto& finder : finders_) finder.second.take(view_, run_.record.values);
  }
  void finish() {
    for (auto& finder : finders_) run_.extremes[finder.first] = finder.second.found();
  }

 private:
  MeasuredPass& run_;
  measure::PieceView view_;
  double from_ = 0.0, to_ = 0.0;
  std::vector<std::pair<std::size_t, ExtremeFinder>> finders_;
};

MeasuredSum shift_of(std::size_t instant) {
  MeasuredSum sum;
  sum.run.shifts[instant] = 1.0;
  return sum;
}

MeasuredPass pass_of(const circuit::Measurements& measurements, const measure::Record& record, double start, double stop) {
  MeasuredPass run;
  run.measurements = &measurements;
  run.start = start;
  run.stop = stop;
  run.record = record;
  for (std::size_t k = 0; k < run.record.values.size(); ++k)
    if (!run.record.failures[k].empty()) run.record.values[k] = std::numeric_limits<double>::quiet_NaN();
  return run;
}

PieceLook::PieceLook(MeasuredPass& run) : run_(run) {
  run.pieces.clear();
  run.extremes.clear();
  for (std::size_t k = 0; k < run.measurements->list.size(); ++k) {
    const Measurement& measurement = run.measurements->list[k];
    if (!run.record.failures[k].empty() || !(needs_pieces(measurement, run.record.values) || is_extreme(measurement.kind))) continue;
    from_ = is_needed() ? std::min(from_, run.record.places[k].from) : run.record.places[k].from;
    to_ = std::max(to_, run.record.places[k].to);
  }
  if (is_needed()) keeper_ = std::make_unique<PieceKeeper>(run);
}

PieceLook::~PieceLook() = default;

engine::Probes PieceLook::probes() const {
  return is_needed() ? engine::Probes{run_.measurements->probe_signals, from_, to_, keeper_.get()} : engine::Probes{};
}

void PieceLook::finish() {
  if (keeper_) keeper_->finish();
}

MeasuredPass measure_run(const circuit::Measurements& measurements, const Simulate& simulate, engine::Request request, double start,
                         double stop, double longest_window, const measure::Record* known) {
  NoRows rows;
  request.grid = {[stop](std::uint64_t) { return stop; }, 1};
  measure::Record record;
  if (known != nullptr && known->values.size() == measurements.list.size()) {
    record = *known;
  } else {
    measure::Measuring measuring(measurements, start, stop, std::max(stop, longest_window));
    while (measuring.begin_pass()) {
      request.probes = measuring.probes();
      const engine::Answer answer = simulate(request, rows);
      measuring.end_pass(request.probes.to > stop ? answer.probed : answer.time);
      if (answer.outcome != engine::Outcome::completed) break;
    }
    record = measuring.record();
  }
  MeasuredPass run = pass_of(measurements, record, start, stop);
  PieceLook look(run);
  if (!look.is_needed()) return run;
  request.probes = look.probes();
  (void)simulate(request, rows);
  look.finish();
  return run;
}

namespace {

constexpr const char* only_fixed_derivatives = "DERIV has a derivative here only of sums of signals at a fixed time";

MeasuredFunctional failed_functional(std::string why) {
  MeasuredFunctional functional;
  functional.failure = std::move(why);
  return functional;
}

/// The sixteen polynomials that are 1 at one of the points and 0 at the others, at x.
linalg::LegendreValues cardinals(double x) {
  const auto& rule = linalg::gauss_legendre();
  const auto polynomials = [](double at) {
    linalg::LegendreValues p{};
    p[0] = 1.0;
    p[1] = at;
    for (std::size_t k = 1; k + 1 < p.size(); ++k) {
      const auto order = static_cast<double>(k);
      p[k + 1] = ((2.0 * order + 1.0) * at * p[k] - order * p[k - 1]) / (order + 1.0);
    }
    return p;
  };
  static const std::array<linalg::LegendreValues, linalg::legendre_points> at_points = [&] {
    std::array<linalg::LegendreValues, linalg::legendre_points> table{};
    for (std::size_t j = 0; j < table.size(); ++j) table[j] = polynomials(rule.point[j]);
    return table;
  }();
  const linalg::LegendreValues here = polynomials(x);
  linalg::LegendreValues values{};
  for (std::size_t j = 0; j < values.size(); ++j)
    for (std::size_t k = 0; k < values.size(); ++k)
      values[j] += 0.5 * (2.0 * static_cast<double>(k) + 1.0) * rule.weight[j] * at_points[j][k] * here[k];
  return values;
}

}  // namespace

void MeasuredSum::add(double weight, const MeasuredSum& other) {
  if (weight == 0.0) return;
  run.add(weight, other.run);
  start_moves += weight * other.start_moves;
  stop_moves += weight * other.stop_moves;
  if (numbers.size() < other.numbers.size()) numbers.resize(other.numbers.size(), 0.0);
  for (std::size_t k = 0; k < other.numbers.size(); ++k) numbers[k] += weight * other.numbers[k];
}

bool MeasuredSum::is_empty() const {
  return run.is_empty() && start_moves == 0.0 && stop_moves == 0.0 &&
         std::all_of(numbers.begin(), numbers.end(), [](double n) { return n == 0.0; });
}

void MeasuredFunctional::add(double weight, const MeasuredFunctional& other) {
  sum.add(weight, other.sum);
  for (const Kink& kink : other.kinks) kinks.push_back({kink.q, weight * kink.weight, kink.sign, kink.why});
  obstacles.insert(obstacles.end(), other.obstacles.begin(), other.obstacles.end());
  for (const Tie& tie : other.ties) {
    ties.push_back(tie);
    ties.back().weight *= weight;
  }
  if (failure.empty()) failure = other.failure;
}

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
        {shift_of(*instant), std::move(moves.sum), fmt::format("the value jumps at that very time: {}", event_at(*instant))});
  else
    result.kinks.push_back({std::move(apart), right.rate - left.rate, 1, event_at(*instant)});
  return result;
}

/// dt/dp of a passage.
MeasuredFunctional MeasuredFunctionals::crossing_moves(const circuit::Crossing& crossing, double time) {
  circuit::MeasuredExpression difference = crossing.left;
  difference.steps.insert(difference.steps.end(), crossing.right.steps.begin(), crossing.right.steps.end());
  difference.steps.push_back({.kind = circuit::MeasuredExpression::Step::Kind::operation, .operation = "-"});
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
  if (left.rate == 0.0) return failed_functional("what crosses there has no slope");
  MeasuredFunctional moves;
  moves.add(-1.0 / left.rate, left.moved);
  if (!instant) return moves;
  // Where it crosses after the instant, it does so with the slope behind it.
  const double rate = jet_of(difference, time, Side::right).rate;
  if (rate * left.rate <= 0.0) {
    moves.obstacles.push_back({moves.sum, shift_of(*instant), fmt::format("it turns back there: {}", event_at(*instant))});
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

/// What each point of a part of a piece takes of the points of the piece; most pieces have the parts of others.
const MeasuredFunctionals::Shares& MeasuredFunctionals::shares_on(double from, double to, double rounding) {
  const auto same = [&](const Shares& known) { return std::abs(from - known.from) <= rounding && std::abs(to - known.to) <= rounding; };
  const auto known = std::find_if(shares_.begin(), shares_.end(), same);
  if (known != shares_.end()) return *known;
  Shares& shares = shares_[next_shares_++ % shares_.size()];
  shares.from = from;
  shares.to = to;
  const auto& rule = linalg::gauss_legendre();
  for (std::size_t i = 0; i < shares.points.size(); ++i)
    shares.points[i] = cardinals(2.0 * (from + 0.5 * (rule.point[i] + 1.0) * (to - from)) - 1.0);
  return shares;
}

MeasuredFunctionals::AffineGradient MeasuredFunctionals::affine_gradient(const circuit::MeasuredExpression& expression,
                                                                         bool squares) const {
  constexpr double same = 1e-12;  // of a gradient: what else it may be is a function of higher degree
  const measure::Program program(expression);
  if (reads_time(expression) || !program.is_polynomial() || (squares && !program.is_linear())) return {};
  const ExpressionGradient gradient(expression);
  const std::size_t count = gradient.probes().size();
  // Of a square: 2·value·gradient.
  const auto at = [&](const std::vector<double>& signals) {
    std::vector<double> values = gradient_by_signals(gradient, signals, run_.record.values);
    if (squares)
      for (double& each : values) each *= 2.0 * gradient.at(signals, run_.record.values, 0.0).value;
    return values;
  };
  AffineGradient affine{at(std::vector<double>(count, 0.0)), std::vector<double>(count * count, 0.0)};
  if (affine.constant.size() != count) return {};
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<double> unit(count, 0.0);
    unit[k] = 1.0;
    const std::vector<double> there = at(unit);
    if (there.size() != count) return {};
    for (std::size_t i = 0; i < count; ++i) affine.slopes[i * count + k] = there[i] - affine.constant[i];
  }
  const std::vector<double> values = some_values(count), there = at(values);
  if (there.size() != count) return {};
  for (std::size_t i = 0; i < count; ++i) {
    double own = affine.constant[i], size = std::abs(own);
    for (std::size_t k = 0; k < count; ++k) {
      own += affine.slopes[i * count + k] * values[k];
      size += std::abs(affine.slopes[i * count + k] * values[k]);
    }
    if (!(std::abs(own - there[i]) <= same * size)) return {};
  }
  return affine;
}

/// ∫ of the derivative of the expression, or of its square's, over what a piece stands for; results and numbers are added up by the caller.
void MeasuredFunctionals::add_inside(const ExpressionGradient& gradient, const AffineGradient& affine, std::size_t number, double from,
                                     double to, bool squares, double scale, MeasuredFunctional& sum) {
  const KeptPiece& kept = run_.pieces[number];
  const std::size_t n = linalg::legendre_points, width = signals_.size();
  steady::Functional::Interval& interval = sum.sum.run.intervals[number];
  if (interval.weights.empty()) interval = {0.5 * (kept.from + kept.to), kept.begin, kept.length, std::vector<double>(n * width, 0.0)};
  constexpr double whole = 1e-14, of_time = 1e-15;
  const double near = whole + of_time * std::abs(to) / kept.length;
  const double begins = (from - kept.begin) / kept.length, ends = (to - kept.begin) / kept.length;
  const bool is_whole = std::abs(begins) <= near && std::abs(ends - 1.0) <= near;
  std::vector<linalg::LegendreSeries> values;
  if (!is_whole)
    for (const int probe : gradient.probes()) values.emplace_back(kept.values.data() + static_cast<std::size_t>(probe) * n);
  const auto& rule = linalg::gauss_legendre();
  const Shares* const shares = is_whole ? nullptr : &shares_on(begins, ends, near);
  std::vector<double> signals(gradient.probes().size()), of_signals;
  for (std::size_t i = 0; i < n; ++i) {
    const double time = from + 0.5 * (rule.point[i] + 1.0) * (to - from);
    const double x = is_whole ? rule.point[i] : 2.0 * (time - kept.begin) / kept.length - 1.0;
    for (std::size_t k = 0; k < signals.size(); ++k)
      signals[k] = is_whole ? kept.values[static_cast<std::size_t>(gradient.probes()[k]) * n + i] : values[k](x);
    double weight = 0.5 * (to - from) * rule.weight[i] * scale;
    if (!affine.constant.empty()) {
      of_signals = affine.constant;
      for (std::size_t j = 0; j < signals.size(); ++j)
        for (std::size_t k = 0; k < signals.size(); ++k) of_signals[j] += affine.slopes[j * signals.size() + k] * signals[k];
    } else {
      GradientValue at = gradient.at(signals, run_.record.values, time);
      if (squares) weight *= 2.0 * at.value;
      add_numbers(weight, at);
      of_signals = std::move(at.signals);
    }
    const auto take = [&](std::size_t point, double share) {
      for (std::size_t k = 0; k < signals.size(); ++k)
        interval.weights[point * width + static_cast<std::size_t>(gradient.probes()[k])] += share * of_signals[k];
    };
    if (is_whole) {
      take(i, weight);
      continue;
    }
    for (std::size_t j = 0; j < n; ++j) take(j, weight * shares->points[i][j]);
  }
}

void MeasuredFunctionals::add_numbers(double weight, const GradientValue& at) {
  const auto add = [&](std::vector<double>& sum, const std::vector<double>& list) {
    if (sum.size() < list.size()) sum.resize(list.size(), 0.0);
    for (std::size_t k = 0; k < list.size(); ++k) sum[k] += weight * list[k];
  };
  add(read_.results, at.results);
  add(read_.numbers, at.numbers);
}

/// ∫ of a sum of signals.
bool MeasuredFunctionals::add_stretch(const Measurement& measurement, const measure::Place& place, double scale, MeasuredFunctional& sum) {
  const std::vector<double> weights = even_weights(measurement.expression, run_.record.values);
  if (weights.empty()) return false;
  steady::Functional even;
  even.stretches.push_back({place.from, place.to, std::vector<double>(signals_.size(), 0.0)});
  const ExpressionGradient gradient(measurement.expression);
  for (std::size_t k = 0; k < weights.size(); ++k) even.stretches[0].weights[static_cast<std::size_t>(gradient.probes()[k])] += weights[k];
  sum.sum.run.add(scale, even);
  return true;
}

void MeasuredFunctionals::add_integral(const Measurement& measurement, const measure::Place& place, bool squares, double scale,
                                       MeasuredFunctional& sum) {
  const ExpressionGradient gradient(measurement.expression);
  const measure::Program program(measurement.expression);
  measure::PieceView view(signals_.size());
  double size = 0.0;
  read_ = {};
  const AffineGradient affine = affine_gradient(measurement.expression, squares);
  const bool is_even = !squares && add_stretch(measurement, place, scale, sum);
  for (std::size_t k = 0; k < run_.pieces.size() && !is_even; ++k) {
    const KeptPiece& kept = run_.pieces[k];
    const double from = std::max(kept.from, place.from), to = std::min(kept.to, place.to);
    if (!(from < to)) continue;
    if (program.is_polynomial()) {
      add_inside(gradient, affine, k, from, to, squares, scale, sum);
      continue;
    }
    view.set(piece_of(kept));
    const bool resolved = view.resolve(program, run_.record.values, from, to, size, [&](const measure::Part& part) {
      for (const double value : part.values) size = std::max(size, std::abs(value));
      add_inside(gradient, affine, k, part.from, part.to, squares, scale, sum);
    });
    if (!resolved) sum.failure = "the expression moves too fast to be followed";
  }
  const GradientValue read = std::exchange(read_, {});
  add_results(1.0, read, sum);
  const auto of_end = [&](double time, Side side) {
    const double value = jet_of(measurement.expression, time, side).value;
    return squares ? value * value : value;
  };
  if (const MeasuredFunctional moves = to_moves(measurement); !moves.sum.is_empty()) sum.add(scale * of_end(place.to, Side::left), moves);
  if (const MeasuredFunctional moves = from_moves(measurement); !moves.sum.is_empty())
    sum.add(-scale * of_end(place.from, Side::right), moves);
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

double read_direct(const MeasuredSum& sum, const DirectMoves& direct) {
  double value = sum.start_moves * direct.start_moves + sum.stop_moves * direct.stop_moves;
  if (direct.number >= 0 && static_cast<std::size_t>(direct.number) < sum.numbers.size())
    value += sum.numbers[static_cast<std::size_t>(direct.number)];
  return value;
}

double ForwardReader::read(const MeasuredSum& sum) { return read(sum.run) + read_direct(sum, direct_); }

double ForwardReader::read(const steady::Functional& functional) {
  const std::vector<int>& signals = run_.measurements->probe_signals;
  long double sum = 0.0L;
  for (const steady::Functional::Stretch& stretch : functional.stretches)
    sum += sensitivity_.moved_over(followed_, parameter_, signals, stretch);
  for (const auto& [instant, weight] : functional.shifts) sum += weight * followed_.shifts[instant];
  for (const steady::Functional::Point& point : functional.points) {
    const std::vector<steady::MovedJet> jets = sensitivity_.moved_signals_at(followed_, parameter_, signals, point.time, point.side);
    for (std::size_t k = 0; k < point.moved.size(); ++k) sum += point.moved[k] * jets[k].moved;
    for (std::size_t k = 0; k < point.rates.size(); ++k) sum += point.rates[k] * jets[k].moved_rate;
  }
  for (const auto& [number, interval] : functional.intervals) {
    auto& points = points_[number];
    if (points.empty()) points = sensitivity_.moved_at(followed_, parameter_, signals, interval.inside, interval.begin, interval.length);
    const std::size_t width = signals.size();
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t k = 0; k < width; ++k) sum += interval.weights[i * width + k] * points[i][k];
  }
  return static_cast<double>(sum);
}

namespace {

/// The largest of equal values grows as fast as the fastest of them, and falls as slowly as the slowest.
TwoSided of_tie(const MeasuredFunctional::Tie& tie, const std::function<double(const MeasuredSum&)>& read) {
  TwoSided taken;
  for (const MeasuredFunctional& place : tie.places) {
    const TwoSided own = two_sided(place, read);
    if (!own.failure.empty()) return own;
    const bool is_first = &place == &tie.places.front();
    taken.right = is_first ? own.right : tie.is_largest ? std::max(taken.right, own.right) : std::min(taken.right, own.right);
    taken.left = is_first ? own.left : tie.is_largest ? std::min(taken.left, own.left) : std::max(taken.left, own.left);
    taken.noise = std::max(taken.noise, own.noise);
    if (is_first) taken.measured = own.right;
  }
  taken.noise = std::max(taken.noise, tie_noise * tie.size);
  taken.kink = tie.why;
  return taken;
}

}  // namespace

std::size_t MeasuredFunctional::sums() const {
  std::size_t count = 1 + kinks.size() + obstacles.size();
  for (const Tie& tie : ties)
    for (const MeasuredFunctional& place : tie.places) count += place.sums();
  return count;
}

TwoSided two_sided(const MeasuredFunctional& functional, const std::function<double(const MeasuredSum&)>& read) {
  if (!functional.failure.empty()) return TwoSided::failed(functional.failure);
  for (const MeasuredFunctional::Obstacle& obstacle : functional.obstacles) {
    const double moves = read(obstacle.moves), against = obstacle.against.is_empty() ? 0.0 : read(obstacle.against);
    if (std::abs(moves - against) > same_shift * (std::abs(moves) + std::abs(against))) return TwoSided::failed(obstacle.why);
  }
  double left = read(functional.sum), right = left;
  TwoSided result;
  result.measured = left;
  for (const MeasuredFunctional::Kink& kink : functional.kinks) {
    const double q = read(kink.q);
    (q * kink.sign > 0.0 ? right : left) += kink.weight * q;
    if (q != 0.0 && result.kink.empty()) result.kink = kink.why;
  }
  for (const MeasuredFunctional::Tie& tie : functional.ties) {
    const TwoSided taken = of_tie(tie, read);
    if (!taken.failure.empty()) return taken;
    left += tie.weight * taken.left;
    right += tie.weight * taken.right;
    result.noise = std::max(result.noise, taken.noise * std::abs(tie.weight));
    result.measured += tie.weight * taken.measured;
    if (result.kink.empty()) result.kink = taken.kink;
  }
  if (!(std::isfinite(left) && std::isfinite(right))) return TwoSided::failed("the derivative is not a finite number");
  const bool is_one = std::abs(left - right) <= same_side * (std::abs(left) + std::abs(right));
  result.right = right;
  result.left = is_one ? right : left;
  if (is_one) result.kink.clear();
  return result;
}

}  // namespace pwlsim::analysis
