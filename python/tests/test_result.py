"""Results: views, closed form, events, tables, pages."""

import signal
import threading
import time
import warnings

import numpy as np
import pytest

import pwlsim

warnings.simplefilter("ignore", pwlsim.PwlsimWarning)


def test_arrays_are_views_that_cannot_be_written_to(buck):
    result = buck.run()
    first, second = result["v(out)"], result["v(out)"]
    assert first.__array_interface__["data"] == second.__array_interface__["data"]
    assert not first.flags.writeable and not first.flags.owndata
    with pytest.raises(ValueError):
        first[0] = 1
    kept = result.time
    del result, second
    assert kept[-1] == 5e-3  # the array keeps what it looks at
    assert first.shape == kept.shape == (501,)


def test_the_closed_form_at_any_time():
    # 10 V through 1 kΩ into 1 µF: v = 10(1 − e^{−t/RC}).
    circuit = pwlsim.Circuit("rc").voltage_source("V1", "in", "0", 10).resistor("R1", "in", "out", 1e3).capacitor("C1", "out", "0", 1e-6)
    result = circuit.run(stop=5e-3, step=1e-3, use_initial_conditions=True)
    times = np.array([[3.3e-3, 1e-7], [0.0, 5e-3]])
    np.testing.assert_allclose(result("v(out)", times), 10 * -np.expm1(-times / 1e-3), rtol=1e-13, atol=1e-15)
    assert isinstance(result("v(out)", 1e-3), float)
    np.testing.assert_array_equal(result("v(out)", result.time), result["v(out)"])
    for call, id in ((lambda: result("v(out)", 6e-3), "E-range"), (lambda: result("v(no)", 0.0), "E-unknown-signal")):
        with pytest.raises(pwlsim.Error) as caught:
            call()
        assert caught.value.id == id
    with pytest.raises(pwlsim.Error) as caught:
        circuit.run(stop=1e-3, evaluable=False)("v(out)", 0.0)
    assert caught.value.id == "E-not-kept"


def test_events_are_a_structured_array():
    # 10 sin(2π50t) through an ideal diode into a resistor: it conducts in the positive half-waves.
    result = pwlsim.Circuit("half").voltage_source("V1", "a", "0", pwlsim.sine(0, 10, 50)).diode("D1", "a", "b").resistor("R1", "b", "0", 1).run(stop=40e-3)
    assert result.on_at_start == ("D1",)
    assert result.events.dtype.names == ("time", "source_edge", "mode_change", "jump", "turned_on", "turned_off")
    np.testing.assert_allclose(result.events["time"][:3], [0.01, 0.02, 0.03], rtol=1e-12)
    assert result.events["turned_off"][0] == ("D1",) and result.events["turned_on"][1] == ("D1",)
    assert result.events["mode_change"][:3].all() and not result.events["jump"].any()


def test_measurements_and_fourier():
    circuit = pwlsim.Circuit("sine").voltage_source("V1", "a", "0", pwlsim.sine(1, 2, 50)).resistor("R1", "a", "0", 4)
    circuit.measure("mean", "AVG v(a)").measure("never", "WHEN v(a)=9").cards(".four 50 v(a)")
    result = circuit.run(stop=20e-3)
    assert result.measurements["mean"] == pytest.approx(1, abs=1e-13)
    assert np.isnan(result.measurements["never"]) and result.measurement_list[1].failure
    assert result.measurement_list[0].unit == "V"
    (fourier,) = result.fourier
    assert fourier.magnitude[:2] == pytest.approx([1, 2], abs=1e-12) and fourier.frequency[1] == 50


def test_tables_of_other_packages(buck):
    pandas = pytest.importorskip("pandas")
    xarray = pytest.importorskip("xarray")
    result = buck.run()
    frame = result.to_dataframe()
    assert isinstance(frame, pandas.DataFrame) and list(frame.columns) == ["v(out)", "i(L1)"] and frame.index.name == "time"
    data = result.to_xarray()
    assert isinstance(data, xarray.Dataset) and data["i(L1)"].attrs["units"] == "A"
    np.testing.assert_array_equal(data["v(out)"].values, result["v(out)"])


def test_plot(buck):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    axes = buck.run().plot()
    assert [axis.get_ylabel() for axis in axes] == ["V", "A"]
    assert axes[0].get_legend_handles_labels()[1] == ["v(out)"]


