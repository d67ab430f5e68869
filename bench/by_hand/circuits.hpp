#pragma once
/// Three circuits of netlists/ solved by a program that was derived for each by hand: closed forms of every mode, an event where a
/// current or a voltage says so, nothing else. What a general program can at best come near to.
///
/// `Real` is double for the times to compare with, and long double for the solution that errors are taken against.

#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <vector>

namespace pwlsim::by_hand {

/// Inductor current in A and capacitor voltage in V, one a row.
template <class Real>
struct State {
  Real i = 0, v = 0;
};
template <class Real>
using Rows = std::vector<State<Real>>;

/// L i' = u − v,  C v' = i − v/R: the inductor feeds the output, u its other end.
template <class Real>
class Filter {
 public:
  Filter(Real l, Real c, Real r) : l_(l), c_(c), r_(r), alpha_(1 / (2 * r * c)), omega_(std::sqrt(1 / (l * c) - alpha_ * alpha_)) {}

  /// e^{At}, 2 × 2:  e^{−αt} (cos ωt + (A + α) sin ωt / ω).
  struct Flow {
    Real ii, iv, vi, vv;
    State<Real> operator()(State<Real> x) const { return {ii * x.i + iv * x.v, vi * x.i + vv * x.v}; }
  };
  Flow flow(Real t) const {
    const Real e = std::exp(-alpha_ * t), c = e * std::cos(omega_ * t), s = e * std::sin(omega_ * t) / omega_;
    return {c + alpha_ * s, -s / l_, s / c_, c - alpha_ * s};
  }
  State<Real> rest(Real u) const { return {u / r_, u}; }
  /// From x under a constant u.
  State<Real> after(State<Real> x, Real u, const Flow& flow) const {
    const State<Real> end = rest(u), moved = flow({x.i - end.i, x.v - end.v});
    return {end.i + moved.i, end.v + moved.v};
  }
  Real decay(Real t) const { return std::exp(-2 * alpha_ * t); }
  Real l() const { return l_; }
  Real c() const { return c_; }
  Real r() const { return r_; }

 private:
  Real l_, c_, r_, alpha_, omega_;
};

/// Row k of `cycles` periods lies at k·cycles/(rows − 1) periods, rounded to double as the program's time is.
template <class Real>
class RowClock {
 public:
  RowClock(std::uint64_t cycles, std::uint64_t rows, Real period)
      : period_(period), last_(rows - 1), stop_(static_cast<double>(period) * static_cast<double>(cycles)) {
    set();
  }
  /// Whether the next row lies before the end of this cycle.
  [[nodiscard]] bool due(std::uint64_t cycle) const { return row_ <= last_ && phase(cycle) < period_; }
  /// Of the next row, from the start of the cycle.
  [[nodiscard]] Real phase(std::uint64_t cycle) const {
    return static_cast<Real>(time_ - static_cast<long double>(cycle) * static_cast<long double>(period_));
  }
  void next() {
    ++row_;
    set();
  }
  [[nodiscard]] bool is_left() const { return row_ <= last_; }

 private:
  void set() { time_ = stop_ * static_cast<double>(row_) / static_cast<double>(last_); }

  Real period_;
  std::uint64_t last_, row_ = 0;
  double stop_;
  long double time_ = 0;
};

/// A buck converter from rest: u is `input` while the switch is on, from 0 to `on` of each period, then zero until the inductor is empty.
template <class Real>
class Buck {
 public:
  Buck(const Filter<Real>& filter, Real input, Real start, Real on, Real period)
      : f_(filter),
        input_(input),
        start_(start),
        on_(on),
        period_(period),
        to_start_(f_.flow(start)),
        while_on_(f_.flow(on)),
        while_off_(f_.flow(period - on)),
        after_off_(f_.flow(period - start - on)) {}

  Rows<Real> run(std::uint64_t cycles, std::uint64_t rows) const {
    Rows<Real> result;
    RowClock<Real> clock(cycles, rows, period_);
    State<Real> x;  // at the start of the period
    for (std::uint64_t cycle = 0; cycle < cycles; ++cycle) {
      for (; clock.due(cycle); clock.next()) result.push_back(at(x, clock.phase(cycle)));
      x = freewheel(f_.after(freewheel(x, start_, to_start_), input_, while_on_), period_ - start_ - on_, after_off_);
    }
    if (clock.is_left()) result.push_back(x);
    return result;
  }

 private:
  State<Real> at(State<Real> x, Real t) const {
    if (t <= start_) return freewheel(x, t, f_.flow(t));
    x = freewheel(x, start_, to_start_);
    if (t <= start_ + on_) return f_.after(x, input_, f_.flow(t - start_));
    const Real off = t - start_ - on_;
    return freewheel(f_.after(x, input_, while_on_), off, f_.flow(off));
  }
  /// The switch is off for the time t: the diode carries the current until there is none left.
  State<Real> freewheel(State<Real> x, Real t, const typename Filter<Real>::Flow& flow) const {
    if (x.i > 0) {
      const State<Real> end = flow(x);
      if (end.i >= 0) return end;
      // Newton's method from where a constant voltage would have emptied it: i is convex there and i' = −v/L.
      Real empty = std::min(t, f_.l() * x.i / x.v);
      State<Real> there = f_.flow(empty)(x);
      for (int k = 0; k < 8; ++k) {
        const Real step = there.i * f_.l() / there.v;
        empty += step;
        if (std::abs(step) <= 1e-9 * empty) {
          there.v += step * (there.i - there.v / f_.r()) / f_.c();
          break;
        }
        there = f_.flow(empty)(x);
      }
      return {0, there.v * f_.decay(t - empty)};
    }
    return {0, x.v * f_.decay(t)};
  }

