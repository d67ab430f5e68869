"""The periodic steady state, and small signals around it."""

from __future__ import annotations

from typing import Dict, List, NamedTuple, Optional, Tuple

import numpy as np

from .result import Result

__all__ = ["LoopGain", "Response", "SteadyState"]


class SteadyState(NamedTuple):
    """A periodic orbit."""

    period: float
    """s."""
    multiple: int
    """Periods of the sources in one period of the orbit."""
    is_driven: bool
    """By periodic sources; else the circuit is self-timed."""
    stability: str
    """"stable", "unstable", "marginal"; "" if the orbit has no derivative."""
    residual: float
    """Difference of the states at both ends of the period, relative to the largest state."""
    iterations: int
    """Of Newton's method."""
    periods_simulated: int
    multipliers: np.ndarray
    """Floquet multipliers, complex, the largest first."""
    states: Dict[str, float]
    """Just after t = 0: "v(C1)" in V, "i(L1)" in A."""
    waveform: Result
    """One period from t = 0, with the values of `.meas pss`."""


class LoopGain(NamedTuple):
    """T(f) = −v(n−)/v(n+) of a source in a loop."""

    values: np.ndarray
    """Complex, shape (frequencies,)."""
    crossovers: List[Tuple[float, float]]
    """(frequency in Hz, phase margin in degrees)."""
    gain_margins: List[Tuple[float, float]]
    """(frequency in Hz, gain margin in dB)."""


class Response:
    """Small signals: `frequency` in Hz, shape (frequencies,); response["v(out)"] is complex with the same shape; `loop` is a LoopGain or None."""

    def __init__(self, frequency: np.ndarray, values: Dict[str, np.ndarray], loop: Optional[LoopGain]) -> None:
        self.frequency = frequency
        self.values = values
        self.loop = loop

    def __getitem__(self, name: str) -> np.ndarray:
        for key, value in self.values.items():
            if key.lower() == name.lower():
                return value
        raise KeyError(f"no signal {name!r}; the signals are {', '.join(self.values)}")

    @property
    def signals(self) -> Tuple[str, ...]:
        return tuple(self.values)

    def plot(self, *signals: str, axes: object = None) -> object:
        """Draws a Bode plot with matplotlib; of the loop gain if there is one and no signal is named. Returns two axes."""
        import matplotlib.pyplot as pyplot

        if axes is None:
            _, axes = pyplot.subplots(2, 1, sharex=True)
        names = signals or (() if self.loop else self.signals)
        curves = {name: self[name] for name in names}
        if not curves and self.loop:
            curves = {"loop gain": self.loop.values}
        for name, value in curves.items():
            axes[0].semilogx(self.frequency, 20 * np.log10(np.abs(value)), label=name)
            axes[1].semilogx(self.frequency, np.degrees(np.unwrap(np.angle(value))), label=name)
        axes[0].set_ylabel("dB")
        axes[1].set_ylabel("degrees")
        axes[1].set_xlabel("frequency (Hz)")
        axes[0].legend()
        return axes