def test_the_page_of_a_notebook_needs_no_network(buck):
    page = buck.run()._repr_html_()
    assert page.startswith("<iframe srcdoc=") and "v(out)" in page
    report = buck.run().report()
    assert report.lstrip().lower().startswith("<!doctype html") and 'src="http' not in report


def test_ctrl_c_keeps_the_rows():
    # A run of many minutes; the signal comes after 0.2 s.
    circuit = pwlsim.Circuit("long").voltage_source("V1", "a", "0", pwlsim.sine(0, 10, 50)).diode("D1", "a", "b").resistor("R1", "b", "0", 1).save("v(b)")
    timer = threading.Timer(0.2, lambda: signal.raise_signal(signal.SIGINT))
    start = time.monotonic()
    timer.start()
    with pytest.raises(pwlsim.Interrupted) as caught:
        circuit.run(stop=1e6, step=1e-2, events=False)
    assert time.monotonic() - start < 5
    result = caught.value.result
    assert isinstance(caught.value, KeyboardInterrupt)
    assert not result.completed and 0 < result.end < 1e6
    assert len(result.time) > 100 and len(result["v(b)"]) == len(result.time)
    assert any(m.id == "E-interrupted" for m in result.messages)


def test_progress_may_stop_a_run():
    circuit = pwlsim.Circuit("long").voltage_source("V1", "a", "0", pwlsim.sine(0, 10, 50)).diode("D1", "a", "b").resistor("R1", "b", "0", 1).save("v(b)")

    def stop(t):
        raise RuntimeError(f"enough at {t > 0}")

    with pytest.raises(RuntimeError, match="enough at True"):
        circuit.run(stop=1e6, step=1e-2, events=False, progress=stop)


def test_threads_run_side_by_side_without_the_gil(buck):
    results = {}

    def work(k):
        results[k] = buck.run(events=False)["v(out)"][-1]

    reference = buck.run()["v(out)"][-1]
    threads = [threading.Thread(target=work, args=(k,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert set(results.values()) == {reference}
    # While a long run is under way another thread of Python goes on: without the GIL being released it would not be scheduled.
    counted = []
    circuit = pwlsim.Circuit("long").voltage_source("V1", "a", "0", pwlsim.sine(0, 10, 50)).diode("D1", "a", "b").resistor("R1", "b", "0", 1).save("v(b)")
    worker = threading.Thread(target=lambda: counted.append(circuit.run(stop=400, step=1e-2, events=False).completed))
    worker.start()
    ticks = 0
    while worker.is_alive():
        ticks += 1
        time.sleep(1e-3)
    assert counted == [True] and ticks > 5


def test_the_steady_state_of_a_buck(buck):
    buck_on_orbit = buck.steady_state(points=100)
    assert buck_on_orbit.period == 10e-6 and buck_on_orbit.is_driven and buck_on_orbit.stability == "stable"
    # Ideal parts: the mean of the output is duty·Vin = 0.45·24 V exactly, and ripple current swings about the load current.
    waveform = buck_on_orbit.waveform
    assert waveform("v(out)", np.linspace(0, 10e-6, 20001)[:-1]).mean() == pytest.approx(10.8, rel=1e-6)
    assert waveform.time[-1] == 10e-6 and len(waveform.time) == 101
    assert waveform["v(out)"][0] == pytest.approx(waveform["v(out)"][-1], rel=1e-12)
    assert abs(buck_on_orbit.multipliers[0]) < 1
    assert buck_on_orbit.states["v(C1)"] == pytest.approx(waveform["v(out)"][0], rel=1e-12)


def test_small_signals_of_a_buck(buck):
    buck["V1"].value = "24 AC 1"
    response = buck.ac([1.0, 1e5 / 7], settling_time=0)
    # At low frequency the output follows the input by the duty cycle.
    assert abs(response["v(out)"][0]) == pytest.approx(0.45, rel=1e-3)
    assert response.frequency.tolist() == [1.0, 1e5 / 7] and response.loop is None
    with pytest.raises(KeyError):
        response["v(nothing)"]


def test_no_orbit_is_an_error():
    with pytest.raises(pwlsim.RunError) as caught:
        pwlsim.Circuit("dc").voltage_source("V1", "a", "0", 1).resistor("R1", "a", "b", 1).capacitor("C1", "b", "0", 1e-6).steady_state()
    assert caught.value.id.startswith("E-pss")
