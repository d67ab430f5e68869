#include "analysis/measured_pass.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace pwlsim::analysis {

namespace {

using circuit::Measurement;
using measure::ExpressionGradient;
using measure::GradientValue;
using Kind = Measurement::Kind;

}  // namespace

std::vector<double> gradient_by_signals(const ExpressionGradient& gradient, const std::vector<double>& signals,
                                        const std::vector<double>& results) {
  const GradientValue at = gradient.at(signals, results, 0.0);
  const auto moves = [](const std::vector<double>& list) {
    return std::any_of(list.begin(), list.end(), [](double x) { return x != 0.0; });
  };
  return moves(at.results) || moves(at.numbers) || at.has_kink ? std::vector<double>() : at.signals;
}

bool reads_time(const circuit::MeasuredExpression& expression) {
  using circuit::StepKind;
  return std::any_of(expression.steps.begin(), expression.steps.end(), [](const auto& step) { return step.kind == StepKind::time; });
}

std::vector<double> some_values(std::size_t count) {
  std::vector<double> values;
  for (std::size_t k = 0; k < count; ++k) values.push_back(std::sin(static_cast<double>(k) + 1.0));
  return values;
}

std::vector<double> even_weights(const circuit::MeasuredExpression& expression, const std::vector<double>& results) {
  if (reads_time(expression) || !measure::Program(expression).is_linear()) return {};
  const ExpressionGradient gradient(expression);
  const std::vector<double> at_zero = gradient_by_signals(gradient, std::vector<double>(gradient.probes().size(), 0.0), results);
  const std::vector<double> elsewhere = gradient_by_signals(gradient, some_values(gradient.probes().size()), results);
  return at_zero == elsewhere ? at_zero : std::vector<double>();
}

namespace {

bool integrates(Kind kind) { return kind == Kind::average || kind == Kind::integral || kind == Kind::rms; }

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
  run.is_whole = simulate(request, rows).outcome == engine::Outcome::completed;
  look.finish();
  return run;
}

}  // namespace pwlsim::analysis
