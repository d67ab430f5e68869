"""A switched circuit written by hand as an automaton of linear modes: its periodic orbit, multipliers, transfer functions and derivatives to 40 digits.

Nothing is shared with the program: no netlist, no extraction of a model, no saltation matrix, no projection formula. A mode is x' = A x with the sources as
further states; the sequence of modes is found by marching in double precision, the instants of the guards by Newton's method with 60 digits.
The monodromy matrix, transfer functions and derivatives are differences of that map with a step of 1e-22. Event times are analytic in the start and in the
input, so an input eps*e^{jwt} is run as it stands, with complex event times; terms for outputs that jump at moving instants come out by themselves.
"""
from dataclasses import dataclass, field

from mpmath import mp, mpc, mpf

STEP = mpf(10) ** -22
GRID = 96  # steps of a period in the search for the first event


@dataclass
class Mode:
    rows: dict  # state -> {name: coefficient}: x' of the states that move; of sources too, if they move
    guards: list = field(default_factory=list)  # (row, next mode, jump): positive while the mode lasts
    output: dict = field(default_factory=dict)


@dataclass
class Circuit:
    states: list
    sources: dict  # name -> value at the start of a period
    modes: dict
    start: str
    period: object = None  # None: self-timed, the period ends where the mode `start` is entered
    clock: list = field(default_factory=list)  # (time, {mode: next mode}, jump); the last one may stand at the period's end
    ahead: dict = field(default_factory=dict)  # x of a first guess
    span: object = None  # self-timed: a length for the search


class Matrices:
    """Rows of a circuit over the vector (states, sources, E), E the small input."""

    def __init__(self, circuit, driven=None, jw=0, kind=mpf):
        self.names = circuit.states + list(circuit.sources) + ["E"]
        self.at = {name: k for k, name in enumerate(self.names)}
        self.kind, self.driven, self.jw = kind, driven, jw
        self.modes = {}
        for name, mode in circuit.modes.items():
            rows = [(self.at[state], self.row(row)) for state, row in mode.rows.items()]
            if jw:
                rows.append((self.at["E"], [(self.at["E"], jw)]))
            guards = [(self.row(g), to, self.jump(jump)) for g, to, jump in mode.guards]
            self.modes[name] = (rows, guards, self.row(mode.output))
        self.clock = [(kind(t), to, self.jump(jump)) for t, to, jump in circuit.clock]

    def row(self, coefficients):
        """X' stands for the derivative of a constant source X: that of the small input."""
        out = [(self.at[name], self.kind(value)) for name, value in coefficients.items() if value != 0 and name in self.at]
        for name, factor in ((self.driven, 1), (f"{self.driven}'", self.jw)):
            if coefficients.get(name, 0) != 0:
                out.append((self.at["E"], factor * self.kind(coefficients[name])))
        return out

    def jump(self, jump):
        return [(self.at[name], self.row(row)) for name, row in (jump or {}).items()]


def value(row, y):
    return sum((v * y[j] for j, v in row), 0 * y[0])


def jumped(jump, y):
    new = list(y)
    for at, row in jump:
        new[at] = value(row, y)
    return new


def flow(rows, y, h, shift=0, output=None):
    """e^{(A - shift) h} y by its Taylor series; with `output` also the integral of output*e^{-shift s} e^{A s} y over 0 ... h."""
    total, term, k, small = list(y), list(y), 0, 0
    integral = 0 * y[0]
    exact = isinstance(y[0], (mpf, mpc))
    least = mpf(10) ** (-mp.dps - 5) if exact else 1e-18
    while small < 3:
        k += 1
        if output is not None:
            integral += value(output, term) * h / k
        new = [-shift * x * h / k for x in term] if shift else [0 * x for x in term]
        for at, row in rows:
            new[at] += value(row, term) * h / k
        term = new
        total = [a + b for a, b in zip(total, term)]
        small = small + 1 if max(map(abs, term)) <= least * max(map(abs, total)) else 0
    return total, integral


