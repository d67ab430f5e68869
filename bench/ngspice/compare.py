#!/usr/bin/env python3
"""Speed against stock ngspice at its fastest setting that reaches an error of 1e-3.

    python3 bench/ngspice/compare.py --pwlsim build/pwlsim          the table, with the settings of settings.json
    python3 bench/ngspice/compare.py --pwlsim build/pwlsim buck     one circuit
    python3 bench/ngspice/compare.py --sweep [buck …]               searches the settings anew and rewrites settings.json
    python3 bench/ngspice/compare.py --references                   computes reference/*.csv anew (validation/references)

Error: worst over 64 sample times and the deck's saved signals, relative to each signal's maximum. ngspice's analysis time is the
CPU time of its process less that of an empty deck; pwlsim's is `seconds.simulate` of --stats. Medians of several runs.
Picking the setting with the reference in hand flatters ngspice: its user does not know which setting is right.
"""
import argparse
import csv
import json
import statistics
import sys
import tempfile
from itertools import product
from pathlib import Path

sys.dont_write_bytecode = True
HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(HERE), str(ROOT / "validation" / "references")]

from mpmath import mp  # noqa: E402

import ngspice_deck  # noqa: E402
from deck import Deck  # noqa: E402
from ngspice_deck import Setting  # noqa: E402

CIRCUITS = ["fullwave", "buck", "buck_dcm", "boost", "flyback", "flyback_ideal", "six_pulse", "hbridge", "hysteretic_buck"]
SETTINGS = HERE / "settings.json"
TARGET = 1e-3


def load_deck(name):
    mp.dps = 30
    return Deck(ROOT / "netlists" / f"{name}.net")


def read_reference(path):
    """(times, rows of signals) of a reference file."""
    lines = [line for line in path.read_text().split("\n") if line and not line.startswith("#")]
    rows = [[float(x) for x in row] for row in list(csv.reader(lines))[1:]]
    return [row[0] for row in rows], [row[1:] for row in rows]


def error(rows, reference):
    maxima = [max(abs(row[i]) for row in reference) or 1.0 for i in range(len(reference[0]))]
    return max(abs(x - y) / m for p, q in zip(rows, reference) for x, y, m in zip(p, q, maxima))


# ---- references at times that lie on no clock edge
def make_reference(name):
    from generate import AGREE, text_of, write
    from mpmath import mpf
    from trajectory import Trajectory
    mp.dps = 140
    deck = Deck(ROOT / "netlists" / f"{name}.net")
    golden = (mp.sqrt(5) - 1) / 2
    times = [mpf(mp.nstr(deck.stop * (j + mp.frac(j * golden)) / 64, 12)) for j in range(1, 64)]
    rough = Trajectory(deck, digits=50).run(times)
    apart = deck.stop / 20000
    events = [e[0] for e in rough.events]
    times = [t + (apart if any(abs(t - e) < apart / 2 for e in events) else 0) for t in times] + [deck.stop * mpf("0.9999")]
    first = Trajectory(deck, digits=50).run(times)
    second = Trajectory(deck, digits=66, reach=2.3, r0=7, t0=deck.stop / 317).run(times)
    maxima = [max(abs(v[i]) for _, v in first.rows) for i in range(len(deck.saves))]
    if any(abs(x - y) > AGREE * m for (_, p), (_, q) in zip(first.rows, second.rows) for x, y, m in zip(p, q, maxima)):
        raise SystemExit(f"{name}: the two reference runs differ")
    (HERE / "reference").mkdir(exist_ok=True)
    write(HERE / "reference" / f"{name}.csv",
          [f"netlists/{name}.net between its events, 20 digits. Made by: python3 bench/ngspice/compare.py --references {name}"],
          ["time"] + deck.saves, [",".join([text_of(t)] + [text_of(v, m) for v, m in zip(values, maxima)]) for t, values in first.rows])
    print(f"{name}: reference written", flush=True)


# ---- the search
def variants(name, deck):
    """[(label in settings.json, gain)]: where a switch watches the circuit, also with its control amplified. The amplifier
    changes nothing in the ideal circuit, but ngspice follows a switch's control to 0.05 V only."""
    gates = {e.nodes[0] for e in deck.elements if e.name in ngspice_deck.gate_thresholds(deck)}
    watching = any(e.kind == "S" and e.control[0] not in gates for e in deck.elements)
    return [(name, 1.0)] + ([(f"{name}, control amplified", 1e5)] if watching else [])


def candidates(gain):
    """Every setting tried, coarse steps first."""
    diodes = [("exponential", n) for n in (1.0, 0.1, 0.03, 0.01, 0.003, 0.001)] + [("sidiode", r) for r in (1e-2, 1e-3, 1e-4, 1e-5)]
    all_steps = (50, 200, 500, 1000, 2000, 5000, 10000, 20000, 50000, 100000, 200000)
    for steps, reltol, method, diode, shunt in product(all_steps, (1e-2, 1e-3, 1e-4), ("trap", "gear"), diodes, (0.0, 1e6)):
        yield Setting(reltol, steps, *diode, shunt, control_gain=gain, method=method)


