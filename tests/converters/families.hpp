#pragma once
/// Realistic converters with random values.

#include <cstdint>
#include <string>
#include <vector>

#include "converters/draw.hpp"
#include "converters/netlist.hpp"

namespace pwlsim::test::converters {

struct Family {
  const char* name;
  void (*build)(Draw&, ConverterBuilder&);
};

[[nodiscard]] const std::vector<Family>& families();
[[nodiscard]] const std::vector<Family>& thyristor_families();
/// The same for the same seed; of a family drawn from the seed, of those with thyristors or the others, where `name` is "thyristors" or empty.
[[nodiscard]] Converter make_converter(std::uint64_t seed, const std::string& name = {});

// Parts that families share.

/// A diode and, where it is asked for, a contact: Ron from 0 to 0.1 Ω, Roff from 1e5 Ω to inf.
struct Parts {
  std::size_t diode = 0, contact = 1;
};
[[nodiscard]] Parts add_models(Draw& draw, ConverterBuilder& builder, double least_off = 1e5);
/// Rows that do not meet the edges of the gates; `periods` of the source or gate.
void set_times(Draw& draw, ConverterBuilder& builder, double period, double periods, int rows);
/// A gate from the fraction `from` of its period to the fraction `to`, with a random ramp that is common to the circuit.
struct Clock {
  double period, ramp, dead, offset;
};
[[nodiscard]] Clock draw_clock(Draw& draw, double least_frequency, double most_frequency);
std::size_t add_gate(ConverterBuilder& builder, const Clock& clock, double from, double to);
/// Without a dead time: the ramps pass the threshold together.
std::size_t add_inverse(ConverterBuilder& builder, std::size_t gate);
/// A contact with its body diode.
void transistor(ConverterBuilder& builder, const std::string& plus, const std::string& minus, std::size_t gate, const Parts& parts);

// rectifiers.cpp
void single_phase(Draw& draw, ConverterBuilder& builder);
void three_phase(Draw& draw, ConverterBuilder& builder);
void six_phase(Draw& draw, ConverterBuilder& builder);
void twelve_pulse(Draw& draw, ConverterBuilder& builder);
void vienna(Draw& draw, ConverterBuilder& builder);
void multiplier(Draw& draw, ConverterBuilder& builder);

// thyristors.cpp
void scr_half_wave(Draw& draw, ConverterBuilder& builder);
void scr_bridge(Draw& draw, ConverterBuilder& builder);
void scr_six_pulse(Draw& draw, ConverterBuilder& builder);
void ac_controller(Draw& draw, ConverterBuilder& builder);

// choppers.cpp
void buck(Draw& draw, ConverterBuilder& builder);
void sync_buck(Draw& draw, ConverterBuilder& builder);
void boost(Draw& draw, ConverterBuilder& builder);
void buck_boost(Draw& draw, ConverterBuilder& builder);
void cuk(Draw& draw, ConverterBuilder& builder);
void sepic(Draw& draw, ConverterBuilder& builder);
void zeta(Draw& draw, ConverterBuilder& builder);
void interleaved(Draw& draw, ConverterBuilder& builder);
void charge_pump(Draw& draw, ConverterBuilder& builder);

// isolated.cpp
void flyback(Draw& draw, ConverterBuilder& builder);
void forward(Draw& draw, ConverterBuilder& builder);
void push_pull(Draw& draw, ConverterBuilder& builder);
void half_bridge(Draw& draw, ConverterBuilder& builder);
void full_bridge(Draw& draw, ConverterBuilder& builder);
void llc(Draw& draw, ConverterBuilder& builder);
void dual_active_bridge(Draw& draw, ConverterBuilder& builder);
void class_e(Draw& draw, ConverterBuilder& builder);
void npc(Draw& draw, ConverterBuilder& builder);

}  // namespace pwlsim::test::converters
