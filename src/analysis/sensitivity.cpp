#include "analysis/sensitivity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <optional>

#include "analysis/beside_kinks.hpp"
#include "analysis/derivative_columns.hpp"
#include "analysis/recorded_run.hpp"
#include "base/names.hpp"
#include "linalg/factorisations.hpp"
#include "steady/start_derivative.hpp"
#include "waveform/csv.hpp"

namespace pwlsim::analysis {
namespace {

using circuit::Compiled;
using circuit::SensitivityAnalysis;
using steady::Followed;
using steady::LinearisedOrbit;
using steady::Matrix;
using steady::Sensitivity;
using steady::Vector;

/// Of I − Φ, against the larger of 1 and its norm.
constexpr double singular_closing = 1e-11;
/// Of a derivative: what I − Φ cannot give.
constexpr double inconsistent = 1e-7;

/// The orbit's derivative to one parameter.
struct OrbitMove {
  Vector start;         ///< of the stacked ξ left of t = 0
  double period = 0.0;  ///< s
  std::string failure;
  bool is_kink = false;  ///< there is one on each side
};

class OrbitMoves : public RunMotion {
 public:
  OrbitMoves(const Compiled& compiled, const SteadyState& state, const Sensitivity& sensitivity, const LinearisedOrbit& linear)
      : compiled_(compiled),
        state_(state),
        sensitivity_(sensitivity),
        variation_(steady::variation(linear.stacking(), state.trace_with_inputs())) {
    const Eigen::Index n = linear.stacking().size();
    Matrix closing = Matrix::Identity(n, n) - (is_driven() ? variation_.x : variation_.return_map());
    const double norm = n > 0 ? closing.cwiseAbs().colwise().sum().maxCoeff() : 1.0;
    lu_.compute(closing);
    is_singular_ = n > 0 && !(lu_.rcond() * norm > singular_closing * std::max(1.0, norm));
    if (is_singular_ || !state.orbit.free_directions.empty()) svd_.compute(closing, Eigen::ComputeFullU | Eigen::ComputeFullV);
    free_ = svd_.rows() > 0 ? (svd_.singularValues().array() <= singular_closing * std::max(1.0, svd_.singularValues()[0])).count() : 0;
  }

  [[nodiscard]] bool is_driven() const { return !state_.common.sources.empty(); }

  OrbitMove of(std::size_t parameter) {
    OrbitMove move;
    move.failure = failure(parameter);
    if (!move.failure.empty()) return move;
    return found(parameter);
  }

  /// Of an orbit that stays near where others are too: the one that is kept from the start.
  OrbitMove found(std::size_t parameter) const {
    OrbitMove move;
    if (is_driven()) move.period = period_share(parameter) * state_.orbit.period;
    const Eigen::Index n = variation_.flow.size();
    const Followed own = sensitivity_.follow(parameter, Vector::Zero(n));
    if (!own.failure.empty()) return {{}, 0.0, own.failure, own.is_kink};
    const double end_shift = is_driven() ? move.period : own.shifts.back();
    const Vector right = own.end + variation_.flow * end_shift;
    if (free_ > 0 && (svd_.matrixU().rightCols(free_).transpose() * right).norm() > inconsistent * right.norm())
      return {{}, 0.0, "the orbit is one of a family, and for other parameter values there is none nearby (multiplier 1)", false};
    move.start = solve(right, false);
    if (!is_driven()) move.period = end_shift + variation_.end_time.dot(move.start);
    return move;
  }

  std::string failure(std::size_t parameter) override {
    if (!variation_.kink.empty()) return "the orbit has no derivative: " + variation_.kink;
    if (free_ == 0 && is_singular_) return "the orbit is not the only one nearby (multiplier 1)";
    if (free_ > 0 && !is_driven()) return "the orbit is one of a family (multiplier 1)";
    std::string failure = is_driven() ? period_failure(parameter) : "";
    return failure.empty() && free_ > 0 ? found(parameter).failure : failure;
  }

  std::vector<Vector> free_directions() const override {
    std::vector<Vector> list;
    for (Eigen::Index k = 0; k < free_; ++k) list.emplace_back(svd_.matrixV().col(svd_.cols() - 1 - k));
    return list;
  }

  Forward forward(std::size_t parameter) override {
    const OrbitMove move = of(parameter);
    if (!move.failure.empty()) return {{}, {}, move.failure, move.is_kink};
    return {sensitivity_.follow(parameter, move.start), {number_of(parameter), 0.0, move.period}, "", false};
  }

