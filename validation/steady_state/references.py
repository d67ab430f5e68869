#!/usr/bin/env python3
"""validation/steady_state/references.py [NAME ...]: long-digit references of the decks here from the equations in circuits.py or, for
circuits of many modes, by the solver of validation/references (deck_orbit.py); makes references/NAME.csv.

Debian: python3-mpmath; a few minutes. check.py compares the program with them.
"""
import csv
import pathlib
import sys
import time

sys.dont_write_bytecode = True
from mpmath import mp, mpf  # noqa: E402

from automaton import Orbit  # noqa: E402
from circuits import CIRCUITS  # noqa: E402
from deck_orbit import DECKS, DeckOrbit  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
SUFFIXES = {"k": 3, "m": -3, "u": -6, "n": -9}


# of these the falling edge of Vg is an input and a parameter, too
DUTY = {"buck", "buck_discontinuous", "boost", "boost_discontinuous", "buck_boost", "cuk", "input_filter"}
FLUXES = {("llc", f"i(L{k})") for k in (1, 2, 3)}  # one flux links the three: the program's state


def shown(x):
    return mp.nstr(x if abs(x) > mpf(10) ** -18 else mpf(0), 20, min_fixed=-4, max_fixed=8)


def number(text):
    return mpf(text[:-1]) * mpf(10) ** SUFFIXES[text[-1]] if text[-1] in SUFFIXES else mpf(text)


def deck_lines_of(name):
    period, output, guess, moved = DECKS[name]
    orbit = DeckOrbit(HERE / f"{name}.net", period, output, guess)
    with mp.workdps(50):
        if orbit.residual > mpf(10) ** -30:
            raise RuntimeError(f"{name}: residual {mp.nstr(orbit.residual, 3)}")
        yield "period", "", shown(number(period)), ""
        for state, value in zip(orbit.names, orbit.x):
            if (name, state) not in FLUXES:
                yield "state", state, shown(value), ""
        for value in orbit.multipliers():
            if abs(value) > mpf(10) ** -15:
                yield "multiplier", "", shown(value.real), shown(value.imag)
        yield "mean", output, shown(orbit.average), ""
        for parameter in moved:
            yield "derivative", parameter, shown(orbit.derivative(parameter)), ""


def lines_of(name):
    build, parameters, options, mean, source, multiples, moved = CIRCUITS[name]
    mp.dps = 60
    orbit = Orbit(build, {k: number(v) for k, v in parameters.items()}, **options)
    if orbit.residual > mpf(10) ** -30:
        raise RuntimeError(f"{name}: residual {mp.nstr(orbit.residual, 3)}")
    yield "period", "", shown(orbit.period), ""
    for state, value in zip(orbit.circuit.states, orbit.x):
        yield "state", state, shown(value), ""
    for value in orbit.multipliers():
        if abs(value) > mpf(10) ** -15:
            yield "multiplier", "", shown(value.real), shown(value.imag)
    yield "mean", mean, shown(orbit.mean()), ""
    own, card = source if isinstance(source, tuple) else (source, source)
    inputs = [(own, card, multiple) for multiple in multiples] + [("duty", "duty(Vg)", m) for m in multiples if name in DUTY]
    for own, card, multiple in inputs:
        frequency = mpf(mp.nstr(number(multiple) / orbit.period, 12))  # as many digits as the table and the deck have
        answer = orbit.transfer(own, frequency)
        yield "transfer", f"{card} {mp.nstr(frequency, 12)}", shown(answer.real), shown(answer.imag)
    for parameter in [*moved, *(["Ton"] if name in DUTY else [])]:
        yield "derivative", "Vg:Ton" if parameter == "Ton" else parameter, shown(orbit.derivative(parameter)), ""


def main():
    (HERE / "references").mkdir(exist_ok=True)
    for name in sys.argv[1:] or [*CIRCUITS, *DECKS]:
        begin, by_hand = time.time(), name in CIRCUITS
        lines = list(lines_of(name) if by_hand else deck_lines_of(name))
        with open(HERE / "references" / f"{name}.csv", "w", encoding="ascii") as out:
            out.write(f"# {name}.net: period, states at t = 0, multipliers other than 0, mean, c_0 of the mean's signal, derivatives of the mean\n"
                      "# (of the period where it is free), 20 digits; made by validation/steady_state/references.py from "
                      + ("equations written by hand" if by_hand else "the deck by the solver of validation/references") + "\nkind,name,re,im\n")
            csv.writer(out, lineterminator="\n").writerows(lines)
        print(f"{name}: {len(lines)} numbers, {time.time() - begin:.0f} s", flush=True)


main()
