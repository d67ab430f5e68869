"""A deck as linear complementarity systems for Siconos, one for each position of its switches:

    x' = A x + B l + E zeta(t),   y = C x + D l + F zeta(t),   0 <= l, y >= 0, l.y = 0,   signals = P x + Q l + R zeta(t).

x: sqrt(C) v of capacitors, flux in the factor of the inductance matrix. A diode gives l its current and y its blocking voltage, or the other way round,
whichever leaves A, B, C, D defined. zeta holds the sources. Built from the decks' independent reading in validation/references.
"""
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "references"))

from deck import Deck  # noqa: E402
from mpmath import mp, mpf  # noqa: E402
from pencil import Layout  # noqa: E402

DIGITS = 30       # of times and values before they become doubles
FLUX_RANK = 1e-9  # of the coupled inductors, relative: k = 1 leaves fewer fluxes than windings
REGULAR = 1e-12   # reciprocal condition, after scaling, below which a position of ideal switches has no A, B, C, D
REAL_SWITCH = 1e9  # there, and only there, a switch is this many times less or more than the deck's mean impedance


class NotForSiconos(Exception):
    pass


@dataclass
class System:
    A: np.ndarray
    B: np.ndarray
    E: np.ndarray
    C: np.ndarray
    D: np.ndarray
    F: np.ndarray
    P: np.ndarray
    Q: np.ndarray
    R: np.ndarray


@dataclass
class Stretch:
    """Of the run, with one position of the switches."""
    start: float
    end: float
    closed: frozenset

    @property
    def middle(self):
        return (self.start + self.end) / 2