  /// What reads the start reads, through (I − Φ)⁻¹, the end of a run from a start that does not move.
  std::vector<double> backward(const MeasuredSum& sum, const steady::Adjoint& adjoint) override {
    steady::Functional functional = sum.run;
    Vector start = adjoint.to_start(functional, Vector());
    if (!is_driven()) start += sum.stop_moves * variation_.end_time.transpose();
    const Vector end = solve(start, true);
    const double on_end_shift = end.dot(variation_.flow) + sum.stop_moves;
    if (!is_driven()) functional.shifts[sensitivity_.orbit().instants().size() - 1] += on_end_shift;
    std::vector<double> values = adjoint.read(functional, end).values;
    for (std::size_t p = 0; p < values.size(); ++p) {
      if (is_driven() && period_failure(p).empty()) values[p] += on_end_shift * period_share(p) * state_.orbit.period;
      values[p] += read_direct(sum, {number_of(p), 0.0, 0.0});
    }
    return values;
  }

 private:
  /// (I − Φ)⁻¹, or its transpose; the least norm where it is singular.
  [[nodiscard]] Vector solve(const Vector& right, bool transposed) const {
    if (right.size() == 0) return right;
    if (free_ == 0) return transposed ? Vector(lu_.transpose().solve(right)) : Vector(lu_.solve(right));
    const Eigen::Index rank = svd_.cols() - free_;
    const auto u = svd_.matrixU().leftCols(rank), v = svd_.matrixV().leftCols(rank);
    const auto s = svd_.singularValues().head(rank);
    if (transposed) return u * Vector(Vector(v.transpose() * right).cwiseQuotient(s));
    return v * Vector(Vector(u.transpose() * right).cwiseQuotient(s));
  }

  [[nodiscard]] int number_of(std::size_t parameter) const { return compiled_.analyses.sensitivities->parameters[parameter].number; }

  /// How the period of one source moves, as a share of it.
  [[nodiscard]] double share_of(std::size_t parameter, const steady::PeriodicSource& source) const {
    double share = 0.0;
    for (const steady::Wave& wave : state_.parameters->parameters[parameter].waves)
      if (wave.source >= 0 && same_name(compiled_.network.sources[static_cast<std::size_t>(wave.source)].label.name, source.name))
        share += steady::period_share(wave);
    return share;
  }
  [[nodiscard]] double period_share(std::size_t parameter) const { return share_of(parameter, state_.common.sources.front()); }

  /// All periodic sources must stretch alike.
  [[nodiscard]] std::string period_failure(std::size_t parameter) const {
    constexpr double same = 1e-12;
    const double share = period_share(parameter);
    for (const steady::PeriodicSource& source : state_.common.sources)
      if (const double own = share_of(parameter, source); std::abs(own - share) > same * (std::abs(own) + std::abs(share)))
        return fmt::format("the periods of {} and {} change differently", state_.common.sources.front().name, source.name);
    return "";
  }

