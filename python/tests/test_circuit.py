"""Circuits: building, values, errors, warnings."""

import copy
import pickle

import numpy as np
import pytest

import pwlsim

ROUNDING = 1e-13  # of a signal's largest value


def charging():
    return (
        pwlsim.Circuit("charging")
        .voltage_source("V1", "in", "0", 10)
        .resistor("R1", "in", "out", "1k")
        .capacitor("C1", "out", "0", 1e-6, ic=4)
        .save("v(out)")
    )


def test_a_capacitor_charges_exponentially():
    result = charging().run(stop=5e-3, step=1e-4, use_initial_conditions=True)
    assert result.completed and result.end == 5e-3
    assert result.signals == ("v(out)",)
    expected = 10 - 6 * np.exp(-result.time / 1e-3)  # RC = 1 ms
    np.testing.assert_allclose(result["v(out)"], expected, rtol=ROUNDING)
    assert result["V(OUT)"][0] == 4.0
    assert result.certificate.kcl_kvl < 1e-12 and result.certificate.passive is True
    assert result.statistics.engine == "exact" and result.statistics.states == 1


def test_every_kind_of_element_has_its_method():
    circuit = (
        pwlsim.Circuit("all")
        .voltage_source("V1", "a", "0", pwlsim.sine(0, 5, 50))
        .current_source("I1", "0", "b", pwlsim.straight_lines([(0, 0), (1e-3, 1)]))
        .resistor("R1", "a", "b", 1e3)
        .capacitor("C1", "b", "0", 1e-6)
        .inductor("L1", "b", "c", 1e-3, Rser=0.1)
        .inductor("L2", "d", "0", 1e-3)
        .coupling("K1", ["L1", "L2"], 0.9)
        .resistor("R2", "c", "0", 10)
        .resistor("R3", "d", "0", 10)
        .model("fast", "D", Ron=0.01, Vfwd=0.7)
        .diode("D1", "b", "e", model="fast")
        .diode("D2", "b", "e")
        .resistor("R4", "e", "0", 10)
        .model("sw", "SW", Vt=0.5, Ron=0.1)
        .voltage_switch("S1", "a", "f", "a", "0", "sw")
        .resistor("R5", "f", "0", 10)
        .model("cs", "CSW", It=0.5, Ron=0.1)
        .current_switch("W1", "a", "g", "V1", "cs", on=True)
        .resistor("R6", "g", "0", 10)
        .voltage_controlled_voltage("E1", "h", "0", "a", "0", 2)
        .voltage_controlled_current("G1", "0", "i", "a", "0", 1e-3)
        .current_controlled_voltage("H1", "j", "0", "V1", 2)
        .current_controlled_current("F1", "0", "k", "V1", 2)
        .expression_voltage("B1", "l", "0", "max(v(a),0)")
        .expression_current("B2", "0", "m", "abs(v(a))")
        .cards(".subckt half in out\nRa in out 1k\nRb out 0 {r}\n.ends")
        .subcircuit("X1", ["a", "n"], "half", r=1e3)
        .parameter("unused", 3)
        .option("seed", 1)
        .initial_voltage("b", 1)
        .initial_current("L1", 0.5)
    )
    for node in "hijklm":
        circuit.resistor(f"R{node}", node, "0", 10)
    result = circuit.run(stop=20e-3, use_initial_conditions=True)
    v = result["v(a)"]
    np.testing.assert_allclose(result["v(h)"], 2 * v, atol=1e-12)
    np.testing.assert_allclose(result["v(i)"], 1e-2 * v, atol=1e-12)
    np.testing.assert_allclose(result["v(l)"], np.maximum(v, 0), atol=1e-12)
    np.testing.assert_allclose(result["v(m)"], 10 * np.abs(v), atol=1e-11)
    np.testing.assert_allclose(result["v(n)"], v / 2, atol=1e-12)
    assert "X1:Ra" in circuit.elements()


def test_values_of_elements_and_parameters(source):
    circuit = pwlsim.Circuit.from_text("d\nV1 in 0 SIN(0 10 50) AC 1\nR1 in out {2*r}\nC1 out 0 C=1u\nE1 e 0 out 0 3\nRe e 0 1\nL1 e 0 1m\nL2 f 0 1m\nK1 L1 L2 0.5\nRf f 0 1\n.param r=1k\n")
    assert circuit["R1"].value == 2e3
    assert circuit["C1"].value == 1e-6
    assert circuit["E1"].value == 3
    assert circuit["K1"].value == 0.5
    with pytest.raises(pwlsim.Error) as caught:
        circuit["V1"].value
    assert caught.value.id == "E-no-value"
    circuit["R1"].value = 1 / 3
    circuit["C1"].value = "2u"
    circuit["V1"].value = 7
    circuit["E1"].value = -1
    circuit["K1"].value = "{r/4k}"
    assert [circuit[name].value for name in ("R1", "C1", "V1", "E1", "K1")] == [1 / 3, 2e-6, 7, -1, 0.25]
    assert circuit.ac([1.0], source="V1")["v(in)"][0] == 1  # AC is still there, and V1 with it
    circuit["V1"].value = pwlsim.pulse(0, 1, width=1e-3, period=2e-3)
    assert circuit.run(stop=2e-3, step=1e-3)["v(in)"].tolist() == [1.0, 0.0, 1.0]
    for name, id in (("R9", "E-unknown-element"), ("Rsub", "E-unknown-element")):
        with pytest.raises(pwlsim.Error) as caught:
            circuit[name].value
        assert caught.value.id == id
    circuit["R9"].value = 1
    with pytest.raises(pwlsim.Error) as caught:
        circuit.operating_point()
    assert caught.value.id == "E-unknown-element"
    circuit = pwlsim.Circuit.from_file(source / "netlists" / "buck.net")
    circuit["D1"].value = 1
    with pytest.raises(pwlsim.Error) as caught:
        circuit.run()
    assert caught.value.id == "E-no-value"


