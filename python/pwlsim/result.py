"""The result of a run: arrays, events, measurements, certificate."""

from __future__ import annotations

import html
from functools import cached_property
from typing import Any, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

from . import _core
from .errors import Message, _messages

__all__ = ["Certificate", "Fourier", "Measurement", "Result", "Statistics"]

EVENT_TYPE = np.dtype(
    [("time", "f8"), ("source_edge", "?"), ("mode_change", "?"), ("jump", "?"), ("turned_on", "O"), ("turned_off", "O")]
)


class Certificate(NamedTuple):
    """How well the run satisfies the circuit's laws: the largest relative residuals over all points checked. Values near 1e-15 are rounding."""

    complementarity: float
    """No diode conducts with a voltage, none blocks with a current, no sign is wrong."""
    kcl_kvl: float
    """Kirchhoff's laws."""
    energy: float
    """Energy delivered minus dissipated minus stored."""
    passive: Optional[bool]
    """The circuit without its sources cannot deliver energy; None if not known."""


class Statistics(NamedTuple):
    """Counts of a run."""

    engine: str
    states: int
    ports: int
    switches: int
    modes_visited: int
    events: int
    jumps: int
    seconds: float
    """s, for all work from the model to the values of the rows."""


class Measurement(NamedTuple):
    """The result of a `.meas` card."""

    name: str
    value: float
    """NaN if it failed."""
    unit: str
    failure: str
    """Why there is no value; "" if there is one."""
    left_out: str
    """Impulses that the value excludes, and why; "" if none."""


class Fourier(NamedTuple):
    """A Fourier analysis: y = Σ magnitude[k]·sin(2π·frequency[k]·t + phase[k]), k = 0 the mean."""

    signal: str
    frequency: np.ndarray
    """Hz."""
    magnitude: np.ndarray
    """The signal's unit."""
    phase: np.ndarray
    """Degrees."""
    distortion: float
    """Of all harmonics, relative to the first."""
    failure: str


