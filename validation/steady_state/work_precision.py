#!/usr/bin/env python3
"""validation/steady_state/work_precision.py [PROGRAM]: .pss, .ac and .sens beside brute force; Markdown tables on standard output (some minutes).

Brute force: a transient from zero until the mean over the last period has settled, in pwlsim and in ngspice (Debian: ngspice); a sine of small amplitude
beside .ac; differences beside .sens. Errors are relative to the references. Times: pwlsim's `seconds` of --stats but for parse, flatten, model, write and
certificate, ngspice's CPU time less that of an empty deck; the least of several runs, taken in turn, so that a busy machine burdens all alike. ngspice runs the
deck that `pwlsim export` writes, with other largest steps and tolerances; the fastest setting that reaches the error counts, which its user cannot know.
"""
import cmath
import csv
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
PROGRAM = str(pathlib.Path(sys.argv[1]).resolve()) if len(sys.argv) > 1 else str(HERE.parents[1] / "build/pwlsim")
DECKS = ["buck", "boost_discontinuous", "deane_hamill"]
ERRORS = [1e-3, 1e-6, 1e-9]
REPEATS, NGSPICE_REPEATS = 9, 2
SMOOTH, RELTOL, STEPS = [1e-2, 1e-3, 1e-4], [1e-3, 1e-5], [50, 200, 1000]  # sharpness of ngspice's diodes, its tolerance, largest steps a period