def test_parameters_rule_over_the_deck():
    circuit = pwlsim.Circuit.from_text("p\nV1 a 0 {v}\nR1 a 0 1\n.param v=1\n")
    circuit.parameters["v"] = 2.5
    assert circuit.parameters["V"] == 2.5 and list(circuit.parameters) == ["v"]
    assert circuit.operating_point() == {"v(a)": 2.5, "i(V1)": -2.5}


def test_copies_and_pickles_are_apart():
    first = charging()
    second = pickle.loads(pickle.dumps(first))
    third = copy.deepcopy(first)
    second["R1"].value = 2e3
    assert (first["R1"].value, second["R1"].value, third["R1"].value) == (1e3, 2e3, 1e3)
    assert second.text == first.text


def test_errors_are_exceptions_with_ids():
    with pytest.raises(pwlsim.Error) as caught:
        pwlsim.Circuit("wrong").resistor("Q1", "a", "b", 1)
    assert caught.value.id == "E-name"
    with pytest.raises(pwlsim.Error) as caught:
        pwlsim.Circuit("wrong").diode("D1", "a", "0", model="fsat").model("fast", "D").run(stop=1)
    assert caught.value.id == "E-unknown-model"
    assert "try 'fast'" in str(caught.value)
    assert [m.kind for m in caught.value.messages if m.id == "E-unknown-model"] == ["error"]
    with pytest.raises(pwlsim.Error) as caught:
        pwlsim.Circuit.from_file("no such file.net").run()
    assert caught.value.id.startswith("E-")
    with pytest.raises(TypeError):
        pwlsim.Circuit().resistor("R1", "a", "b", object())
    with pytest.raises(pwlsim.Error) as caught:
        charging().run(stop=1e-3)["v(nowhere)"]
    assert caught.value.id == "E-unknown-signal"
    with pytest.raises(ValueError):
        charging().run(stop=1, engine="fast")


def test_a_run_that_fails_keeps_its_rows():
    # A source of current into a diode that blocks: no solution from 1 ms on, when it turns round.
    circuit = pwlsim.Circuit("blocked").current_source("I1", "0", "a", pwlsim.straight_lines([(0, 1), (1e-3, 1), (1e-3, -1)])).diode("D1", "a", "0")
    with pytest.raises(pwlsim.RunError) as caught:
        circuit.run(stop=2e-3, step=1e-4)
    assert caught.value.id == "E-no-solution"
    result = caught.value.result
    assert not result.completed and result.end == pytest.approx(1e-3)
    assert result["i(D1)"][:5].tolist() == [1.0] * 5


def test_warnings_are_those_of_python():
    circuit = pwlsim.Circuit.from_text("coarse\nV1 a 0 SIN(0 1 1k)\nR1 a 0 1\n.tran 1m 10m\n")
    with pytest.warns(pwlsim.PwlsimWarning, match="W-coarse-rows") as caught:
        result = circuit.run()
    assert caught[0].message.id == "W-coarse-rows" and caught[0].filename == __file__
    assert [m.id for m in result.messages if m.kind == "warning"] == ["W-coarse-rows"]


def test_stepped_decks_are_run_one_by_one():
    circuit = pwlsim.Circuit.from_text("s\nV1 a 0 1\nR1 a 0 {r}\n.step param r list 1 2 4\n.tran 1m 2m\n")
    assert circuit.runs() == 3
    results = [circuit.run(run=k) for k in range(3)]
    assert [r.stepped for r in results] == [{"r": 1.0}, {"r": 2.0}, {"r": 4.0}]
    assert [r["i(V1)"][-1] for r in results] == [-1.0, -0.5, -0.25]


def test_gradients_are_exact():
    # v = 12·R2/(R1 + R2): dv/dR1 = −12·R2/(R1 + R2)², dv/dV1 = R2/(R1 + R2); 2·v beside it.
    circuit = pwlsim.Circuit.from_text("d\nV1 a 0 12\nR1 a b {r}\nR2 b 0 2\n.param r=4\n.meas tran v AVG v(b)\n.meas tran twice PARAM 2*v\n.tran 1 1\n")
    gradient = circuit.gradient("V", ["R1", "r", "V1"])
    assert gradient.measurement == "v" and gradient.value == pytest.approx(4, rel=ROUNDING) and gradient.parameters == ("R1", "r", "V1")
    np.testing.assert_allclose(np.asarray(gradient), [-2 / 3, -2 / 3, 1 / 3], rtol=ROUNDING)
    np.testing.assert_allclose(gradient.normalised, [-2 / 3, -2 / 3, 1], rtol=ROUNDING)
    np.testing.assert_array_equal(gradient.left, gradient.derivatives)
    assert gradient["r1"] == gradient.derivatives[0] and not gradient.failures and not gradient.kinks
    both = circuit.gradients(["twice", "v"], ["V1"])
    assert list(both["twice"].derivatives) == pytest.approx([2 / 3], rel=ROUNDING) and both["v"]["V1"] == pytest.approx(1 / 3, rel=ROUNDING)
    assert set(circuit.gradients([], ["V1"])) == {"v", "twice"}
    for measurement, parameters, id in (("w", ["R1"], "E-sens-no-measurement"), ("v", ["R9"], "E-sens-unknown-parameter")):
        with pytest.raises(pwlsim.Error) as caught:
            circuit.gradient(measurement, parameters)
        assert caught.value.id == id
    with pytest.raises(pwlsim.Error) as caught:
        circuit.copy().controller([], "V1", 1.0, lambda t: 1.0).gradient("v", ["R1"])
    assert caught.value.id == "E-controller"
