// The digital PFC of examples/python/digital_pfc.py with its controller in C++: rows of v(out), i(L1) and v(duty), in hexadecimal.
#include <pwlsim/pwlsim.hpp>

#include <algorithm>
#include <cstdio>

namespace {

constexpr double mains = 325.0, frequency = 50.0, output_voltage = 400.0;  // V, Hz, V
constexpr double inductance = 1e-3, capacitance = 220e-6, load = 320.0;    // H, F, ohm
constexpr double period = 20e-6;                                           // s
constexpr double voltage_kp = 0.02, voltage_ki = 4e-6;                     // A/V
constexpr double current_kp = 0.04, current_ki = 0.002;                    // 1/A

double limited(double value, double low, double high) { return std::min(std::max(value, low), high); }

/// The same operations in the same order: each product is rounded before it is added, as in Python.
struct Pfc {
  double amplitude = 3.1, integral = 0.0;

  double operator()(double rectified, double current, double output) {
    const volatile double error = output_voltage - output;
    const volatile double slow = voltage_ki * error, quick = voltage_kp * error;
    amplitude = limited(amplitude + slow, 0.0, 10.0);
    const double peak = limited(amplitude + quick, 0.0, 10.0);
    const volatile double reference = peak * (rectified / mains);
    const volatile double miss = reference - current;
    const volatile double more = current_ki * miss, now = current_kp * miss;
    integral = limited(integral + more, -0.2, 0.2);
    const volatile double ahead = output > 1.0 ? 1.0 - rectified / output : 0.0;
    return limited(ahead + integral + now, 0.0, 0.95);
  }
};

}  // namespace

int main() {
  pwlsim::Circuit circuit("digital PFC");
  circuit.voltage_source("Vmains", "l", "n", pwlsim::sine({.offset = 0, .amplitude = mains, .frequency = frequency}))
      .resistor("Rn", "n", "0", 1e6)
      .diode("D1", "l", "rect")
      .diode("D2", "n", "rect")
      .diode("D3", "0", "l")
      .diode("D4", "0", "n")
      .inductor("L1", "rect", "sw", inductance, {{"ic", 0}})
      .diode("D5", "sw", "out")
      .capacitor("C1", "out", "0", capacitance, {{"ic", output_voltage}})
      .resistor("R1", "out", "0", load)
      .voltage_source("Vcarrier", "carrier", "0",
                      pwlsim::pulse({.low = 0, .high = 1, .rise = period / 2, .fall = period / 2, .width = 0, .period = period}))
      .voltage_switch("S1", "sw", "0", "duty", "carrier", "gate")
      .model("gate", "SW", {{"Vt", 0}, {"Ron", 0.05}})
      .resistor("Rin", "rect", "0", 1e5);
  Pfc pfc;
  circuit.controller(
      {.inputs = {"v(rect)", "i(L1)", "v(out)"},
       .outputs = {"duty"},
       .every = period,
       .delay = period,
       .function = [&pfc](double, const std::vector<double>& in, std::vector<double>& out) { out[0] = pfc(in[0], in[1], in[2]); }});
  circuit.save({"v(rect)", "v(out)", "i(L1)", "v(duty)"}).measure("mean", "AVG v(out) FROM=20m");
  const pwlsim::Result result = circuit.run({.stop = 40e-3, .step = 1e-4, .use_initial_conditions = true});
  const auto &out = result.signal("v(out)"), &current = result.signal("i(L1)"), &duty = result.signal("v(duty)");
  for (std::size_t k = 0; k < out.size(); ++k) std::printf("%a %a %a\n", out[k], current[k], duty[k]);
}