class Circuit:
    def __init__(self, path):
        mp.dps = DIGITS
        self.deck = Deck(path)
        self.layout = Layout(self.deck, 1, 1)
        self.nodes, self.algebraic, self.size = len(self.layout.node), self.layout.algebraic, self.layout.size
        self.stores = len(self.layout.of["C"]) + len(self.layout.of["L"])
        self.impedance = self._mean_impedance()
        self.factor = self._factor()
        self.inverse = np.linalg.pinv(self.factor)
        self.systems, self.pieces = {}, {}
        self.cut = None
        if not self.layout.of["S"]:
            self._leave_out_cutsets()

    def _mean_impedance(self):
        of = {kind: [abs(float(e.value)) for e in self.layout.of[kind]] for kind in "RLC"}
        ring = [(inductance / c) ** 0.5 for inductance in of["L"] for c in of["C"]]
        values = of["R"] + ring
        return float(np.exp(np.mean(np.log(values)))) if values else 1.0

    def dense(self, rows):
        out = np.zeros((len(rows), self.size))
        for i, row in enumerate(rows):
            for j, value in row.items():
                out[i, j] = float(value)
        return out

    # ---- states
    def _factor(self):
        """Charges and fluxes are factor times x; half the sum of squares of x is the energy."""
        roots = np.sqrt([float(e.value) for e in self.layout.of["C"]])
        columns = [self.layout.current[e.name.lower()] for e in self.layout.of["L"]]
        inductance = self.dense(self.layout.inductance_rows())[:, columns]
        scale = np.sqrt(np.diag(inductance))
        values, vectors = np.linalg.eigh(inductance / np.outer(scale, scale)) if columns else (np.zeros(0), np.zeros((0, 0)))
        kept = values > FLUX_RANK
        windings = scale[:, None] * vectors[:, kept] * np.sqrt(values[kept])
        out = np.zeros((self.stores, len(roots) + int(kept.sum())))
        out[:len(roots), :len(roots)] = np.diag(roots)
        out[len(roots):, len(roots):] = windings
        return out

    def _leave_out_cutsets(self):
        """Fewer states where Kirchhoff's laws alone tie them, whatever the diodes do: a star of inductors that leads nowhere else."""
        left, on_x, on_zeta = self._equations(frozenset(), True)
        ended = np.vstack([left, self._ends(*self._ports()[:2])])
        rows, columns = scales(ended)
        vectors, sizes, _ = np.linalg.svd(rows[:, None] * ended * columns)
        tied = (vectors[:, sizes < REGULAR * sizes[0]] * rows[:, None])[:len(left)].T
        if len(tied) == 0:
            return
        if np.abs(tied @ on_zeta).max() > REGULAR * np.abs(tied @ on_x).max():
            raise NotForSiconos("a source in a loop of capacitors or a cutset of inductors")
        _, sizes, basis = np.linalg.svd(tied @ on_x)
        free = basis[len(sizes[sizes > REGULAR * sizes[0]]):].T
        self.factor, self.inverse = self.factor @ free, free.T @ self.inverse

    def start(self):
        rows, _ = self.layout.pencil(frozenset(), frozenset())
        initial = {e.name: e.initial for e in self.layout.of["C"] + self.layout.of["L"]}
        charges = self.layout.charges(rows, (initial, self.layout.zeta(mpf(0))))
        return self.inverse @ np.array([float(q) for q in charges[self.nodes:self.nodes + self.stores]])

    # ---- one position
    def system(self, closed):
        if closed not in self.systems:
            try:
                self.systems[closed] = self._system(closed, ideal=True)
            except np.linalg.LinAlgError:
                self.systems[closed] = self._system(closed, ideal=False)
        return self.systems[closed]

    def _switch_row(self, switch, closed):
        row, current = dict(self.layout.voltage(switch.nodes)), self.layout.current[switch.name.lower()]
        share = 1 / REAL_SWITCH if switch.name in closed else REAL_SWITCH
        row[current] = -mpf(self.impedance * share)
        return row

    def _equations(self, closed, ideal):
        """Left side on (z, x') without the diodes' rows, and right sides on x and zeta."""
        charges, rows = self.layout.pencil(closed, frozenset())
        first = self.nodes + self.stores + len(self.layout.of["V"]) + len(self.layout.of["E"])
        switches = len(self.layout.of["S"])
        if not ideal:
            rows[first:first + switches] = [self._switch_row(s, closed) for s in self.layout.of["S"]]
        charges, rows = self.dense(charges), self.dense(rows[:first + switches])
        store = slice(self.nodes, self.nodes + self.stores)
        states = self.factor.shape[1]
        rates = np.zeros((len(rows), states))
        rates[store] = -self.factor
        of_x = self.inverse @ charges[store]
        left = np.block([[rows[:, :self.algebraic], rates], [of_x[:, :self.algebraic], np.zeros((states, states))]])
        on_x = np.vstack([np.zeros((len(rows), states)), np.eye(states)])
        on_zeta = np.vstack([-rows[:, self.algebraic:], np.zeros((states, self.size - self.algebraic))])
        return left, on_x, on_zeta

    def _ports(self):
        """Rows over z of each diode's current and blocking voltage, padded to (z, x'), and the latter's part on zeta."""
        diodes, pad = self.layout.of["D"], np.zeros((len(self.layout.of["D"]), self.factor.shape[1]))
        current = self.dense([self.layout.current_row(d) for d in diodes])
        blocking = self.dense([self.layout.blocking_row(d) for d in diodes])
        cut = self.algebraic
        return np.hstack([current[:, :cut], pad]), np.hstack([blocking[:, :cut], pad]), blocking[:, cut:]

    def _ends(self, current, blocking):
        """Rows of the diodes' places ended in resistances."""
        return self.impedance ** 0.5 * current + blocking / self.impedance ** 0.5

    def _which(self, left, current, blocking):
        """For each diode whether l is its blocking voltage: signature of the scattering matrix that leaves every pivot at least 1."""
        count = len(current)
        right = np.vstack([np.zeros((len(left), count)), np.eye(count)])
        w = 2 * blocking / self.impedance ** 0.5 @ regular_solve(np.vstack([left, self._ends(current, blocking)]), right) - np.eye(count)
        signs, undone = np.zeros(count, bool), list(range(count))
        while undone:
            j = max(undone, key=lambda k: abs(w[k, k]))
            signs[j] = w[j, j] >= 0
            undone.remove(j)
            pivot = w[j, j] + (1 if signs[j] else -1)
            w = w - np.outer(w[:, j], w[j]) / pivot
        return signs

    def _system(self, closed, ideal):
        left, on_x, on_zeta = self._equations(closed, ideal)
        current, blocking, offset = self._ports()
        by_voltage = self._which(left, current, blocking)[:, None]
        given, read = np.where(by_voltage, blocking, current), np.where(by_voltage, current, blocking)
        given_offset, read_offset = np.where(by_voltage, offset, 0.0), np.where(by_voltage, 0.0, offset)
        count, states = len(current), on_x.shape[1]
        right = np.block([[on_x, np.zeros((len(left), count)), on_zeta], [np.zeros((count, states)), np.eye(count), -given_offset]])
        z = regular_solve(np.vstack([left, given]), right)
        cuts = [states, states + count]
        rates, outputs, signals = z[self.algebraic:], read @ z, self._signals() @ z[:self.algebraic]
        outputs[:, states + count:] += read_offset
        return System(*np.split(rates, cuts, 1), *np.split(outputs, cuts, 1), *np.split(signals, cuts, 1))

    def _signals(self):
        rows = [self.layout.signal(text) for text in self.deck.saves]
        return (self.dense([row for row, _ in rows]) * np.array([[float(factor)] for _, factor in rows]))[:, :self.algebraic]

    # ---- time
    def _control(self, switch):
        """The control as a function of time and of an instant within the piece of the sources, or a refusal."""
        grounded = {e.nodes[0]: e.name.lower() for e in self.layout.of["V"] if e.nodes[1] in ("0", "gnd")}
        if switch.model.get("vh", 0) != 0 or any(node not in grounded and node != "0" for node in switch.control):
            raise NotForSiconos("a switch that the circuit itself controls")
        row = np.zeros(self.size)
        for node, sign in zip(switch.control, (1.0, -1.0)):
            if node != "0":
                row += sign * self.dense([self.layout.source_row[grounded[node]]])[0]
        threshold = float(switch.model.get("vt", 0))
        return lambda time, within: (row[self.algebraic:] @ self.zeta(np.array([time]), within))[0] - threshold

    def stretches(self):
        """The run, cut where a switch moves or a source that the circuit feels has an edge."""
        self.cut = self.cut or self._joined(self._cut())
        return self.cut

    def _joined(self, stretches):
        systems = [self.system(closed) for closed in {s.closed for s in stretches}]
        felt = np.any([np.vstack([s.E, s.F, s.R]) != 0 for s in systems], axis=(0, 1))
        sources = [name[1] for name, is_felt in zip(self.layout.zeta_names, felt) if is_felt and name[0] in ("value", "slope")]
        edges = {float(t) for source in sources for t in source.breakpoints(self.deck.stop)}
        out = stretches[:1]
        for stretch in stretches[1:]:
            if stretch.start in edges or stretch.closed != out[-1].closed:
                out.append(stretch)
            else:
                out[-1] = Stretch(out[-1].start, stretch.end, stretch.closed)
        return out

    def _cut(self):
        stop = self.deck.stop
        corners = sorted({mpf(0), stop, *(t for e in self.layout.of["V"] + self.layout.of["I"] for t in e.value.breakpoints(stop) if 0 < t < stop)})
        corners = [t for k, t in enumerate(corners) if k == 0 or t - corners[k - 1] > stop * mpf(10) ** (10 - DIGITS)]
        controls = {s.name: self._control(s) for s in self.layout.of["S"]}
        out = []
        for start, end in zip(corners, corners[1:]):
            start, end = float(start), float(end)
            cuts = {crossing(control, start, end) for control in controls.values()} - {None}
            ends = sorted({start, end, *cuts})
            for stretch in (Stretch(a, b, frozenset()) for a, b in zip(ends, ends[1:])):
                stretch.closed = frozenset(name for name, control in controls.items() if control(stretch.middle, stretch.middle) > 0)
                out.append(stretch)
        return out

    def zeta(self, times, within):
        """The sources' vector at `times`, one column each, on the piece in which the instant `within` lies."""
        out = np.empty((self.size - self.algebraic, len(times)))
        for i, name in enumerate(self.layout.zeta_names):
            if name == "1":
                out[i] = 1.0
            elif name[0] in ("sin", "cos"):
                out[i] = getattr(np, name[0])(2 * np.pi * float(name[1]) * times)
            else:
                key = (i, within)
                if key not in self.pieces:
                    self.pieces[key] = [float(v) for v in name[1].value_and_slope(mpf(within))]
                value, slope = self.pieces[key]
                out[i] = value + slope * (times - within) if name[0] == "value" else slope
        return out


