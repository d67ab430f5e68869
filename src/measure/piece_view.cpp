#include "measure/piece_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pwlsim::measure {
namespace {

constexpr std::size_t points = linalg::legendre_points;
constexpr double resolution = 1e-14;
constexpr double end_slack = 32.0;  ///< rounding of a polynomial's ends, in that of its coefficients
/// A tail of this size, of the largest value, that halving does not lower to this part is rounding.
constexpr double noise = 1e-12;
constexpr double stalled = 0.7;
constexpr int deepest = 48;
constexpr std::size_t most_parts = 500;  ///< of a piece, for one expression
/// Mean error of the parts, of the largest value, beyond which they do not stand for the expression.
constexpr double most_unresolved = 0.01;

}  // namespace

PieceView::PieceView(std::size_t probes) : signals_(probes) { inputs_.signals.resize(probes); }

void PieceView::set(const engine::Piece& piece) {
  piece_ = piece;
  for (Signal& signal : signals_) signal.has_series = false;
}

const double* PieceView::signal_on(int probe, double from, double to) {
  const auto index = static_cast<std::size_t>(probe);
  const double* values = piece_.values.data() + index * points;
  if (from == piece_.begin && to == piece_.begin + piece_.length) return values;
  Signal& signal = signals_[index];
  if (!signal.has_series) signal.series = linalg::LegendreSeries(values);
  signal.has_series = true;
  const double lower = piece_.place(from);
  const double upper = piece_.place(to);
  const auto& point = linalg::gauss_legendre().point;
  for (std::size_t i = 0; i < points; ++i) signal.values[i] = signal.series(lower + 0.5 * (point[i] + 1.0) * (upper - lower));
  return signal.values.data();
}

void PieceView::values(const Program& program, const std::vector<double>& results, double from, double to, double* out) {
  for (const int probe : program.probes()) inputs_.signals[static_cast<std::size_t>(probe)] = signal_on(probe, from, to);
  const auto& point = linalg::gauss_legendre().point;
  for (std::size_t i = 0; i < points; ++i) times_[i] = from + 0.5 * (point[i] + 1.0) * (to - from);
  inputs_.times = times_.data();
  inputs_.results = &results;
  program.evaluate(inputs_, points, out);
}

double PieceView::value(const Program& program, const std::vector<double>& results, double time) {
  const double x = std::clamp(piece_.place(time), -1.0, 1.0);
  for (const int probe : program.probes()) {
    const auto index = static_cast<std::size_t>(probe);
    Signal& signal = signals_[index];
    signal.values[0] = linalg::LegendreSeries(piece_.values.data() + index * points)(x);
    inputs_.signals[index] = signal.values.data();
  }
  inputs_.times = &time;
  inputs_.results = &results;
  double value = 0.0;
  program.evaluate(inputs_, 1, &value);
  return value;
}

std::vector<double> PieceView::signals(const Program& program, double time) const {
  std::vector<double> found(signals_.size(), 0.0);
  const double x = std::clamp(piece_.place(time), -1.0, 1.0);
  for (const int probe : program.probes()) {
    const auto index = static_cast<std::size_t>(probe);
    found[index] = linalg::LegendreSeries(piece_.values.data() + index * points)(x);
  }
  return found;
}

double PieceView::noise_of(const Program& program, const std::vector<double>& results, double from, double to) {
  if (piece_.noise.empty()) return 0.0;
  linalg::LegendreValues plain, shifted, changed;
  values(program, results, from, to, plain.data());
  double sum = 0.0;
  for (const int probe : program.probes()) {
    const double*& signal = inputs_.signals[static_cast<std::size_t>(probe)];
    const double* own = signal;
    const double shift = piece_.noise[static_cast<std::size_t>(probe)];
    std::transform(own, own + points, shifted.begin(), [&](double value) { return value + shift; });
    signal = shifted.data();
    program.evaluate(inputs_, points, changed.data());
    signal = own;
    double largest = 0.0;
    for (std::size_t i = 0; i < points; ++i) largest = std::max(largest, std::abs(changed[i] - plain[i]));
    if (std::isfinite(largest)) sum += largest;
  }
  return sum;
}

