#pragma once
/// Functions of time that sources follow: plain data, SI units.

#include <cstdint>
#include <limits>
#include <variant>
#include <vector>

namespace pwlsim::model {

inline constexpr double forever = std::numeric_limits<double>::infinity();

struct Dc {
  double value = 0.0;
  bool operator==(const Dc&) const = default;
};

/// offset + amplitude·exp(−damping·(t−delay))·sin(2π·frequency·(t−delay) + phase) from `delay` on, for `cycles` periods
/// (infinite by default); before `delay`, and after the last cycle, the value offset + amplitude·sin(phase) (SPICE; LTspice for cycles).
struct Sin {
  double offset = 0.0, amplitude = 0.0, frequency = 0.0, delay = 0.0, damping = 0.0;
  double phase = 0.0;  ///< radians
  double cycles = forever;
  bool operator==(const Sin&) const = default;
};

/// Edge n starts at delay + n·period. rise, fall = 0: a true jump. period = forever: one pulse. width = forever: stays at `pulsed`.
struct Pulse {
  double initial = 0.0, pulsed = 0.0, delay = 0.0, rise = 0.0, fall = 0.0, width = forever, period = forever;
  double cycles = forever;
  bool operator==(const Pulse&) const = default;
};

/// Corner points (time, value), times not decreasing; equal times are a true jump. Constant before the first and after the last point.
/// repeats > 0: after the last point the part from `repeat_from` on is repeated that often (infinite: forever).
struct Pwl {
  struct Point {
    double time = 0.0, value = 0.0;
    bool operator==(const Point&) const = default;
  };
  std::vector<Point> points;
  double repeats = 0.0;
  double repeat_from = 0.0;
  bool operator==(const Pwl&) const = default;
};

/// v1 until td1; v1 + (v2−v1)(1−e^{−(t−td1)/tau1}) until td2; plus (v1−v2)(1−e^{−(t−td2)/tau2}) from td2 on.
struct Exp {
  double v1 = 0.0, v2 = 0.0, td1 = 0.0, tau1 = 0.0, td2 = 0.0, tau2 = 0.0;
  bool operator==(const Exp&) const = default;
};

/// `value` until the run sets another one (engine::Sampler); `channel` is its name there.
struct Held {
  double value = 0.0;
  int channel = 0;
  bool operator==(const Held&) const = default;
};

/// Zero: what a small input and its derivatives would do is read from the columns of their states, w^(k) = rate^k·(state k).
struct SmallInput {
  double rate = 1.0;  ///< 1/s
  int states =
      8;  ///< its value and so many derivatives less one. The extraction differentiates six times at most (E-index), a mode seldom more than once
  bool operator==(const SmallInput&) const = default;
};

using SourceFunction = std::variant<Dc, Sin, Pulse, Pwl, Exp, Held, SmallInput>;

}  // namespace pwlsim::model
