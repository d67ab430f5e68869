// The inductor of a buck converter: the ripple of its current at each duty, and when the current ends in each period at light load.
//
//     buck [inductance in H]
//
// Shows: a circuit built in code; a sweep by a loop; measurements, waveforms, events and the certificate of a run; errors.
// Each number stands beside the textbook's (Erickson and Maksimović, Fundamentals of Power Electronics, chapters 2 and 5):
//     ripple, peak to peak             Vin D (1 - D) T / L
//     end of the current, light load   D T Vin / Vout

#include <pwlsim/pwlsim.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

constexpr double input = 24.0, period = 10e-6;

/// 1. The circuit: an ideal switch and an ideal diode; the output capacitor is so large that its voltage is a source.
pwlsim::Circuit buck(double duty, double inductance, double output) {
  pwlsim::Circuit circuit("buck converter");
  circuit.voltage_source("V1", "in", "0", input)
      .voltage_source("VG", "gate", "0", pwlsim::pulse({.high = 1, .width = duty * period, .period = period}))
      .voltage_switch("S1", "in", "sw", "gate", "0", "ideal")
      .model("ideal", "SW", {{"Vt", 0.5}})
      .diode("D1", "0", "sw")
      .inductor("L1", "sw", "out", inductance)
      .voltage_source("VO", "out", "0", output)
      .save({"v(sw)", "i(L1)"})
      .measure("ripple", "PP i(L1)");
  return circuit;
}

/// 2. Whether a number is what the textbook says, to one part in 10^9.
bool agrees(double value, double expected) { return std::abs(value - expected) <= 1e-9 * std::abs(expected); }

/// 3. Continuous conduction: the current begins at 100 A and comes back to it.
bool print_ripple(double duty, double inductance) {
  pwlsim::Circuit circuit = buck(duty, inductance, duty * input);
  circuit.initial_current("L1", 100);
  const pwlsim::Result result = circuit.run({.stop = 5 * period, .use_initial_conditions = true});

  const double ripple = result.measurement("ripple");
  const double expected = input * duty * (1.0 - duty) * period / inductance;
  std::printf("%4.2f  %12.9f A  %12.9f A   %zu events, KCL/KVL to %.0e\n", duty, ripple, expected, result.events().size(),
              result.certificate().kcl_kvl);
  return agrees(ripple, expected) && agrees(result.signal("i(L1)").back(), 100.0);
}

/// 4. Light load: the current ends within each period, and the diode turns off by itself.
bool print_light_load(double duty, double inductance, double output) {
  const pwlsim::Result result = buck(duty, inductance, output).run({.stop = period, .use_initial_conditions = true});
  const double expected = duty * period * input / output;
  bool good = false;
  for (const pwlsim::Event& event : result.events()) {
    std::printf("t = %.9f us:", event.time * 1e6);
    for (const std::string& name : event.turned_on) std::printf(" %s on", name.c_str());
    for (const std::string& name : event.turned_off) std::printf(" %s off", name.c_str());
    std::printf("\n");
    good = good || (event.turned_off == std::vector<std::string>{"D1"} && agrees(event.time, expected));
  }
  std::printf("the textbook's end of the current: %.9f us\n", expected * 1e6);
  return good;
}

}  // namespace

int main(int argument_count, char** arguments) try {
  const double inductance = argument_count > 1 ? std::atof(arguments[1]) : 47e-6;
  std::printf("duty        ripple        textbook\n");
  bool good = true;
  for (const double duty : {0.1, 0.25, 0.5, 0.75, 0.9}) good = print_ripple(duty, inductance) && good;
  good = print_light_load(0.4, inductance, 15.0) && good;
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
} catch (const pwlsim::Error& error) {  // 5. All that is wrong, each with its id, its place and a cure.
  std::fprintf(stderr, "%s", error.what());
  return EXIT_FAILURE;
}