def crossing(control, start, end):
    """Where a control that passes zero at most once between two corners of the sources does so, or None."""
    middle = (start + end) / 2
    low, high = start, end
    above = control(low, middle) > 0
    if control(low, middle) * control(high, middle) >= 0:
        return None
    while low < (at := (low + high) / 2) < high:
        low, high = (at, high) if (control(at, middle) > 0) == above else (low, at)
    return at


def scales(matrix):
    """Factors of rows and columns that bring their largest entries near 1."""
    rows, columns = np.ones(len(matrix)), np.ones(matrix.shape[1])
    for _ in range(3):
        rows /= np.sqrt(np.maximum(np.abs(matrix * rows[:, None] * columns).max(1), np.finfo(float).tiny))
        columns /= np.sqrt(np.maximum(np.abs(matrix * rows[:, None] * columns).max(0), np.finfo(float).tiny))
    return rows, columns


def regular_solve(left, right):
    """The solution, or LinAlgError where the matrix, its rows and columns scaled, is singular to REGULAR."""
    rows, columns = scales(left)
    scaled = rows[:, None] * left * columns
    if np.linalg.cond(scaled, 1) * REGULAR > 1:
        raise np.linalg.LinAlgError("singular")
    return columns[:, None] * np.linalg.solve(scaled, rows[:, None] * right)
