"""Sampled controllers beside recursions between samples by scipy's matrix exponential, and beside the same function in C++."""

import importlib
import os
import pickle
import subprocess

import numpy as np
import pytest

import pwlsim

TO_ROUNDING = 1e-9  # of a signal's largest value, over some hundred periods

SWITCH = {"Vt": 0.0, "Ron": 0.0}
pytestmark = pytest.mark.filterwarnings("ignore:W-coarse-rows")  # rows at the samples alone


class Buck:
    """12 V to 5 V; the switch is closed while the duty is above a carrier that rises from 0 to 1 in each period."""

    vin, inductance, capacitance, load, series, period = 12.0, 22e-6, 47e-6, 1.0, 0.02, 5e-6

    def circuit(self):
        circuit = pwlsim.Circuit("digital buck").voltage_source("V1", "in", "0", self.vin)
        circuit.voltage_source("Vcarrier", "carrier", "0", pwlsim.pulse(0, 1, rise=self.period, fall=0, width=0, period=self.period))
        circuit.voltage_switch("S1", "in", "sw", "duty", "carrier", "gate").model("gate", "SW", **SWITCH).diode("D1", "0", "sw")
        circuit.resistor("Rs", "sw", "a", self.series).inductor("L1", "a", "out", self.inductance, ic=5)
        circuit.capacitor("C1", "out", "0", self.capacitance, ic=4.5).resistor("R1", "out", "0", self.load)
        return circuit.save("v(out)", "i(L1)")

    def advance(self, state, duty):
        """One period: x' = A x + b u with u = Vin and then 0, each by the exponential of the augmented matrix."""
        from scipy.linalg import expm

        for on, length in ((1.0, duty * self.period), (0.0, (1.0 - duty) * self.period)):
            m = np.zeros((3, 3))
            m[0] = [-self.series / self.inductance, -1 / self.inductance, on * self.vin / self.inductance]
            m[1] = [1 / self.capacitance, -1 / (self.load * self.capacitance), 0.0]
            state = (expm(m * length) @ np.append(state, 1.0))[:2]
        return state


class PI:
    """A PI controller of the output voltage with limits of its integral: any state and any nonlinearity."""

    def __init__(self, reference=5.0, kp=0.02, ki=0.004):
        self.reference, self.kp, self.ki = reference, kp, ki
        self.integral, self.calls = 0.4, []

    def __call__(self, t, v_out):
        self.calls.append((t, v_out))
        error = self.reference - v_out
        self.integral = min(max(self.integral + self.ki * error, 0.05), 0.9)
        return min(max(self.integral + self.kp * error, 0.05), 0.9)


@pytest.mark.parametrize("delay", [0.0, 5e-6, 12.5e-6])
def test_a_voltage_mode_buck_follows_its_recursion(delay):
    pytest.importorskip("scipy")
    buck, control = Buck(), PI()
    circuit = buck.circuit().controller(inputs=["v(out)"], outputs=["duty"], every=buck.period, delay=delay, function=control, initial=[0.4])
    periods = 200
    result = circuit.run(stop=periods * buck.period, step=buck.period, use_initial_conditions=True)

    if delay == 12.5e-6:  # the duty changes in the middle of a carrier: only when and with what the function is called is known
        assert [t for t, _ in control.calls] == [k * buck.period for k in range(len(control.calls))]
        np.testing.assert_allclose([v for _, v in control.calls[1:]], result["v(out)"][1 : len(control.calls)], rtol=1e-12)
        return
    again, duties, state = PI(), [], np.array([5.0, 4.5])
    for k in range(periods):
        np.testing.assert_allclose([result["i(L1)"][k], result["v(out)"][k]], state, rtol=TO_ROUNDING)
        duties.append(again(k * buck.period, state[1]))
        late = round(delay / buck.period)
        state = buck.advance(state, duties[k - late] if k >= late else 0.4)
        assert state[0] > 0.1  # continuous conduction, as the recursion takes it
    assert abs(state[1] - 5.0) < 0.05  # and it controls
    np.testing.assert_allclose([v for _, v in control.calls[:periods]], [v for _, v in again.calls], rtol=TO_ROUNDING)