  Filter<Real> f_;
  Real input_, start_, on_, period_;
  typename Filter<Real>::Flow to_start_, while_on_, while_off_, after_off_;
};

/// A full-wave bridge: mains V sin ωt through L into C and R; |i| and v.
template <class Real>
class Bridge {
 public:
  Bridge(const Filter<Real>& filter, Real amplitude, Real frequency) : f_(filter), amplitude_(amplitude), period_(1 / frequency) {
    omega_ = 2 * std::numbers::pi_v<Real> * frequency;
    const std::complex<Real> j(0, 1);
    v_ = amplitude / (Real(1) - omega_ * omega_ * f_.l() * f_.c() + j * omega_ * f_.l() / f_.r());
    i_ = v_ * (1 / f_.r() + j * omega_ * f_.c());
  }

  Rows<Real> run(std::uint64_t cycles, std::uint64_t rows) const {
    Rows<Real> result;
    RowClock<Real> clock(cycles, rows, period_);
    Stretch s = conduct(0, {});
    for (std::uint64_t cycle = 0; cycle < cycles; ++cycle) {
      const auto fill = [&](Real end) {
        for (; clock.due(cycle); clock.next()) {
          const Real t = clock.phase(cycle);
          if (t > end) return;
          State<Real> x = at(s, t);
          x.i *= s.sign;
          result.push_back(x);
        }
      };
      while (s.end < period_) {
        fill(s.end);
        State<Real> x = at(s, s.end);
        x.i = 0;
        s = s.sign == 0 || std::abs(mains(s.end)) > x.v ? conduct(s.end, x) : wait(s.end, x.v);
      }
      fill(period_);
      s.start -= period_;
      s.end -= period_;
    }
    if (clock.is_left()) {
      State<Real> x = at(s, 0);
      x.i *= s.sign;
      result.push_back(x);
    }
    return result;
  }

 private:
  /// One mode from `start` to `end`, times within the period; `sign` of the mains that conducts, 0: none does.
  struct Stretch {
    Real start = 0, end = 0;
    int sign = 0;
    State<Real> own;  ///< at the start: of the free part where it conducts, of the whole where not
  };

  State<Real> forced(Real t, int sign) const {
    const std::complex<Real> turn = std::polar(static_cast<Real>(sign), omega_ * t);
    return {(i_ * turn).imag(), (v_ * turn).imag()};
  }
  State<Real> at(const Stretch& s, Real t) const {
    if (s.sign == 0) return {0, s.own.v * f_.decay(t - s.start)};
    const State<Real> free = f_.flow(t - s.start)(s.own), driven = forced(t, s.sign);
    return {free.i + driven.i, free.v + driven.v};
  }
  Real mains(Real t) const { return amplitude_ * std::sin(omega_ * t); }

  Stretch conduct(Real start, State<Real> x) const {
    Stretch s;
    s.start = start;
    s.sign = mains(start) >= 0 ? 1 : -1;
    const State<Real> driven = forced(start, s.sign);
    s.own = {x.i - driven.i, x.v - driven.v};
    // The current has risen and falls through zero once within the half wave and what follows it.
    Real low = start, high = start;
    do {
      low = high;
      high += period_ / 40;
    } while (at(s, high).i > 0);
    s.end = root(low, high, [&](Real t, Real& rate) {
      const State<Real> y = at(s, t);
      rate = (s.sign * mains(t) - y.v) / f_.l();
      return y.i;
    });
    return s;
  }

  /// All diodes block until the rising mains meets the falling voltage.
  Stretch wait(Real start, Real v) const {
    Stretch s;
    s.start = start;
    s.own.v = v;
    const Real half = period_ / 2;
    const bool rises = mains(start) * std::cos(omega_ * start) >= 0;
    Real wave = std::floor(start / half) + (rises ? 0 : 1);
    while (v * f_.decay((wave + Real(0.5)) * half - start) > amplitude_) ++wave;
    const Real low = std::max(start, wave * half), high = (wave + Real(0.5)) * half;
    s.end = root(low, high, [&](Real t, Real& rate) {
      const Real sign = mains((wave + Real(0.5)) * half) > 0 ? 1 : -1, now = v * f_.decay(t - start);
      rate = -now / (f_.r() * f_.c()) - sign * amplitude_ * omega_ * std::cos(omega_ * t);
      return now - sign * mains(t);
    });
    return s;
  }

  /// Where f falls through zero: Newton's method, within its bracket.
  template <class F>
  static Real root(Real low, Real high, const F& f) {
    Real t = (low + high) / 2, rate = 0;
    for (int k = 0; k < 60; ++k) {
      const Real value = f(t, rate);
      (value > 0 ? low : high) = t;
      const Real next = t - value / rate;
      const bool inside = next > low && next < high;
      const Real step = (inside ? next : (low + high) / 2) - t;
      t += step;
      if (inside && std::abs(step) <= 1e-9 * (high - low + std::abs(t))) break;
    }
    return t;
  }

  Filter<Real> f_;
  Real amplitude_, period_, omega_ = 0;
  std::complex<Real> v_, i_;  ///< phasors of the forced solution
};

}  // namespace pwlsim::by_hand