  const Compiled& compiled_;
  const SteadyState& state_;
  const Sensitivity& sensitivity_;
  steady::Variation variation_;
  Eigen::PartialPivLU<Matrix> lu_;
  Eigen::JacobiSVD<Matrix> svd_;  ///< where I − Φ is singular
  Eigen::Index free_ = 0;         ///< directions in which there are other orbits
  bool is_singular_ = false;
};

Derivative entry_of(const std::string& measurement, const SensitivityAnalysis::Parameter& parameter, double value, TwoSided d) {
  if (parameter.value != 0.0 && std::abs(d.left - d.right) * std::abs(parameter.value) < d.noise) {
    d.left = d.right = d.measured;
    d.kink.clear();
  }
  Derivative entry;
  entry.measurement = measurement;
  entry.parameter = parameter.name;
  entry.measured = value;
  entry.value = entry.right = d.right;
  entry.left = d.left;
  entry.normalised = value != 0.0 ? d.right * parameter.value / value : std::numeric_limits<double>::quiet_NaN();
  entry.kink = std::move(d.kink);
  entry.failure = std::move(d.failure);
  entry.is_kink = d.is_kink;
  return entry;
}

/// Measurement by measurement; `columns`: for each parameter those of all measurements.
DerivativeTable table_of(const SensitivityAnalysis& card, const circuit::Measurements& measurements, const std::vector<double>& values,
                         const std::vector<std::vector<TwoSided>>& columns) {
  DerivativeTable table;
  for (std::size_t k = 0; k < measurements.list.size(); ++k) {
    const circuit::Measurement& measurement = measurements.list[k];
    if (!measurement.shown || !card.wants(measurement.name)) continue;
    for (std::size_t p = 0; p < card.parameters.size(); ++p)
      table.push_back(entry_of(measurement.name, card.parameters[p], values[k], columns[p][k]));
  }
  return table;
}

bool are_wanted(const SensitivityAnalysis& card, const circuit::Measurements& measurements) {
  return std::any_of(measurements.list.begin(), measurements.list.end(),
                     [&](const circuit::Measurement& each) { return each.shown && card.wants(each.name); });
}

std::vector<std::vector<TwoSided>> failed_columns(const SensitivityAnalysis& card, const circuit::Measurements& measurements,
                                                  const std::string& why) {
  return {card.parameters.size(), std::vector<TwoSided>(measurements.list.size(), TwoSided::failed(why))};
}

}  // namespace

bool are_interrupted(const DerivativeTable& table) {
  return std::any_of(table.begin(), table.end(), [](const Derivative& each) { return each.failure == interrupted_derivative; });
}

DerivativeTable failed_derivatives(const Compiled& compiled, const circuit::Measurements& measurements, const std::string& failure) {
  const SensitivityAnalysis& card = *compiled.analyses.sensitivities;
  const std::vector<double> values(measurements.list.size(), std::numeric_limits<double>::quiet_NaN());
  return table_of(card, measurements, values, failed_columns(card, measurements, failure));
}

DerivativeTable orbit_derivatives(const Compiled& compiled, const SteadyState& state, const std::atomic<int>& interrupt,
                                  const measure::Record* measured) {
  const SensitivityAnalysis& card = *compiled.analyses.sensitivities;
  const circuit::Measurements& measurements = state.compiled.measurements;
  if (!are_wanted(card, measurements)) return {};
  const bool is_driven = !state.common.sources.empty();
  const engine::ExactModel& model = state.model_with_inputs();
  const LinearisedOrbit linear(model, state.trace_with_inputs(), state.orbit.period, is_driven, state.parameters->names);
  const Sensitivity sensitivity(model, state.trace_with_inputs(), linear, *state.parameters, true);
  RunControl control;
  control.interrupt = &interrupt;
  engine::Request request = request_of(state.compiled.analyses, control);
  request.stop = state.orbit.period;
  request.use_initial_conditions = true;
  const MeasuredPass run =
      measure_run(measurements, state.simulate, request, 0.0, state.orbit.period, most_periods_measured * state.orbit.period, measured);
  if (!run.is_whole)
    return failed_derivatives(compiled, measurements,
                              interrupt != 0 ? interrupted_derivative : "the period could not be followed once more");
  OrbitMoves moves(compiled, state, sensitivity, linear);
  return table_of(card, measurements, run.record.values, derivative_columns(card, run, sensitivity, moves, interrupt));
}

namespace {

/// The orbit that a run starts on.
struct OnOrbit {
  OnOrbit(const Compiled& compiled, const SteadyState& state)
      : linear(state.model_with_inputs(), state.trace_with_inputs(), state.orbit.period, !state.common.sources.empty(),
               state.parameters->names),
        along(state.model_with_inputs(), state.trace_with_inputs(), linear, *state.parameters, true),
        moves(compiled, state, along, linear) {}
  LinearisedOrbit linear;
  Sensitivity along;
  OrbitMoves moves;
};

/// A run of `.tran`, with the parameters as inputs.
class RunDerivatives : public RunMotion {
 public:
  RunDerivatives(const Compiled& compiled, const SteadyState* state, const std::atomic<int>& interrupt, const measure::Record* measured)
      : compiled_(compiled),
        card_(*compiled.analyses.sensitivities),
        orbit_(state),
        interrupt_(interrupt),
        run_(record_run(compiled, state, interrupt, measured)) {}

  DerivativeTable run() {
    if (!run_.failure.empty()) return failed_derivatives(compiled_, compiled_.measurements, run_.failure);
    const double stop = compiled_.analyses.transient->stop.seconds;
    const LinearisedOrbit linear(*run_.model, run_.trace, stop, false, run_.inputs.names);
    const Sensitivity sensitivity(*run_.model, run_.trace, linear, run_.inputs, false);
    linear_ = &linear;
    sensitivity_ = &sensitivity;
    return table_of(card_, compiled_.measurements, run_.measured.record.values,
                    derivative_columns(card_, run_.measured, sensitivity, *this, interrupt_));
  }

