"""Sweeps: tables, workers, failures."""

import numpy as np
import pytest

import pwlsim


def loaded(deck=""):
    # 12 V behind r into R2: v = 12·R2/(r + R2).
    return pwlsim.Circuit.from_text("s\nV1 in 0 12\nR1 in out {r}\nR2 out 0 2\n.param r=1\n.meas tran v AVG v(out)\n.tran 1m 2m\n" + deck)


def test_a_grid_is_a_tidy_table():
    table = pwlsim.sweep(loaded(), {"r": [1, 2], "R2": [2, 4, 10]})
    assert list(table["run"]) == list(range(6))
    r, load = np.array(table["r"]), np.array(table["R2"])
    assert r.tolist() == [1, 1, 1, 2, 2, 2] and load.tolist() == [2, 4, 10, 2, 4, 10]
    np.testing.assert_allclose(table["v"], 12 * load / (r + load), rtol=1e-14)
    assert list(table["error"]) == [""] * 6


def test_the_table_does_not_depend_on_workers(buck):
    tables = [
        pwlsim.sweep(buck, pwlsim.MonteCarlo(12, {"L1": (47e-6, 1e-6), "C1": (1e-4, 5e-6), "V1": (24, 1)}, seed=7), measure=[("mean", "AVG v(out) FROM=4m"), ("swing", "PP i(L1) FROM=4m")], jobs=jobs)
        for jobs in (1, 3, 4)
    ]
    for table in tables[1:]:
        for name in ("L1", "mean", "swing"):
            np.testing.assert_array_equal(table[name], tables[0][name])
    assert len(set(tables[0]["mean"])) == 12
    # Each run is what the circuit gives by itself.
    one = buck.copy()
    for name in ("L1", "C1", "V1"):
        one[name].value = float(tables[0][name][5])
    assert one.measure("mean", "AVG v(out) FROM=4m").run().measurements["mean"] == tables[0]["mean"][5]


def test_functions_of_the_result_and_measurements_side_by_side():
    table = pwlsim.sweep(loaded(), {"V1": [3, 6]}, measure=["v", ("last", lambda result: result["v(out)"][-1]), ("peak", "MAX v(in)")], jobs=2)
    assert list(table["v"]) == pytest.approx([2, 4], rel=1e-14)
    assert list(table["last"]) == [2, 4] and list(table["peak"]) == [3, 6]


def test_a_run_that_fails_does_not_end_the_others():
    # Without load the ideal diode cannot take the current of the source when it turns round.
    circuit = pwlsim.Circuit("f").current_source("I1", "0", "a", 1).diode("D1", "a", "0").measure("i", "AVG i(D1)")
    table = pwlsim.sweep(circuit, {"I1": [1, -1, 2]}, stop=1e-3)
    assert list(table["error"]) == ["", "E-no-solution", ""] or list(table["error"])[1].startswith("E-")
    assert list(table["i"])[::2] == [1, 2] and np.isnan(table["i"][1])


def test_what_is_not_there_is_named():
    for values, measure, id in (({"nothing": [1]}, (), "E-unknown-element"), ({"r": [1]}, ["w"], "E-unknown-signal")):
        table_or_error = None
        try:
            table_or_error = pwlsim.sweep(loaded(), values, measure=measure)
        except pwlsim.Error as error:
            table_or_error = error
        assert (table_or_error.id if isinstance(table_or_error, pwlsim.Error) else list(table_or_error["error"])[0]) == id


def test_monte_carlo_draws_the_same_for_the_same_seed():
    draw = pwlsim.MonteCarlo(1000, {"R": (10.0, 0.5)}, seed=3).columns()["R"]
    np.testing.assert_array_equal(draw, pwlsim.MonteCarlo(1000, {"L": (1, 1), "R": (10.0, 0.5)}, seed=3).columns()["R"])
    assert not np.array_equal(draw, pwlsim.MonteCarlo(1000, {"R": (10.0, 0.5)}, seed=4).columns()["R"])
    # Mean and spread of 1,000 draws of N(10, 0.5) within five standard errors.
    assert abs(draw.mean() - 10) < 5 * 0.5 / np.sqrt(1000) and abs(draw.std() - 0.5) < 5 * 0.5 / np.sqrt(2000)
