"""Circuits: built in Python, read from a deck, or both."""

from __future__ import annotations

import os
import warnings
from typing import Any, Callable, Dict, Iterable, Iterator, List, Mapping, MutableMapping, Optional, Sequence, Tuple, Union

import numpy as np

from . import _core
from .errors import Interrupted, PwlsimWarning, _messages
from .gradient import Gradient
from .result import Result
from .steady import LoopGain, Response, SteadyState

__all__ = ["Circuit", "Element"]

Value = Union[float, int, str]
"""A number, kept to the last bit; or text as in a deck: "10k", "{2*R}", "inf"."""


def _names(given: Union[str, Sequence[str]]) -> List[str]:
    """One name, or several."""
    return [given] if isinstance(given, str) else list(given)


def _warn(raw: Iterable[tuple], level: int) -> None:
    for message in _messages(list(raw)):
        if message.kind == "warning":
            warnings.warn(PwlsimWarning(f"{message.id}: {message.text}", message.id), stacklevel=level)


class Element:
    """An element of a circuit, by its name.

    >>> circuit = Circuit.from_text("divider\\nV1 in 0 10\\nR1 in out {2*r}\\nR2 out 0 1k\\n.param r=1k\\n")
    >>> circuit["R1"].value
    2000.0
    >>> circuit["R1"].value = 4e3
    >>> circuit.operating_point()["v(out)"]
    2.0
    """

    def __init__(self, circuit: "Circuit", name: str) -> None:
        self._circuit = circuit
        self.name = name

    @property
    def value(self) -> float:
        """The value of R, C, L in ohm, farad, henry; of V and I in V and A (a number or, when set, a waveform: AC stays); the gain of E, F, G, H;
        the coefficient of K. Raises Error: E-unknown-element, E-no-value, and all mistakes of the circuit."""
        return self._circuit._core.value(self.name)

    @value.setter
    def value(self, value: Value) -> None:
        self._circuit.set_value(self.name, value)

    def __repr__(self) -> str:
        return f"<pwlsim.Element {self.name}>"


class _Parameters(MutableMapping[str, Any]):
    """Parameters that were set in Python; they override those of the deck."""

    def __init__(self, circuit: "Circuit") -> None:
        self._circuit = circuit
        self._given: Dict[str, Any] = {}

    def __setitem__(self, name: str, value: Value) -> None:
        self._circuit.parameter(name, value)

    def __getitem__(self, name: str) -> Any:
        return self._given[name.lower()]

    def __delitem__(self, name: str) -> None:
        raise TypeError("a parameter cannot be deleted; set another value")

    def __iter__(self) -> Iterator[str]:
        return iter(self._given)

    def __len__(self) -> int:
        return len(self._given)