def test_between_samples_the_run_is_in_closed_form():
    from math import exp

    # 1 A for one sample, then 0: v = R(1 − e^{−t/RC}) and its decay.
    circuit = pwlsim.Circuit("rc").current_source("Iset", "0", "a", 0).resistor("R1", "a", "0", 2).capacitor("C1", "a", "0", 1e-3)
    calls = []
    circuit.controller("v(a)", "Iset", 1e-3, lambda t, v: calls.append(v) or (1.0 if t == 0 else 0.0))
    result = circuit.run(stop=4e-3)
    count = len(calls)
    top = 2 * (1 - exp(-0.5))
    for t, v in ((0.3e-3, 2 * (1 - exp(-0.15))), (1e-3, top), (1.7e-3, top * exp(-0.35)), (4e-3, top * exp(-1.5))):
        assert result("v(a)", t) == pytest.approx(v, rel=1e-13)
    assert len(calls) == count  # the run is done again without the function
    np.testing.assert_allclose(calls[1:3], [top, top * exp(-0.5)], rtol=1e-13)
    edges = result.events["time"][result.events["source_edge"]]
    np.testing.assert_allclose(edges[edges > 0], [1e-3], rtol=1e-13)


def test_a_deadbeat_current_mode_converter_follows_its_recursion():
    # Output held at Vo: i[k+1] = i[k] + (Vin d[k] − Vo) T/L; with a period of delay, the duty that reaches Iref is known from the last sample and duty.
    vin, vo, inductance, period = 12.0, 5.0, 10e-6, 4e-6
    circuit = pwlsim.Circuit("deadbeat").voltage_source("V1", "in", "0", vin).voltage_source("Vo", "out", "0", vo).voltage_source("Vduty", "d", "0", 0.4)
    circuit.voltage_source("Vcarrier", "carrier", "0", pwlsim.pulse(0, 1, rise=period, fall=0, width=0, period=period))
    circuit.voltage_switch("S1", "in", "sw", "d", "carrier", "gate").model("gate", "SW", **SWITCH).diode("D1", "0", "sw")
    circuit.inductor("L1", "sw", "out", inductance, ic=6)
    state = {"duty": 0.4}

    def control(t, current):
        reference = 6.0 if t < 20 * period else 8.0
        predicted = current + (vin * state["duty"] - vo) * period / inductance
        state["duty"] = min(max((reference - predicted) * inductance / (period * vin) + vo / vin, 0.0), 0.95)
        return state["duty"]

    circuit.controller(inputs=["i(L1)"], outputs=["Vduty"], every=period, delay=period, function=control)
    result = circuit.run(stop=40 * period, step=period, use_initial_conditions=True)
    current, duty, expected = 6.0, 0.4, []
    state["duty"] = 0.4
    for k in range(41):
        expected.append(current)
        following = control(k * period, current)
        current += (vin * duty - vo) * period / inductance
        duty = following
    np.testing.assert_allclose(result["i(L1)"], expected, rtol=1e-11)
    assert expected[22] == pytest.approx(8.0, rel=1e-12)  # two periods after the step


def test_what_a_function_returns():
    base = pwlsim.Circuit("two").resistor("R1", "a", "0", 1).resistor("R2", "b", "0", 1).save("v(a)", "v(b)")
    answers = iter([(1, np.float64(2)), None, [3, 4], np.array([5, 6])])
    circuit = base.copy().controller([], ["a", "b"], 1e-3, lambda t: next(answers, None), initial=[0.5, 0.25])
    result = circuit.run(stop=4e-3, step=1e-3)
    assert result["v(a)"].tolist() == [1, 1, 3, 5, 5] and result["v(b)"].tolist() == [2, 2, 4, 6, 6]
    assert circuit.operating_point()["v(b)"] == 0.25
    with pytest.raises(pwlsim.RunError, match="b was set to nan"):
        base.copy().controller([], ["a", "b"], 1e-3, lambda t: (1, float("nan"))).run(stop=1e-2)
    for wrong, cause in ((1.0, TypeError), ((1, 2, 3), ValueError), ("x", ValueError), ({}, ValueError), ((1, "x"), TypeError)):
        with pytest.raises(pwlsim.RunError) as caught:
            base.copy().controller([], ["a", "b"], 1e-3, lambda t: wrong).run(stop=1e-2)
        assert caught.value.id == "E-controller" and isinstance(caught.value.__cause__, cause)


def test_an_exception_ends_the_run_and_keeps_its_rows():
    def fails(t, v):
        if t > 2.5e-3:
            raise ZeroDivisionError("no answer")
        return t

    circuit = pwlsim.Circuit("fails").resistor("R1", "a", "0", 1).save("v(a)").controller("v(a)", "a", 1e-3, fails)
    with pytest.raises(pwlsim.RunError, match="no answer") as caught:
        circuit.run(stop=1e-2, step=5e-4)
    assert caught.value.id == "E-controller" and isinstance(caught.value.__cause__, ZeroDivisionError)
    assert caught.value.__cause__.__traceback__.tb_frame.f_code.co_name == "fails"
    result = caught.value.result
    assert not result.completed and result.end == pytest.approx(3e-3)
    assert result["v(a)"].tolist() == [0, 0, 1e-3, 1e-3, 2e-3, 2e-3]
    assert [m.id for m in result.messages if m.kind == "error"] == ["E-controller"]

    def interrupts(t, v):
        raise KeyboardInterrupt

    with pytest.raises(pwlsim.Interrupted) as stopped:
        pwlsim.Circuit("stops").resistor("R1", "a", "0", 1).controller("v(a)", "a", 1e-3, interrupts).run(stop=1e-2)
    assert not stopped.value.result.completed


