#!/usr/bin/env python3
"""Makes tests/reference/caseNN.csv from formulas, for the decks tests/hard/caseNN.net.

    python3 validation/references/closed_forms.py            every case
    python3 validation/references/closed_forms.py case16     only these

No solver makes these numbers. As a check of the formulas, the solver of this folder runs each deck too and must agree
to 24 digits. The event times in caseNN.events.csv are the solver's.
"""
import sys

sys.dont_write_bytecode = True
from mpmath import asin, atan, cos, exp, findroot, mp, mpf, phi, pi, sin, sqrt  # noqa: E402

from deck import Deck, number  # noqa: E402
from generate import AGREE, OUT, ROOT, text_of, write, write_events  # noqa: E402
from trajectory import Trajectory  # noqa: E402

HARD = ROOT / "tests" / "hard"
CASES = {}


def case(name, formula_text, unchecked=(), check_stop=None):
    """Registers make() -> f, where f(t) gives the saved signals; `unchecked` columns are not determined by the circuit.
    check_stop: where the solver, which follows the fastest time constant, checks only a beginning of the run."""
    def register(make):
        CASES[name] = (formula_text, make, unchecked, check_stop)
        return make
    return register


def constant(name, formula_text, values, unchecked=()):
    case(name, formula_text, unchecked)(lambda: lambda t: [mpf(v) for v in values()])


def swing(t, x2, x4):
    """Two free carts from x1 = x3 = 0: modes of frequency 1/phi (x2 = phi x1) and phi (x2 = -x1/phi)."""
    slow, fast, root5 = t / phi, t * phi, sqrt(mpf(5))
    x1 = (x2 * (cos(slow) - cos(fast)) + x4 * (phi * sin(slow) - sin(fast) / phi)) / root5
    y2 = (x2 * (phi * cos(slow) + cos(fast) / phi) + x4 * (phi ** 2 * sin(slow) + sin(fast) / phi ** 2)) / root5
    x3 = (x2 * (phi * sin(fast) - sin(slow) / phi) + x4 * (cos(slow) - cos(fast))) / root5
    y4 = (-x2 * (sin(slow) + sin(fast)) + x4 * (phi * cos(slow) + cos(fast) / phi)) / root5
    return [x1, y2, x3, y4]


@case("case01", "x2 = -cos t, x4 = sin t at the stop until pi/2; then tau = t - pi/2: x1 = (phi sin(tau/phi) - sin(phi tau)/phi)/sqrt 5")
def _():
    return lambda t: [mpf(0), -cos(t), mpf(0), sin(t)] if t < pi / 2 else swing(t - pi / 2, 0, 1)


@case("case02", "x1 = t + a sin(t/phi) + b sin(phi t), x2 = 2t + phi a sin(t/phi) - b sin(phi t)/phi, a = -(1+2 phi)/sqrt 5, b = a + 2")
def _():
    a = -(1 + 2 * phi) / sqrt(mpf(5))
    b = a + 2
    return lambda t: [t + a * sin(t / phi) + b * sin(phi * t), 2 * t + phi * a * sin(t / phi) - b * sin(phi * t) / phi,
                      1 + a / phi * cos(t / phi) + b * phi * cos(phi * t), 2 + a * cos(t / phi) - b * cos(phi * t)]


@case("case03", "x3 jumps to 0; x1 = (cos(t/phi) - cos(phi t))/sqrt 5, x2 = (phi cos(t/phi) + cos(phi t)/phi)/sqrt 5")
def _():
    return lambda t: swing(t, 1, 0)


@case("case04", "free until x1 = 0 at about 3e-4 (root of case 3's x1 times 1e-4 less case 1's x1), then x2'' = -x2 at the stop")
def _():
    start = (mpf("1e-4"), mpf(-1))
    hit = findroot(lambda t: swing(t, *start)[0] / t ** 2, mpf("3e-4"))
    _, x2, _, x4 = swing(hit, *start)
    held = lambda s: [mpf(0), x2 * cos(s) + x4 * sin(s), mpf(0), x4 * cos(s) - x2 * sin(s)]
    return lambda t: swing(t, *start) if t < hit else held(t - hit)


