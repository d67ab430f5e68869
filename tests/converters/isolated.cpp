#include <fmt/format.h>

#include <cmath>

#include "converters/families.hpp"

namespace pwlsim::test::converters {
namespace {

constexpr double isolated_periods = 20.0;
constexpr int isolated_rows = 40;

struct TransformerStage {
  Parts parts;
  Clock clock;
  double volts, ohms, magnetizing, farad, ratio, duty, factor;
};

/// `ratio`: secondary turns by primary turns; `factor`: coupling.
TransformerStage draw_transformer_stage(Draw& draw, ConverterBuilder& builder) {
  TransformerStage stage{};
  stage.parts = add_models(draw, builder);
  stage.clock = draw_clock(draw, 2e4, 3e5);
  stage.volts = draw.pick({12.0, 24.0, 48.0, 325.0, 400.0});
  stage.ohms = draw.logarithmic(0.5, 100.0);
  stage.ratio = draw.logarithmic(0.1, 2.0);
  stage.magnetizing = Draw::rounded(stage.ohms / (stage.ratio * stage.ratio) * stage.clock.period * draw.logarithmic(0.2, 10.0));
  stage.farad = Draw::rounded(stage.clock.period / stage.ohms * draw.logarithmic(2.0, 50.0));
  stage.duty = draw.uniform(0.15, 0.43);
  stage.factor = draw.pick({0.95, 0.98, 0.99, 0.995});
  builder.source("in", "0", constant(stage.volts));
  return stage;
}

double secondary(const TransformerStage& stage) { return Draw::rounded(stage.magnetizing * stage.ratio * stage.ratio, 6); }

void output(ConverterBuilder& builder, const std::string& plus, const TransformerStage& stage) {
  builder.capacitor(plus, "0", stage.farad);
  builder.resistor(plus, "0", stage.ohms);
}

/// Resistor and capacitor that take the energy of the leakage inductance.
void snubber(Draw& draw, ConverterBuilder& builder, const std::string& plus, const std::string& minus, const TransformerStage& stage) {
  const std::string middle = "sn" + plus;
  const double ohms = Draw::rounded(stage.ohms / (stage.ratio * stage.ratio) * draw.logarithmic(0.1, 3.0));
  builder.resistor(plus, middle, ohms);
  builder.capacitor(middle, minus, Draw::rounded(stage.clock.period / ohms * draw.logarithmic(1e-3, 3e-2)));
}

void finish(Draw& draw, ConverterBuilder& builder, const TransformerStage& stage) {
  set_times(draw, builder, stage.clock.period, isolated_periods, isolated_rows);
}

/// Two transistors in a leg that conduct half of a period each, but for the dead time, if there is one.
void leg(Draw& draw, ConverterBuilder& builder, const TransformerStage& stage, const std::string& plus, const std::string& middle,
         const std::string& minus, double shift) {
  const double dead = stage.clock.dead / stage.clock.period;
  const std::size_t high = add_gate(builder, stage.clock, shift + dead, shift + 0.5);
  const std::size_t low = draw.chance(0.15) ? add_inverse(builder, high) : add_gate(builder, stage.clock, shift + 0.5 + dead, shift + 1.0);
  transistor(builder, plus, middle, high, stage.parts);
  transistor(builder, middle, minus, low, stage.parts);
}

void diode_bridge(ConverterBuilder& builder, const std::string& a, const std::string& b, const std::string& plus) {
  builder.diode(a, plus);
  builder.diode("0", a);
  builder.diode(b, plus);
  builder.diode("0", b);
}

/// Both halves of a secondary with its middle at ground, each with a diode.
void centre_tap(ConverterBuilder& builder, const TransformerStage& stage, std::vector<std::string> windings, const std::string& plus) {
  windings.push_back(builder.inductor("sa", "0", secondary(stage)));
  windings.push_back(builder.inductor("0", "sb", secondary(stage)));
  builder.couple(windings, stage.factor);
  builder.diode("sa", plus);
  builder.diode("sb", plus);
}

/// Behind the rectifier of a converter with an inductor.
void filter(Draw& draw, ConverterBuilder& builder, const TransformerStage& stage) {
  builder.inductor("f", "out", Draw::rounded(stage.ohms * stage.clock.period * draw.logarithmic(0.2, 5.0)));
  output(builder, "out", stage);
  finish(draw, builder, stage);
}

}  // namespace

void flyback(Draw& draw, ConverterBuilder& builder) {
  TransformerStage stage = draw_transformer_stage(draw, builder);
  const bool perfect = draw.chance(0.3);
  if (perfect) stage.factor = 1.0;
  const std::string primary = builder.inductor("in", "sw", stage.magnetizing);
  builder.contact("sw", "0", add_gate(builder, stage.clock, 0.02, 0.02 + 1.5 * stage.duty), stage.parts.contact);
  if (!perfect || draw.chance(0.5)) snubber(draw, builder, "sw", "0", stage);
  const std::string winding = builder.inductor("0", "s", secondary(stage));
  builder.couple({primary, winding}, stage.factor);
  builder.diode("s", "out");
  output(builder, "out", stage);
  finish(draw, builder, stage);
}

void forward(Draw& draw, ConverterBuilder& builder) {
  const TransformerStage stage = draw_transformer_stage(draw, builder);
  const std::size_t gate = add_gate(builder, stage.clock, 0.02, 0.02 + stage.duty);
  builder.contact("in", "pa", gate, stage.parts.contact);  // two transistors, two diodes that reset the core
  builder.contact("pb", "0", gate, stage.parts.contact);
  builder.diode("0", "pa");
  builder.diode("pb", "in");
  const std::string primary = builder.inductor("pa", "pb", stage.magnetizing);
  const std::string winding = builder.inductor("s", "0", secondary(stage));
  builder.couple({primary, winding}, stage.factor);
  builder.diode("s", "f");
  builder.diode("0", "f");
  filter(draw, builder, stage);
}

void push_pull(Draw& draw, ConverterBuilder& builder) {
  const TransformerStage stage = draw_transformer_stage(draw, builder);
  std::vector<std::string> windings{builder.inductor("in", "a", stage.magnetizing), builder.inductor("b", "in", stage.magnetizing)};
  transistor(builder, "a", "0", add_gate(builder, stage.clock, 0.02, 0.02 + stage.duty), stage.parts);
  transistor(builder, "b", "0", add_gate(builder, stage.clock, 0.52, 0.52 + stage.duty), stage.parts);
  snubber(draw, builder, "a", "0", stage);
  snubber(draw, builder, "b", "0", stage);
  centre_tap(builder, stage, windings, "f");
  filter(draw, builder, stage);
}

void half_bridge(Draw& draw, ConverterBuilder& builder) {
  const TransformerStage stage = draw_transformer_stage(draw, builder);
  leg(draw, builder, stage, "in", "sw", "0", 0.0);
  const double half = Draw::rounded(stage.farad * stage.ratio * stage.ratio * draw.logarithmic(1.0, 10.0));
  builder.resistor("in", "cin", draw.logarithmic(1e-2, 0.5));
  builder.capacitor("cin", "mid", half, Draw::rounded(stage.volts / 2));
  builder.capacitor("mid", "0", half, Draw::rounded(stage.volts / 2));
  const std::string primary = builder.inductor("sw", "mid", stage.magnetizing);
  centre_tap(builder, stage, {primary}, "f");
  filter(draw, builder, stage);
}

void full_bridge(Draw& draw, ConverterBuilder& builder) {
  const TransformerStage stage = draw_transformer_stage(draw, builder);
  leg(draw, builder, stage, "in", "a", "0", 0.0);
  leg(draw, builder, stage, "in", "b", "0", draw.uniform(0.1, 0.5));
  const std::string primary = builder.inductor("a", "b", stage.magnetizing);
  if (draw.chance(0.5)) {
    centre_tap(builder, stage, {primary}, "f");
  } else {
    builder.couple({primary, builder.inductor("sa", "sb", secondary(stage))}, stage.factor);
    diode_bridge(builder, "sa", "sb", "f");
  }
  filter(draw, builder, stage);
}

void llc(Draw& draw, ConverterBuilder& builder) {
  const TransformerStage stage = draw_transformer_stage(draw, builder);
  leg(draw, builder, stage, "in", "sw", "0", 0.0);
  // The resonance of the series inductor and capacitor lies near the clock's frequency.
  const double series = Draw::rounded(stage.magnetizing / draw.logarithmic(3.0, 10.0));
  const double angle = stage.clock.period / (2 * 3.141592653589793) * draw.uniform(0.7, 1.3);
  builder.capacitor("sw", "r", Draw::rounded(angle * angle / series));
  builder.inductor("r", "p", series);
  const std::string primary = builder.inductor("p", "0", stage.magnetizing);
  if (draw.chance(0.5)) {
    centre_tap(builder, stage, {primary}, "out");
  } else {
    builder.couple({primary, builder.inductor("sa", "sb", secondary(stage))}, stage.factor);
    diode_bridge(builder, "sa", "sb", "out");
  }
  output(builder, "out", stage);
  finish(draw, builder, stage);
}

void dual_active_bridge(Draw& draw, ConverterBuilder& builder) {
  const TransformerStage stage = draw_transformer_stage(draw, builder);
  leg(draw, builder, stage, "in", "a", "0", 0.0);
  leg(draw, builder, stage, "in", "b", "0", 0.5);
  builder.inductor("a", "p", Draw::rounded(stage.magnetizing / draw.logarithmic(5.0, 50.0)));
  const std::string primary = builder.inductor("p", "b", stage.magnetizing);
  builder.couple({primary, builder.inductor("sa", "sb", secondary(stage))}, stage.factor);
  const double shift = draw.uniform(0.06, 0.25);
  leg(draw, builder, stage, "out", "sa", "0", shift);
  leg(draw, builder, stage, "out", "sb", "0", shift + 0.5);
  output(builder, "out", stage);
  finish(draw, builder, stage);
}

void class_e(Draw& draw, ConverterBuilder& builder) {
  const TransformerStage stage = draw_transformer_stage(draw, builder);
  const double load = draw.logarithmic(2.0, 60.0), angle = stage.clock.period / (2 * 3.141592653589793);
  builder.inductor("in", "d", Draw::rounded(load * stage.clock.period * draw.uniform(3.0, 20.0)));
  const std::size_t gate = add_gate(builder, stage.clock, 0.02, 0.52);
  // The contact meets a charged capacitor: its resistance limits the current.
  builder.contact("d", "m", gate, stage.parts.contact);
  builder.resistor("m", "0", draw.logarithmic(1e-2, 0.2));
  builder.diode("0", "d");
  builder.capacitor("d", "0", Draw::rounded(0.1836 * angle / load * draw.uniform(0.7, 1.5)));
  const double quality = draw.uniform(4.0, 12.0), henry = Draw::rounded(quality * load * angle);
  builder.inductor("d", "x", henry);
  builder.capacitor("x", "o", Draw::rounded(angle * angle / henry * draw.uniform(1.05, 1.3)));
  builder.resistor("o", "0", load);
  finish(draw, builder, stage);
}

/// One leg of three levels with a neutral-point clamp.
void npc(Draw& draw, ConverterBuilder& builder) {
  const TransformerStage stage = draw_transformer_stage(draw, builder);
  const double dead = stage.clock.dead / stage.clock.period, duty = stage.duty;
  builder.resistor("in", "top", draw.logarithmic(1e-2, 0.2));
  const double half = Draw::rounded(stage.farad * draw.logarithmic(2.0, 20.0));
  builder.capacitor("top", "mid", half, Draw::rounded(stage.volts / 2));
  builder.capacitor("mid", "0", half, Draw::rounded(stage.volts / 2));
  // The outer contacts alternate; each inner one conducts while the outer one of the other half does not.
  const std::size_t upper = add_gate(builder, stage.clock, dead, dead + duty),
                    lower = add_gate(builder, stage.clock, 0.5 + dead, 0.5 + dead + duty);
  const std::size_t inner_upper = add_gate(builder, stage.clock, 0.5 + 2 * dead + duty, 1.5);
  const std::size_t inner_lower = add_gate(builder, stage.clock, 2 * dead + duty, 1.0);
  transistor(builder, "top", "u", upper, stage.parts);
  transistor(builder, "u", "o", inner_upper, stage.parts);
  transistor(builder, "o", "l", inner_lower, stage.parts);
  transistor(builder, "l", "0", lower, stage.parts);
  builder.diode("mid", "u");
  builder.diode("l", "mid");
  builder.inductor("o", "x", Draw::rounded(stage.ohms * stage.clock.period * draw.logarithmic(0.1, 2.0)));
  builder.capacitor("x", "mid", stage.farad);
  builder.resistor("x", "mid", stage.ohms);
  finish(draw, builder, stage);
}

}  // namespace pwlsim::test::converters
