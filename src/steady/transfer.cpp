#include "steady/transfer.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "linalg/factorisations.hpp"
#include "steady/tolerances.hpp"

namespace pwlsim::steady {
namespace {

using model::Mode;
using model::System;

constexpr Complex j{0.0, 1.0};

/// ∫ e^{−jωt} dt from `begin` on.
Complex phase_integral(double omega, double begin, double length) {
  if (omega == 0.0) return length;
  return (std::exp(-j * omega * (begin + length)) - std::exp(-j * omega * begin)) / (-j * omega);
}

/// e^M by scaling and squaring of its Taylor series.
ComplexMatrix exponential(const ComplexMatrix& m) {
  const double norm = m.cwiseAbs().rowwise().sum().maxCoeff();
  const int halvings = norm > 0.5 ? static_cast<int>(std::ceil(std::log2(norm / 0.5))) : 0;
  const ComplexMatrix scaled = m / std::ldexp(1.0, halvings);
  ComplexMatrix sum = ComplexMatrix::Identity(m.rows(), m.cols()), term = sum;
  constexpr int terms = 18;
  for (int k = 1; k <= terms; ++k) {
    term = scaled * term / static_cast<double>(k);
    sum += term;
  }
  for (int k = 0; k < halvings; ++k) sum = sum * sum;
  return sum;
}

ComplexMatrix shifted(const Mode& mode, double omega) {
  ComplexMatrix m = mode.flow.a().topLeftCorner(mode.n1, mode.n1).cast<Complex>();
  m.diagonal().array() -= j * omega;
  return m;
}

/// Columns of the mode's matrix for inputs of these amplitudes: w^(k) = (jω)^k w.
template <class Rows>
auto input_columns(const LinearisedOrbit& orbit, std::size_t island, const Rows& rows, int first, double omega,
                   const std::vector<Complex>& amplitudes) {
  ComplexVector sum = ComplexVector::Zero(rows.rows());
  for (std::size_t k = 0; k < orbit.inputs(); ++k) {
    const InputColumns& column = orbit.columns(island, k);
    if (column.value < 0 || amplitudes[k] == 0.0) continue;
    Complex derivative = amplitudes[k];
    for (int order = 0; order < column.count; ++order, derivative *= j * omega / column.rate)
      sum += derivative * rows.col(first + column.value + order).template cast<Complex>();
  }
  return sum;
}

/// (A − jω)⁻¹
struct Inverse {
  Eigen::PartialPivLU<ComplexMatrix> factors;
  double least = 0.0;  ///< 1/‖(A − jω)⁻¹‖

  /// Where a pivot is zero (an integrator at ω = 0) its estimate means nothing.
  explicit Inverse(const ComplexMatrix& m) : factors(m) {
    if (m.size() > 0 && factors.matrixLU().diagonal().cwiseAbs().minCoeff() > 0.0)
      least = factors.rcond() * m.cwiseAbs().colwise().sum().maxCoeff();
  }
  [[nodiscard]] ComplexVector solve(const ComplexVector& b) const { return factors.solve(b); }
};

}  // namespace

/// One period at one frequency.
struct Transfer::Pass {
  double omega = 0.0, omega_out = 0.0;  ///< of the input; m·ω_s of the harmonic asked for
  std::vector<Complex> amplitudes;      ///< in force
  const TimeShifts& moved;
  ComplexVector r;     ///< of all islands
  ComplexVector sums;  ///< T·c_m of the signals
  bool collects = false;
  std::optional<double> sample;  ///< s: the deviation at that time of the period in place of its mean
  std::map<const Mode*, Inverse> inverse, inverse_out;
  std::map<std::pair<const Mode*, double>, Slow> slow;
  std::vector<Complex> deltas{};  ///< δt̂ of each change of an instant, before any of them moves the deviation