constant("case06", "0 from t = 0 on", lambda: [0, 0, 0])


@case("case07", "x = 1/4 - t + t^2/2 until 1 - sqrt(1/2); 0 until t = 1; (t-1)^2/2")
def _():
    return lambda t: [mpf(1) / 4 - t + t * t / 2 if t < 1 - sqrt(mpf(1) / 2) else mpf(0) if t < 1 else (t - 1) ** 2 / 2]


@case("case09", "x = max(1 - t, 0)")
def _():
    return lambda t: [max(1 - t, mpf(0))]


@case("case10", "x = 2 - t until t = 1, then exp(-(t-1))")
def _():
    return lambda t: [2 - t if t < 1 else exp(1 - t)]


@case("case12", "half swings around +1, -1, +1: x = 1 + 4.5 cos t, -1 + 2.5 cos t, 1 + 0.5 cos t; x = 0.5 from 3 pi on")
def _():
    def f(t):
        if t >= 3 * pi:
            return [mpf(1) / 2, mpf(0)]
        centre, amplitude = [(1, mpf("4.5")), (-1, mpf("2.5")), (1, mpf("0.5"))][int(t / pi)]
        return [centre + amplitude * cos(t), -amplitude * sin(t)]
    return f


@case("case16", "in each period i = (sin(t - pi/4) + sin(pi/4) exp(-t))/sqrt 2 until beta, sin(beta - pi/4) + sin(pi/4) exp(-beta) = 0")
def _():
    current = lambda t: (sin(t - pi / 4) + sin(pi / 4) * exp(-t)) / sqrt(mpf(2))
    beta = findroot(current, mpf("3.94"))

    def f(t):
        s = t - 2 * pi * int(t / (2 * pi))
        return [current(s) if s < beta else mpf(0)] * 2
    return f


def peaks(period):
    """max-follower of sin, RC = 2: off at pi - atan 2, decay, on again where the decay meets the next rise."""
    off = pi - atan(mpf(2))
    decay = lambda t: sin(off) * exp(-(t - off) / 2)
    wave = (lambda t: sin(t)) if period > 4 else (lambda t: -sin(t))
    on = findroot(lambda t: wave(t) - decay(t), mpf("6.385") if period > 4 else mpf("3.57"))

    def f(t):
        s = t - period * int((t - off) / period) if t >= off else t
        return [sin(s) if s < off else decay(s) if s < on else wave(s)]
    return f


case("case17", "0 at t = 0; sin t; from pi - atan 2 sin(off) exp(-(t - off)/2) until it meets sin t at 6.384949403569911; period 2 pi")(
    lambda: peaks(2 * pi))
case("case26", "as case 17: the second diode changes nothing outside")(lambda: peaks(2 * pi))
case("case28b", "as case 17 with |sin t|: off at pi - atan 2, on at 3.569668899701, period pi")(lambda: peaks(pi))


@case("case18", "v = cos(t/sqrt(LC)), i = sqrt(C/L) sin(t/sqrt(LC)) until pi sqrt(LC); then -1 and 0")
def _():
    w = 1 / sqrt(mpf("1e-8"))
    return lambda t: [cos(w * t), mpf("0.01") * sin(w * t)] if w * t < pi else [mpf(-1), mpf(0)]


constant("case19", "(1*3 + 2*0)/3", lambda: [1, 1])
constant("case20", "5e-12/(1e-12 + 1e-6)", lambda: [mpf("5e-12") / (mpf("1e-12") + mpf("1e-6"))] * 2)
constant("case21a", "isotonic regression of (3, 0, 1): 4/3", lambda: [mpf(4) / 3] * 3)
constant("case21b", "isotonic regression of (3, 0, 2): (1.5, 1.5, 2)", lambda: ["1.5", "1.5", 2])
constant("case22a", "flux mean (1*2 + 3*(-1))/4", lambda: ["-0.25", "-0.25"])
constant("case22b", "no jump: the diode carries 3 A", lambda: [-1, 2])