def reference_of(name):
    lines = [line for line in (HERE / "references" / f"{name}.csv").read_text().splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


def number_of(rows, kind, name=None):
    row = next(r for r in rows if r["kind"] == kind and name in (None, r["name"]))
    return complex(float(row["re"]), float(row["im"] or 0))


def with_cards(deck, cards):
    return re.sub(r"(?m)^\.pss.*$", lambda _: "\n".join(cards), deck)


def run(deck, folder):
    path = pathlib.Path(folder) / "deck.net"
    path.write_text(deck)
    done = subprocess.run([PROGRAM, path, "--json", "--no-rows", "--quiet"], capture_output=True, text=True, cwd=folder, check=False)
    return json.loads(done.stdout)


def mean_of(result):
    return next(m["value"] for m in result["measurements"] if m["name"] == "mean")


def seconds_of(result):
    """All from the model to the results, without the certificate; `simulate` alone does not hold the search for an orbit."""
    seconds = result["stats"]["seconds"]
    return seconds["total"] - sum(seconds[phase] for phase in ("parse", "flatten", "model", "write", "certificate"))


def least(decks, folder, repeats=REPEATS):
    """The least time of each deck, taken in turn."""
    best = [float("inf")] * len(decks)
    for _ in range(repeats):
        for k, deck in enumerate(decks):
            best[k] = min(best[k], seconds_of(run(deck, folder)))
    return best


def transient(deck, period, periods):
    start, stop = (periods - 1) * period, periods * period
    return with_cards(deck, [f".tran {period!r} {stop!r} {start!r} uic", f".meas tran mean AVG v(out) FROM={start!r} TO={stop!r}"])


def settled(deck, period, mean, error, folder):
    """The least number of periods from zero after which the mean has this error."""
    def good(periods):
        return abs(mean_of(run(transient(deck, period, periods), folder)) / mean - 1) <= error
    high = 4
    while not good(high):
        high *= 2
        if high > 1e6:
            return None
    low = high // 2
    while high - low > max(1, low // 50):
        middle = (low + high) // 2
        low, high = (low, middle) if good(middle) else (middle, high)
    return high


def cpu_of(text, folder):
    path = pathlib.Path(folder) / "deck.cir"
    path.write_text(text)
    before = os.times()
    try:
        done = subprocess.run(["ngspice", "-n", "-b", str(path)], capture_output=True, text=True, cwd=folder, check=False, timeout=60)
    except subprocess.TimeoutExpired:
        return 60.0, ""
    after = os.times()
    return after.children_user + after.children_system - before.children_user - before.children_system, done.stdout + done.stderr


def ngspice(deck, period, mean, periods, folder):
    """(seconds, error, setting) of each setting after this many periods, and what it says of those that fail."""
    empty = min(cpu_of("empty\nR1 a 0 1\nV1 a 0 1\n.tran 1 2\n.meas tran mean AVG v(a)\n.end\n", folder)[0] for _ in range(5))
    source = pathlib.Path(folder) / "export.net"
    source.write_text(transient(deck, period, periods))
    points, stopped = [], set()
    for smooth in SMOOTH:
        target = pathlib.Path(folder) / "export.cir"
        subprocess.run([PROGRAM, "export", source, "-o", target, "--smooth", str(smooth), "--quiet"], cwd=folder, check=True, capture_output=True)
        for reltol in RELTOL:
            for steps in STEPS:
                start, stop = (periods - 1) * period, periods * period
                cards = f".tran {period!r} {stop!r} 0 {period / steps!r} uic\n.meas tran mean AVG v(out) from={start!r} to={stop!r}"
                text = re.sub(r"(?m)^\.tran .*$", cards, target.read_text())
                text = re.sub(r"(?m)^\.save .*\n", "", text).replace("\n.tran", "\n.save v(out)\n.tran")
                text = re.sub(r"reltol=\S+", f"reltol={reltol}", text)
                seconds, log = cpu_of(text, folder)
                found = re.search(r"(?mi)^mean\s*=\s*(\S+)", log)
                if not found:
                    stopped.add(next(iter(re.findall(r"Timestep too small|singular matrix", log)), "no result"))
                else:
                    seconds = min([seconds] + [cpu_of(text, folder)[0] for _ in range(NGSPICE_REPEATS - 1)])
                    setting = f"smooth {smooth:g}, reltol {reltol:g}, {steps} steps a period"
                    points.append((max(seconds - empty, 1e-4), abs(float(found.group(1)) / mean - 1), setting))
    return points, sorted(stopped)


def orbits(folder):
    has_ngspice = shutil.which("ngspice") is not None
    print("| circuit | method | periods | error of the mean | time | times `.pss` |\n| --- | --- | --- | --- | --- | --- |")
    for name in DECKS:
        deck, rows = (HERE / f"{name}.net").read_text(), reference_of(name)
        mean, period = number_of(rows, "mean").real, number_of(rows, "period").real
        orbit = with_cards(deck, [".pss uic", ".meas pss mean AVG v(out)"])
        counts = [settled(deck, period, mean, error, folder) for error in ERRORS]
        decks = [orbit] + [transient(deck, period, count) for count in counts]
        times, results = least(decks, folder), [run(d, folder) for d in decks]
        simulated = [results[0]["pss"]["periods_simulated"]] + counts
        for k, (result, seconds, count) in enumerate(zip(results, times, simulated)):
            method = "`.pss uic`" if k == 0 else f"pwlsim `.tran` until {ERRORS[k - 1]:.0e}"
            print(f"| {name} | {method} | {count} | {abs(mean_of(result) / mean - 1):.1e} | {seconds * 1e3:.3g} ms | {seconds / times[0]:.3g} |", flush=True)
        points, stopped = ngspice(deck, period, mean, counts[1], folder) if has_ngspice else ([], [])
        if stopped and not points:
            print(f"| {name} | ngspice, {len(SMOOTH) * len(RELTOL) * len(STEPS)} settings, stops in all: {', '.join(stopped)} | {counts[1]} | | | |")
        for error in ERRORS[:2] if points else []:
            good = [p for p in points if p[1] <= error]
            seconds, reached, setting = min(good) if good else min(points, key=lambda p: p[1])
            title = f"ngspice until {error:.0e}" if good else f"ngspice: {error:.0e} not reached, its best"
            print(f"| {name} | {title} ({setting}) | {counts[1]} | {reached:.1e} | {seconds * 1e3:.3g} ms | {seconds / times[0]:.3g} |")


def responses(folder):
    """v(out) of the boost converter to Vin at 1 kHz, a hundredth of its switching frequency."""
    deck, rows = (HERE / "boost_discontinuous.net").read_text(), reference_of("boost_discontinuous")
    answer = number_of(rows, "transfer", "Vin 1000.0")
    by_ac = with_cards(deck, [".pss uic", ".ac list 1000 from=Vin"])
    result = run(by_ac, folder)
    signal = next(s for s in result["ac"]["signals"] if s["name"] == "v(out)")
    swept, settings = [], [(a, c) for a in (1.0, 1e-1, 1e-2, 1e-3) for c in (5, 10, 20)]
    for amplitude, cycles in settings:
        wave = deck.replace("Vin in 0 5", f"Vin in 0 SIN(5 {amplitude} 1k)")
        swept.append(with_cards(wave, [f".tran 10u {cycles}m {cycles - 1}m uic", ".four 1k v(out)"]))
    times = least([by_ac, *swept], folder, 5)
    print("\n| response at 1 kHz, boost_discontinuous | cycles | error | time | times `.pss` + `.ac` |\n| --- | --- | --- | --- | --- |")
    print(f"| `.pss` + `.ac` | | {abs(complex(signal['re'][0], signal['im'][0]) / answer - 1):.1e} | {times[0] * 1e3:.3g} ms | 1 |")
    for (amplitude, cycles), wave, seconds in zip(settings, swept, times[1:]):
        first = run(wave, folder)["fourier"][0]["harmonics"][1]
        found = first["magnitude"] * cmath.exp(1j * cmath.pi * first["phase"] / 180) / amplitude
        error = abs(found / answer - 1)
        print(f"| sine of {amplitude:g} V in pwlsim `.tran` | {cycles} | {error:.1e} | {seconds * 1e3:.3g} ms | {seconds / times[0]:.3g} |")


def derivatives(folder):
    """Of the mean of v(out) to L1 of the boost converter."""
    deck, rows = (HERE / "boost_discontinuous.net").read_text(), reference_of("boost_discontinuous")
    answer, period, mean = number_of(rows, "derivative", "L1").real, number_of(rows, "period").real, number_of(rows, "mean").real
    cards = [".pss uic", ".meas pss mean AVG v(out)"]
    by_sens = with_cards(deck, [*cards, ".sens param=L1"])
    print("\n| d mean / d L1, boost_discontinuous | step | error | time | times `.pss` + `.sens` |\n| --- | --- | --- | --- | --- |")
    moved = lambda text, h: re.sub(r"(?m)^L1 (\S+ \S+) 5u", lambda m: f"L1 {m[1]} {5e-6 * (1 + h)!r}", text)
    count = settled(deck, period, mean, 1e-6, folder)
    long = transient(deck, period, count)
    times = least([by_sens, with_cards(deck, cards), long], folder)
    error = abs(run(by_sens, folder)["sensitivities"][0]["derivative"] / answer - 1)
    print(f"| `.pss` + `.sens` | | {error:.1e} | {times[0] * 1e3:.3g} ms | 1 |")
    for title, text, seconds in (("two orbits, central difference", with_cards(deck, cards), times[1]),
                                 (f"two pwlsim `.tran` of {count} periods (settled to 1e-6)", long, times[2])):
        for h in (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8):
            difference = (mean_of(run(moved(text, h), folder)) - mean_of(run(moved(text, -h), folder))) / (2 * h * 5e-6)
            print(f"| {title} | {h:.0e} | {abs(difference / answer - 1):.1e} | {2 * seconds * 1e3:.3g} ms | {2 * seconds / times[0]:.3g} |", flush=True)


def main():
    with tempfile.TemporaryDirectory() as folder:
        orbits(folder)
        responses(folder)
        derivatives(folder)


if __name__ == "__main__":
    main()