def sweep(name, deck, gain):
    """The fastest settings found that reach TARGET: settled by repeated runs of the five best."""
    times, reference = read_reference(HERE / "reference" / f"{name}.csv")
    good, tried, failed, limit = [], 0, 0, 20.0
    for setting in candidates(gain):
        if len(good) >= 5 and setting.steps > 8 * min(s.steps for _, s, _ in good):
            break  # only slower ones follow
        tried += 1
        run = ngspice_deck.run(ngspice_deck.deck_text(deck, setting, times), timeout=limit)
        rows = run and ngspice_deck.samples(deck, run.vectors, times)
        if not rows:
            failed += 1
            continue
        reached = error(rows, reference)
        if reached <= TARGET:
            good.append((run.cpu, setting, reached))
            limit = max(1.0, 12 * min(cpu for cpu, _, _ in good))  # of wall time, on a machine that may be busy
    if not good:
        return {"found": False, "tried": tried, "failed": failed}
    best = sorted(good, key=lambda g: g[0])[:5]
    settled = [(median_ngspice(deck, setting, times, 7)[1], setting, reached) for _, setting, reached in best]
    cpu, setting, reached = min(settled, key=lambda g: g[0])
    return {"found": True, "setting": setting.as_dict(), "error": float(f"{reached:.3g}"), "tried": tried, "failed": failed}


def median_ngspice(deck, setting, times, repeats):
    """(wall, cpu, error rows) of one setting."""
    text = ngspice_deck.deck_text(deck, setting, times)
    runs = [ngspice_deck.run(text) for _ in range(repeats)]
    return statistics.median(r.wall for r in runs), statistics.median(r.cpu for r in runs), ngspice_deck.samples(deck, runs[0].vectors, times)


# ---- the table
def empty_deck(repeats):
    runs = [ngspice_deck.run(ngspice_deck.EMPTY) for _ in range(repeats)]
    return statistics.median(r.cpu for r in runs)


def run_pwlsim(program, name, repeats):
    """Medians of (wall, simulate) seconds, and the worst error against tests/reference."""
    deck = ROOT / "netlists" / f"{name}.net"
    walls, simulates = [], []
    with tempfile.TemporaryDirectory() as folder:
        out, stats = Path(folder) / "out.csv", Path(folder) / "stats.json"
        for _ in range(repeats):
            measured = ngspice_deck.timed([program, str(deck), "-o", str(out), "--stats", str(stats), "--quiet"])
            if measured is None:
                return None
            walls.append(measured[0])
            simulates.append(json.loads(stats.read_text())["seconds"]["simulate"])
        times, reference = read_reference(ROOT / "tests" / "reference" / f"{name}.csv")
        rows = {row[0]: row[1:] for row in ([float(x) for x in line] for line in list(csv.reader(out.open()))[1:])}
        return statistics.median(walls), statistics.median(simulates), error([rows[t] for t in times], reference)


def table(program, names, repeats):
    settings = json.loads(SETTINGS.read_text())
    empty = empty_deck(2 * repeats)
    print(f"ngspice start-up (empty deck): {empty * 1e3:.1f} ms CPU, taken off its analysis times")
    print("| circuit | ngspice analysis ms (error) | pwlsim simulate ms (error) | ratio | whole process ms: ngspice | pwlsim |")
    print("| --- | --- | --- | --- | --- | --- |")
    for name in names:
        deck = load_deck(name)
        ours = run_pwlsim(program, name, repeats) if program else None
        for label, _ in variants(name, deck):
            print_row(label, settings[label], deck, name, ours, empty, repeats)


def print_row(label, entry, deck, name, ours, empty, repeats):
    mine, process = (f"{ours[1] * 1e3:.3f} ({ours[2]:.0e})", f"{ours[0] * 1e3:.1f}") if ours else ("-", "-")
    if not entry["found"]:
        print(f"| {label} | none of {entry['tried']} settings reached {TARGET:g} | {mine} | - | - | {process} |", flush=True)
        return
    times, reference = read_reference(HERE / "reference" / f"{name}.csv")
    wall, cpu, rows = median_ngspice(deck, Setting(**entry["setting"]), times, repeats)
    ratio = f"{(cpu - empty) / ours[1]:.0f}" if ours else "-"
    print(f"| {label} | {(cpu - empty) * 1e3:.1f} ({error(rows, reference):.0e}) | {mine} | {ratio} | {wall * 1e3:.1f} | {process} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("circuits", nargs="*", default=CIRCUITS)
    parser.add_argument("--pwlsim", help="the program to run beside ngspice")
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--sweep", action="store_true")
    parser.add_argument("--references", action="store_true")
    options = parser.parse_args()
    if options.references:
        for name in options.circuits:
            make_reference(name)
    elif options.sweep:
        for name in options.circuits:
            deck = load_deck(name)
            for label, gain in variants(name, deck):
                found = json.loads(SETTINGS.read_text()) if SETTINGS.exists() else {}
                found[label] = sweep(name, deck, gain)
                SETTINGS.write_text(json.dumps(found, indent=2, sort_keys=True) + "\n")
                print(label, found[label], flush=True)
    else:
        table(options.pwlsim, options.circuits, options.repeats)


if __name__ == "__main__":
    main()