@case("case23", "in each period i = 1 - cos t until pi/3, 0.5 until pi, -0.5 - cos t until 4 pi/3, 0; v(b) = sin t between pi/3 and pi, else 0")
def _():
    def f(t):
        s = t - 2 * pi * int(t / (2 * pi))
        if s < pi / 3:
            return [1 - cos(s), mpf(0)]
        if s < pi:
            return [mpf(1) / 2, sin(s)]
        return [-mpf(1) / 2 - cos(s) if s < 4 * pi / 3 else mpf(0), mpf(0)]
    return f


@case("case24", "v(m) = exp(-(t-1u)/4u)/4 from 1 us, less exp(-(t-11u)/4u)/4 from 11 us; v(s,m) the source less that")
def _():
    def f(t):
        u, v, s = mpf("1e-6"), mpf(0), 0
        for edge, sign in ((1, 1), (11, -1)):
            if t > edge * u - mpf("1e-20"):  # right limit, whatever the last digit of t
                v, s = v + sign * exp(-(t - edge * u) / (4 * u)) / 4, s + sign
        return [v, s - v]
    return f


constant("case25", "(1, 0, 1) + x (1, 1, 1), x >= 0, least norm: x = 0; all nodes at 0 V", lambda: [1, 0, 1, 0, 0], unchecked=(0, 1, 2))


def resistive_charging(shares):
    """v' = sin t - 1.5 v while sin t > v, else v' = -v/2, from 0."""
    particular = lambda t: (mpf("1.5") * sin(t) - cos(t)) / mpf("3.25")

    def on_from(t0, v0):
        return lambda t: particular(t) + (v0 - particular(t0)) * exp(-mpf("1.5") * (t - t0))

    pieces, t, v = [], mpf(0), mpf(0)
    while t < 21:
        turn = 2 * pi * len(pieces[::2])
        rising = on_from(t, v)
        stop = findroot(lambda x: sin(x) - rising(x), turn + mpf("2.61"))
        falling = (lambda t0, v0: lambda x: v0 * exp(-(x - t0) / 2))(stop, rising(stop))
        pieces += [(stop, rising), (findroot(lambda x: sin(x) - falling(x), turn + mpf("6.36")), falling)]
        t, v = pieces[-1][0], falling(pieces[-1][0])

    def f(t):
        i = next(i for i, (end, _) in enumerate(pieces) if t < end)
        v = pieces[i][1](t)
        return [v] + [(sin(t) - v) / shares if i % 2 == 0 else mpf(0)] * shares
    return f


FORMULA_27 = "on: v = (1.5 sin t - cos t)/3.25 + A exp(-1.5 t); off: B exp(-t/2); switching where sin t = v"
case("case27a", FORMULA_27)(lambda: resistive_charging(1))
case("case27b", FORMULA_27 + "; equal shares by least norm", unchecked=(1, 2))(lambda: resistive_charging(2))


@case("case28a", "|sin t|")
def _():
    return lambda t: [abs(sin(t))]


@case("case29", "v(b) = 2 (1 - 0.75^n) after n positive edges; v(s,a) = 1 - v(b) after them, -1 after negative ones")
def _():
    def f(t):
        n = int((t + 1) / 2)
        v, high = 2 * (1 - mpf("0.75") ** n), t >= 1 and int(t) % 2 == 1
        return [v, 1 - v if high else mpf(-1), v if high else mpf(0)]
    return f


@case("case30", "i = 4 s until s = 0.3, 1.2 - 6 (s - 0.3) until 0.5, 0 until 1; v(sw) = 10, 0, 6")
def _():
    def f(t):
        s = t - int(t)
        if s < mpf("0.3"):
            return [4 * s, mpf(10)]
        return [mpf("1.2") - 6 * (s - mpf("0.3")), mpf(0)] if s < mpf("0.5") else [mpf(0), mpf(6)]
    return f


@case("case31a", "x = 0.99999999 sin t")
def _():
    return lambda t: [mpf("0.99999999") * sin(t), mpf("0.99999999") * cos(t)]


