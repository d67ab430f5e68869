"""A digital power-factor corrector: average-current mode with a multiplier, in a function of Python.

    python3 digital_pfc.py [picture.svg]

A boost converter behind a bridge of ideal diodes draws a current of the form of the mains. Every 20 µs the function sees the rectified voltage, the inductor's current and the
output voltage, in the middle of the time that the switch is closed, where the current is its mean; what it answers holds from the next sample on. python/tests/digital_pfc.cpp is the same in C++, and gives the same numbers to the last bit.
"""

import sys

import pwlsim

MAINS, FREQUENCY, OUTPUT = 325.0, 50.0, 400.0  # V, Hz, V
INDUCTANCE, CAPACITANCE, LOAD = 1e-3, 220e-6, 320.0  # H, F, ohm: 500 W
PERIOD = 20e-6  # s, of the carrier and of the samples
VOLTAGE_KP, VOLTAGE_KI = 0.02, 4e-6  # A/V: of the output voltage, to the current's amplitude
CURRENT_KP, CURRENT_KI = 0.04, 0.002  # 1/A: of the current, to the duty


class Pfc:
    """The state of both loops stays here between samples."""

    def __init__(self):
        self.amplitude = 3.1  # A, integral of the voltage loop
        self.integral = 0.0  # of the current loop

    def __call__(self, t, rectified, current, output):
        error = OUTPUT - output
        self.amplitude = min(max(self.amplitude + VOLTAGE_KI * error, 0.0), 10.0)
        peak = min(max(self.amplitude + VOLTAGE_KP * error, 0.0), 10.0)
        reference = peak * (rectified / MAINS)  # the multiplier
        miss = reference - current
        self.integral = min(max(self.integral + CURRENT_KI * miss, -0.2), 0.2)
        ahead = 1.0 - rectified / output if output > 1.0 else 0.0
        return min(max(ahead + self.integral + CURRENT_KP * miss, 0.0), 0.95)


def circuit():
    pfc = pwlsim.Circuit("digital PFC").voltage_source("Vmains", "l", "n", pwlsim.sine(0, MAINS, FREQUENCY)).resistor("Rn", "n", "0", 1e6)
    for name, anode, cathode in (("D1", "l", "rect"), ("D2", "n", "rect"), ("D3", "0", "l"), ("D4", "0", "n")):
        pfc.diode(name, anode, cathode)
    pfc.inductor("L1", "rect", "sw", INDUCTANCE, ic=0).diode("D5", "sw", "out")
    pfc.capacitor("C1", "out", "0", CAPACITANCE, ic=OUTPUT).resistor("R1", "out", "0", LOAD)
    pfc.voltage_source("Vcarrier", "carrier", "0", pwlsim.pulse(0, 1, rise=PERIOD / 2, fall=PERIOD / 2, width=0, period=PERIOD))
    pfc.voltage_switch("S1", "sw", "0", "duty", "carrier", "gate").model("gate", "SW", Vt=0, Ron=0.05)
    pfc.resistor("Rin", "rect", "0", 1e5)
    pfc.controller(inputs=["v(rect)", "i(L1)", "v(out)"], outputs=["duty"], every=PERIOD, delay=PERIOD, function=Pfc())
    return pfc.save("v(rect)", "v(out)", "i(L1)", "v(duty)").measure("mean", "AVG v(out) FROM=20m")


def run(stop=40e-3):
    return circuit().run(stop=stop, step=1e-4, use_initial_conditions=True)


if __name__ == "__main__":
    result = run()
    print(f"output {result.measurements['mean']:.2f} V, {len(result.events)} events, certificate: KCL/KVL {result.certificate.kcl_kvl:.0e}")
    if len(sys.argv) > 1:
        result.plot("v(rect)", "v(out)", "i(L1)")[0].figure.savefig(sys.argv[1])
