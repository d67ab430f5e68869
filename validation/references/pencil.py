"""A circuit with every switch and diode held in one position, as a pencil  E z' = A z, and its exact solution spaces.

z = (node voltages, currents of C L V E D S, exosystem zeta); charges, fluxes and zeta are E z.  The exosystem holds the
constant 1, sin and cos of each frequency, and value and slope of each piecewise-linear source.

Wong sequences give V (consistent z) and W (directions of jumps and impulses):
    V := A^-1(E V) from the whole space,   W := E^-1(A W) from 0.
V ∩ W is what the circuit leaves undetermined (the potential of a floating part, the share of parallel diodes); charges
and fluxes must not depend on it. On V the solution is y' = M y, z = Vb y; from charges e that do not fit, e = E Vb y + E Wb c
splits into where the circuit jumps to (y) and the impulses -Wb N^(i+1) c of order i, with A Wb N = E Wb.
"""
from mpmath import mp, mpf

from subspace import Solver, apply, intersection, null_space, orthonormal, rows_of, zeros


class Layout:
    """Numbers the unknowns of a deck and knows its sources. Voltages count in V, currents in V/r0, time in units t0."""

    def __init__(self, deck, r0, t0):
        self.deck, self.r0, self.t0 = deck, mpf(r0), mpf(t0)
        self.of = {kind: [e for e in deck.elements if e.kind == kind] for kind in "RCLVIEGFDS"}
        names = {}
        for element in deck.elements:
            for node in element.nodes + (element.control if element.kind in "EGS" else []):
                if node not in ("0", "gnd"):
                    names.setdefault(node, len(names))
        self.node, self.current = names, {}
        for element in deck.elements:
            if element.kind in "CLVEDS":
                self.current[element.name.lower()] = len(names) + len(self.current)
        self.algebraic = len(names) + len(self.current)
        self._exosystem()
        self.size = self.algebraic + len(self.zeta_names)

    def _exosystem(self):
        self.zeta_names, self.source_row = ["1"], {}
        first = self.algebraic
        self.rate = []  # (row, column, value): zeta' = ...
        sines = {}
        for element in self.of["V"] + self.of["I"]:
            source = element.value
            if source.kind == "dc":
                self.source_row[element.name.lower()] = {first: source.value}
            elif source.kind == "sin":
                if source.frequency not in sines:
                    at = first + len(self.zeta_names)
                    sines[source.frequency] = at
                    self.zeta_names += [("sin", source.frequency), ("cos", source.frequency)]
                    omega = 2 * mp.pi * source.frequency * self.t0
                    self.rate += [(at, at + 1, omega), (at + 1, at, -omega)]
                at = sines[source.frequency]
                row = {first: source.value, at: source.amplitude * mp.cos(source.phase), at + 1: source.amplitude * mp.sin(source.phase)}
                self.source_row[element.name.lower()] = {j: v for j, v in row.items() if abs(v) > mpf(10) ** (5 - mp.dps)}
            else:
                at = first + len(self.zeta_names)
                self.source_row[element.name.lower()] = {at: mpf(1)}
                self.zeta_names.append(("value", source))
                if source.has_ramps:
                    self.zeta_names.append(("slope", source))
                    self.rate.append((at, at + 1, mpf(1)))

    def zeta(self, time):
        """The exosystem's state at `time` (right limit)."""
        out = []
        for name in self.zeta_names:
            if name == "1":
                out.append(mpf(1))
            elif name[0] in ("sin", "cos"):
                angle = 2 * mp.pi * mp.frac(name[1] * time)
                out.append(mp.sin(angle) if name[0] == "sin" else mp.cos(angle))
            else:
                value, slope = name[1].value_and_slope(time)
                out.append(value if name[0] == "value" else slope * self.t0)
        return out

    def voltage(self, nodes):
        """Sparse row of v(p) - v(n)."""
        row = {}
        for node, sign in zip(nodes, (1, -1)):
            if node not in ("0", "gnd"):
                j = self.node[node]
                row[j] = row.get(j, mpf(0)) + sign
        return row

    def current_row(self, element):
        """Sparse row of the element's current in units V/r0."""
        name = element.name.lower()
        if name in self.current:
            return {self.current[name]: mpf(1)}
        if element.kind == "R":
            return {j: v * self.r0 / element.value for j, v in self.voltage(element.nodes).items()}
        if element.kind == "I":
            return {j: v * self.r0 for j, v in self.source_row[name].items()}
        if element.kind == "G":
            return {j: v * self.r0 * element.value for j, v in self.voltage(element.control).items()}
        return {self.current[element.control[0]]: element.value}  # F

    def signal(self, text):
        """(sparse row, factor to SI) of a saved signal."""
        inside = [w.strip().lower() for w in text[2:-1].split(",")]
        if text[0] in "vV":
            return self.voltage(inside), mpf(1)
        element = next(e for e in self.deck.elements if e.name.lower() == inside[0])
        return self.current_row(element), 1 / self.r0

    def inductance_rows(self):
        """Sparse rows of the fluxes, in units of r0*t0."""
        coils = self.of["L"]
        at = {e.name.lower(): i for i, e in enumerate(coils)}
        rows = [{self.current[e.name.lower()]: e.value / (self.r0 * self.t0)} for e in coils]
        for a, b, k in self.deck.couplings:
            i, j = at[a], at[b]
            mutual = k * mp.sqrt(coils[i].value * coils[j].value) / (self.r0 * self.t0)
            rows[i][self.current[b]] = rows[j][self.current[a]] = mutual
        return rows

    def pencil(self, closed, conducting):
        """E and A as lists of sparse rows for these closed switches and conducting diodes (sets of names)."""
        kcl = [{} for _ in self.node]
        for element in self.deck.elements:
            for node, sign in zip(element.nodes, (1, -1)):
                if node in ("0", "gnd"):
                    continue
                row = kcl[self.node[node]]
                for j, v in self.current_row(element).items():
                    row[j] = row.get(j, mpf(0)) + sign * v
        e_rows, a_rows = [{} for _ in kcl], kcl
        for element in self.of["C"]:
            factor = element.value * self.r0 / self.t0
            e_rows.append({j: v * factor for j, v in self.voltage(element.nodes).items()})
            a_rows.append(self.current_row(element))
        for element, flux in zip(self.of["L"], self.inductance_rows()):
            e_rows.append(flux)
            a_rows.append(self.voltage(element.nodes))
        for element in self.of["V"] + self.of["E"]:
            row = self.voltage(element.nodes)
            right = self.source_row[element.name.lower()] if element.kind == "V" else \
                {j: v * element.value for j, v in self.voltage(element.control).items()}
            e_rows.append({})
            a_rows.append(subtract(row, right))
        for element in self.of["S"] + self.of["D"]:
            on = element.name in (closed if element.kind == "S" else conducting)
            e_rows.append({})
            a_rows.append({j: -v for j, v in self.blocking_row(element).items()} if on else self.current_row(element))
        for i in range(len(self.zeta_names)):
            e_rows.append({self.algebraic + i: mpf(1)})
            a_rows.append({j: v for r, j, v in self.rate if r == self.algebraic + i})
        return e_rows, a_rows

    def blocking_row(self, element):
        """drop + Ron i - v: >= 0 for a blocking diode, = 0 for a conducting one and for a closed switch."""
        row = {j: -v for j, v in self.voltage(element.nodes).items()}
        ron = element.model.get("ron", mpf(0))
        if ron:
            row = subtract(row, {j: -v * ron / self.r0 for j, v in self.current_row(element).items()})
        if element.model.get("vfwd", mpf(0)):
            row[self.algebraic] = element.model["vfwd"]
        return row

    def charges(self, e_rows, initial):
        """E z of the given capacitor voltages and inductor currents (by element name) and zeta."""
        values, zeta = initial
        count, out = len(self.node), []
        out = zeros(len(e_rows))
        at = count
        for element in self.of["C"]:
            out[at] = element.value * self.r0 / self.t0 * values[element.name]
            at += 1
        for flux in self.inductance_rows():
            by_column = {self.current[e.name.lower()]: values[e.name] * self.r0 for e in self.of["L"]}
            out[at] = sum((v * by_column[j] for j, v in flux.items()), mpf(0))
            at += 1
        out[len(e_rows) - len(zeta):] = zeta
        return out


