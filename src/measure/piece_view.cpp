#include "measure/piece_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace pwlsim::measure {
namespace {

constexpr std::size_t points = linalg::legendre_points;
constexpr double resolution = 1e-14;
constexpr double end_slack = 32.0;  ///< rounding of a polynomial's ends, in that of its coefficients
/// A tail of this size, of the largest value, that halving does not lower to this part is rounding.
constexpr double noise = 1e-12;
constexpr double stalled = 0.7;
constexpr int deepest = 48;
/// Of so short a part a larger tail may be rounding: beside a zero of its argument a root has the root of that rounding. A root's own tail is lowered to 0.71.
constexpr int deep = 20;
constexpr double deep_noise = 1e-7, stalled_deep = 0.75;
constexpr std::size_t most_parts = 4000;  ///< of a piece, for one expression
/// Mean error of the parts, of the largest value, beyond which they do not stand for the expression.
constexpr double most_unresolved = 1e-10;
/// What the shortest parts do not resolve, of ∫|f|: more of it is a pole whose integral diverges, as that of 1/|v| through a zero of v.
constexpr double most_of_poles = 1e-6;
/// Tail of a product of signals, of the largest value: those of its factors are as large.
constexpr double product_tail = 1e-12;
/// Of the larger side of a comparison: a difference below it is none.
constexpr double equal_sides = 1e-13;
/// Tail of a quantity at whose zeros the expression has corners or jumps, of its terms.
constexpr double turn_tail = 1e-13;
/// A tail that halving does not lower to `stalled`, or to this part where it is larger, is rounding of arguments.
constexpr double hardly_less = 0.9, stalled_turn = 1e-9, rough_turn = 1e-3;
constexpr double turn_rounding = 2e-14;  ///< of such a quantity's terms: what comes no farther past a level touches it
/// Of a time: two closer ones are one instant.
constexpr double same_instant = 4.0 * std::numeric_limits<double>::epsilon();
/// Of a part's length, from its ends: where the expression is compared with its series, inside the part.
constexpr double inside = 1e-9;
/// Of a part's length: a stretch of noise about a zero that is longer is looked into.
constexpr double flat_zero = 1e-11;
constexpr int most_bisections = 100;

double instant_at(double from, double to) { return same_instant * std::max(std::abs(from), std::abs(to)); }

/// The time of a zero of a series on [from, to]. Where the series is below the noise about it for a while, as about the zero of x³, it has no sign there and that of
/// `value` decides.
template <typename Value>
double zero_time(const linalg::LegendreSeries& series, double zero, double rounding, double from, double to, const Value& value,
                 double known) {
  constexpr double first_step = 1e-15, growth = 4.0;
  const auto end = [&](double direction) {
    double step = first_step;
    while (std::abs(zero + direction * step) < 1.0 && std::abs(series(zero + direction * step)) <= rounding) step *= growth;
    return std::clamp(zero + direction * step, -1.0, 1.0);
  };
  const double lower = end(-1.0), upper = end(1.0);
  if (upper - lower <= flat_zero) return known;
  double a = from + 0.5 * (lower + 1.0) * (to - from), b = from + 0.5 * (upper + 1.0) * (to - from);
  const double at_a = value(a), at_b = value(b);
  if (!((at_a < 0.0 && at_b > 0.0) || (at_a > 0.0 && at_b < 0.0))) return known;
  for (int step = 0; step < most_bisections; ++step) {
    const double middle = 0.5 * (a + b), at_middle = value(middle);
    if (at_middle == 0.0 || middle <= a || middle >= b) return middle;
    ((at_middle < 0.0) == (at_a < 0.0) ? a : b) = middle;
  }
  return b;
}

/// Whether two values of a quantity of turns are on the same side of its zero, or of all integers.
bool on_one_side(double a, double b, bool at_integers) {
  if (at_integers) return std::ceil(a) == std::ceil(b) && std::floor(a) == std::floor(b);
  return (a < 0.0) == (b < 0.0) && (a > 0.0) == (b > 0.0);
}

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

void PieceView::set_inputs(const Program& program, const std::vector<double>& results, double from, double to) {
  for (const int probe : program.probes()) inputs_.signals[static_cast<std::size_t>(probe)] = signal_on(probe, from, to);
  const auto& point = linalg::gauss_legendre().point;
  for (std::size_t i = 0; i < points; ++i) times_[i] = from + 0.5 * (point[i] + 1.0) * (to - from);
  inputs_.times = times_.data();
  inputs_.results = &results;
}

void PieceView::set_inputs(const Program& program, const std::vector<double>& results, const double& time) {
  const double x = std::clamp(piece_.place(time), -1.0, 1.0);
  for (const int probe : program.probes()) {
    const auto index = static_cast<std::size_t>(probe);
    Signal& signal = signals_[index];
    if (!signal.has_series) signal.series = linalg::LegendreSeries(piece_.values.data() + index * points);
    signal.has_series = true;
    signal.values[0] = signal.series(x);
    inputs_.signals[index] = signal.values.data();
  }
  inputs_.times = &time;
  inputs_.results = &results;
}

void PieceView::values(const Program& program, const std::vector<double>& results, double from, double to, double* out) {
  set_inputs(program, results, from, to);
  program.evaluate(inputs_, points, out);
}

double PieceView::value(const Program& program, const std::vector<double>& results, double time) {
  set_inputs(program, results, time);
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
  if (program.turns() > 0) program.find_turns(inputs_, points, turns_, turn_sizes_);
  std::vector<double> shifted_turns, sizes;
  // Where the shift takes a condition to its other side, what changes is the expression.
  const auto is_same = [&](std::size_t i) {
    for (std::size_t turn = 0; turn < program.turns(); ++turn)
      if (!on_one_side(turns_[turn * points + i], shifted_turns[turn * points + i], program.turns_at_integers(turn))) return false;
    return true;
  };
  double sum = 0.0;
  for (const int probe : program.probes()) {
    const double*& signal = inputs_.signals[static_cast<std::size_t>(probe)];
    const double* own = signal;
    const double shift = piece_.noise[static_cast<std::size_t>(probe)];
    std::transform(own, own + points, shifted.begin(), [&](double value) { return value + shift; });
    signal = shifted.data();
    program.evaluate(inputs_, points, changed.data());
    if (program.turns() > 0) program.find_turns(inputs_, points, shifted_turns, sizes);
    signal = own;
    double largest = 0.0;
    for (std::size_t i = 0; i < points; ++i)
      if (is_same(i)) largest = std::max(largest, std::abs(changed[i] - plain[i]));
    if (std::isfinite(largest)) sum += largest;
  }
  return sum;
}

/// A sum of signals is as much of a polynomial as these; of a product of two the points give ∫ exactly.
bool PieceView::resolve(const Program& program, const std::vector<double>& results, double from, double to, double scale,
                        const std::function<void(const PolynomialPart&)>& take, bool for_integral) {
  const int degree = program.degree();
  const PolynomialPart whole = part_on(program, results, from, to);
  const auto size = [&] {
    return std::accumulate(whole.values.begin(), whole.values.end(), scale, [](double a, double b) { return std::max(a, std::abs(b)); });
  };
  if (degree >= 0 && (degree <= 1 || (degree == 2 && for_integral) || !(whole.series.tail() > product_tail * size()))) {
    take(whole);
    return true;
  }
  cuts_.assign(1, from);
  looks_ = 0;
  is_overrun_ = false;
  if (degree < 0) find_cuts(program, results, from, to, 0, 0, std::numeric_limits<double>::infinity());
  if (is_overrun_) return false;
  cuts_.push_back(to);
  double unresolved = 0.0, poles = 0.0, area = 0.0;
  for (std::size_t k = 0; k + 1 < cuts_.size(); ++k) {
    split(program, results, cuts_.size() == 2 ? whole : part_on(program, results, cuts_[k], cuts_[k + 1]), scale);
    std::sort(parts_.begin(), parts_.end(), [](const Open& a, const Open& b) { return a.part.from < b.part.from; });
    for (const Open& open : parts_) {
      take(open.part);
      if (open.hidden > noise * scale) return false;
      unresolved += open.error * open.part.length();
      if (!for_integral) continue;
      for (std::size_t i = 0; i < points; ++i)
        area += 0.5 * linalg::gauss_legendre().weight[i] * std::abs(open.part.values[i]) * open.part.length();
      if (open.is_shortest) poles += open.part.series.tail() * open.part.length();
    }
  }
  return !(unresolved > most_unresolved * scale * whole.length()) && !(poles > most_of_poles * area);
}

/// Where quantities of turns pass zero, or integers, from the quantity `turn` on; those before it do not in [from, to]. Each depends on those before it only, and so is
/// smooth between their cuts.
void PieceView::find_cuts(const Program& program, const std::vector<double>& results, double from, double to, std::size_t turn, int depth,
                          double tail_before) {
  if (turn >= program.turns() || is_overrun_) return;
  if (++looks_ > most_parts) {
    is_overrun_ = true;
    return;
  }
  set_inputs(program, results, from, to);
  program.find_turns(inputs_, points, turns_, turn_sizes_);
  bool is_hidden_known = false;
  const double middle = 0.5 * (from + to);
  const bool may_halve = depth < deepest && middle - from > instant_at(from, to) && to - middle > instant_at(from, to);
  for (const std::size_t first = turn; turn < program.turns(); ++turn) {
    if (turn > first) tail_before = std::numeric_limits<double>::infinity();
    const double* const own = turns_.data() + turn * points;
    if (!std::all_of(own, own + points, [](double value) { return std::isfinite(value); })) continue;
    if (program.turn_degree(turn) < 0 || program.turn_degree(turn) > 1) {
      const linalg::LegendreSeries quantity(own);
      const double tail = quantity.tail(), size = turn_sizes_[turn];
      const bool is_rounding =
          (tail <= stalled_turn * size && tail > stalled * tail_before) || (tail <= rough_turn * size && tail > hardly_less * tail_before);
      bool is_open = tail > turn_tail * size && !is_rounding;
      if (!is_open && program.turn_degree(turn) < 0) {
        if (!is_hidden_known) {
          set_inputs(program, results, from, to);
          program.find_hidden(inputs_, hidden_);
          is_hidden_known = true;
        }
        is_open = hidden_.turns[turn] != 0;
      }
      if (is_open && may_halve) {
        find_cuts(program, results, from, middle, turn, depth + 1, tail);
        cuts_.push_back(middle);  // a zero may be there
        find_cuts(program, results, middle, to, turn, depth + 1, tail);
        return;
      }
    }
    std::vector<double> own_cuts = cuts_of(program, results, turn, from, to);
    if (own_cuts.empty()) continue;
    own_cuts.push_back(to);
    double begin = from;
    for (const double cut : own_cuts) {
      find_cuts(program, results, begin, cut, turn + 1, depth, std::numeric_limits<double>::infinity());
      if (cut < to) cuts_.push_back(cut);
      begin = cut;
    }
    return;
  }
}

/// Between `from` and `to`, ascending, where the quantity whose values are known passes zero or integers.
std::vector<double> PieceView::cuts_of(const Program& program, const std::vector<double>& results, std::size_t turn, double from,
                                       double to) {
  const linalg::LegendreSeries quantity(turns_.data() + turn * points);
  const double size = turn_sizes_[turn], rounding = turn_rounding * size, variation = quantity.variation();
  const bool at_integers = program.turns_at_integers(turn);
  if (!at_integers && (std::abs(quantity.mean()) > variation || std::abs(quantity.mean()) + variation <= equal_sides * size)) return {};
  double first = 0.0, last = 0.0;
  if (at_integers) {
    const linalg::Extremes extremes = linalg::extremes(quantity);
    first = std::ceil(extremes.least);
    last = std::floor(extremes.largest);
    is_overrun_ = is_overrun_ || last - first > static_cast<double>(most_parts);
    if (is_overrun_) return {};
  }
  std::vector<double> cuts;
  for (double level = first; level <= last; level += 1.0) {
    linalg::LegendreValues shifted = quantity.coefficients();
    shifted[0] -= level;
    const linalg::LegendreSeries difference{std::span<const double>(shifted)};
    const auto sign_at = [&](double time) {
      set_inputs(program, results, time);
      std::vector<double> values, sizes;
      program.find_turns(inputs_, 1, values, sizes);
      return values[turn] - level;
    };
    for (const double zero : linalg::sign_changes(difference, rounding)) {
      const double time = from + 0.5 * (zero + 1.0) * (to - from);
      cuts.push_back(zero_time(difference, zero, rounding, from, to, sign_at, time));
    }
  }
  std::sort(cuts.begin(), cuts.end());
  const double instant = instant_at(from, to);
  double before = from;
  std::erase_if(cuts, [&](double cut) {
    if (cut - before <= instant || to - cut <= instant) return true;
    before = cut;
    return false;
  });
  return cuts;
}

double PieceView::refined_zero(const Program& program, const std::vector<double>& results, const PolynomialPart& part, double time,
                               double rounding) {
  const double x = part.place(time);
  if (!(x > -1.0 && x < 1.0)) return time;
  const auto value_at = [&](double at) { return value(program, results, at); };
  return zero_time(part.series, x, rounding, part.from, part.to, value_at, time);
}

/// Halves the part that is farthest from a polynomial until all are near, or there are too many.
/// `scale` grows with what comes to light.
void PieceView::split(const Program& program, const std::vector<double>& results, const PolynomialPart& whole, double& scale) {
  const auto is_nearer = [](const Open& a, const Open& b) { return a.error < b.error; };
  const auto add = [&](const PolynomialPart& part, double tail_before, int depth) {
    for (const double value : part.values) scale = std::max(scale, std::abs(value));
    const double middle = part.time(0.0), instant = instant_at(part.from, part.to);
    const bool may_split = depth < deepest && middle - part.from > instant && part.to - middle > instant;
    double hidden = 0.0;
    const double error = may_split ? error_of(program, results, part, tail_before, depth, scale, hidden) : 0.0;
    parts_.push_back({part, error, hidden, depth, !may_split});
    std::push_heap(parts_.begin(), parts_.end(), is_nearer);
  };
  parts_.clear();
  add(whole, std::numeric_limits<double>::infinity(), 0);
  while (parts_.front().error > 0.0 && parts_.size() < most_parts) {
    std::pop_heap(parts_.begin(), parts_.end(), is_nearer);
    if (parts_.back().hidden > 0.0 && parts_.back().hidden <= noise * scale) {
      parts_.back().error = parts_.back().hidden = 0.0;
      std::push_heap(parts_.begin(), parts_.end(), is_nearer);
      continue;
    }
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

/// Whether a quantity of turns is on another side at `time` than at the point of the part that is nearest: at an end it touches its zero or an integer, to rounding.
bool PieceView::touches(const Program& program, const std::vector<double>& results, const PolynomialPart& part, double time,
                        std::size_t nearest) {
  if (program.turns() == 0) return false;
  set_inputs(program, results, part.from, part.to);
  program.find_turns(inputs_, points, turns_, turn_sizes_);
  std::vector<double> there;
  set_inputs(program, results, time);
  program.find_turns(inputs_, 1, there, turn_sizes_);
  for (std::size_t turn = 0; turn < program.turns(); ++turn)
    if (!on_one_side(turns_[turn * points + nearest], there[turn], program.turns_at_integers(turn))) return true;
  return false;
}

/// 0 for a part that is resolved. A narrow decay may hide between an end and the first point, and a narrow peak between points: `hidden`, how far the expression may vary there. What
/// halving leaves as it was is rounding, unless it is large.
double PieceView::error_of(const Program& program, const std::vector<double>& results, const PolynomialPart& part, double tail_before,
                           int depth, double scale, double& hidden) {
  const double tail = part.series.tail();
  if (program.degree() >= 0) return tail <= product_tail * scale ? 0.0 : tail;
  // Not at the ends themselves, which may be jumps.
  const double margin = std::max(inside * part.length(), instant_at(part.from, part.to));
  const double tolerance = resolution * scale;
  const auto off = [&](double time, std::size_t nearest) {
    const double difference = std::abs(part.series(part.place(time)) - value(program, results, time));
    return difference > tolerance && touches(program, results, part, time, nearest) ? 0.0 : difference;
  };
  const double ends = std::max(off(part.from + margin, 0), off(part.to - margin, points - 1));
  const bool is_small = std::max(tail, ends) <= noise * scale && tail > stalled * tail_before;
  const bool is_short = depth >= deep && std::max(tail, ends) <= deep_noise * scale && tail > stalled_deep * tail_before;
  const bool is_rounding = is_small || is_short;
  if (!is_rounding && !(tail <= tolerance && ends <= end_slack * tolerance)) return std::max(tail, ends);
  set_inputs(program, results, part.from, part.to);
  program.find_hidden(inputs_, hidden_);
  hidden = hidden_.width > noise * scale ? hidden_.width : 0.0;
  return hidden;
}

}  // namespace pwlsim::measure
