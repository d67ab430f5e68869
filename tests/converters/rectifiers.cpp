#include <fmt/format.h>

#include "converters/families.hpp"

namespace pwlsim::test::converters {
namespace {

struct Mains {
  double amplitude, frequency, line;  ///< line: H, 0 for none
};

Mains draw_mains(Draw& draw) {
  return {draw.pick({17.0, 325.0, 170.0, 565.0, draw.logarithmic(5.0, 800.0)}), draw.pick({50.0, 60.0, 400.0}),
          draw.chance(0.5) ? draw.logarithmic(5e-6, 2e-3) : 0.0};
}

/// Smoothing inductor, capacitor and load between two rails.
void load(Draw& draw, ConverterBuilder& builder, const std::string& plus, const std::string& minus, bool choke) {
  std::string out = plus;
  if (choke) {
    out = "out";
    builder.inductor(plus, out, draw.logarithmic(1e-4, 5e-2));
  }
  builder.capacitor(out, minus, draw.logarithmic(1e-5, 2e-3));
  builder.resistor(out, minus, draw.logarithmic(5.0, 500.0));
}

/// Phases in a star, through line inductors or resistors to nodes `prefix`0, `prefix`1, …
void star(Draw& draw, ConverterBuilder& builder, const Mains& mains, int phases, const std::string& prefix, const std::string& neutral,
          double shift) {
  const double value = mains.line > 0.0 ? mains.line : draw.logarithmic(1e-3, 0.5);
  for (int i = 0; i < phases; ++i) {
    const std::string source = fmt::format("{}s{}", prefix, i), line = fmt::format("{}{}", prefix, i);
    builder.source(source, neutral, sine(mains.amplitude, mains.frequency, shift - 360.0 / phases * i));
    if (mains.line > 0.0) {
      builder.inductor(source, line, value);
    } else {
      builder.resistor(source, line, value);
    }
  }
}

void bridge(ConverterBuilder& builder, int legs, const std::string& prefix, const std::string& plus, const std::string& minus) {
  for (int i = 0; i < legs; ++i) {
    const std::string line = fmt::format("{}{}", prefix, i);
    builder.diode(line, plus);
    builder.diode(minus, line);
  }
}

/// A bridge of the issue: the neutral is held by Roff alone.
void polyphase(Draw& draw, ConverterBuilder& builder, int phases) {
  const Mains mains = draw_mains(draw);
  (void)add_models(draw, builder);
  star(draw, builder, mains, phases, "p", "nn", draw.chance(0.5) ? 0.0 : draw.uniform(-180.0, 180.0));
  bridge(builder, phases, "p", "dp", "0");
  load(draw, builder, "dp", "0", mains.line == 0.0 || draw.chance(0.7));
  set_times(draw, builder, 1.0 / mains.frequency, 3.0, 40);
}

}  // namespace

void single_phase(Draw& draw, ConverterBuilder& builder) {
  const Mains mains = draw_mains(draw);
  (void)add_models(draw, builder);
  builder.source("s", "p1", sine(mains.amplitude, mains.frequency, draw.chance(0.5) ? 0.0 : draw.uniform(-90.0, 90.0)));
  if (mains.line > 0.0) {
    builder.inductor("s", "p0", mains.line);
  } else {
    builder.resistor("s", "p0", draw.logarithmic(1e-2, 1.0));
  }
  bridge(builder, 2, "p", "dp", "0");
  load(draw, builder, "dp", "0", draw.chance(0.5));
  if (draw.chance(0.3)) {  // an EMI filter across the line
    builder.resistor("p0", "x", draw.logarithmic(1.0, 100.0));
    builder.capacitor("x", "p1", draw.logarithmic(1e-8, 1e-6));
  }
  set_times(draw, builder, 1.0 / mains.frequency, 5.0, 40);
}

void three_phase(Draw& draw, ConverterBuilder& builder) { polyphase(draw, builder, 3); }
void six_phase(Draw& draw, ConverterBuilder& builder) { polyphase(draw, builder, 6); }

void twelve_pulse(Draw& draw, ConverterBuilder& builder) {
  Mains mains = draw_mains(draw);
  mains.line = draw.logarithmic(2e-5, 2e-3);  // of the transformer: it commutates
  (void)add_models(draw, builder);
  star(draw, builder, mains, 3, "p", "n1", 0.0);
  star(draw, builder, mains, 3, "q", "n2", -30.0);
  const bool series = draw.chance(0.5);
  bridge(builder, 3, "p", "dp", series ? "mid" : "0");
  bridge(builder, 3, "q", series ? "mid" : "dp", "0");
  load(draw, builder, "dp", "0", true);
  set_times(draw, builder, 1.0 / mains.frequency, 2.0, 40);
}

void vienna(Draw& draw, ConverterBuilder& builder) {
  Mains mains = draw_mains(draw);
  mains.line = draw.logarithmic(5e-5, 1e-3);
  mains.frequency = 400.0;
  const Parts parts = add_models(draw, builder);
  star(draw, builder, mains, 3, "p", "nn", 0.0);
  bridge(builder, 3, "p", "dp", "dn");
  Clock clock = draw_clock(draw, 5e3, 2e4);
  for (int i = 0; i < 3; ++i) {  // a two-way contact to the middle, its gates shifted
    const double from = 0.03 + i / 3.0 * 0.9;
    builder.contact(fmt::format("p{}", i), "m", add_gate(builder, clock, from, from + draw.uniform(0.1, 0.7)), parts.contact);
  }
  const double capacitance = draw.logarithmic(2e-5, 1e-3), resistance = draw.logarithmic(10.0, 200.0);
  builder.capacitor("dp", "m", capacitance);
  builder.capacitor("m", "dn", capacitance);
  builder.resistor("dp", "m", resistance);
  builder.resistor("m", "dn", draw.chance(0.5) ? resistance : draw.logarithmic(10.0, 200.0));
  builder.resistor("m", "0", 1000.0);
  set_times(draw, builder, clock.period, 24.0, 40);
}

/// Cockcroft and Walton.
void multiplier(Draw& draw, ConverterBuilder& builder) {
  const Parts parts = add_models(draw, builder);
  Contact& diode = builder.converter.models[parts.diode];
  if (diode.on == 0.0) diode.on = 0.01;
  const double frequency = draw.logarithmic(50.0, 5e4), amplitude = draw.logarithmic(3.0, 1000.0);
  if (draw.chance(0.6)) {
    builder.source("s", "0", sine(amplitude, frequency, 0.0));
  } else {
    const double period = Draw::rounded(1.0 / frequency), ramp = Draw::rounded(period * draw.pick({1e-3, 1e-2, 0.05}));
    Wave wave = pulse(Draw::rounded(period * 0.1), ramp, ramp, Draw::rounded(period / 2 - ramp), period);
    wave.offset = -amplitude;
    wave.high = amplitude;
    builder.source("s", "0", wave);
  }
  builder.resistor("s", "a0", draw.logarithmic(0.1, 50.0));
  const int stages = draw.integer(1, 5);
  const double capacitance = Draw::rounded(1.0 / (frequency * draw.logarithmic(3e2, 3e4)));
  for (int i = 0; i < stages; ++i) {
    const auto name = [](const char* letter, int k) { return fmt::format("{}{}", letter, k); };
    const std::string below = i == 0 ? "0" : name("b", i), push = name("a", i), top = name("a", i + 1), above = name("b", i + 1);
    builder.capacitor(push, top, draw.chance(0.7) ? capacitance : Draw::rounded(capacitance * draw.uniform(0.5, 2.0)));
    builder.diode(below, top);
    builder.capacitor(below, above, capacitance);
    builder.diode(top, above);
  }
  builder.resistor(fmt::format("b{}", stages), "0", Draw::rounded(draw.logarithmic(20.0, 2e3) / (frequency * capacitance)));
  set_times(draw, builder, 1.0 / frequency, 10.0, 40);
}

}  // namespace pwlsim::test::converters
