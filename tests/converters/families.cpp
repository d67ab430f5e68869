#include "converters/families.hpp"

#include <algorithm>
#include <utility>

namespace pwlsim::test::converters {

const std::vector<Family>& families() {
  static const std::vector<Family> result{
      {"single-phase", single_phase},
      {"three-phase", three_phase},
      {"six-phase", six_phase},
      {"twelve-pulse", twelve_pulse},
      {"vienna", vienna},
      {"multiplier", multiplier},
      {"buck", buck},
      {"sync-buck", sync_buck},
      {"boost", boost},
      {"buck-boost", buck_boost},
      {"cuk", cuk},
      {"sepic", sepic},
      {"zeta", zeta},
      {"interleaved", interleaved},
      {"charge-pump", charge_pump},
      {"flyback", flyback},
      {"forward", forward},
      {"push-pull", push_pull},
      {"half-bridge", half_bridge},
      {"full-bridge", full_bridge},
      {"llc", llc},
      {"dual-active-bridge", dual_active_bridge},
      {"class-e", class_e},
      {"npc", npc},
  };
  return result;
}

const std::vector<Family>& thyristor_families() {
  static const std::vector<Family> result{
      {"scr-half-wave", scr_half_wave},
      {"scr-bridge", scr_bridge},
      {"scr-six-pulse", scr_six_pulse},
      {"ac-controller", ac_controller},
  };
  return result;
}

Converter make_converter(std::uint64_t seed, const std::string& name) {
  Draw draw(seed);
  const std::vector<Family>& all = name == "thyristors" ? thyristor_families() : families();
  const Family* family = &all[draw.bits() % all.size()];
  if (!name.empty() && name != "thyristors") {
    family = nullptr;
    for (const auto* list : {&families(), &thyristor_families()})
      for (const Family& one : *list)
        if (name == one.name) family = &one;
    if (family == nullptr) return {};
  }
  ConverterBuilder builder(family->name);
  family->build(draw, builder);
  return std::move(builder.converter);
}

Parts add_models(Draw& draw, ConverterBuilder& builder, double least_off) {
  const double on = draw.chance(0.15) ? 0.0 : draw.logarithmic(1e-3, 0.1);
  const auto off = [&] {
    if (draw.chance(0.2)) return infinity;
    return draw.chance(0.6) ? draw.pick({1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e12}) : draw.logarithmic(1e5, 1e12);
  };
  const double drop = draw.chance(0.25) ? 0.0 : draw.pick({0.3, 0.4, 0.55, 0.7, 0.85, 1.0});
  builder.converter.models = {{on, std::max(off(), least_off), drop},
                              {draw.chance(0.5) ? on : draw.logarithmic(1e-3, 0.1), std::max(off(), least_off), 0.0}};
  return {};
}

void set_times(Draw& draw, ConverterBuilder& builder, double period, double periods, int rows) {
  builder.converter.fast = period;
  // An odd fraction, so that no row lies on an edge of a gate.
  builder.converter.row_step = Draw::rounded(period * periods / rows * (0.97 + 0.0271828 * draw.unit()), 5);
  builder.converter.stop = Draw::rounded(builder.converter.row_step * rows, 9);
}

Clock draw_clock(Draw& draw, double least_frequency, double most_frequency) {
  Clock clock{};
  clock.period = 1.0 / draw.logarithmic(least_frequency, most_frequency);
  clock.period = Draw::rounded(clock.period);
  clock.ramp = draw.chance(0.4) ? 0.0 : Draw::rounded(clock.period * draw.pick({1e-4, 1e-3, 1e-2}));
  clock.dead = Draw::rounded(clock.period * draw.uniform(0.012, 0.05));
  clock.offset = draw.chance(0.5) ? 0.0 : Draw::rounded(clock.period * draw.unit());
  return clock;
}

std::size_t add_gate(ConverterBuilder& builder, const Clock& clock, double from, double to) {
  const double delay = Draw::rounded(clock.offset + clock.period * from, 5);
  const double width = Draw::rounded(std::max(0.0, clock.period * (to - from) - clock.ramp), 5);
  return builder.gate(pulse(delay, clock.ramp, clock.ramp, width, clock.period));
}

std::size_t add_inverse(ConverterBuilder& builder, std::size_t gate) {
  Wave wave = builder.converter.gates[gate];
  std::swap(wave.offset, wave.high);
  return builder.gate(wave);
}

void transistor(ConverterBuilder& builder, const std::string& plus, const std::string& minus, std::size_t gate, const Parts& parts) {
  builder.contact(plus, minus, gate, parts.contact);
  builder.diode(minus, plus, parts.diode);
}

}  // namespace pwlsim::test::converters
