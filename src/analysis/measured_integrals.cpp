/// What integrals contribute to derivatives: the members of MeasuredFunctionals that read pieces of the run.
#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/measured_derivative.hpp"
#include "linalg/legendre.hpp"
#include "measure/piece_view.hpp"

namespace pwlsim::analysis {

namespace {

using circuit::Measurement;
using measure::ExpressionGradient;
using measure::GradientValue;

engine::Piece piece_of(const KeptPiece& kept) { return {kept.from, kept.to, kept.begin, kept.length, kept.values}; }

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
  // Σ_k (k + ½) w_j P_k(x_j) P_k(x): by k, then by j.
  static const std::array<linalg::LegendreValues, linalg::legendre_points> table = [&] {
    std::array<linalg::LegendreValues, linalg::legendre_points> entries{};
    for (std::size_t j = 0; j < entries.size(); ++j) {
      const linalg::LegendreValues at_point = polynomials(rule.point[j]);
      for (std::size_t k = 0; k < entries.size(); ++k) entries[k][j] = (static_cast<double>(k) + 0.5) * rule.weight[j] * at_point[k];
    }
    return entries;
  }();
  const linalg::LegendreValues here = polynomials(x);
  linalg::LegendreValues values{};
  for (std::size_t k = 0; k < values.size(); ++k)
    for (std::size_t j = 0; j < values.size(); ++j) values[j] += table[k][j] * here[k];
  return values;
}

}  // namespace

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

void MeasuredFunctionals::AffineGradient::at(const std::vector<double>& signals, std::vector<double>& gradient) const {
  gradient.resize(constant.size());
  for (std::size_t j = 0; j < signals.size(); ++j) {
    gradient[j] = constant[j];
    for (std::size_t k = 0; k < signals.size(); ++k) gradient[j] += slopes[j * signals.size() + k] * signals[k];
  }
}

namespace {

/// At the points of a part what is known at those of the piece.
linalg::LegendreValues on_part(const double* values, const std::array<linalg::LegendreValues, linalg::legendre_points>& shares) {
  linalg::LegendreValues sum{};
  for (std::size_t i = 0; i < sum.size(); ++i)
    for (std::size_t j = 0; j < sum.size(); ++j) sum[i] += shares[i][j] * values[j];
  return sum;
}

/// Weights of the points of a part as those of the piece's.
linalg::LegendreValues on_piece(const linalg::LegendreValues& weights,
                                const std::array<linalg::LegendreValues, linalg::legendre_points>& shares) {
  linalg::LegendreValues sum{};
  for (std::size_t i = 0; i < sum.size(); ++i)
    for (std::size_t j = 0; j < sum.size(); ++j) sum[j] += weights[i] * shares[i][j];
  return sum;
}

}  // namespace

/// Values of the probes at the points of a piece, or of the part of it that has these shares.
void MeasuredFunctionals::take_values(const KeptPiece& piece, const std::vector<int>& probes, const Shares* shares) {
  const std::size_t n = linalg::legendre_points;
  values_.resize(probes.size());
  for (std::size_t k = 0; k < probes.size(); ++k) {
    const double* const own = piece.values.data() + static_cast<std::size_t>(probes[k]) * n;
    if (shares == nullptr)
      std::copy_n(own, n, values_[k].begin());
    else
      values_[k] = on_part(own, shares->points);
  }
}

/// Weights of the probes at the points from `from` to `to`, where their values are `values_`.
void MeasuredFunctionals::weigh(const ExpressionGradient& gradient, const AffineGradient& affine, double from, double to, bool squares,
                                double scale) {
  const std::size_t count = values_.size();
  weights_.resize(count);
  const auto& rule = linalg::gauss_legendre();
  std::vector<double> signals(count), of_signals;
  for (std::size_t i = 0; i < linalg::legendre_points; ++i) {
    for (std::size_t k = 0; k < count; ++k) signals[k] = values_[k][i];
    double weight = 0.5 * (to - from) * rule.weight[i] * scale;
    if (!affine.constant.empty()) {
      affine.at(signals, of_signals);
    } else {
      GradientValue at = gradient.at(signals, run_.record.values, from + 0.5 * (rule.point[i] + 1.0) * (to - from));
      if (squares) weight *= 2.0 * at.value;
      add_numbers(weight, at);
      of_signals = std::move(at.signals);
    }
    for (std::size_t k = 0; k < count; ++k) weights_[k][i] = weight * of_signals[k];
  }
}

/// ∫ of the derivative of the expression, or of its square's, over what a piece stands for; results and numbers are added up by the caller.
void MeasuredFunctionals::add_inside(const ExpressionGradient& gradient, const AffineGradient& affine, std::size_t number, double from,
                                     double to, bool squares, double scale, MeasuredFunctional& sum) {
  const KeptPiece& kept = run_.pieces[number];
  const std::size_t n = linalg::legendre_points, width = signals_.size(), count = gradient.probes().size();
  steady::Functional::Interval& interval = sum.sum.run.intervals[number];
  if (interval.weights.empty()) interval = {0.5 * (kept.from + kept.to), kept.begin, kept.length, std::vector<double>(n * width, 0.0)};
  constexpr double whole = 1e-14, of_time = 1e-15;
  const double near = whole + of_time * std::abs(to) / kept.length;
  const double begins = (from - kept.begin) / kept.length, ends = (to - kept.begin) / kept.length;
  const bool is_whole = std::abs(begins) <= near && std::abs(ends - 1.0) <= near;
  const Shares* const shares = is_whole ? nullptr : &shares_on(begins, ends, near);
  take_values(kept, gradient.probes(), shares);
  weigh(gradient, affine, from, to, squares, scale);
  for (std::size_t k = 0; k < count; ++k) {
    const linalg::LegendreValues own = is_whole ? weights_[k] : on_piece(weights_[k], shares->points);
    const auto at = static_cast<std::size_t>(gradient.probes()[k]);
    for (std::size_t i = 0; i < n; ++i) interval.weights[i * width + at] += own[i];
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
    const bool resolved = view.resolve(program, run_.record.values, from, to, size, [&](const measure::PolynomialPart& part) {
      for (const double value : part.values) size = std::max(size, std::abs(value));
      add_inside(gradient, affine, k, part.from, part.to, squares, scale, sum);
    });
    if (!resolved) sum.failure = "the expression varies too fast";
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

}  // namespace pwlsim::analysis