  std::string failure(std::size_t p) override { return start_of(p).failure; }

  Forward forward(std::size_t p) override {
    const steady::StartDerivative& start = start_of(p);
    if (!start.failure.empty()) return {{}, {}, start.failure, false};
    return {sensitivity_->follow(p, start.xi), direct_of(p), "", false};
  }

  Forward forward_to_last_rest(std::size_t p) override {
    const steady::StartDerivative& start = start_of(p);
    if (!start.failure.empty()) return {{}, {}, start.failure, false};
    return {sensitivity_->follow_to_last_rest(p, start.xi), direct_of(p), "", false};
  }

  std::vector<double> backward(const MeasuredSum& sum, const steady::Adjoint& adjoint) override {
    steady::Adjoint::Read read = adjoint.read(sum.run, Vector());
    for (std::size_t p = 0; p < read.values.size(); ++p) {
      const steady::StartDerivative& start = start_of(p);
      if (start.failure.empty()) read.values[p] += read.start.dot(start.xi) + read_direct(sum, direct_of(p));
    }
    return std::move(read.values);
  }

 private:
  [[nodiscard]] DirectMoves direct_of(std::size_t p) const {
    const circuit::TransientAnalysis& transient = *compiled_.analyses.transient;
    const int number = card_.parameters[p].number;
    const auto moves = [&](const circuit::TimeValue& time) {
      return number >= 0 && static_cast<std::size_t>(number) < time.gradient.size() ? time.gradient[static_cast<std::size_t>(number)] : 0.0;
    };
    return {number, moves(transient.start), moves(transient.stop)};
  }

  const steady::StartDerivative& start_of(std::size_t p) {
    const auto known = starts_.find(p);
    return known != starts_.end() ? known->second : starts_[p] = find_start_of(p);
  }

  steady::StartDerivative find_start_of(std::size_t p) {
    const steady::ParameterInputs& own = run_.inputs.parameters[p];
    if (!own.failure.empty()) return {{}, own.failure};
    if (orbit_ == nullptr)
      return compiled_.analyses.transient->use_initial_conditions ? steady::of_initial_values(*run_.model, linear_->stacking(), own)
                                                                  : steady::of_operating_point(*run_.model, *linear_, run_.start, own);
    if (!on_orbit_) on_orbit_ = std::make_unique<OnOrbit>(compiled_, *orbit_);
    const OrbitMove move = on_orbit_->moves.of(p);
    if (!move.failure.empty()) return {{}, move.failure};
    return {carried(move.start, on_orbit_->linear.stacking(), linear_->stacking()), ""};
  }

  /// From the orbit's model to that of the run, island by island.
  [[nodiscard]] Vector carried(const Vector& from, const steady::Stacking& there, const steady::Stacking& here) const {
    Vector xi = Vector::Zero(here.size());
    for (std::size_t i = 0; i < run_.model->islands.size(); ++i)
      for (std::size_t k = 0; k < orbit_->model_with_inputs().islands.size(); ++k)
        if (orbit_->model_with_inputs().islands[k].island.name == run_.model->islands[i].island.name && there.count(k) == here.count(i))
          xi.segment(here.first(i), here.count(i)) = from.segment(there.first(k), there.count(k));
    return xi;
  }

