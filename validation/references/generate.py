#!/usr/bin/env python3
"""Makes tests/reference/NAME.csv and NAME.events.csv from netlists/NAME.net.

    python3 validation/references/generate.py            every deck (about ten minutes)
    python3 validation/references/generate.py buck carts  only these

Every run is done twice, with different digits, step lengths, units and order of elimination; the numbers are written only
if both agree to 24 digits of each signal's maximum. The first run also compares, at each event, all modes that would be consistent.
"""
import sys
import time
from pathlib import Path

sys.dont_write_bytecode = True
from mpmath import mp, mpf  # noqa: E402

from deck import Deck  # noqa: E402
from trajectory import Trajectory  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
OUT = ROOT / "tests" / "reference"
NAMES = ["buck", "buck_dcm", "boost", "flyback", "flyback_ideal", "halfwave", "fullwave", "fullwave_centre_tap", "six_pulse",
         "cockcroft_walton", "hbridge", "hysteretic_buck", "freewheel", "carts", "two_capacitors", "rlcd", "diode_bridge",
         "bridge_filter", "supplied_bridge", "buck_parasitic", "voltage_mode_buck"]
AGREE = mpf(10) ** -24


def sample_rows(rows, most=64):
    if rows <= 100:
        return list(range(rows + 1))
    return sorted({0} | {round(j * rows / most) for j in range(1, most + 1)})


def column_maxima(rows):
    return [max(abs(values[i]) for _, values in rows) or mpf(1) for i in range(len(rows[0][1]))]


def worst_difference(a, b):
    """Of two runs, relative to each signal's maximum and to the length of the run."""
    if [e[1] for e in a.events] != [e[1] for e in b.events]:
        raise SystemExit("the two runs took different events")
    maxima = column_maxima(a.rows)
    values = max(abs(x - y) / m for (_, p), (_, q) in zip(a.rows, b.rows) for x, y, m in zip(p, q, maxima))
    times = max((abs(p[0] - q[0]) / a.deck.stop for p, q in zip(a.events, b.events)), default=mpf(0))
    return max(values, times)


def text_of(value, maximum=mpf(1)):
    if abs(value) < mpf(10) ** -30 * maximum:
        return "0"
    return mp.nstr(value, 20, min_fixed=-4, max_fixed=6).replace(".0e", "e").removesuffix(".0")


def quoted(name):
    return f'"{name}"' if "," in name else name


def write(path, head, columns, lines):
    with open(path, "w", encoding="ascii") as out:
        out.writelines(f"# {line}\n" for line in head)
        out.write(",".join(map(quoted, columns)) + "\n")
        out.writelines(line + "\n" for line in lines)


def solve(path, every_mode=True):
    """Two runs of one deck; the first, and their worst difference."""
    mp.dps = 140
    deck = Deck(path)
    times = [k * deck.step for k in sample_rows(int(mp.nint(deck.stop / deck.step)))]
    first = Trajectory(deck, digits=50, reach=6, every_mode=every_mode).run(times)
    second = Trajectory(deck, digits=66, reach=2.3, r0=7, t0=deck.stop / 317).run(times)
    return first, worst_difference(first, second)


def write_events(name, deck_path, run, made_by):
    """NAME.events.csv: every event of a run with the saved signals after it."""
    maxima = column_maxima(run.rows)
    head = [f"{deck_path}: every event and the saved signals just after it, 20 digits."] + made_by
    head.append("edge: a source's value jumps; corner: a source's slope changes; jump: charges or fluxes jump; +X, -X: switch or diode X")
    head.append("closes, opens (of diodes whose share of a current is not determined, one labelling of several with the same trajectory).")
    write(OUT / f"{name}.events.csv", head, ["time", "what"] + run.deck.saves,
          [",".join([text_of(t), what] + [text_of(v, m) for v, m in zip(values, maxima)]) for t, what, values in run.events])


def save(name, run, difference, deck_path):
    maxima = column_maxima(run.rows)
    head = [f"Made by: python3 validation/references/generate.py {name}",
            f"A second run with other digits, steps and units differs by {mp.nstr(difference, 2)} of each signal's maximum."]
    OUT.mkdir(parents=True, exist_ok=True)
    write(OUT / f"{name}.csv", [f"{deck_path}: saved signals at rows of its grid (the value after a jump), 20 digits."] + head,
          ["time"] + run.deck.saves,
          [",".join([text_of(t)] + [text_of(v, m) for v, m in zip(values, maxima)]) for t, values in run.rows])
    write_events(name, deck_path, run, head)


def main(names):
    for name in names or NAMES:
        started, path = time.time(), ROOT / "netlists" / f"{name}.net"
        run, difference = solve(path)
        if difference > AGREE:
            raise SystemExit(f"{name}: the two runs differ by {mp.nstr(difference, 3)}")
        save(name, run, difference, path.relative_to(ROOT))
        print(f"{name}: {len(run.rows)} rows, {len(run.events)} events, {len(run.visited)} modes visited of {len(run.modes)} built, "
              f"two runs differ by {mp.nstr(difference, 2)}, {time.time() - started:.0f} s", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