  void take_amplitudes(double time) {
    for (std::size_t k = 0; k < amplitudes.size() && moved.amplitude; ++k) amplitudes[k] = moved.amplitude(k, time);
  }
};

Transfer::Transfer(const LinearisedOrbit& orbit, std::size_t signals) : orbit_(orbit), signals_(signals) {
  // Φ column by column, by passes without inputs at ω = 0.
  const Eigen::Index n = orbit.stacking().size();
  monodromy_ = Matrix::Zero(n, n);
  const std::vector<Complex> none(orbit.inputs(), 0.0);
  const TimeShifts still;
  for (Eigen::Index k = 0; k < n; ++k) {
    Pass pass{0.0, 0.0, none, still, ComplexVector::Zero(n), {}, false, std::nullopt, {}, {}, {}};
    pass.r[k] = 1.0;
    run(pass);
    monodromy_.col(k) = pass.r.real();
  }
}

const Matrix& Transfer::propagator(const Mode& mode, double length) {
  Matrix& known = propagators_[{&mode, length}];
  if (known.size() == 0) {
    known = mode.flow.minus_identity(length).topLeftCorner(mode.n1, mode.n1);
    known.diagonal().array() += 1.0;
  }
  return known;
}

/// c at the end of a stretch that begins like the segment, and ∫ e^{−jω_out t} c dt over it.
Transfer::Travelled Transfer::travel(const LinearSegment& s, double length, const ComplexVector& c0, const ComplexVector& b, Pass& pass) {
  const Mode& mode = *s.mode;
  const Complex turn = std::exp(-j * pass.omega * length);
  Travelled stretch{turn * (propagator(mode, length) * c0), ComplexVector::Zero(mode.n1)};
  if (mode.n1 == 0 || (b.isZero(0.0) && !pass.collects)) return stretch;
  const double total = pass.omega + pass.omega_out;
  const auto inverse_of = [&](auto& known, double omega) -> const Inverse& {
    auto it = known.find(&mode);
    if (it == known.end()) it = known.emplace(&mode, Inverse(shifted(mode, omega))).first;
    return it->second;
  };
  const auto& inverse = inverse_of(pass.inverse, pass.omega);
  const auto& inverse_out = pass.omega_out == 0.0 ? inverse : inverse_of(pass.inverse_out, total);
  const auto can_solve = [&](const Inverse& factors) { return factors.least * length > tolerance::brief_stretch; };
  const Complex turn0 = std::exp(-j * pass.omega_out * s.begin), turn1 = std::exp(-j * pass.omega_out * (s.begin + length));
  if (can_solve(inverse) && can_solve(inverse_out)) {
    stretch.end += inverse.solve(ComplexVector(turn * (propagator(mode, length) * b) - b));
    if (pass.collects)
      stretch.integral =
          inverse_out.solve(ComplexVector(turn1 * stretch.end - turn0 * c0 - phase_integral(pass.omega_out, s.begin, length) * b));
    return stretch;
  }
  if (FlowSeries::is_slow(pass.omega, length) && FlowSeries::is_slow(total, length)) {
    const auto& [whole, whole_out, rest] = slow_of(mode, length, pass);
    stretch.end += whole * b;
    if (pass.collects) stretch.integral = turn0 * (whole_out * c0 + rest * b);
    return stretch;
  }
  return travel_by_exponential(s, length, c0, b, pass);
}

/// σ = e^{−jω_out t}c, its input, and the integral of σ, in one exponential.
Transfer::Travelled Transfer::travel_by_exponential(const LinearSegment& s, double length, const ComplexVector& c0, const ComplexVector& b,
                                                    const Pass& pass) {
  const Complex turn0 = std::exp(-j * pass.omega_out * s.begin), turn1 = std::exp(-j * pass.omega_out * (s.begin + length));
  const Eigen::Index n = s.mode->n1;
  ComplexMatrix m = ComplexMatrix::Zero(2 * n + 1, 2 * n + 1);
  m.topLeftCorner(n, n) = shifted(*s.mode, pass.omega + pass.omega_out);
  m.block(0, n, n, 1) = b;
  m(n, n) = -j * pass.omega_out;
  m.bottomLeftCorner(n, n).setIdentity();
  ComplexVector start = ComplexVector::Zero(2 * n + 1);
  start.head(n) = turn0 * c0;
  start[n] = turn0;
  const ComplexVector end = exponential(m * length) * start;
  return {end.head(n) / turn1, end.tail(n)};
}

const Transfer::Slow& Transfer::slow_of(const Mode& mode, double length, Pass& pass) {
  const std::pair key(&mode, length);
  const auto known = pass.slow.find(key);
  if (known != pass.slow.end()) return known->second;
  auto series = series_.find(key);
  if (series == series_.end()) series = series_.emplace(key, FlowSeries(mode.flow.a().topLeftCorner(mode.n1, mode.n1), length)).first;
  Slow slow{series->second.integral(pass.omega), {}, {}};
  if (pass.omega_out == 0.0) {
    slow.whole_out = slow.whole;
    slow.rest = length * slow.whole - series->second.moment(pass.omega);
  } else {
    slow.whole_out = series->second.integral(pass.omega + pass.omega_out);
    slow.rest = (std::exp(-j * pass.omega_out * length) * slow.whole - slow.whole_out) / (-j * pass.omega_out);
  }
  return pass.slow.emplace(key, std::move(slow)).first->second;
}

void Transfer::segment(const LinearSegment& s, Pass& pass) {
  const Mode& mode = *s.mode;
  const Stacking& stacking = orbit_.stacking();
  const System& system = stacking.system(s.island);
  auto block = pass.r.segment(stacking.first(s.island), stacking.count(s.island));
  pass.take_amplitudes(s.begin + 0.5 * s.length);
  const ComplexVector b = input_columns(orbit_, s.island, mode.flow.a(), mode.n1, pass.omega, pass.amplitudes).head(mode.n1);
  const ComplexVector c0 = mode.constrained ? ComplexVector(mode.basis.transpose() * block) : ComplexVector(block);
  const Travelled stretch = travel(s, s.length, c0, b, pass);
  if (pass.collects) {
    const ComplexVector direct = input_columns(orbit_, s.island, mode.outputs, mode.n1, pass.omega, pass.amplitudes);
    ComplexVector sum = mode.outputs.leftCols(mode.n1) * stretch.integral + phase_integral(pass.omega_out, s.begin, s.length) * direct;
    if (pass.sample) {
      const bool holds = *pass.sample >= s.begin && *pass.sample < s.begin + s.length;
      sum.setZero();
      if (holds) sum = direct + mode.outputs.leftCols(mode.n1) * travel(s, *pass.sample - s.begin, c0, b, pass).end;
    }
    for (std::size_t k = 0; k < system.outputs.size(); ++k) pass.sums[system.output_signal[k]] += sum[static_cast<Eigen::Index>(k)];
  }
  if (!mode.constrained)
    block = stretch.end;
  else
    block = mode.basis * stretch.end + input_columns(orbit_, s.island, mode.lift, 0, pass.omega, pass.amplitudes);
}

/// δt̂ of a guard.
Complex Transfer::guard_shift(const LinearGuard& guard, const Pass& pass) const {
  Complex delta = 0.0;
  for (std::size_t k = 0; k < guard.on_w.size(); ++k) delta += pass.amplitudes[k] * (guard.on_w[k] + j * pass.omega * guard.on_slope[k]);
  for (Eigen::Index k = 0; k < guard.on_derivatives.rows(); ++k)
    for (Eigen::Index order = 0; order < guard.on_derivatives.cols(); ++order)
      delta += pass.amplitudes[static_cast<std::size_t>(k)] * std::pow(j * pass.omega, static_cast<int>(order) + 2) *
               guard.on_derivatives(k, order);
  if (guard.island < 0) return delta;
  const Stacking& stacking = orbit_.stacking();
  const auto island = static_cast<std::size_t>(guard.island);
  return delta + (guard.on_state.cast<Complex>() * pass.r.segment(stacking.first(island), stacking.count(island))).value();
}

void Transfer::instant(const LinearInstant& at, const Complex& shift, Pass& pass) {
  const Stacking& stacking = orbit_.stacking();
  const double near = tolerance::just_beside * orbit_.period();
  pass.take_amplitudes(at.time > near ? at.time - near : orbit_.period() - near);
  const Complex first = shift + guard_shift(at, pass);
  pass.deltas.clear();
  for (const LinearChange& change : at.changes) pass.deltas.push_back(change.own ? guard_shift(*change.own, pass) : first);
  auto next = pass.deltas.cbegin();
  const Complex turn = std::exp(-j * pass.omega_out * at.time);
  pass.take_amplitudes(at.time + near);
  for (const LinearChange& change : at.changes) {
    const Complex delta = *next++;
    const int n = stacking.count(change.island);
    const System& system = stacking.system(change.island);
    auto block = pass.r.segment(stacking.first(change.island), n);
    auto impulse = change.impulses.begin();
    for (std::size_t way = 0; way < change.by_way_of.size(); ++way) {
      const Mode* const mode = change.by_way_of[way];
      if (!mode->constrained || n == 0) continue;
      // δQ̂ − j(ω + mω_s) Q δt̂
      for (; impulse != change.impulses.end() && impulse->way == way; ++impulse) {
        if (!pass.collects || pass.sample) continue;
        const ComplexVector inputs = input_columns(orbit_, change.island, impulse->on, n, pass.omega, pass.amplitudes);
        const Complex size = (impulse->on.head(n).cast<Complex>() * block).value() + inputs[0] + impulse->rate * delta;
        pass.sums[system.output_signal[static_cast<std::size_t>(impulse->output)]] +=
            turn * (size - j * (pass.omega + pass.omega_out) * impulse->size * delta);
      }
      block = mode->projector.topLeftCorner(n, n) * block +
              input_columns(orbit_, change.island, mode->projector, n, pass.omega, pass.amplitudes).head(n);
    }
    block += change.d * delta;
    if (!pass.collects || pass.sample) continue;
    for (std::size_t k = 0; k < system.outputs.size(); ++k)
      pass.sums[system.output_signal[k]] += turn * delta * change.outputs[static_cast<Eigen::Index>(k)];
  }
}

void Transfer::run(Pass& pass) {
  for (std::size_t i = 0; i < orbit_.instants().size(); ++i) {
    const LinearInstant& at = orbit_.instants()[i];
    for (const LinearSegment& s : at.segments) segment(s, pass);
    instant(at, i < pass.moved.shifts.size() ? pass.moved.shifts[i] : Complex(0.0), pass);
  }
  for (const LinearSegment& s : orbit_.tail()) segment(s, pass);
}

/// With C(ω) = 1 − e^{−jωT}Φ, C(ω₀)v = 0 and u*C(ω₀) = 0, the start r of C r = g has a limit for ω → ω₀ if u*g(ω₀) = 0: r = C⁺g + V z, and the
/// derivative of the equation, with u*C′ = jT u*, gives z: jT u*(C⁺g + V z) = u*g′. g is an entire function of ω, so that differences give g′.
std::optional<ComplexVector> Transfer::start_in_resonance(const Pass& pass, const ComplexMatrix& closing) {
  if (!pass.moved.shifts.empty() || pass.moved.amplitude) return std::nullopt;  // they depend on ω, too
  const double period = orbit_.period();
  const Eigen::JacobiSVD<ComplexMatrix> svd(closing, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const auto& values = svd.singularValues();
  const double least = tolerance::resonant_direction * std::max(1.0, values[0]);
  const Eigen::Index free = (values.array() <= least).count(), rank = values.size() - free;
  if (free == 0) return std::nullopt;
  const ComplexMatrix u = svd.matrixU().rightCols(free), v = svd.matrixV().rightCols(free);
  const auto excited = [&](double turns) {
    Pass other{pass.omega + 2.0 * std::numbers::pi * turns / period,
               0.0,
               pass.amplitudes,
               pass.moved,
               ComplexVector::Zero(closing.rows()),
               {},
               false,
               std::nullopt,
               {},
               {},
               {}};
    run(other);
    return ComplexVector(u.adjoint() * other.r);
  };
  double size = pass.r.norm();
  for (const double turns : {0.25, 0.5, 0.75}) size = std::max(size, excited(turns).norm());
  if (!((u.adjoint() * pass.r).norm() <= tolerance::unexcited_direction * size)) return std::nullopt;
  constexpr double near = 1e-3;  // of a turn: what the differences leave out is of the order of (2π·near)⁴
  const ComplexVector slope = (8.0 * (excited(near) - excited(-near)) - (excited(2.0 * near) - excited(-2.0 * near))) *
                              (period / (12.0 * near * 2.0 * std::numbers::pi));
  const ComplexVector least_norm =
      svd.matrixV().leftCols(rank) * (svd.matrixU().leftCols(rank).adjoint() * pass.r).cwiseQuotient(values.head(rank).cast<Complex>());
  const Eigen::FullPivLU<ComplexMatrix> along(u.adjoint() * v);
  if (!(along.rcond() > tolerance::resonant_direction)) return std::nullopt;  // it grows with the square of the time
  return least_norm + v * along.solve(ComplexVector(slope / (j * period) - u.adjoint() * least_norm));
}

Transfer::Response Transfer::at(double frequency, int harmonic, const std::vector<Complex>& amplitudes, const TimeShifts& shifts,
                                std::optional<double> sample) {
  const Eigen::Index n = orbit_.stacking().size();
  const double omega = 2.0 * std::numbers::pi * frequency;
  const double period = orbit_.period();
  Pass pass{omega, 2.0 * std::numbers::pi * harmonic / period, amplitudes, shifts, ComplexVector::Zero(n), {}, false, std::nullopt, {}, {},
            {}};
  run(pass);
  Response response;
  ComplexMatrix closing = -std::exp(-j * omega * period) * monodromy_.cast<Complex>();
  closing.diagonal().array() += 1.0;
  const Eigen::PartialPivLU<ComplexMatrix> lu(closing);
  response.signals = ComplexVector::Zero(static_cast<Eigen::Index>(signals_));
  const double norm = n > 0 ? closing.cwiseAbs().colwise().sum().maxCoeff() : 1.0;
  response.is_singular = n > 0 && !(lu.rcond() * norm > tolerance::singular_response * std::max(1.0, norm));
  if (response.is_singular) {
    const std::optional<ComplexVector> start = start_in_resonance(pass, closing);
    if (!start) {
      constexpr double none = std::numeric_limits<double>::quiet_NaN();
      response.signals.setConstant(Complex(none, none));
      return response;
    }
    response.is_singular = false;
    pass.r = *start;
  } else {
    pass.r = n > 0 ? ComplexVector(lu.solve(pass.r)) : pass.r;
  }
  pass.collects = true;
  pass.sums = response.signals;
  pass.sample = sample;
  run(pass);
  response.signals = sample ? pass.sums : ComplexVector(pass.sums / period);
  return response;
}

}  // namespace pwlsim::steady