class Orbit:
    def __init__(self, build, parameters, settle=400, kept=()):
        mp.dps = 60
        self.build, self.parameters = build, {k: mpf(v) for k, v in parameters.items()}
        self.circuit = build(self.parameters)
        self.n = len(self.circuit.states)
        self.kept = [self.circuit.states.index(name) for name in kept]  # states of a family of orbits, kept from the start
        self.fast = Matrices(self.circuit, kind=float)
        x = [float(self.circuit.ahead.get(s, 0)) for s in self.circuit.states]
        for _ in range(settle):
            x = self.march(x)[0]
        for _ in range(12):
            x = self.newton_fast(x)
        x, self.path = self.march(x)
        self.exact = Matrices(self.circuit)
        self.x = [mpf(v) for v in x]
        for _ in range(2):
            self.path = self.follow(self.x)[3]
            self.phi = self.monodromy()
            for _ in range(3):
                self.x = self.corrected(self.x)
        end, self.integral, self.period, self.path = self.follow(self.x)
        self.residual = max(abs(a - b) for a, b in zip(end, self.x))
        again = self.march([float(v) for v in self.x])[1]
        if [step[:2] for step in again] != [step[:2] for step in self.path]:
            raise RuntimeError("the orbit does not take the modes that were assumed")
        self.phi = self.monodromy()

    # ---- double precision: which modes follow one another
    def begin(self, x, circuit, zero):
        return list(x) + [zero + v for v in circuit.sources.values()] + [zero]

    def march(self, x):
        c, m = self.circuit, self.fast
        y = self.begin(x, c, 0.0)
        y = [float(v) for v in y]
        length = float(c.period if c.period is not None else c.span)
        mode, t, path, at = c.start, 0.0, [], 0
        step = length / GRID
        while len(path) < 20000:
            end = m.clock[at][0] if at < len(m.clock) else (length if c.period is not None else 1e6 * length)
            rows, guards, _ = m.modes[mode]
            hit = None
            while t < end and hit is None:
                h = min(step, end - t)
                new = flow(rows, y, h)[0]
                for g, (row, _, _) in enumerate(guards):
                    if value(row, new) < 0:
                        s = self.first_root(rows, row, y, h)
                        if hit is None or s < hit[1]:
                            hit = (g, s)
                if hit is None:
                    y, t = new, (end if h < step else t + h)
                    if end - t < 1e-12 * length:
                        t = end
            if hit is not None:
                y = flow(rows, y, hit[1])[0]
                t += hit[1]
                _, to, jump = guards[hit[0]]
                path.append((mode, hit[0], t))
                y, mode = jumped(jump, y), to
                if c.period is None and mode == c.start:
                    return y[: self.n], path
                continue
            if at == len(m.clock):
                path.append((mode, "end", t))
                return y[: self.n], path
            _, to, jump = m.clock[at]
            path.append((mode, "clock", t))
            at += 1
            y, mode = jumped(jump, y), to[mode]
            if at == len(m.clock) and c.period is not None and abs(t - length) < 1e-9 * length:
                return y[: self.n], path
        raise RuntimeError("too many events")

    def first_root(self, rows, row, y, h):
        low, high = 0.0, h
        for _ in range(60):
            middle = 0.5 * (low + high)
            if value(row, flow(rows, y, middle)[0]) < 0:
                high = middle
            else:
                low = middle
        return high

    def newton_fast(self, x):
        end = self.march(x)[0]
        columns = []
        for k in range(self.n):
            d = 1e-6 * max(abs(x[k]), 1e-3)
            moved = list(x)
            moved[k] += d
            columns.append([(a - b) / d for a, b in zip(self.march(moved)[0], end)])
        a = mp.matrix(self.n, self.n)
        for i in range(self.n):
            for j in range(self.n):
                a[i, j] = (1 if i == j else 0) - columns[j][i]
        for k in self.kept:
            a[k, k] += 1
        d = mp.lu_solve(a, mp.matrix([e - v for e, v in zip(end, x)]))
        return [v + float(s) for v, s in zip(x, d)]

    # ---- 60 digits: the instants as roots along the known sequence
    def follow(self, x, circuit=None, matrices=None, jw=0, small=0, until=None):
        """End state, integral of output*e^{-jwt}, end time, path with its instants.

        With `until` a self-timed circuit runs on, or back, in its first mode to that time."""
        c, m = circuit or self.circuit, matrices or self.exact
        y = self.begin(x, c, mpf(0))
        y[-1] = small
        t, total, path, at = mpf(0), mpf(0), [], 0
        for mode, what, guess in self.path:
            rows, guards, output = m.modes[mode]
            if what == "clock":
                end = m.clock[at][0]
                if m.driven == "duty" and at == 0:  # the first edge, natural sampling
                    end += small * c.period * mp.exp(jw * end)
            elif what == "end":
                end = c.period
            else:
                end, row = guess, guards[what][0]
                reached = flow(rows, y, end - t)[0]
                for _ in range(12):
                    slope = sum((v * value(dict(rows).get(j, []), reached) for j, v in row), 0 * reached[0])
                    d = value(row, reached) / slope
                    end = end - d
                    reached = flow(rows, reached, -d)[0]
                    if abs(d) < mpf(10) ** (-mp.dps + 12) * abs(end):
                        break
            h = end - t
            shift, integral = flow(rows, y, h, jw, output)
            total += integral * (mp.exp(-jw * t) if jw else 1)
            y = [v * mp.exp(jw * h) for v in shift] if jw else shift
            t = end
            path.append((mode, what, end))
            if what == "clock":
                y = jumped(m.clock[at][2], y)
                at += 1
            elif what != "end":
                y = jumped(guards[what][2], y)
        if until is not None:
            rows, _, output = m.modes[c.start]
            shift, integral = flow(rows, y, until - t, jw, output)
            total += integral * (mp.exp(-jw * t) if jw else 1)
            y = [v * mp.exp(jw * (until - t)) for v in shift] if jw else shift
        return y[: self.n], total, t, path

    def monodromy(self, until=None):
        """Of the return to the first mode; with `until` of that time, in which a self-timed orbit has the multiplier 1."""
        end = self.follow(self.x, until=until)[0]
        phi = mp.matrix(self.n, self.n)
        for k in range(self.n):
            moved = list(self.x)
            moved[k] += STEP
            for i, (a, b) in enumerate(zip(self.follow(moved, until=until)[0], end)):
                phi[i, k] = (a - b) / STEP
        return phi

    def corrected(self, x, circuit=None, matrices=None):
        end = self.follow(x, circuit, matrices)[0]
        a = mp.eye(self.n) - self.phi
        for k in self.kept:
            a[k, k] += 1
        d = mp.lu_solve(a, mp.matrix([e - v for e, v in zip(end, x)]))
        return [a + s for a, s in zip(x, d)]

    # ---- results
    def multipliers(self):
        values = mp.eig(self.phi, left=False, right=False) if self.n > 1 else [self.phi[0, 0]]
        return sorted(([mpc(v) for v in values]), key=lambda v: (-abs(v), -v.imag))

    def mean(self):
        return self.integral / self.period

    def transfer(self, source, frequency):
        """c_0: output to an input on `source` at this frequency."""
        jw = mpc(0, 2 * mp.pi * mpf(frequency))
        m = Matrices(self.circuit, driven=source, jw=jw)
        until = self.period if self.circuit.period is None else None
        run = lambda x, **given: self.follow(x, jw=jw, until=until, **given)
        base_end, base, _, _ = run(self.x)
        g = mp.matrix([(a - b) / STEP for a, b in zip(run(self.x, matrices=m, small=STEP)[0], base_end)])
        r = mp.lu_solve(mp.exp(jw * self.period) * mp.eye(self.n) - self.monodromy(until), g)
        moved = [a + STEP * b for a, b in zip(self.x, r)]
        return (run(moved, matrices=m, small=STEP)[1] - base) / STEP / self.period

    def derivative(self, parameter):
        """Of the mean (self-timed: of the period) to a parameter."""
        values = []
        for sign in (1, -1):
            p = dict(self.parameters)
            d = STEP * abs(p[parameter])
            p[parameter] += sign * d
            circuit = self.build(p)
            m = Matrices(circuit)
            x = self.x
            for _ in range(3):
                x = self.corrected(x, circuit, m)
            _, integral, period, _ = self.follow(x, circuit, m)
            values.append(period if self.circuit.period is None else integral / period)
        return (values[0] - values[1]) / (2 * d)
