"""Waveforms of sources, as text of the deck language."""

from __future__ import annotations

from typing import Iterable, Tuple, Union

from . import _core

__all__ = ["pulse", "sine", "straight_lines"]

Number = Union[float, str]


def sine(offset: Number = 0, amplitude: Number = 1, frequency: Number = 50, *, delay: Number = 0, damping: Number = 0, phase: Number = 0) -> str:
    """offset + amplitude·e^(−damping (t − delay))·sin(2π·frequency (t − delay) + phase).

    V or A; Hz; s; 1/s; degrees. Before `delay` it keeps the value it has there.

    >>> sine(0, 10, 50)
    'SIN(0 10 50 0 0 0)'
    """
    return _core.sine([offset, amplitude, frequency, delay, damping, phase])


def pulse(
    low: Number = 0, high: Number = 1, *, delay: Number = 0, rise: Number = 0, fall: Number = 0, width: Number = float("inf"), period: Number = 0
) -> str:
    """Edge n begins at delay + n·period (s); `width` s at `high`. Rise and fall of 0 are true jumps. Period 0: one pulse.

    >>> pulse(0, 1, width=4.5e-6, period=1e-5)
    'PULSE(0 1 0 0 0 4.5e-06 1e-05)'
    """
    return _core.pulse([low, high, delay, rise, fall, width, period])


def straight_lines(points: Iterable[Tuple[float, float]], repeat: bool = False) -> str:
    """Straight lines through points (s, value); equal times are a jump. The first and the last value apply outside.

    With `repeat` the waveform up to the last point repeats forever.

    >>> straight_lines([(0, 0), (1e-3, 5)])
    'PWL(0 0 0.001 5 )'
    """
    return _core.straight_lines([(float(time), float(value)) for time, value in points], repeat)
