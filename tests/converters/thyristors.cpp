#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "converters/families.hpp"

namespace pwlsim::test::converters {
namespace {

/// A supply whose thyristors fire at one delay angle.
struct Supply {
  double amplitude = 0.0, period = 0.0, phase = 0.0;  ///< degrees
  double line = 0.0;                                  ///< H; 0: `resistance` in its place
  double resistance = 0.0;
  double delay = 0.0, width = 0.0, ramp = 0.0;  ///< degrees from where a diode would begin; of a pulse; s
  bool always_on = false;                       ///< gates on from rest: diodes
};

Supply draw_supply(Draw& draw, ConverterBuilder& builder) {
  Supply supply;
  supply.amplitude = draw.pick({17.0, 325.0, 170.0, 565.0});
  supply.period = draw.pick({0.02, 0.0025});
  supply.phase = draw.pick({0.0, 0.0, 30.0, 37.0, -75.0});
  supply.line = draw.chance(0.5) ? draw.logarithmic(1e-5, 2e-3) : 0.0;
  supply.resistance = draw.logarithmic(1e-2, 0.5);
  supply.delay = draw.pick({0.0, 15.0, 45.0, 90.0, 120.0, draw.uniform(1.0, 150.0)});
  supply.width = draw.pick({0.5, 5.0, 40.0, 70.0, 115.0, 170.0});
  supply.ramp = draw.chance(0.7) ? 0.0 : Draw::rounded(1e-4 * supply.period);
  supply.always_on = draw.chance(0.2);
  const double on = draw.chance(0.4) ? 0.0 : draw.logarithmic(1e-4, 1e-2);
  const double off = draw.chance(0.4) ? infinity : draw.pick({1e6, 1e7, 1e9, 1e12});
  builder.converter.models = {{on, off, draw.chance(0.5) ? 0.0 : draw.pick({0.7, 1.0, 1.5})}};
  return supply;
}

double time_of(const Supply& supply, double degrees) {
  const double turns = degrees / 360.0;
  return Draw::rounded(supply.period * (turns - std::floor(turns)), 7);
}

/// Of the thyristor whose diode would begin `begin` degrees behind the zero of the sine.
std::size_t fire(ConverterBuilder& builder, const Supply& supply, double begin) {
  if (supply.always_on) return builder.gate(constant(1.0));
  const double rest = Draw::rounded(std::max(0.0, supply.width / 360.0 * supply.period - supply.ramp), 5);
  return builder.gate(pulse(time_of(supply, begin + supply.delay - supply.phase), supply.ramp, supply.ramp, rest, supply.period));
}

/// From `from` to `to` through what the line is.
void line(ConverterBuilder& builder, const Supply& supply, const std::string& from, const std::string& to) {
  if (supply.line > 0.0) {
    builder.inductor(from, to, supply.line);
  } else {
    builder.resistor(from, to, supply.resistance);
  }
}

/// What the other signals are compared with where no thyristor fires.
void observe(ConverterBuilder& builder, const Supply& supply, const std::string& plus, const std::string& minus) {
  constexpr double ohms = 1e4;
  builder.resistor(plus, "m", ohms);
  builder.capacitor("m", minus, Draw::rounded(0.2 * supply.period / ohms));
}

double frequency(const Supply& supply) { return 1.0 / supply.period; }

/// R (seen through R and C), R and L, R and L at a battery, or R beside C behind a choke; true: an inductor is in the way of the current.
bool load(Draw& draw, ConverterBuilder& builder, const Supply& supply, const std::string& plus, const std::string& minus) {
  const double ohms = draw.logarithmic(1.0, 100.0);
  const double seconds = supply.period * draw.logarithmic(0.02, 5.0);
  switch (draw.integer(0, 3)) {
    case 0:
      builder.resistor(plus, minus, ohms);
      builder.resistor(plus, "w", 100.0 * ohms);
      builder.capacitor("w", minus, Draw::rounded(seconds / (100.0 * ohms)));
      return false;
    case 1:
      builder.inductor(plus, "l", Draw::rounded(seconds * ohms));
      builder.resistor("l", minus, ohms);
      return true;
    case 2:
      builder.inductor(plus, "l", Draw::rounded(seconds * ohms));
      builder.resistor("l", "e", ohms);
      builder.source("e", minus, constant(Draw::rounded(supply.amplitude * draw.uniform(0.1, 0.7))));
      return true;
    default:
      builder.inductor(plus, "l", Draw::rounded(0.1 * seconds * ohms));
      builder.capacitor("l", minus, Draw::rounded(seconds / ohms));
      builder.resistor("l", minus, ohms);
      return true;
  }
}

/// A holding current does not part an inductor from its path.
double holding(Draw& draw, const Supply& supply, bool inductive) {
  return inductive || supply.line > 0.0 || draw.chance(0.4) ? 0.0 : draw.pick({1e-3, 0.02, 0.1});
}

void end(Draw& draw, ConverterBuilder& builder, const Supply& supply) {
  set_times(draw, builder, supply.period, draw.pick({2.2, 3.3}), 40);
}

/// Behind Roff = inf the integrator, which has a large number for it, would charge the capacitor where nothing else does.
void snub(Draw& draw, ConverterBuilder& builder, const std::string& plus, const std::string& minus, const std::string& inner) {
  Contact& model = builder.converter.models.front();
  model.off = std::min(model.off, 1e9);
  builder.resistor(plus, inner, draw.logarithmic(10.0, 200.0));
  builder.capacitor(inner, minus, draw.logarithmic(1e-8, 5e-7));
}

/// A source from `minus`, and its line to `phase`.
Supply single_phase(Draw& draw, ConverterBuilder& builder, const std::string& minus, const std::string& phase) {
  const Supply supply = draw_supply(draw, builder);
  builder.source("s", minus, sine(supply.amplitude, frequency(supply), supply.phase));
  observe(builder, supply, "s", minus);
  line(builder, supply, "s", phase);
  return supply;
}

}  // namespace

void scr_half_wave(Draw& draw, ConverterBuilder& builder) {
  const Supply supply = single_phase(draw, builder, "0", "p");
  const bool inductive = load(draw, builder, supply, "dp", "0");
  builder.thyristor("p", "dp", fire(builder, supply, 0.0), holding(draw, supply, inductive));
  if (draw.chance(0.4)) builder.diode("0", "dp");
  if (draw.chance(0.2)) snub(draw, builder, "p", "dp", "sn");
  end(draw, builder, supply);
}

/// Four thyristors, or two and two diodes in one leg each or in each leg.
void scr_bridge(Draw& draw, ConverterBuilder& builder) {
  const Supply supply = single_phase(draw, builder, "b", "a");
  const bool inductive = load(draw, builder, supply, "dp", "0");
  const double least = holding(draw, supply, inductive);
  const std::size_t first = fire(builder, supply, 0.0), second = fire(builder, supply, 180.0);
  const int kind = draw.integer(0, 3);
  builder.thyristor("a", "dp", first, least);
  if (kind == 1) {
    builder.diode("b", "dp");
    builder.thyristor("0", "a", second, least);
    builder.diode("0", "b");
  } else {
    builder.thyristor("b", "dp", second, least);
    if (kind == 0) {
      builder.diode("0", "a");
      builder.diode("0", "b");
    } else {
      builder.thyristor("0", "a", second, least);
      builder.thyristor("0", "b", first, least);
    }
  }
  if (draw.chance(0.25)) builder.diode("0", "dp");
  if (draw.chance(0.2)) snub(draw, builder, "a", "b", "sn");
  end(draw, builder, supply);
}

/// Three phases: six thyristors with pulses of 70 degrees at least, or three and three diodes; or three that feed a load between them and the neutral.
void scr_six_pulse(Draw& draw, ConverterBuilder& builder) {
  Supply supply = draw_supply(draw, builder);
  if (supply.width < 70.0) supply.width = 70.0;
  const std::string neutral = draw.chance(0.7) ? "nn" : "0", minus = "0";
  const bool inductive = load(draw, builder, supply, "dp", minus);
  const double least = holding(draw, supply, inductive);
  observe(builder, supply, "s0", neutral);
  const bool half = draw.chance(0.25);
  for (int i = 0; i < 3; ++i) {
    const std::string source = fmt::format("s{}", i), phase = fmt::format("p{}", i);
    builder.source(source, neutral, sine(supply.amplitude, frequency(supply), supply.phase - 120.0 * i));
    line(builder, supply, source, phase);
    const double begin = 30.0 + 120.0 * i;
    builder.thyristor(phase, "dp", fire(builder, supply, begin), least);
    if (neutral == minus) continue;
    if (half) {
      builder.diode(minus, phase);
    } else {
      builder.thyristor(minus, phase, fire(builder, supply, begin + 180.0), least);
    }
  }
  if (draw.chance(0.2)) builder.diode(minus, "dp");
  end(draw, builder, supply);
}

/// Two thyristors back to back, as in a triac, between a supply and an R-L load.
void ac_controller(Draw& draw, ConverterBuilder& builder) {
  const Supply supply = single_phase(draw, builder, "0", "a");
  builder.thyristor("a", "o", fire(builder, supply, 0.0));
  builder.thyristor("o", "a", fire(builder, supply, 180.0));
  (void)load(draw, builder, supply, "o", "0");
  if (draw.chance(0.4)) snub(draw, builder, "a", "o", "sn");
  end(draw, builder, supply);
}

}  // namespace pwlsim::test::converters