class Circuit:
    """A circuit; each function adds a card of the deck language and returns the circuit.

    Nodes are names; "0" and "gnd" are ground. The name of an element begins with the letter of its kind. Names are not case-sensitive. Each function checks
    its names (Error, E-name); `run` checks everything else. Further parameters of a card are keywords: ``circuit.inductor("L1", "a", "b", 1e-3, Rser=0.1, ic=2)``.

    >>> circuit = Circuit("divider").voltage_source("V1", "in", "0", 10).resistor("R1", "in", "out", 1e3).resistor("R2", "out", "0", "4k")
    >>> circuit.run(stop=1e-3)["v(out)"][-1]
    8.0
    """

    def __init__(self, title: str = "circuit") -> None:
        self._begin(("new", title))

    def _begin(self, start: Tuple[str, str]) -> None:
        kind, text = start
        self._start = start
        self._calls: List[Tuple[str, tuple]] = []
        self._core = _core.Circuit(text) if kind == "new" else _core.Circuit.from_file(text) if kind == "file" else _core.Circuit.from_text(text)
        self.parameters = _Parameters(self)

    @classmethod
    def from_file(cls, path: Union[str, "os.PathLike[str]"]) -> "Circuit":
        """The deck or LTspice schematic in a file, which `run` reads; cards added in Python count as written at its end."""
        circuit = cls.__new__(cls)
        circuit._begin(("file", os.fspath(path)))
        return circuit

    @classmethod
    def from_text(cls, deck: str) -> "Circuit":
        """A deck; its first line is the title. Included files are looked up from the current directory."""
        circuit = cls.__new__(cls)
        circuit._begin(("text", deck))
        return circuit

    def _call(self, name: str, *arguments: Any) -> "Circuit":
        getattr(self._core, name)(*arguments)
        self._calls.append((name, arguments))
        if name == "parameter":
            self.parameters._given[arguments[0].lower()] = arguments[1]
        return self

    def __getstate__(self) -> Any:
        return self._start, self._calls

    def __setstate__(self, state: Any) -> None:
        start, calls = state
        self._begin(start)
        for name, arguments in calls:
            self._call(name, *arguments)

    def copy(self) -> "Circuit":
        """An independent copy of this circuit."""
        copy = type(self).__new__(type(self))
        copy.__setstate__((self._start, list(self._calls)))
        return copy

    __copy__ = copy

    def __deepcopy__(self, _memo: Any) -> "Circuit":
        return self.copy()

    def resistor(self, name: str, p: str, n: str, resistance: Value, **more: Value) -> "Circuit":
        """R…, in ohm."""
        return self._call("resistor", name, p, n, resistance, more)

    def capacitor(self, name: str, p: str, n: str, capacitance: Value, **more: Value) -> "Circuit":
        """C…, in farad; ic=v is its initial voltage."""
        return self._call("capacitor", name, p, n, capacitance, more)

    def inductor(self, name: str, p: str, n: str, inductance: Value, **more: Value) -> "Circuit":
        """L…, in henry; ic=i is its initial current."""
        return self._call("inductor", name, p, n, inductance, more)

    def coupling(self, name: str, inductors: Sequence[str], coefficient: Value = 1) -> "Circuit":
        """K…: couples inductors by −1 ≤ coefficient ≤ 1; 1 is exact."""
        return self._call("coupling", name, list(inductors), coefficient)

    def voltage_source(self, name: str, p: str, n: str, voltage: Value = 0, **more: Value) -> "Circuit":
        """V…: a number in V, the result of `sine`, `pulse`, `straight_lines`, or other text as in a deck ("EXP(0 1 0 1m)")."""
        return self._call("voltage_source", name, p, n, voltage, more)

    def current_source(self, name: str, p: str, n: str, current: Value = 0, **more: Value) -> "Circuit":
        """I…: as `voltage_source`, in A; the current flows from p through the source to n."""
        return self._call("current_source", name, p, n, current, more)

    def diode(self, name: str, anode: str, cathode: str, model: str = "", **more: Value) -> "Circuit":
        """D…: ideal, or by a model of type D."""
        return self._call("diode", name, anode, cathode, model, more)

    def voltage_switch(self, name: str, p: str, n: str, cp: str, cn: str, model: str, on: bool = False) -> "Circuit":
        """S…: closed while v(cp,cn) is above the threshold of a model of type SW. `on`: the state at the start if that is within the hysteresis."""
        return self._call("voltage_switch", name, p, n, cp, cn, model, on)

    def current_switch(self, name: str, p: str, n: str, element: str, model: str, on: bool = False) -> "Circuit":
        """W…: closed while the current of an element is above the threshold of a model of type CSW."""
        return self._call("current_switch", name, p, n, element, model, on)

    def voltage_controlled_voltage(self, name: str, p: str, n: str, cp: str, cn: str, gain: Value) -> "Circuit":
        """E…: v(p,n) = gain·v(cp,cn)."""
        return self._call("voltage_controlled_voltage", name, p, n, cp, cn, gain)

    def voltage_controlled_current(self, name: str, p: str, n: str, cp: str, cn: str, gain: Value) -> "Circuit":
        """G…: a current of gain·v(cp,cn) from p through it to n."""
        return self._call("voltage_controlled_current", name, p, n, cp, cn, gain)

    def current_controlled_voltage(self, name: str, p: str, n: str, element: str, gain: Value) -> "Circuit":
        """H…: v(p,n) = gain·i(element)."""
        return self._call("current_controlled_voltage", name, p, n, element, gain)

    def current_controlled_current(self, name: str, p: str, n: str, element: str, gain: Value) -> "Circuit":
        """F…: a current of gain·i(element) from p through it to n."""
        return self._call("current_controlled_current", name, p, n, element, gain)

    def expression_voltage(self, name: str, p: str, n: str, expression: str) -> "Circuit":
        """B…: v(p,n) = a piecewise-linear expression of voltages, currents and time: "max(v(a),2*i(R1))"."""
        return self._call("expression_voltage", name, p, n, expression)

    def expression_current(self, name: str, p: str, n: str, expression: str) -> "Circuit":
        """B…: a current of such an expression from p through it to n."""
        return self._call("expression_current", name, p, n, expression)

    def subcircuit(self, name: str, nodes: Sequence[str], definition: str, **more: Value) -> "Circuit":
        """X…: a subcircuit of the deck, or of the library that is part of the program."""
        return self._call("subcircuit", name, list(nodes), definition, more)

    def model(self, name: str, type: str, **parameters: Value) -> "Circuit":
        """`.model`: ``circuit.model("fast", "D", Ron=0.01, Vfwd=0.7)``."""
        return self._call("model", name, type, parameters)

    def parameter(self, name: str, value: Value) -> "Circuit":
        """`.param`: the last one of a name is used; it overrides those of the deck. ``circuit.parameters["R"] = 5`` does the same.

        >>> circuit = Circuit.from_text("drop\\nV1 a 0 1\\nR1 a b {r}\\nR2 b 0 1\\n.param r=1\\n")
        >>> circuit.parameters["r"] = 3
        >>> circuit.operating_point()["v(b)"]
        0.25
        """
        return self._call("parameter", name, value)

    def option(self, name: str, value: Value) -> "Circuit":
        """`.options`."""
        return self._call("option", name, value)

    def initial_voltage(self, node: str, voltage: Value) -> "Circuit":
        """`.ic` of a node, V: forced in the operating point; the initial value with use_initial_conditions."""
        return self._call("initial_voltage", node, voltage)

    def initial_current(self, inductor: str, current: Value) -> "Circuit":
        """`.ic` of an inductor, A."""
        return self._call("initial_current", inductor, current)

    def save(self, *signals: str) -> "Circuit":
        """`.save`: signals "v(n)", "v(a,b)", "i(X)". Without any: all node voltages, and the currents of L, V, E, H, D, S."""
        return self._call("save", list(signals))

    def measure(self, name: str, what: str) -> "Circuit":
        """`.meas tran name …`: ``circuit.measure("mean", "AVG v(out) FROM=1m")``."""
        return self._call("measure", name, what)

    def cards(self, lines: str) -> "Circuit":
        """Any lines of the deck language: subcircuits, blocks A, `.func`, …"""
        return self._call("cards", lines)

    def set_value(self, element: str, value: Value) -> "Circuit":
        """Sets the value of an element outside of subcircuits, as ``circuit[element].value = value`` does."""
        return self._call("set_value", element, value)

    def controller(
        self,
        inputs: Union[str, Sequence[str]],
        outputs: Union[str, Sequence[str]],
        every: float,
        function: Callable[..., Union[float, Sequence[float], None]],
        *,
        delay: float = 0.0,
        initial: Union[float, Sequence[float], None] = None,
    ) -> "Circuit":
        """Digital control: at t = 0, every, 2·every, … (s) ``function(t, *inputs)`` returns the outputs, which hold from t + delay (s) until the next ones.

        inputs: signals, "v(out)", "i(L1)" in V and A, as they are just before the instant. outputs: names of sources V… and I… of constant value, which
        is set (V, A); any other name is a node, and the controller adds a source that sets its voltage against ground (V). A duty cycle is such a node that a
        switch compares with a carrier: ``voltage_switch("S1", "in", "sw", "duty", "carrier", "SW")``. The function returns a number, a sequence with one
        number per output, or None (the outputs stay). initial: outputs until the first ones are set, and at the operating point; default: the source's
        value, or 0.

        The function keeps the state of the controller; reset it between runs. An exception in it ends the run: a RunError (E-controller) has the rows as
        `result`, and the exception as its cause. Raises Error (E-controller) if every, delay or initial is wrong; `run` checks inputs and outputs. The exact
        engine only.

        In every second interval of 1 ms, 1 mA charges a capacitor of 1 µF by 1 V:

        >>> circuit = Circuit("staircase").current_source("I1", "0", "a", 0).capacitor("C1", "a", "0", 1e-6, ic=0).save("v(a)")
        >>> circuit = circuit.controller("v(a)", "I1", 1e-3, lambda t, v: 0 if round(t / 1e-3) % 2 else 1e-3)
        >>> circuit.run(stop=4e-3, step=1e-3, use_initial_conditions=True)["v(a)"].round(12).tolist()
        [0.0, 1.0, 1.0, 2.0, 2.0]
        """
        first = [] if initial is None else np.atleast_1d(np.asarray(initial, dtype=float)).tolist()
        return self._call("controller", _names(inputs), _names(outputs), float(every), float(delay), first, function)

    def __getitem__(self, name: str) -> Element:
        return Element(self, name)

    def elements(self) -> List[str]:
        """Names of all elements, those of subcircuits as "X1:R1". Raises Error if the circuit has mistakes."""
        return self._core.elements()

    @property
    def text(self) -> str:
        """The cards added in Python, below the title. Messages name this text `code`."""
        return self._core.text()

    def run(
        self,
        stop: float = 0.0,
        step: float = 0.0,
        start: float = 0.0,
        *,
        use_initial_conditions: bool = False,
        engine: str = "auto",
        reltol: Optional[float] = None,
        rows_at_events: bool = False,
        events: bool = True,
        evaluable: bool = True,
        run: int = 0,
        progress: Optional[Callable[[float], None]] = None,
    ) -> Result:
        """Runs the circuit from 0 to `stop` (s), with a row every `step` (s) from `start` (s) on.

        stop: 0 uses the deck's `.tran`. step: the distance of rows, not an integration step; 0 is a thousandth of the run. use_initial_conditions: start from
        `ic=` and `.ic`, zero elsewhere, instead of the operating point (uic). engine: "auto", "exact" or "sparse"; `reltol` is for the sparse one.
        rows_at_events: adds rows before and after every event. events: keep a list of all events. evaluable: keep the model, for ``result(signal, t)``
        and ``result.report()``. run: number of the run of the deck's `.step`. progress: called with the time reached, s, some twenty times a second.

        Raises Error if the circuit has mistakes, RunError if the run could not continue (its `result` has the rows), Interrupted after Ctrl-C. Warnings of
        the simulator are PwlsimWarning. Other threads continue during the run.
        """
        options = {
            "stop": stop,
            "step": step,
            "start": start,
            "use_initial_conditions": use_initial_conditions,
            "engine": engine,
            "reltol": reltol,
            "rows_at_events": rows_at_events,
            "events": events,
            "evaluable": evaluable,
            "run": run,
        }
        core, interrupted = self._core.run(options, progress)
        result = Result(core)
        _warn(core.messages, 3)
        if interrupted:
            raise Interrupted(result)
        return result

    def operating_point(self, *, engine: str = "auto") -> Dict[str, float]:
        """Names and values (V, A) of the saved signals at the DC operating point. Raises as `run` does."""
        return dict(self._core.operating_point({"engine": engine}))

    def steady_state(
        self,
        period: Optional[float] = None,
        *,
        multiple: Optional[int] = None,
        on: Optional[str] = None,
        off: Optional[str] = None,
        when: Optional[str] = None,
        settling_time: Optional[float] = None,
        points: Optional[int] = None,
        use_initial_conditions: bool = False,
    ) -> SteadyState:
        """The periodic steady state, by the deck's `.pss` or by these arguments.

        period: s, a multiple of the common period of the sources (the default); a guess for a self-timed circuit. multiple: periods of the sources in
        one period of the orbit. on, off: the element whose closing or opening begins the period of a self-timed circuit; when: "v(a)=0 rise".
        settling_time: s, simulated before the search. points: row intervals per period.

        Raises Error if the circuit has mistakes, RunError (E-pss-…) if no orbit was found.
        """
        return self._steady_state(self._around(period, multiple, on, off, when, settling_time, points, use_initial_conditions))

    @staticmethod
    def _around(period: Any, multiple: Any, on: Any, off: Any, when: Any, settling: Any, points: Any, uic: bool) -> Dict[str, Any]:
        events = [f"{word}{name}" for word, name in (("on=", on), ("off=", off), ("when ", when)) if name is not None]
        if len(events) > 1:
            raise ValueError("give one of on, off and when")
        return {
            "period": period,
            "multiple": multiple,
            "begins": events[0] if events else None,
            "settling_time": settling,
            "points": points,
            "use_initial_conditions": uic,
        }

    def _steady_state(self, what: Mapping[str, Any]) -> SteadyState:
        found = self._core.steady_state(what, {})
        found["states"] = dict(found["states"])
        _warn(found["waveform"].messages, 4)
        found["waveform"] = Result(found["waveform"])
        return SteadyState(**found)

    def ac(
        self,
        frequencies: Union[Sequence[float], np.ndarray],
        *,
        source: str = "",
        loop: str = "",
        harmonic: int = 0,
        sample: Optional[float] = None,
        period: Optional[float] = None,
        multiple: Optional[int] = None,
        on: Optional[str] = None,
        off: Optional[str] = None,
        when: Optional[str] = None,
        settling_time: Optional[float] = None,
        use_initial_conditions: bool = False,
    ) -> Response:
        """Small signals at `frequencies` (Hz): around the steady state, or of a linear circuit.

        source: "V1", "freq(V1)", "duty(V1)"; default: all sources with AC values. loop: a source of 0 V in a loop, for its loop gain. harmonic: the
        sideband at f + harmonic/period. sample: s, the sampled response at that time of the period. The other arguments are those of `steady_state`.

        Raises as `steady_state` does; E-ac-no-input, E-ac-no-derivative.

        >>> circuit = Circuit("low-pass").voltage_source("V1", "in", "0", "0 AC 1").resistor("R1", "in", "out", 1e3).capacitor("C1", "out", "0", 1e-6)
        >>> response = circuit.ac([1 / (2 * 3.141592653589793 * 1e-3)])
        >>> complex(response["v(out)"][0].round(12))
        (0.5-0.5j)
        """
        what = {"from": source, "loop": loop, "harmonic": harmonic, "sample": sample}
        around = self._around(period, multiple, on, off, when, settling_time, None, use_initial_conditions)
        grid = np.atleast_1d(np.asarray(frequencies, dtype=float))
        frequency, values, gain, messages = self._core.small_signals(grid.tolist(), what, around)
        _warn(messages, 3)
        return Response(frequency, values, LoopGain(*gain) if gain else None)

    def gradient(self, measurement: str, parameters: Sequence[str], *, stop: float = 0.0, use_initial_conditions: bool = False) -> Gradient:
        """A measurement of `.meas tran` or `.meas pss` with its exact derivatives to parameters, as by `.sens`, through all events.

        parameters: "R" of a `.param`, "R1", "X1:L1", "S1:Vt", "Vg:Ton", "ic(C1)"; all together cost little more than one. stop: s; 0 uses the deck's
        `.tran`. A measurement of `.meas pss` needs a card `.pss`.

        Raises as `run` and `steady_state` do; Error: E-sens-no-measurement, E-sens-unknown-parameter. A derivative that does not exist is NaN, and
        `failures` has the reason.

        R1 and 2 ohm divide 12 V: v = 24/(R1 + 2), so that dv/dR1 = −24/(R1 + 2)².

        >>> circuit = Circuit.from_text("d\\nV1 a 0 12\\nR1 a b 4\\nR2 b 0 2\\n.meas tran v AVG v(b)\\n.tran 1 1\\n")
        >>> gradient = circuit.gradient("v", ["R1", "V1"])
        >>> round(gradient.value, 12), round(gradient["R1"], 12), round(gradient["V1"], 12)
        (4.0, -0.666666666667, 0.333333333333)
        """
        return self.gradients([measurement], parameters, stop=stop, use_initial_conditions=use_initial_conditions, _level=4)[measurement]

    def gradients(
        self, measurements: Sequence[str], parameters: Sequence[str], *, stop: float = 0.0, use_initial_conditions: bool = False, _level: int = 3
    ) -> Dict[str, Gradient]:
        """The same for several measurements of one run, by name; for all if `measurements` is empty."""
        given = {"stop": stop, "use_initial_conditions": use_initial_conditions}
        found = self._core.gradients(list(measurements), _names(parameters), given)
        if found:
            _warn(found[0][3], _level)
        asked = {name.lower(): name for name in measurements}
        return {asked.get(name.lower(), name): Gradient(name, value, derivatives) for name, value, derivatives, _ in found}

    def runs(self) -> int:
        """Number of runs of the deck's `.step`; 1 without `.step`. Raises as `run` does."""
        return self._core.runs()

    def __repr__(self) -> str:
        kind, text = self._start
        name = text if kind != "text" else text.split("\n", 1)[0]
        return f"<pwlsim.Circuit {name!r}>"