@pytest.mark.parametrize(
    "change, id",
    [
        ({"every": 0.0}, "E-controller"),
        ({"delay": -1e-6}, "E-controller"),
        ({"initial": [1, 2]}, "E-controller"),
        ({"outputs": []}, "E-controller"),
        ({"outputs": ["Vsine"]}, "E-controller"),
        ({"outputs": ["a", "A"]}, "E-controller"),
        ({"inputs": ["v(nowhere)"]}, "E-unknown-node"),
        ({"inputs": ["i(R9)"]}, "E-unknown-element"),
        ({"outputs": ["a b"]}, "E-name"),
    ],
)
def test_what_is_wrong_is_said(change, id):
    circuit = pwlsim.Circuit("wrong").voltage_source("Vsine", "s", "0", pwlsim.sine()).resistor("Rs", "s", "0", 1).resistor("R1", "a", "0", 1)
    given = {"inputs": ["v(s)"], "outputs": ["a"], "every": 1e-3, "function": lambda t, *v: None, **change}
    with pytest.raises(pwlsim.Error) as caught:
        circuit.controller(**given).run(stop=1e-2)
    assert caught.value.id == id


def test_what_controllers_cannot_do_is_refused():
    circuit = pwlsim.Circuit("refused").voltage_source("V1", "s", "0", pwlsim.sine()).resistor("R1", "a", "s", 1)
    circuit.controller("v(s)", "a", 1e-3, lambda t, v: v)
    for call in (
        lambda: circuit.run(stop=1e-2, engine="sparse"),
        lambda: circuit.steady_state(),
        lambda: circuit.ac([1.0], source="V1"),
        lambda: pwlsim.sweep(circuit, {"R1": [1, 2]}, stop=1e-2),
        lambda: circuit.copy().cards(".model X D(Is=1e-14)").diode("D1", "a", "s", model="X").run(stop=1e-2),
    ):
        with pytest.raises(pwlsim.Error) as caught:
            call()
        assert caught.value.id == "E-controller"


def test_copies_keep_their_controllers():
    buck = Buck()
    circuit = buck.circuit().controller("v(out)", "duty", buck.period, PI())
    first = circuit.run(stop=1e-4, use_initial_conditions=True)["v(out)"]
    fresh = buck.circuit().controller("v(out)", "duty", buck.period, PI())
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(fresh)).run(stop=1e-4, use_initial_conditions=True)["v(out)"], first)
    np.testing.assert_array_equal(fresh.copy().run(stop=1e-4, use_initial_conditions=True)["v(out)"], first)


def test_measurements_in_two_passes_call_the_function_once_an_instant():
    buck, control = Buck(), PI()
    circuit = buck.circuit().controller("v(out)", "duty", buck.period, control)
    circuit.measure("mean", "AVG v(out) FROM=0.5m").measure("when", "WHEN v(out)=mean")
    result = circuit.run(stop=1e-3, use_initial_conditions=True)
    assert result.measurements["mean"] == pytest.approx(5, abs=0.1)
    assert len(control.calls) == len({t for t, _ in control.calls})


def test_the_digital_pfc_is_that_of_cpp(source, monkeypatch):
    """Average-current mode with a multiplier: the same arithmetic in Python and in C++ gives the same numbers, to the last bit."""
    program = os.environ.get("PWLSIM_DIGITAL_PFC")
    if not program:
        pytest.skip("PWLSIM_DIGITAL_PFC does not name the program of python/tests/digital_pfc.cpp")
    monkeypatch.syspath_prepend(str(source / "examples" / "python"))
    result = importlib.import_module("digital_pfc").run()
    lines = subprocess.run([program], check=True, capture_output=True, text=True, timeout=250).stdout.splitlines()
    expected = np.array([[float.fromhex(word) for word in line.split()] for line in lines])
    assert expected.shape == (len(result.time), 3)
    for column, name in enumerate(("v(out)", "i(L1)", "v(duty)")):
        np.testing.assert_array_equal(result[name], expected[:, column])
    # It is a PFC: the output is held, and the current has the form of the voltage.
    late = result.time > 0.02
    assert abs(result["v(out)"][late].mean() - 400) < 8
    assert np.corrcoef(result["i(L1)"][late], result["v(rect)"][late])[0, 1] > 0.97
