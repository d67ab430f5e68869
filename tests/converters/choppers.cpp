#include <fmt/format.h>

#include "converters/families.hpp"

namespace pwlsim::test::converters {
namespace {

constexpr double chopper_periods = 24.0;
constexpr int chopper_rows = 40;

/// Values that belong together: a clock, a supply, a load, an inductor and a capacitor of suitable sizes.
struct Stage {
  Parts parts;
  Clock clock;
  double volts, ohms, henry, farad, duty;
};

Stage draw_stage(Draw& draw, ConverterBuilder& builder) {
  Stage stage{};
  stage.parts = add_models(draw, builder);
  stage.clock = draw_clock(draw, 5e3, 5e5);
  stage.volts = draw.pick({5.0, 12.0, 24.0, 48.0, 400.0, draw.logarithmic(3.0, 800.0)});
  stage.ohms = draw.logarithmic(0.5, 200.0);
  stage.henry = Draw::rounded(stage.ohms * stage.clock.period * draw.logarithmic(0.05, 5.0));  // continuous and discontinuous
  stage.farad = Draw::rounded(stage.clock.period / stage.ohms * draw.logarithmic(2.0, 50.0));
  stage.duty = draw.uniform(0.15, 0.75);
  return stage;
}

/// The supply, behind an input filter at times.
std::string supply(Draw& draw, ConverterBuilder& builder, const Stage& stage) {
  builder.source("in", "0", constant(stage.volts));
  if (!draw.chance(0.3)) return "in";
  builder.inductor("in", "fi", Draw::rounded(stage.henry * draw.logarithmic(0.05, 0.5)));
  builder.capacitor("fi", "0", Draw::rounded(stage.farad * draw.logarithmic(0.1, 1.0)), stage.volts);
  builder.resistor("in", "fi", Draw::rounded(stage.ohms * draw.logarithmic(0.5, 5.0)));
  return "fi";
}

/// A resistor and a capacitor in series across a part, at times.
void snubber(Draw& draw, ConverterBuilder& builder, const std::string& plus, const std::string& minus, const Stage& stage) {
  if (!draw.chance(0.25)) return;
  const std::string middle = "sn" + plus;
  const double ohms = draw.logarithmic(2.0, 100.0);
  builder.resistor(plus, middle, ohms);
  builder.capacitor(middle, minus, Draw::rounded(stage.clock.period / ohms * draw.logarithmic(1e-4, 1e-2)));
}

void output(Draw& draw, ConverterBuilder& builder, const std::string& plus, const std::string& minus, const Stage& stage) {
  if (draw.chance(0.3)) {  // a capacitor with series resistance
    builder.resistor(plus, "esr", Draw::rounded(stage.ohms * draw.logarithmic(1e-4, 1e-2)));
    builder.capacitor("esr", minus, stage.farad);
  } else {
    builder.capacitor(plus, minus, stage.farad);
  }
  builder.resistor(plus, minus, stage.ohms);
}

void finish(Draw& draw, ConverterBuilder& builder, const Stage& stage) {
  set_times(draw, builder, stage.clock.period, chopper_periods, chopper_rows);
}

/// Behind the switches of a buck.
void filter(Draw& draw, ConverterBuilder& builder, const Stage& stage) {
  snubber(draw, builder, "sw", "0", stage);
  builder.inductor("sw", "out", stage.henry);
  output(draw, builder, "out", "0", stage);
  finish(draw, builder, stage);
}

}  // namespace

void buck(Draw& draw, ConverterBuilder& builder) {
  const Stage stage = draw_stage(draw, builder);
  const std::string in = supply(draw, builder, stage);
  builder.contact(in, "sw", add_gate(builder, stage.clock, 0.02, 0.02 + stage.duty), stage.parts.contact);
  builder.diode("0", "sw");
  filter(draw, builder, stage);
}

void sync_buck(Draw& draw, ConverterBuilder& builder) {
  const Stage stage = draw_stage(draw, builder);
  const std::string in = supply(draw, builder, stage);
  const double dead = stage.clock.dead / stage.clock.period;
  const std::size_t high = add_gate(builder, stage.clock, dead, dead + stage.duty);
  if (draw.chance(0.4)) {  // complementary, without body diodes at times
    const std::size_t low = add_inverse(builder, high);
    const bool body = draw.chance(0.5);
    builder.contact(in, "sw", high, stage.parts.contact);
    builder.contact("sw", "0", low, stage.parts.contact);
    if (body) builder.diode("0", "sw");
  } else {
    transistor(builder, in, "sw", high, stage.parts);
    transistor(builder, "sw", "0", add_gate(builder, stage.clock, 2 * dead + stage.duty, 1.0), stage.parts);
  }
  filter(draw, builder, stage);
}

void boost(Draw& draw, ConverterBuilder& builder) {
  const Stage stage = draw_stage(draw, builder);
  const std::string in = supply(draw, builder, stage);
  builder.inductor(in, "sw", stage.henry);
  builder.contact("sw", "0", add_gate(builder, stage.clock, 0.02, 0.02 + stage.duty), stage.parts.contact);
  builder.diode("sw", "out");
  snubber(draw, builder, "sw", "0", stage);
  output(draw, builder, "out", "0", stage);
  finish(draw, builder, stage);
}

void buck_boost(Draw& draw, ConverterBuilder& builder) {
  const Stage stage = draw_stage(draw, builder);
  const std::string in = supply(draw, builder, stage);
  if (draw.chance(0.5)) {
    builder.contact(in, "sw", add_gate(builder, stage.clock, 0.02, 0.02 + stage.duty), stage.parts.contact);
    builder.inductor("sw", "0", stage.henry);
    builder.diode("out", "sw");
    snubber(draw, builder, "sw", "0", stage);
  } else {  // not inverting: two contacts, two diodes
    const std::size_t gate = add_gate(builder, stage.clock, 0.02, 0.02 + stage.duty);
    builder.contact(in, "sw", gate, stage.parts.contact);
    builder.diode("0", "sw");
    builder.inductor("sw", "sx", stage.henry);
    builder.contact("sx", "0", draw.chance(0.5) ? gate : add_gate(builder, stage.clock, 0.05, 0.05 + stage.duty / 2), stage.parts.contact);
    builder.diode("sx", "out");
  }
  output(draw, builder, "out", "0", stage);
  finish(draw, builder, stage);
}

namespace {

double coupling_capacitance(Draw& draw, const Stage& stage) {
  return Draw::rounded(stage.clock.period / stage.ohms * draw.logarithmic(0.5, 20.0));
}

/// Two inductors, coupled at times.
void couple(Draw& draw, ConverterBuilder& builder, const std::string& one, const std::string& other) {
  if (draw.chance(0.3)) builder.couple({one, other}, draw.pick({0.5, 0.9, 0.97, 0.99}));
}

}  // namespace

void cuk(Draw& draw, ConverterBuilder& builder) {
  const Stage stage = draw_stage(draw, builder);
  const std::string in = supply(draw, builder, stage);
  const std::string first = builder.inductor(in, "a", stage.henry);
  builder.contact("a", "0", add_gate(builder, stage.clock, 0.02, 0.02 + stage.duty), stage.parts.contact);
  builder.capacitor("a", "b", coupling_capacitance(draw, stage));
  builder.diode("b", "0");
  const std::string second = builder.inductor("b", "out", Draw::rounded(stage.henry * draw.uniform(0.5, 2.0)));
  couple(draw, builder, first, second);
  output(draw, builder, "out", "0", stage);
  finish(draw, builder, stage);
}

void sepic(Draw& draw, ConverterBuilder& builder) {
  const Stage stage = draw_stage(draw, builder);
  const std::string in = supply(draw, builder, stage);
  const std::string first = builder.inductor(in, "a", stage.henry);
  builder.contact("a", "0", add_gate(builder, stage.clock, 0.02, 0.02 + stage.duty), stage.parts.contact);
  builder.capacitor("a", "b", coupling_capacitance(draw, stage));
  const std::string second = builder.inductor("b", "0", Draw::rounded(stage.henry * draw.uniform(0.5, 2.0)));
  couple(draw, builder, first, second);
  builder.diode("b", "out");
  output(draw, builder, "out", "0", stage);
  finish(draw, builder, stage);
}

void zeta(Draw& draw, ConverterBuilder& builder) {
  const Stage stage = draw_stage(draw, builder);
  const std::string in = supply(draw, builder, stage);
  builder.contact(in, "a", add_gate(builder, stage.clock, 0.02, 0.02 + stage.duty), stage.parts.contact);
  const std::string first = builder.inductor("a", "0", stage.henry);
  builder.capacitor("a", "b", coupling_capacitance(draw, stage));
  builder.diode("0", "b");
  const std::string second = builder.inductor("b", "out", Draw::rounded(stage.henry * draw.uniform(0.5, 2.0)));
  couple(draw, builder, first, second);
  output(draw, builder, "out", "0", stage);
  finish(draw, builder, stage);
}

void interleaved(Draw& draw, ConverterBuilder& builder) {
  Stage stage = draw_stage(draw, builder);
  const std::string in = supply(draw, builder, stage);
  const int phases = draw.integer(2, 4);
  const bool up = draw.chance(0.5);
  std::vector<std::string> inductors;
  for (int i = 0; i < phases; ++i) {
    const std::string node = fmt::format("sw{}", i);
    const double from = 0.02 + static_cast<double>(i) / phases;
    const std::size_t gate = add_gate(builder, stage.clock, from, from + stage.duty);
    if (up) {
      inductors.push_back(builder.inductor(in, node, stage.henry));
      builder.contact(node, "0", gate, stage.parts.contact);
      builder.diode(node, "out");
    } else {
      builder.contact(in, node, gate, stage.parts.contact);
      builder.diode("0", node);
      inductors.push_back(builder.inductor(node, "out", stage.henry));
    }
  }
  if (phases == 2 && draw.chance(0.5)) builder.couple(inductors, draw.pick({-0.3, -0.6, -0.9, 0.5}));
  output(draw, builder, "out", "0", stage);
  finish(draw, builder, stage);
}

/// Dickson's, or a doubler of four contacts.
void charge_pump(Draw& draw, ConverterBuilder& builder) {
  Stage stage = draw_stage(draw, builder);
  for (Contact& model : builder.converter.models)
    if (model.on == 0.0) model.on = 0.02;
  stage.ohms *= 20.0;
  const double fly = Draw::rounded(stage.clock.period / stage.ohms * draw.logarithmic(5.0, 200.0));
  builder.source("in", "0", constant(stage.volts));
  if (draw.chance(0.5)) {
    const double dead = stage.clock.dead / stage.clock.period;
    const std::size_t charge = add_gate(builder, stage.clock, dead, 0.5), push = add_gate(builder, stage.clock, 0.5 + dead, 1.0);
    builder.resistor("in", "i", draw.logarithmic(1e-2, 1.0));
    builder.contact("i", "a", charge, stage.parts.contact);
    builder.contact("b", "0", charge, stage.parts.contact);
    builder.contact("i", "b", push, stage.parts.contact);
    builder.contact("a", "out", push, stage.parts.contact);
    builder.capacitor("a", "b", fly);
  } else {
    const double period = stage.clock.period, ramp = Draw::rounded(period * draw.pick({1e-3, 1e-2}));
    const double edge = 0.1 * period;
    const int stages = draw.integer(1, 4);
    for (int k = 0; k < 2; ++k) {
      Wave wave = pulse(Draw::rounded(edge + k * period / 2, 5), ramp, ramp, Draw::rounded(period / 2 - ramp, 5), period);
      wave.high = stage.volts;
      builder.source(fmt::format("c{}", k), "0", wave);
      builder.resistor(fmt::format("c{}", k), fmt::format("d{}", k), draw.logarithmic(0.1, 20.0));
    }
    std::string before = "in";
    for (int i = 0; i < stages; ++i) {
      const std::string node = fmt::format("n{}", i);
      builder.diode(before, node);
      builder.capacitor(node, fmt::format("d{}", i % 2), fly);
      before = node;
    }
    builder.diode(before, "out");
  }
  builder.capacitor("out", "0", Draw::rounded(fly * draw.logarithmic(1.0, 10.0)));
  builder.resistor("out", "0", Draw::rounded(stage.ohms));
  finish(draw, builder, stage);
}

}  // namespace pwlsim::test::converters
