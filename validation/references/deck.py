"""Reads the example decks: the part of the netlist language that the references need, every number kept exact.

Own reading of docs: independent of the simulator. Times, values and expressions become mpf at the working precision,
straight from the decimal text (47u is 47e-6, not the double next to it).
"""
import re
from dataclasses import dataclass, field

from mpmath import mp, mpf

SUFFIXES = {"t": 12, "g": 9, "meg": 6, "k": 3, "m": -3, "u": -6, "n": -9, "p": -12, "f": -15}
NUMBER = re.compile(r"^([+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)(meg|[tgkmunpf])?[a-z]*$", re.I)


def number(text):
    text = text.strip()
    if text.startswith("{"):
        names = {"pi": mp.pi, "sqrt": mp.sqrt, "__builtins__": {}}
        exact = re.sub(r"(?<![\w.])(\d+\.?\d*(?:e[+-]?\d+)?)", r"mpf('\1')", text[1:-1])
        return mpf(eval(exact, dict(names, mpf=mpf)))  # our own decks only
    match = NUMBER.match(text)
    if not match:
        raise ValueError(f"not a number: {text}")
    power = SUFFIXES[match.group(2).lower()] if match.group(2) else 0
    return mpf(match.group(1)) * mpf(10) ** power


@dataclass
class Element:
    kind: str
    name: str
    nodes: list
    value: object = None
    initial: object = None
    control: list = field(default_factory=list)  # nodes, or the name of the controlling source
    model: dict = field(default_factory=dict)
    flag_on: bool = False


class Source:
    """Piecewise a + b*(t - t0) plus offset + amplitude*sin(2 pi f t + phase); the first alone or the second alone."""

    def __init__(self, text):
        match = re.match(r"(?i)\s*(?:dc\s+)?(sin|pulse|pwl)\s*\((.*)\)", text)
        self.kind, self.frequency = "dc", None
        if not match:
            self.value = number(re.sub(r"(?i)^\s*dc\s+", "", text))
            return
        words = re.findall(r"\{[^}]*\}|[^\s,()]+", match.group(2))
        a = [number(w) for w in words]
        self.kind = match.group(1).lower()
        if self.kind == "sin":
            a += [mpf(0)] * (6 - len(a))
            self.value, self.amplitude, self.frequency = a[0], a[1], a[2]
            if a[3] != 0 or a[4] != 0:
                raise ValueError("SIN with delay or damping is not needed by any reference deck")
            self.phase = a[5] * mp.pi / 180
        elif self.kind == "pulse":
            v1, v2, delay, rise, fall, width, self.period = (a + [mpf("inf")] * 7)[:7]
            self.delay, self.before = delay, v1
            self.corners = [(mpf(0), v1), (rise, v2)]
            if mp.isfinite(width):
                self.corners += [(rise + width, v2), (rise + width + fall, v1)]
        else:
            self.delay, self.period, self.before = mpf(0), mpf("inf"), a[1]
            self.corners = list(zip(a[::2], a[1::2]))

    def breakpoints(self, stop):
        if self.kind in ("dc", "sin"):
            return []
        times, cycle = [], 0
        while True:
            start = self.delay + (cycle * self.period if mp.isfinite(self.period) else 0)
            if start > stop:
                return times
            times += [start + corner for corner, _ in self.corners]
            cycle += 1
            if not mp.isfinite(self.period):
                return times

    def value_and_slope(self, time):
        """Right limit at `time` (of the piecewise kinds)."""
        tiny = mpf(10) ** (-mp.dps + 12)
        if time < self.delay - tiny:
            return self.before, mpf(0)
        local = time - self.delay
        if mp.isfinite(self.period):
            local -= mp.floor(local / self.period + tiny) * self.period
        value, slope = self.before, mpf(0)
        for i, (corner, level) in enumerate(self.corners):
            if corner > local + tiny:
                break
            value, slope = level, mpf(0)
            if i + 1 < len(self.corners):
                until, target = self.corners[i + 1]
                if until > corner:
                    slope = (target - level) / (until - corner)
                    value = level + slope * max(local - corner, mpf(0))
        return value, slope

    @property
    def has_ramps(self):
        pairs = list(zip(self.corners, self.corners[1:]))
        return any(b[0] > a[0] and b[1] != a[1] for a, b in pairs)


class Deck:
    def __init__(self, path):
        text = open(path, encoding="utf-8").read().split("\n")
        self.title, cards = text[0], []
        for line in text[1:]:
            line = line.split(";")[0].rstrip()
            if line.startswith("+"):
                cards[-1] += " " + line[1:]
            elif line and not line.startswith("*"):
                cards.append(line)
        self.elements, self.saves, self.models, self.couplings = [], [], {}, []
        for card in cards:
            self._control(card) if card.startswith(".") else self._element(card)
        for element in self.elements:
            if element.kind in "DS":
                element.model = self.models[element.model.lower()]

    def _control(self, card):
        words = card.split()
        keyword = words[0].lower()
        if keyword == ".tran":
            self.step, self.stop = number(words[1]), number(words[2])
        elif keyword == ".save":
            self.saves += re.findall(r"[viVI]\([^)]*\)", card)
        elif keyword == ".model":
            parameters = re.findall(r"(\w+)\s*=\s*([^\s(),]+)", card)
            self.models[words[1].lower()] = {k.lower(): number(v) for k, v in parameters}

    def _element(self, card):
        words = re.findall(r"\{[^}]*\}|[^\s]+", card)
        name, kind, nodes = words[0], words[0][0].upper(), [w.lower() for w in words[1:3]]
        if kind in "RCL":
            initial = [number(w[3:]) for w in words[4:] if w.lower().startswith("ic=")]
            if len(words) > 4 + len(initial):
                raise ValueError(f"unknown parameter in {card}")
            self.elements.append(Element(kind, name, nodes, number(words[3]), (initial or [mpf(0)])[0]))
        elif kind == "K":
            inductors, k = words[1:-1], number(words[-1])
            self.couplings += [(a.lower(), b.lower(), k) for i, a in enumerate(inductors) for b in inductors[i + 1:]]
        elif kind in "VI":
            self.elements.append(Element(kind, name, nodes, Source(" ".join(words[3:]))))
        elif kind in "EG":
            self.elements.append(Element(kind, name, nodes, number(words[5]), control=[w.lower() for w in words[3:5]]))
        elif kind == "F":
            self.elements.append(Element(kind, name, nodes, number(words[4]), control=[words[3].lower()]))
        elif kind == "D":
            self.elements.append(Element(kind, name, nodes, model=words[3]))
        elif kind == "S":
            flag = len(words) > 6 and words[6].lower() == "on"
            self.elements.append(Element(kind, name, nodes, control=[w.lower() for w in words[3:5]], model=words[5], flag_on=flag))
        else:
            raise ValueError(f"unknown card {card}")