  const Compiled& compiled_;
  const SensitivityAnalysis& card_;
  const SteadyState* orbit_;
  const std::atomic<int>& interrupt_;
  const RecordedRun run_;
  const LinearisedOrbit* linear_ = nullptr;
  const Sensitivity* sensitivity_ = nullptr;
  std::map<std::size_t, steady::StartDerivative> starts_;
  std::unique_ptr<OnOrbit> on_orbit_;  ///< where the run starts
};

std::string number_text(double value, int digits) { return digits == 0 ? fmt::format("{}", value) : fmt::format("{:.{}g}", value, digits); }

}  // namespace

DerivativeTable run_derivatives(const Compiled& compiled, const SteadyState* state, const std::atomic<int>& interrupt,
                                const measure::Record* measured) {
  if (!are_wanted(*compiled.analyses.sensitivities, compiled.measurements)) return {};
  return RunDerivatives(compiled, state, interrupt, measured).run();
}

namespace {

DerivativeTable exact_derivatives(const Compiled& compiled, const SteadyState* state, const std::atomic<int>& interrupt,
                                  const MeasuredBefore& measured) {
  DerivativeTable table;
  if (state != nullptr) table = orbit_derivatives(compiled, *state, interrupt, measured.orbit);
  if (!compiled.analyses.transient) return table;
  DerivativeTable more = run_derivatives(compiled, state, interrupt, measured.run);
  table.insert(table.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  return table;
}

/// Of a deck that is another one than that of `state`.
DerivativeTable moved_derivatives(const Compiled& compiled, bool has_orbit, const std::atomic<int>& interrupt) {
  if (!has_orbit) return exact_derivatives(compiled, nullptr, interrupt, {});
  const SteadyState state = find_steady_state(compiled, EngineChoice::modes, interrupt);
  return state.is_found ? exact_derivatives(compiled, &state, interrupt, {}) : DerivativeTable();
}

}  // namespace

DerivativeTable deck_derivatives(const Compiled& compiled, const SteadyState* state, bool is_exact, const std::atomic<int>& interrupt,
                                 const MeasuredBefore& measured) {
  if (is_exact) {
    DerivativeTable table = exact_derivatives(compiled, state, interrupt, measured);
    resolve_kinks(
        compiled, [&](const Compiled& moved) { return moved_derivatives(moved, state != nullptr, interrupt); }, table);
    for (Derivative& each : table)
      if (interrupt != 0 && each.is_kink && !each.failure.empty()) each.failure = interrupted_derivative;
    return table;
  }
  const char* const why = "only the exact engine with dense modes has derivatives; try --engine exact, or fewer stores";
  DerivativeTable table;
  if (state != nullptr) table = failed_derivatives(compiled, compiled.orbit_measurements, why);
  if (!compiled.analyses.transient) return table;
  DerivativeTable more = failed_derivatives(compiled, compiled.measurements, why);
  table.insert(table.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  return table;
}

std::string derivative_text(const DerivativeTable& table, int digits) {
  std::vector<std::vector<std::string>> rows{{"measurement", "parameter", "derivative", "% per %"}};
  for (const Derivative& d : table) {
    if (!d.failure.empty()) {
      rows.push_back({d.measurement, d.parameter, "failed", ""});
      continue;
    }
    std::string value = number_text(d.value, digits);
    if (!d.kink.empty()) value = fmt::format("{} | {}", number_text(d.left, digits), number_text(d.right, digits));
    rows.push_back({d.measurement, d.parameter, value, std::isfinite(d.normalised) ? fmt::format("{:.4g}", d.normalised) : ""});
  }
  std::vector<std::size_t> width(4, 0);
  for (const auto& row : rows)
    for (std::size_t k = 0; k < 4; ++k) width[k] = std::max(width[k], row[k].size());
  std::string text;
  for (const auto& row : rows) {
    std::string line = fmt::format("{:<{}}  {:<{}}  {:<{}}  {}", row[0], width[0], row[1], width[1], row[2], width[2], row[3]);
    while (!line.empty() && line.back() == ' ') line.pop_back();
    text += line + '\n';
  }
  return text;
}

std::vector<std::string> derivative_columns() {
  return {"measurement", "parameter", "derivative", "normalised", "left", "right", "failure"};
}

std::string derivative_csv(const DerivativeTable& table) {
  return fmt::format("{}\n", fmt::join(derivative_columns(), ",")) + derivative_rows(table);
}

std::string derivative_rows(const DerivativeTable& table, const std::string& prefix) {
  std::string text;
  for (const Derivative& d : table) {
    text += prefix + waveform::csv_field(d.measurement) + ',' + waveform::csv_field(d.parameter);
    if (d.failure.empty())
      text += fmt::format(",{},{},{},{},", d.value, std::isfinite(d.normalised) ? fmt::format("{}", d.normalised) : "", d.left, d.right);
    else
      text += ",,,,," + waveform::csv_field(d.failure);
    text += '\n';
  }
  return text;
}

void write_derivatives(JsonWriter& json, const DerivativeTable& table) {
  json.key("sensitivities");
  json.begin_array();
  for (const Derivative& d : table) {
    const auto number = [&](double value) { return d.failure.empty() ? json_number(value) : std::string("null"); };
    json.value(json_line({{"measurement", json_string(d.measurement)},
                          {"parameter", json_string(d.parameter)},
                          {"derivative", number(d.value)},
                          {"normalised", number(d.normalised)},
                          {"left", number(d.left)},
                          {"right", number(d.right)},
                          {"failure", d.failure.empty() ? "null" : json_string(d.failure)}}));
  }
  json.end_array();
}

}  // namespace pwlsim::analysis