bool PieceView::resolve(const Program& program, const std::vector<double>& results, double from, double to, double scale,
                        const std::function<void(const PolynomialPart&)>& take) {
  PolynomialPart whole = part_on(program, results, from, to);
  if (program.is_polynomial()) {
    take(whole);
    return true;
  }
  split(program, results, whole, scale);
  std::sort(parts_.begin(), parts_.end(), [](const Open& a, const Open& b) { return a.part.from < b.part.from; });
  double unresolved = 0.0;
  for (const Open& open : parts_) {
    take(open.part);
    unresolved += open.error * open.part.length();
  }
  return !(unresolved > most_unresolved * scale * whole.length());
}

/// Halves the part that is farthest from a polynomial until all are near, or there are too many.
/// `scale` grows with what comes to light.
void PieceView::split(const Program& program, const std::vector<double>& results, const PolynomialPart& whole, double& scale) {
  const auto is_nearer = [](const Open& a, const Open& b) { return a.error < b.error; };
  const auto add = [&](const PolynomialPart& part, double tail_before, int depth) {
    for (const double value : part.values) scale = std::max(scale, std::abs(value));
    const bool may_split = depth < deepest && part.time(0.0) > part.from && part.time(0.0) < part.to;
    const double error = may_split ? error_of(program, results, part, tail_before, scale) : 0.0;
    parts_.push_back({part, error, depth});
    std::push_heap(parts_.begin(), parts_.end(), is_nearer);
  };
  parts_.clear();
  add(whole, std::numeric_limits<double>::infinity(), 0);
  while (parts_.front().error > 0.0 && parts_.size() < most_parts) {
    std::pop_heap(parts_.begin(), parts_.end(), is_nearer);
    const Open open = parts_.back();
    parts_.pop_back();
    const double middle = open.part.time(0.0);
    const double tail = open.part.series.tail();
    add(part_on(program, results, open.part.from, middle), tail, open.depth + 1);
    add(part_on(program, results, middle, open.part.to), tail, open.depth + 1);
  }
}

PolynomialPart PieceView::part_on(const Program& program, const std::vector<double>& results, double from, double to) {
  PolynomialPart part{from, to, {}, {}};
  values(program, results, from, to, part.values.data());
  part.series = linalg::LegendreSeries(part.values.data());
  return part;
}

/// 0 for a part that is resolved. A corner or a jump may hide between an end and the first point, or two of them between points. What halving leaves as it was is rounding,
/// unless it is large: a jump.
double PieceView::error_of(const Program& program, const std::vector<double>& results, const PolynomialPart& part, double tail_before,
                           double scale) {
  const double tail = part.series.tail();
  const double ends = std::max(std::abs(part.series(-1.0) - value(program, results, part.from)),
                               std::abs(part.series(1.0) - value(program, results, part.to)));
  const double tolerance = resolution * scale;
  const bool is_rounding = std::max(tail, ends) <= noise * scale && tail > stalled * tail_before;
  if (!is_rounding && !(tail <= tolerance && ends <= end_slack * tolerance)) return std::max(tail, ends);
  const double hidden = hidden_error(program, results, part);
  return hidden > noise * scale ? hidden : 0.0;
}

/// How far a part that its points resolve is from the expression where a comparison, or what max chooses from, goes farther between points than at these: what is there alone shows at its
/// extremes.
double PieceView::hidden_error(const Program& program, const std::vector<double>& results, const PolynomialPart& part) {
  if (program.turns() == 0) return 0.0;
  linalg::LegendreValues plain;
  values(program, results, part.from, part.to, plain.data());  // the inputs of the part
  program.find_turns(inputs_, points, turns_);
  double error = 0.0;
  for (std::size_t turn = 0; turn < program.turns(); ++turn) {
    const linalg::LegendreSeries quantity(turns_.data() + turn * points);
    if (program.turns_at_zero(turn) && std::abs(quantity.mean()) > quantity.variation()) continue;
    for (const double x : linalg::stationary_points(quantity))
      error = std::max(error, std::abs(part.series(x) - value(program, results, part.time(x))));
  }
  return error;
}

}  // namespace pwlsim::measure