@case("case31b", "x = 1.00000001 sin t until asin(1/1.00000001) = tc, then cos(t - tc)")
def _():
    a = mpf("1.00000001")
    hit = asin(1 / a)
    return lambda t: [a * sin(t), a * cos(t)] if t < hit else [cos(t - hit), -sin(t - hit)]


@case("case31c", "x = sin t")
def _():
    return lambda t: [sin(t), cos(t)]


@case("case32", "v(a) = exp(-t); v(h) = 1 - exp(-(t - t1)/1n) between the zeros t1, t2 of g = exp(-t) - 5 (exp(-1e9 t) - exp(-2e9 t)), then constant",
      check_stop="20n")
def _():
    nano = mpf("1e-9")
    g = lambda s: exp(-s * nano) - 5 * (exp(-s) - exp(-2 * s))
    t1, t2 = findroot(g, mpf("0.3235")), findroot(g, mpf("1.2859"))
    return lambda t: [1 - exp(-(min(max(t / nano, t1), t2) - t1)), exp(-t)]


@case("case33", "v(c) = t^2 exp(-t)/2; v(h) = 1 - exp(-(t - t1)) between the roots t1, t2 of t^2 exp(-t) = 1/2, constant after")
def _():
    g = lambda t: t * t * exp(-t) - mpf(1) / 2
    t1, t2 = findroot(g, mpf("1.488")), findroot(g, mpf("2.618"))
    return lambda t: [t * t * exp(-t) / 2, 1 - exp(-(min(max(t, t1), t2) - t1))]


@case("tank_clamp", "v = cos(1e4 t), i = 0.01 sin(1e4 t): the clamp is touched and never conducts", check_stop="20m")
def _():
    return lambda t: [cos(10000 * t), sin(10000 * t) / 100]


def worst(rows, run, columns):
    """Worst difference of the checked columns relative to their maxima."""
    out = mpf(0)
    for i in columns:
        size = max(abs(values[i]) for _, values in rows) or mpf(1)
        out = max([out] + [abs(p[i] - q[i]) / size for (_, p), (_, q) in zip(rows, run.rows)])
    return out


def check(path, f, unchecked, check_stop):
    """(run of the solver, its worst difference from the formula f)."""
    deck = Deck(path)
    if check_stop:
        deck.stop = number(check_stop)
        deck.step = deck.stop / 100
    run = Trajectory(deck, digits=50).run([k * deck.step for k in range(int(mp.nint(deck.stop / deck.step)) + 1)])
    with mp.workdps(60):
        rows = [(t, f(t)) for t, _ in run.rows]
        return run, worst(rows, run, [i for i in range(len(deck.saves)) if i not in unchecked])


def main(names):
    mp.dps = 110
    for name in names or CASES:
        formula_text, make, unchecked, check_stop = CASES[name]
        path = (HARD if name.startswith("case") else ROOT / "netlists") / f"{name}.net"
        with mp.workdps(60):
            f = make()
        run, difference = check(path, f, unchecked, check_stop)
        if difference > AGREE:
            raise SystemExit(f"{name}: formula and solver differ by {mp.nstr(difference, 3)}")
        write_events(name, path.relative_to(ROOT), run,
                     [f"Made by: python3 validation/references/closed_forms.py {name} (by the solver, which agrees with the formula"]
                     + [f"of {name}.csv to {mp.nstr(difference, 2)}" + (f"; up to {check_stop}s only)." if check_stop else ").")])
        deck = Deck(path)
        with mp.workdps(60):
            rows = [(k * deck.step, f(k * deck.step)) for k in range(int(mp.nint(deck.stop / deck.step)) + 1)]
        head = [f"{path.relative_to(ROOT)}: {formula_text}", f"Made by: python3 validation/references/closed_forms.py {name}"]
        maxima = [max(abs(v[i]) for _, v in rows) or mpf(1) for i in range(len(deck.saves))]
        write(OUT / f"{name}.csv", head, ["time"] + deck.saves,
              [",".join([text_of(t)] + [text_of(v, m) for v, m in zip(values, maxima)]) for t, values in rows])
        print(f"{name}: {len(rows)} rows, {len(run.events)} events, formula and solver differ by {mp.nstr(difference, 2)}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