def subtract(a, b):
    out = dict(a)
    for j, v in b.items():
        out[j] = out.get(j, mpf(0)) - v
    return {j: v for j, v in out.items() if v}


class Mode:
    """One position of all switches and diodes, reduced. `fault` says why it can hold no solution, or is None."""

    def __init__(self, layout, closed, conducting):
        self.layout, self.closed, self.conducting = layout, closed, conducting
        self.e_rows, self.a_rows = layout.pencil(closed, conducting)
        n = layout.size
        v, w = self._wong(n)
        free = intersection(v, w, n)
        self.fault = None
        if any(max(map(abs, apply(self.e_rows, z)), default=0) > mpf(10) ** (-mp.dps // 3) for z in free):
            self.fault = "charges are not determined"
            return
        self.vb, self.wb = orthonormal(v, free), orthonormal(w, free)
        ev = [apply(self.e_rows, z) for z in self.vb]
        ew = [apply(self.e_rows, z) for z in self.wb]
        rows = len(self.e_rows)
        self.split = Solver(ev + ew, rows)
        on_v, on_w = Solver(ev, rows), Solver([apply(self.a_rows, z) for z in self.wb], rows)
        m_columns = [on_v.solve(apply(self.a_rows, z))[0] for z in self.vb]
        n_columns = [on_w.solve(z)[0] for z in ew]
        self.m = sparse(rows_of(m_columns, len(self.vb)))
        self.n = rows_of(n_columns, len(self.wb))
        self.nw = len(self.wb)
        self.ev_rows = rows_of(ev, rows)
        self.guards = [self.on_basis(layout.current_row(d) if d.name in conducting else layout.blocking_row(d)) for d in layout.of["D"]]
        self.rate = max((sum(abs(x) for x in row.values()) for row in self.m), default=mpf(0))

    def _wong(self, n):
        v = [[mpf(i == j) for i in range(n)] for j in range(n)]
        while True:
            ev = [apply(self.e_rows, z) for z in v]
            rows = [dict(row) for row in self.a_rows]
            for i, row in enumerate(rows):
                row.update({n + j: -col[i] for j, col in enumerate(ev) if col[i]})
            new = orthonormal([k[:n] for k in null_space(rows, n + len(v))])
            if len(new) == len(v):
                break
            v = new
        w = []
        while True:
            aw = [apply(self.a_rows, z) for z in w]
            rows = [dict(row) for row in self.e_rows]
            for i, row in enumerate(rows):
                row.update({n + j: -col[i] for j, col in enumerate(aw) if col[i]})
            new = orthonormal([k[:n] for k in null_space(rows, n + len(w))])
            if len(new) == len(w):
                return v, w
            w = new

    def on_basis(self, row):
        """A row over z as (row over y, row over c)."""
        return ([sum((x * z[j] for j, x in row.items()), mpf(0)) for z in self.vb],
                [sum((x * z[j] for j, x in row.items()), mpf(0)) for z in self.wb])

    def enter(self, charges):
        """(y, impulses from the highest order down as vectors c, whether the charges can be reached)."""
        coefficients, violation = self.split.solve(charges)
        y, c = coefficients[:len(self.vb)], coefficients[len(self.vb):]
        impulses = []
        for _ in range(self.nw + 1):
            c = [-x for x in apply(self.n, c)] if not impulses else apply(self.n, c)
            impulses.append(c)
        return y, impulses[::-1], violation < mpf(10) ** (-mp.dps // 3)

    def charges_of(self, y):
        return apply(self.ev_rows, y)


def sparse(rows):
    tiny = mpf(10) ** (-mp.dps * 2 // 3)
    return [{j: v for j, v in row.items() if abs(v) > tiny} for row in rows]
