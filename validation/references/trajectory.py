"""Runs a deck: Taylor series of the matrix exponential in each mode, exact first zeros of the guards, next mode by
enumeration of all positions that are consistent in the sense of Laplace (every guard's expansion at s -> infinity,
impulses first, is lexicographically nonnegative)."""
from itertools import combinations

from mpmath import mp, mpf

from pencil import Layout, Mode, subtract
from roots import evaluate, first_zero
from subspace import apply, dot


class Failure(Exception):
    pass


class Trajectory:
    def __init__(self, deck, digits=50, reach=6.0, r0=1, t0=None, every_mode=False):
        self.deck, self.digits, self.reach, self.every_mode = deck, digits, mpf(reach), every_mode
        self.layout = Layout(deck, r0, t0 or deck.stop / 1000)
        self.bits, self.scaled = int(digits * 3.33) + 40, (None, None, None)
        self.modes, self.rows, self.events, self.visited = {}, [], [], set()
        self.noise = mpf(10) ** (-digits * 3 // 5)  # of expansions, whose higher terms carry amplified rounding
        self.touch = mpf(10) ** (-digits * 3 // 4)  # of guard values along a step
        self.diodes = [d.name for d in self.layout.of["D"]]
        self.switches = self.layout.of["S"]

    def mode(self, closed, conducting):
        key = (closed, conducting)
        if key not in self.modes:
            with mp.workdps(2 * self.digits):
                mode = Mode(self.layout, closed, conducting)
                if not mode.fault:
                    mode.switch_guards = [mode.on_basis(self.switch_row(s, s.name in closed))[0] for s in self.switches]
                    mode.signals = []
                    for text in self.deck.saves:
                        row, factor = self.layout.signal(text)
                        mode.signals.append([x * factor for x in mode.on_basis(row)[0]])
            self.modes[key] = mode
        return self.modes[key]

    def switch_row(self, switch, on):
        """Nonnegative while the switch stays as it is."""
        control = self.layout.voltage(switch.control)
        vt, vh = switch.model.get("vt", mpf(0)), switch.model.get("vh", mpf(0))
        one = {self.layout.algebraic: (vt - vh) if on else (vt + vh)}
        return subtract(control, one) if on else subtract(one, control)

    # ---- signs of expansions
    def sign(self, guard, mode, y, impulses=()):
        rows_y, rows_c = guard if isinstance(guard, tuple) else (guard, None)
        size = max(map(abs, y), default=mpf(0))
        for c in impulses:
            value, scale = dot(rows_c, c), max(map(abs, c), default=mpf(0))
            if abs(value) > self.noise * max(scale, size):
                return 1 if value > 0 else -1
        z, scale = y, size * max(map(abs, rows_y), default=mpf(0))
        for _ in range(len(y) + 1):
            value = dot(rows_y, z)
            if abs(value) > self.noise * scale:
                return 1 if value > 0 else -1
            z = [x / mode.rate for x in apply(mode.m, z)] if mode.rate else [mpf(0)] * len(y)
        return 0

    def consistent(self, mode, charges):
        """None or (y, whether it jumps)."""
        if mode.fault:
            return None
        y, impulses, reachable = mode.enter(charges)
        if not reachable:
            return None
        size = max(map(abs, y), default=mpf(0))
        moved = max((abs(x) for c in impulses for x in c), default=mpf(0))
        jumps = moved > self.noise * size and moved > 0
        if all(self.sign(g, mode, y, impulses if jumps else ()) >= 0 for g in mode.guards):
            return y, jumps
        return None

    def candidates(self, conducting):
        for distance in range(len(self.diodes) + 1):
            for flips in combinations(self.diodes, distance):
                yield conducting ^ frozenset(flips)

    def select(self, closed, conducting, charges, time):
        """The mode that continues from these charges, its y, the charges after all jumps, whether any happened."""
        jumped = False
        for _ in range(20):
            found = None
            for candidate in self.candidates(conducting):
                mode = self.mode(closed, candidate)
                answer = self.consistent(mode, charges)
                if not answer:
                    continue
                if found is None:
                    found = (mode, *answer)
                    if not self.every_mode:
                        break
                elif not answer[1] and not found[2]:
                    self.same_flow(found[0], found[1], mode, answer[0], time)
            if found is None:
                raise Failure(f"no mode at {mp.nstr(time, 20)}")
            mode, y, jumps = found
            conducting = mode.conducting
            if not jumps:
                return mode, y, jumped
            jumped, charges = True, mode.charges_of(y)
        raise Failure("jumps do not end")

    def flow(self, mode, y, count):
        """Charges and saved signals with their derivatives, in units of the deck's thousandth."""
        out = []
        for _ in range(count):
            out.append(mode.charges_of(y) + [dot(row, y) for row in mode.signals])
            y = apply(mode.m, y)
        return out

    def differ(self, mode_a, y_a, mode_b, y_b):
        count = max(len(y_a), len(y_b)) + 1
        rate = max(mode_a.rate, mode_b.rate, mpf(1))
        for k, (p, q) in enumerate(zip(self.flow(mode_a, y_a, count), self.flow(mode_b, y_b, count))):
            size = max(map(abs, p + q), default=mpf(0))
            first = size if k == 0 else first
            if any(abs(u - v) > self.noise * max(size, first * rate ** k) for u, v in zip(p, q)):
                return True
        return False

    def same_flow(self, mode_a, y_a, mode_b, y_b, time):
        charges_a, charges_b = mode_a.charges_of(y_a), mode_b.charges_of(y_b)
        if max(abs(u - v) for u, v in zip(charges_a, charges_b)) > self.noise * max(map(abs, charges_a)):
            raise Failure(f"two consistent modes with different states at {mp.nstr(time, 20)}")
        rate = max(mode_a.rate, mode_b.rate, mpf(1))
        for k in range(1, max(len(y_a), len(y_b)) + 1):
            y_a, y_b = apply(mode_a.m, y_a), apply(mode_b.m, y_b)
            p, q = mode_a.charges_of(y_a), mode_b.charges_of(y_b)
            if any(abs(u - v) > self.noise * max(map(abs, charges_a)) * rate ** k for u, v in zip(p, q)):
                raise Failure(f"two consistent modes with different flows at {mp.nstr(time, 20)}")

    # ---- switches
    def source_driven(self, switch, on, zeta):
        """Sign of the guard of a switch whose control hangs on grounded sources alone; None for any other."""
        at = {e.nodes[0]: e for e in self.layout.of["V"] if e.nodes[1] in ("0", "gnd")}
        row = {}
        for node, sign in zip(switch.control, (1, -1)):
            if node in ("0", "gnd"):
                continue
            if node not in at:
                return None
            source = self.layout.source_row[at[node].name.lower()]
            row = subtract(row, {j: -sign * v for j, v in source.items()})
        vt, vh = switch.model.get("vt", mpf(0)), switch.model.get("vh", mpf(0))
        one = {self.layout.algebraic: (vt - vh) if on else (vt + vh)}
        row = subtract(row, one) if on else subtract(one, row)
        first, z = self.layout.algebraic, zeta
        speed = max((abs(v) for _, _, v in self.layout.rate), default=mpf(1))
        for _ in range(len(zeta) + 1):
            value = sum((v * z[j - first] for j, v in row.items()), mpf(0))
            if abs(value) > self.noise * max(map(abs, zeta)):
                return 1 if value > 0 else -1
            new = [mpf(0)] * len(z)
            for r, j, v in self.layout.rate:
                new[r - first] += v * z[j - first] / speed
            z = new
        return 0

    def settle(self, closed, conducting, charges, time, zeta):
        """Switches and diodes after `time`: no position between is visited where the sources alone decide."""
        flips = frozenset(s.name for s in self.switches if (self.source_driven(s, s.name in closed, zeta) or 0) < 0)
        closed, jumped = closed ^ flips, False
        for _ in range(12):
            mode, y, moved = self.select(closed, conducting, charges, time)
            jumped = jumped or moved
            flips = frozenset(s.name for s, g in zip(self.switches, mode.switch_guards) if self.sign(g, mode, y) < 0)
            if not flips:
                return mode, y, jumped
            closed, conducting, charges = closed ^ flips, mode.conducting, mode.charges_of(y)
        raise Failure(f"switches do not settle at {mp.nstr(time, 20)}")

    # ---- running
    def run(self, sample_times):
        with mp.workdps(self.digits):
            self._run(sorted(sample_times))
        return self

    def _breakpoints(self):
        stop, tiny = self.deck.stop, self.deck.stop * mpf(10) ** (10 - self.digits)
        times = sorted(t for e in self.layout.of["V"] + self.layout.of["I"] for t in e.value.breakpoints(stop))
        out = []
        for t in times + [stop]:
            if t > tiny and t <= stop and (not out or t - out[-1] > tiny):
                out.append(t)
        return out

    def _run(self, samples):
        deck, layout = self.deck, self.layout
        tiny = deck.stop * mpf(10) ** (10 - self.digits)
        initial = {e.name: e.initial for e in layout.of["C"] + layout.of["L"]}
        zeta, time = layout.zeta(mpf(0)), mpf(0)
        closed = frozenset(s.name for s in self.switches if s.flag_on)
        charges = layout.charges([{}] * layout.size, (initial, zeta))
        mode, y, jumped = self.settle(closed, frozenset(), charges, time, zeta)
        if jumped:
            self._record(time, None, mode, "jump", y)
        at = 0
        for end in self._breakpoints():
            while end - time > tiny:
                at = self._emit(samples, at, time + tiny, mode, lambda t: y)
                self.visited.add((mode.closed, mode.conducting))
                time, mode, y, at = self._segment(time, end, mode, y, samples, at, tiny)
            new = layout.zeta(end)
            charges = mode.charges_of(y)
            old, charges[-len(new):] = charges[-len(new):], new
            edge = self._edge(old, new)
            before, y_before, time = mode, y, end
            mode, y, jumped = self.settle(mode.closed, mode.conducting, charges, end, new)
            if edge or jumped or before.closed != mode.closed or self.differ(before, y_before, mode, y):
                self._record(time, before, mode, edge + (" jump" if jumped else ""), y)
        self._emit(samples, at, deck.stop + tiny, mode, lambda t: y)

    def _edge(self, old, new):
        """"edge" where a source's value jumps, "corner" where only a slope changes, else ""."""
        moved = [name for name, a, b in zip(self.layout.zeta_names, old, new) if abs(a - b) > self.noise]
        return "edge" if any(name[0] == "value" for name in moved) else "corner" if moved else ""

    def _emit(self, samples, at, until, mode, y_of):
        while at < len(samples) and samples[at] < until:
            y = y_of(samples[at])
            self.rows.append((samples[at], [dot(row, y) for row in mode.signals]))
            at += 1
        return at

    def _record(self, time, before, mode, text, y):
        words = text.split()
        if before:
            words += sorted(("+" if n in mode.closed else "-") + n for n in before.closed ^ mode.closed)
            words += sorted(("+" if n in mode.conducting else "-") + n for n in before.conducting ^ mode.conducting)
        self.events.append((time, " ".join(words), [dot(row, y) for row in mode.signals]))

    def _segment(self, time, end, mode, y, samples, at, tiny):
        """Marches in one mode until `end` or the first event; handles the event."""
        guards = [g[0] for g in mode.guards] + mode.switch_guards
        guards = [g for g in guards if self.sign(g, mode, y) != 0]
        fixed = [[self._to_fixed(x) for x in g] for g in guards]
        t0 = self.layout.t0
        while end - time > tiny:
            h = (end - time) / t0
            if mode.rate * h > self.reach:
                h = self.reach / mode.rate
            terms = self._taylor(mode, y, h)
            s, hit = self._first_event(guards, fixed, terms)
            until = time + s * h * t0
            if end - until < tiny:
                until = end
            start, step = time, h * t0
            at = self._emit(samples, at, until - tiny, mode, lambda t: self._at(terms, (t - start) / step))
            y, time = self._at(terms, s), until
            if hit:
                return self._event(time, end, mode, y) + (at,)
        return time, mode, y, at

    # Taylor terms are integers: value * 2^bits. Their rounding is absolute, far below the largest state's last digit.
    def _to_fixed(self, x):
        return int(mp.nint(mp.ldexp(x, self.bits)))

    def _at(self, terms, s):
        return [mp.ldexp(mpf(sum(c)) if s == 1 else evaluate([mpf(x) for x in c], s), -self.bits) for c in zip(*terms)]

    def _taylor(self, mode, y, h):
        bits = self.bits
        if self.scaled[:2] != (mode, h):
            rows = [[(j, self._to_fixed(v * h)) for j, v in row.items()] for row in mode.m]
            self.scaled = (mode, h, rows)
        rows, bound = self.scaled[2], int(mode.rate * h) + 1
        y = [self._to_fixed(x) for x in y]
        terms, k, least = [y], 0, 1 << (bits - int(self.digits * 3.33) - 10)
        least = max(least, max(map(abs, y), default=0) >> (bits - 20))
        while True:
            k += 1
            y = [(sum(v * y[j] for j, v in row) >> bits) // k for row in rows]
            terms.append(y)
            if k > bound and max(map(abs, y), default=0) <= least:
                return terms

    def _first_event(self, guards, fixed, terms):
        best, hit = mpf(1), False
        size = max(max(map(abs, y), default=0) for y in terms)
        for guard, row in zip(guards, fixed):
            a = [sum(g * x for g, x in zip(row, y)) >> self.bits for y in terms]
            noise = self.touch * size * max(map(abs, guard))
            lead = next((k for k, x in enumerate(a) if abs(x) > noise), None)
            if lead is None:
                continue
            if a[lead] < 0:
                if lead == 0:
                    raise Failure("a guard is negative at the start of a step")
                return mpf(0), True
            s = first_zero(a[lead:], noise)
            if s is not None and s <= best:
                best, hit = s, True
        return best, hit

    def _event(self, time, end, mode, y):
        if time == end:
            return time, mode, y  # decided there, together with what the sources do
        charges = mode.charges_of(y)
        zeta = charges[-len(self.layout.zeta_names):]
        after, y_after, jumped = self.settle(mode.closed, mode.conducting, charges, time, zeta)
        if jumped or after.closed != mode.closed or self.differ(mode, y, after, y_after):
            self._record(time, mode, after, "jump" if jumped else "", y_after)
        return time, after, y_after
