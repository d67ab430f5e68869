#include "analysis/measured_derivative.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "linalg/legendre.hpp"
#include "measure/piece_view.hpp"

namespace pwlsim::analysis {
namespace {

using circuit::Measurement;
using measure::ExpressionGradient;
using measure::GradientValue;
using Kind = Measurement::Kind;

constexpr double same_time = 1e-11;  ///< of the run: a place that near to an instant is at it
constexpr double flat = 1e-12;       ///< of values on both sides of an instant: they are one
constexpr double same_side = 1e-7;   ///< of the derivatives to both sides: they are one

class PieceKeeper : public engine::PieceSink {
 public:
  explicit PieceKeeper(std::vector<KeptPiece>& pieces) : pieces_(pieces) {}
  void before_start(std::span<const double>) override {}
  void take(const engine::Piece& piece) override {
    pieces_.push_back({piece.from, piece.to, piece.begin, piece.length, {piece.values.begin(), piece.values.end()}});
  }

 private:
  std::vector<KeptPiece>& pieces_;
};

bool integrates(Kind kind) { return kind == Kind::average || kind == Kind::integral || kind == Kind::rms; }

engine::Piece piece_of(const KeptPiece& kept) { return {kept.from, kept.to, kept.begin, kept.length, kept.values}; }

}  // namespace

MeasuredPass measure_run(const circuit::Measurements& measurements, const Simulate& simulate, engine::Request request, double start,
                         double stop, double longest_window) {
  MeasuredPass run;
  run.measurements = &measurements;
  run.start = start;
  run.stop = stop;
  NoRows rows;
  request.grid = {[stop](std::uint64_t) { return stop; }, 1};
  measure::Measuring measuring(measurements, start, stop, std::max(stop, longest_window));
  while (measuring.begin_pass()) {
    request.probes = measuring.probes();
    const engine::Answer answer = simulate(request, rows);
    measuring.end_pass(request.probes.to > stop ? answer.probed : answer.time);
    if (answer.outcome != engine::Outcome::completed) break;
  }
  run.values = measuring.values();
  run.failures = measuring.failures();
  run.places = measuring.places();
  double from = 0.0, to = 0.0;
  for (std::size_t k = 0; k < measurements.list.size(); ++k) {
    run.has_impulse.push_back(measuring.met_impulse(k) ? 1 : 0);
    if (!integrates(measurements.list[k].kind) || !run.failures[k].empty()) continue;
    from = to > from ? std::min(from, run.places[k].from) : run.places[k].from;
    to = std::max(to, run.places[k].to);
  }
  if (!(to > from)) return run;
  PieceKeeper keeper(run.pieces);
  request.probes = {measurements.probe_signals, from, to, &keeper};
  (void)simulate(request, rows);
  return run;
}

MeasuredDerivatives::MeasuredDerivatives(const MeasuredPass& run, const steady::Sensitivity& sensitivity, const steady::Followed& followed,
                                         std::size_t parameter, int number, double start_moves, double stop_moves)
    : run_(run),
      sensitivity_(sensitivity),
      followed_(followed),
      parameter_(parameter),
      number_(number),
      start_moves_(start_moves),
      stop_moves_(stop_moves),
      known_(run.measurements->list.size()),
      results_(run.measurements->list.size(), 0.0),
      signals_(run.measurements->probe_signals) {}

/// Both sides, told apart where they differ by more than rounding.
TwoSided MeasuredDerivatives::two_sided(double left, double right, std::string kink) {
  TwoSided result = TwoSided::of(right);
  if (std::abs(left - right) <= same_side * (std::abs(left) + std::abs(right))) return result;
  result.left = left;
  result.kink = std::move(kink);
  return result;
}

TwoSided MeasuredDerivatives::of(std::size_t measurement) {
  if (known_[measurement]) return *known_[measurement];
  TwoSided result;
  if (!run_.failures[measurement].empty()) result.failure = "the measurement failed: " + run_.failures[measurement];
  for (const int other : circuit::results_read(run_.measurements->list[measurement])) {
    const TwoSided needed = of(static_cast<std::size_t>(other));
    if (result.failure.empty()) result.failure = needed.failure;
    if (result.kink.empty()) result.kink = needed.kink;
    results_[static_cast<std::size_t>(other)] = needed.right;
  }
  if (!result.failure.empty()) {
    known_[measurement] = result;
    return result;
  }
  const std::string kink = result.kink;
  failure_.clear();
  result = compute(measurement);
  if (result.failure.empty()) result.failure = failure_;
  if (result.failure.empty() && !(std::isfinite(result.left) && std::isfinite(result.right)))
    result.failure = "the derivative is not a finite number";
  if (!kink.empty() && result.failure.empty()) {
    // On the other side the results that it reads move otherwise.
    for (const int other : circuit::results_read(run_.measurements->list[measurement]))
      results_[static_cast<std::size_t>(other)] = known_[static_cast<std::size_t>(other)]->left;
    result.left = compute(measurement).left;
    result.kink = kink;
  }
  results_[measurement] = result.right;
  known_[measurement] = result;
  return result;
}

double MeasuredDerivatives::of_results(const GradientValue& gradient) {
  double sum = 0.0;
  for (std::size_t k = 0; k < gradient.results.size(); ++k)
    if (gradient.results[k] != 0.0) sum += gradient.results[k] * results_[k];
  if (number_ >= 0 && static_cast<std::size_t>(number_) < gradient.numbers.size())
    sum += gradient.numbers[static_cast<std::size_t>(number_)];
  return sum;
}

double MeasuredDerivatives::of_constant(const circuit::MeasuredExpression& expression) {
  return of_results(ExpressionGradient(expression).at({}, run_.values, 0.0));
}

MeasuredDerivatives::Jet MeasuredDerivatives::jet_of(const circuit::MeasuredExpression& expression, double time, Side side) {
  const ExpressionGradient gradient(expression);
  std::vector<int> signals;
  for (const int probe : gradient.probes()) signals.push_back(signals_[static_cast<std::size_t>(probe)]);
  const std::vector<steady::SignalJet> jets = sensitivity_.signals_at(followed_, parameter_, signals, time, side);
  std::vector<double> values;
  for (const steady::SignalJet& jet : jets) values.push_back(jet.value);
  const GradientValue at = gradient.at(values, run_.values, time);
  Jet jet{at.value, at.time, of_results(at), 0.0, at.has_kink};
  for (std::size_t k = 0; k < jets.size(); ++k) {
    jet.rate += at.signals[k] * jets[k].rate;
    jet.moved += at.signals[k] * jets[k].moved;
    jet.moved_rate += at.signals[k] * jets[k].moved_rate;
  }
  return jet;
}

/// The instant at that time, where there is one.
std::optional<std::size_t> MeasuredDerivatives::instant_at(double time) const {
  const auto& instants = sensitivity_.orbit().instants();
  const double near = same_time * std::max(run_.stop, time);
  const auto found =
      std::lower_bound(instants.begin(), instants.end(), time - near, [](const steady::LinearInstant& i, double t) { return i.time < t; });
  if (found == instants.end() || found->time > time + near) return std::nullopt;
  return static_cast<std::size_t>(found - instants.begin());
}

double MeasuredDerivatives::from_moves(const Measurement& measurement) {
  double moves = measurement.from ? of_constant(*measurement.from) : start_moves_;
  if (measurement.when && measurement.when->delay) moves = of_constant(*measurement.when->delay);
  return moves;
}

double MeasuredDerivatives::to_moves(const Measurement& measurement) { return measurement.to ? of_constant(*measurement.to) : stop_moves_; }

TwoSided MeasuredDerivatives::compute(std::size_t number) {
  const Measurement& measurement = run_.measurements->list[number];
  switch (measurement.kind) {
    case Kind::parameter:
      return TwoSided::of(of_constant(measurement.expression));
    case Kind::period:
      return TwoSided::of(stop_moves_);
    case Kind::value:
    case Kind::derivative:
    case Kind::time:
      return of_place(number);
    default:
      return of_window(number);
  }
}

TwoSided MeasuredDerivatives::of_place(std::size_t number) {
  const Measurement& measurement = run_.measurements->list[number];
  const measure::Place& place = run_.places[number];
  const double moves = measurement.at ? of_constant(*measurement.at) : crossing_moves(*measurement.when, place.at);
  if (measurement.kind == Kind::time) return TwoSided::of(moves);
  const Side side = place.at - place.piece_from <= place.piece_to - place.at ? Side::right : Side::left;
  const Jet jet = jet_of(measurement.expression, place.at, side);
  if (measurement.kind == Kind::value) {
    TwoSided result = TwoSided::of(jet.moved + jet.rate * moves);
    // The instant moves across a fixed time.
    const auto instant = measurement.at && moves == 0.0 ? instant_at(place.at) : std::nullopt;
    if (!instant || followed_.shifts[*instant] == 0.0) return result;
    const Jet left = jet_of(measurement.expression, place.at, Side::left), right = jet_of(measurement.expression, place.at, Side::right);
    if (std::abs(left.value - right.value) > flat * (std::abs(left.value) + std::abs(right.value)))
      return TwoSided::failed("the value jumps at that very time");
    const bool is_later = followed_.shifts[*instant] > 0.0;
    return two_sided(is_later ? right.moved : left.moved, is_later ? left.moved : right.moved,
                     fmt::format("an event lies at t = {} s", place.at));
  }
  if (moves != 0.0 || !measure::Program(measurement.expression).is_linear())
    return TwoSided::failed("DERIV has a derivative here only of sums of signals at a fixed time");
  return TwoSided::of(jet.moved_rate);
}

/// dt/dp of a passage.
double MeasuredDerivatives::crossing_moves(const circuit::Crossing& crossing, double time) {
  circuit::MeasuredExpression difference = crossing.left;
  difference.steps.insert(difference.steps.end(), crossing.right.steps.begin(), crossing.right.steps.end());
  difference.steps.push_back({.kind = circuit::MeasuredExpression::Step::Kind::operation, .operation = "-"});
  const auto instant = instant_at(time);
  const Jet left = jet_of(difference, time, instant ? Side::left : Side::right);
  if (instant) {
    const Jet right = jet_of(difference, time, Side::right);
    const double size = std::abs(left.value) + std::abs(right.value);
    constexpr double jumps = 1e-9;
    const double scale =
        std::max(std::abs(jet_of(crossing.left, time, Side::left).value), std::abs(jet_of(crossing.right, time, Side::left).value));
    if (left.value * right.value <= 0.0 && size > jumps * scale) return followed_.shifts[*instant];
  }
  if (left.rate == 0.0) {
    fail("what crosses there has no slope");
    return 0.0;
  }
  return -left.moved / left.rate;
}

TwoSided MeasuredDerivatives::of_window(std::size_t number) {
  const Measurement& measurement = run_.measurements->list[number];
  const measure::Place& place = run_.places[number];
  const double stop = run_.stop;
  if (place.to > stop * (1.0 + same_time)) return TwoSided::failed("its window reaches beyond the period");
  if (measurement.kind == Kind::maximum) return TwoSided::of(of_extreme(measurement, place.largest_at, true, place));
  if (measurement.kind == Kind::minimum) return TwoSided::of(of_extreme(measurement, place.least_at, false, place));
  if (measurement.kind == Kind::peak_to_peak)
    return TwoSided::of(of_extreme(measurement, place.largest_at, true, place) - of_extreme(measurement, place.least_at, false, place));
  if (measurement.kind == Kind::time_of_maximum) return of_extreme_time(measurement, place.largest_at, place);
  if (measurement.kind == Kind::time_of_minimum) return of_extreme_time(measurement, place.least_at, place);
  if (run_.has_impulse[number] != 0) return TwoSided::failed("an impulse lies in its window");
  const bool squares = measurement.kind == Kind::rms;
  const double length = place.to - place.from, moved_length = to_moves(measurement) - from_moves(measurement);
  const double sum = integral(measurement, place, squares);
  const double value = run_.values[number];
  const double sides[2] = {sum + at_instants(measurement, place, squares, -1), sum + at_instants(measurement, place, squares, 1)};
  double finished[2];
  for (int k = 0; k < 2; ++k)
    finished[k] = measurement.kind == Kind::integral  ? sides[k]
                  : measurement.kind == Kind::average ? (sides[k] - value * moved_length) / length
                                                      : (sides[k] - value * value * moved_length) / (2.0 * value * length);
  return two_sided(finished[0], finished[1], "an event lies at an end of its window");
}

const std::vector<std::vector<double>>& MeasuredDerivatives::moved_points(std::size_t number) {
  const auto known = points_.find(number);
  if (known != points_.end()) return known->second;
  const KeptPiece& piece = run_.pieces[number];
  return points_[number] = sensitivity_.moved_at(followed_, parameter_, signals_, 0.5 * (piece.from + piece.to), piece.begin, piece.length);
}

/// ∫ of the derivative of the expression, or of half that of its square's, over what a piece stands for.
double MeasuredDerivatives::inside(const ExpressionGradient& gradient, const KeptPiece& kept, std::size_t number, double from, double to,
                                   bool squares) {
  const auto& points = moved_points(number);
  const std::size_t n = linalg::legendre_points;
  std::vector<linalg::LegendreSeries> values, moved;
  for (const int probe : gradient.probes()) {
    const auto p = static_cast<std::size_t>(probe);
    values.emplace_back(kept.values.data() + p * n);
    linalg::LegendreValues own{};
    for (std::size_t i = 0; i < n; ++i) own[i] = points[i][p];
    moved.emplace_back(own.data());
  }
  const auto& rule = linalg::gauss_legendre();
  double sum = 0.0;
  std::vector<double> signals(values.size());
  for (std::size_t i = 0; i < n; ++i) {
    const double time = from + 0.5 * (rule.point[i] + 1.0) * (to - from);
    const double x = 2.0 * (time - kept.begin) / kept.length - 1.0;
    for (std::size_t k = 0; k < values.size(); ++k) signals[k] = values[k](x);
    const GradientValue at = gradient.at(signals, run_.values, time);
    double change = of_results(at);
    for (std::size_t k = 0; k < values.size(); ++k) change += at.signals[k] * moved[k](x);
    sum += rule.weight[i] * (squares ? 2.0 * at.value * change : change);
  }
  return 0.5 * (to - from) * sum;
}

double MeasuredDerivatives::integral(const Measurement& measurement, const measure::Place& place, bool squares) {
  const ExpressionGradient gradient(measurement.expression);
  const measure::Program program(measurement.expression);
  measure::PieceView view(signals_.size());
  long double sum = 0.0L;
  double scale = 0.0;
  for (std::size_t k = 0; k < run_.pieces.size(); ++k) {
    const KeptPiece& kept = run_.pieces[k];
    const double from = std::max(kept.from, place.from), to = std::min(kept.to, place.to);
    if (!(from < to)) continue;
    if (program.is_polynomial()) {
      sum += inside(gradient, kept, k, from, to, squares);
      continue;
    }
    view.set(piece_of(kept));
    const bool resolved = view.resolve(program, run_.values, from, to, scale, [&](const measure::Part& part) {
      for (const double value : part.values) scale = std::max(scale, std::abs(value));
      sum += inside(gradient, kept, k, part.from, part.to, squares);
    });
    if (!resolved) fail("the expression moves too fast to be followed");
  }
  const auto of_end = [&](double time, Side side) {
    const double value = jet_of(measurement.expression, time, side).value;
    return squares ? value * value : value;
  };
  if (const double moves = to_moves(measurement); moves != 0.0) sum += of_end(place.to, Side::left) * moves;
  if (const double moves = from_moves(measurement); moves != 0.0) sum -= of_end(place.from, Side::right) * moves;
  return static_cast<double>(sum);
}

/// (y⁻ − y⁺)·t_p of what jumps within the window. `side`: −1 towards smaller, 1 towards larger values of the parameter, which tells on which side of
/// an end of the window an instant at that end comes to lie.
double MeasuredDerivatives::at_instants(const Measurement& measurement, const measure::Place& place, bool squares, int side) {
  const auto& instants = sensitivity_.orbit().instants();
  const double near = same_time * run_.stop;
  double sum = 0.0;
  for (std::size_t k = 0; k < instants.size(); ++k) {
    const double time = instants[k].time, shift = followed_.shifts[k];
    if (shift == 0.0 || time < place.from - near || time > place.to + near) continue;
    const bool is_wrap = time <= near, at_from = std::abs(time - place.from) <= near, at_to = std::abs(time - place.to) <= near;
    if (is_wrap && !sensitivity_.is_settled()) {
      fail("an edge at t = 0 moves");
      continue;
    }
    // The begin of the period is its end, too.
    const bool is_whole = is_wrap && place.to >= run_.stop - near;
    const double moved = is_whole ? shift : at_from ? shift - from_moves(measurement) : at_to ? shift - to_moves(measurement) : shift;
    if (at_from && !is_whole && moved * side < 0.0) continue;
    if (at_to && moved * side > 0.0) continue;
    const Jet left = jet_of(measurement.expression, is_wrap ? run_.stop : time, Side::left),
              right = jet_of(measurement.expression, time, Side::right);
    sum += (squares ? left.value * left.value - right.value * right.value : left.value - right.value) * moved;
  }
  return sum;
}

/// At an instant the value goes with it on the side that is the extreme; elsewhere the time of the extreme does not matter.
double MeasuredDerivatives::of_extreme(const Measurement& measurement, double time, bool is_largest, const measure::Place& place) {
  const double near = same_time * run_.stop;
  const auto instant = instant_at(time);
  const bool at_begin = time <= place.from + near, at_end = time >= place.to - near;
  if (at_begin || at_end) {
    const Side side = at_begin ? Side::right : Side::left;
    const Jet jet = jet_of(measurement.expression, time, side);
    double moves = at_begin ? from_moves(measurement) : to_moves(measurement);
    if (instant && moves == 0.0 && time <= near) moves = followed_.shifts[*instant];
    return jet.moved + jet.rate * moves;
  }
  if (!instant) return jet_of(measurement.expression, time, Side::right).moved;
  const Jet left = jet_of(measurement.expression, time, Side::left), right = jet_of(measurement.expression, time, Side::right);
  const Jet& taken = (left.value >= right.value) == is_largest ? left : right;
  return taken.moved + taken.rate * followed_.shifts[*instant];
}

TwoSided MeasuredDerivatives::of_extreme_time(const Measurement& measurement, double time, const measure::Place& place) {
  const double near = same_time * run_.stop;
  if (time <= place.from + near) return TwoSided::of(from_moves(measurement));
  if (time >= place.to - near) return TwoSided::of(to_moves(measurement));
  if (const auto instant = instant_at(time)) return TwoSided::of(followed_.shifts[*instant]);
  return TwoSided::failed("the time of an extreme between events has no derivative here");
}

}  // namespace pwlsim::analysis
