"""Many runs of one circuit: grids and Monte Carlo, on all cores."""

from __future__ import annotations

import itertools
import os
import sys
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Callable, Dict, Iterable, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from . import _core
from .circuit import Circuit
from .errors import Error
from .result import Result

__all__ = ["MonteCarlo", "Points", "sweep"]


class Points:
    """Points for `sweep` as columns of equal length: run k takes the k-th value of each name.

    >>> Points({"R": [1, 2, 3], "L": [1e-3, 2e-3, 4e-3]}).columns()["L"].tolist()
    [0.001, 0.002, 0.004]
    """

    def __init__(self, values: Mapping[str, Iterable[float]]) -> None:
        self.values = {name: np.atleast_1d(np.asarray(column, dtype=float)) for name, column in values.items()}
        if len({column.shape for column in self.values.values()}) > 1:
            raise ValueError("the columns of points have different lengths")

    def columns(self) -> Dict[str, np.ndarray]:
        """The values of every name, shape (runs,)."""
        return self.values


class MonteCarlo:
    """Random points for `sweep`: each name has a function of a numpy Generator and a count, or (mean, standard deviation).

    >>> draw = MonteCarlo(3, {"R": (10.0, 0.1), "L": lambda random, n: random.uniform(1e-3, 2e-3, n)}, seed=1)
    >>> sorted(draw.columns()), draw.columns()["R"].shape
    (['L', 'R'], (3,))
    """

    def __init__(self, runs: int, values: Mapping[str, Any], *, seed: int) -> None:
        self.runs, self.values, self.seed = runs, dict(values), seed

    def columns(self) -> Dict[str, np.ndarray]:
        """The values of every name, shape (runs,). They depend on the seed and the name only, not on the other names."""
        columns = {}
        for name, draw in self.values.items():
            random = np.random.default_rng([self.seed, *name.lower().encode()])
            columns[name] = np.asarray(draw(random, self.runs) if callable(draw) else random.normal(*draw, self.runs), dtype=float)
        return columns


def _grid(values: Mapping[str, Iterable[float]]) -> Dict[str, np.ndarray]:
    """The last name changes fastest."""
    lists = [np.atleast_1d(np.asarray(each, dtype=float)) for each in values.values()]
    points = np.array(list(itertools.product(*lists)), dtype=float).reshape(-1, len(lists))
    return {name: points[:, k] for k, name in enumerate(values)}


class _Bar:
    """A progress bar on standard error."""

    def __init__(self, total: int, shown: bool) -> None:
        self.total, self.shown = total, shown

    def __call__(self, done: int) -> None:
        if self.shown:
            width = 40 * done // max(self.total, 1)
            end = "\n" if done == self.total else ""
            print(f"\r[{'#' * width}{'.' * (40 - width)}] {done}/{self.total}", end=end, file=sys.stderr, flush=True)


Measure = Union[str, Tuple[str, str], Tuple[str, Callable[[Result], float]]]


def sweep(
    circuit: Circuit,
    values: Union[Mapping[str, Iterable[float]], Points, MonteCarlo],
    *,
    measure: Sequence[Measure] = (),
    jobs: Optional[int] = None,
    progress: Optional[bool] = None,
    **options: Any,
) -> Any:
    """Runs a circuit with all combinations of values, the last name changing fastest, or with the points of Points or MonteCarlo.

    values: names of parameters, or of elements outside of subcircuits, with their values. measure: the results to keep of each run: the name of a measurement of
    the deck; (name, "AVG v(out) FROM=1m"), a measurement as for `Circuit.measure`; (name, function of the Result). Default: all measurements of the deck.
    jobs: number of threads; default: one per core. progress: a bar on standard error; default: if that is a terminal. options: those of `Circuit.run`.

    Returns a table with one row per run in the order of the points: run, the names, the measurements (NaN if one failed), error (the id of a run that
    failed, else ""). It is a pandas DataFrame if pandas is installed, else a dict of arrays. Results do not depend on `jobs`. A run that fails does not stop the
    others. Raises Error if the circuit has mistakes, KeyboardInterrupt after Ctrl-C.

    >>> divider = Circuit("divider").voltage_source("V1", "in", "0", 10).resistor("R1", "in", "out", 1).resistor("R2", "out", "0", 1)
    >>> table = sweep(divider, {"R1": [1, 4], "V1": [10, 5]}, measure=[("out", "AVG v(out)")], stop=1e-3)
    >>> [float(x) for x in table["out"]]
    [5.0, 2.5, 2.0, 1.0]
    """
    columns = values.columns() if isinstance(values, (Points, MonteCarlo)) else _grid(values)
    points = np.column_stack(list(columns.values())) if columns else np.empty((0, 0))
    asked = [(each, None) if isinstance(each, str) else tuple(each) for each in measure]
    measured = circuit.copy()
    for name, what in asked:
        if isinstance(what, str):
            measured.measure(name, what)
    core = _core.Sweep(measured._core, list(columns), {"evaluable": False, "events": False, **options})
    bar = _Bar(len(points), sys.stderr.isatty() if progress is None else progress)
    functions = {name: what for name, what in asked if callable(what)}
    if functions:
        names, rows, errors = _by_functions(core, points, functions, jobs or os.cpu_count() or 1, bar)
    else:
        names = core.measurements()
        rows, errors, _ = core.run_points(points, jobs or 0, bar)
    table: Dict[str, Any] = {"run": np.arange(len(points)), **columns}
    for name in [name for name, _ in asked] or names:
        table[name] = _column(name, names, rows)
    table["error"] = np.array(errors, dtype=object)
    try:
        import pandas
    except ImportError:
        return table
    return pandas.DataFrame(table)


def _column(name: str, names: List[str], rows: Sequence[Any]) -> np.ndarray:
    for place, other in enumerate(names):
        if other.lower() == name.lower():
            return np.array([row[place] if len(row) > place else np.nan for row in rows], dtype=float)
    raise Error(f"no measurement is named {name!r}; there are {', '.join(names) or 'none'}", "E-unknown-signal")


def _by_functions(core: Any, points: np.ndarray, functions: Mapping[str, Any], jobs: int, bar: _Bar) -> Any:
    """Python functions receive each result; the runs themselves are parallel."""
    names = core.measurements()

    def one(number: int) -> Tuple[List[float], str]:
        try:
            result = Result(core.run(points[number].tolist(), number))
        except Error as error:
            return [], error.id
        found = result.measurements
        return [found[name] for name in names] + [float(function(result)) for function in functions.values()], ""

    rows, errors = [], []
    with ThreadPoolExecutor(jobs) as pool:
        for done, (row, error) in enumerate(pool.map(one, range(len(points))), 1):
            rows.append(row)
            errors.append(error)
            bar(done)
    return names + list(functions), rows, errors