class Result:
    """A finished run.

    >>> import pwlsim
    >>> circuit = pwlsim.Circuit("charging")
    >>> circuit = circuit.voltage_source("V1", "in", "0", 10).resistor("R1", "in", "out", 1e3).capacitor("C1", "out", "0", 1e-6)
    >>> result = circuit.run(stop=5e-3, step=1e-3, use_initial_conditions=True)
    >>> result.time
    array([0.   , 0.001, 0.002, 0.003, 0.004, 0.005])
    >>> result["v(out)"].round(6)
    array([0.      , 6.321206, 8.646647, 9.502129, 9.816844, 9.932621])
    >>> round(result("v(out)", 0.5e-3), 6)
    3.934693
    """

    def __init__(self, core: _core.Result) -> None:
        self._core = core

    @property
    def completed(self) -> bool:
        """Whether the run reached its end; False if it was interrupted, and in RunError."""
        return self._core.completed

    @property
    def end(self) -> float:
        """The time reached, s."""
        return self._core.end

    @property
    def time(self) -> np.ndarray:
        """Times of the rows, s, shape (rows,), not decreasing; a read-only view."""
        return self._core.time

    @property
    def signals(self) -> Tuple[str, ...]:
        """Names of the signals: "v(out)", "i(L1)". i(X) flows into the first node of X."""
        return self._core.signals

    def __getitem__(self, name: str) -> np.ndarray:
        """Values of a signal at `time`, V or A, shape (rows,); a read-only view.

        Names are not case-sensitive. Raises Error (E-unknown-signal).
        """
        return self._core.signal(name)

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and self._core.has_signal(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self.signals)

    def __len__(self) -> int:
        return len(self.signals)

    def __call__(self, name: str, t: Union[float, Sequence[float], np.ndarray]) -> Any:
        """A signal at any times from 0 to `end`, s, in any order: from the closed form between events; at a jump, the value after it.

        Returns a float for a number, else an array of the shape of `t`. Each call repeats the run: ask for many times in one call.
        Raises Error: E-unknown-signal, E-range, E-not-kept.
        """
        times = np.asarray(t, dtype=float)
        values = self._core.at(name, times.ravel().tolist())
        return float(values[0]) if times.ndim == 0 else values.reshape(times.shape)

    @cached_property
    def events(self) -> np.ndarray:
        """All events in order: a structured array with the fields time (s), source_edge, mode_change, jump (bool), turned_on and
        turned_off (tuples of names of diodes and switches). Empty with events=False."""
        time, edge, mode, jump, on, off = self._core.events
        events = np.empty(len(time), dtype=EVENT_TYPE)
        events["time"], events["source_edge"], events["mode_change"], events["jump"] = time, edge, mode, jump
        for k, names in enumerate(on):
            events["turned_on"][k] = names
        for k, names in enumerate(off):
            events["turned_off"][k] = names
        return events

    @property
    def on_at_start(self) -> Tuple[str, ...]:
        """Diodes and switches that conduct right after t = 0."""
        return self._core.on_at_start

    @cached_property
    def measurement_list(self) -> List[Measurement]:
        """The measurements in the order of their cards, with units and failures."""
        return [
            Measurement(name, float("nan") if failure else value, unit, failure, left_out)
            for name, value, unit, failure, left_out in self._core.measurements
        ]

    @cached_property
    def measurements(self) -> Dict[str, float]:
        """Name and value of every measurement; NaN if it failed."""
        return {each.name: each.value for each in self.measurement_list}

    @cached_property
    def fourier(self) -> List[Fourier]:
        """The results of the `.four` cards."""
        return [Fourier(*each) for each in self._core.fourier]

    @property
    def certificate(self) -> Certificate:
        """The run's certificate."""
        return Certificate(*self._core.certificate)

    @property
    def statistics(self) -> Statistics:
        """Counts of the run."""
        return Statistics(*self._core.statistics)

    @property
    def messages(self) -> List[Message]:
        """Warnings and notes; in RunError also the error that ended the run."""
        return _messages(self._core.messages)

    @property
    def stepped(self) -> Dict[str, float]:
        """Names and values of the parameters that the deck's `.step` varies, in this run."""
        return dict(self._core.stepped)

    def to_dataframe(self) -> Any:
        """The rows as a pandas DataFrame with the times (s) as its index. Needs pandas."""
        import pandas

        return pandas.DataFrame({name: self[name] for name in self.signals}, index=pandas.Index(self.time, name="time"))

    def to_xarray(self) -> Any:
        """The rows as an xarray Dataset along `time` (s), units in the attributes. Needs xarray."""
        import xarray

        units = {"v": "V", "i": "A"}
        variables = {
            name: ("time", self[name], {"units": units[name[0].lower()]} if name[:1].lower() in units else {}) for name in self.signals
        }
        return xarray.Dataset(variables, coords={"time": ("time", self.time, {"units": "s"})})

    def plot(self, *signals: str, axes: Any = None) -> Any:
        """Draws the signals over time with matplotlib (without names: all), voltages and currents on separate axes. Returns the axes. Needs matplotlib."""
        import matplotlib.pyplot as pyplot

        names = signals or self.signals
        groups = [group for group in ([n for n in names if n[:1].lower() != "i"], [n for n in names if n[:1].lower() == "i"]) if group]
        if axes is None:
            _, axes = pyplot.subplots(len(groups), 1, sharex=True, squeeze=False)
            axes = axes[:, 0]
        axes = np.atleast_1d(axes)
        for k, group in enumerate(groups):
            axis = axes[min(k, len(axes) - 1)]
            for name in group:
                axis.plot(self.time, self[name], label=name)
            axis.set_ylabel("A" if group[0][:1].lower() == "i" else "V")
            axis.legend(loc="best")
        axes[-1].set_xlabel("time (s)")
        return axes if len(axes) > 1 else axes[0]

    def report(self) -> str:
        """The run as one web page that needs no network: zoom, cursors, exact statistics, spectra. HTML text. Raises Error (E-not-kept)."""
        return self._core.report()

    def save_report(self, path: Any) -> None:
        """Writes that page into a file."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(self.report())

    def _repr_html_(self) -> str:
        page = html.escape(self.report(), quote=True)
        return f'<iframe srcdoc="{page}" style="width:100%;height:640px;border:0" sandbox="allow-scripts allow-downloads"></iframe>'

    def __repr__(self) -> str:
        state = "" if self.completed else ", not completed"
        return f"<pwlsim.Result: {len(self.time)} rows of {len(self.signals)} signals to t = {self.end:g} s{state}>"
