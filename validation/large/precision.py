#!/usr/bin/env python3
"""Error against time of the engines and of ngspice on large circuits, as docs/validation/large.md. Needs numpy; ngspice for its column.

    precision.py --pwlsim build/pwlsim                 the part of docs/validation/large.md above its gates
    precision.py --pwlsim build/pwlsim --only "line 60"  one circuit alone, or where none has that name those that hold it

Errors are those of all saved signals, relative to each one's largest value, against the exact engine with dense modes where it takes less than --limit seconds, else against the sparse
engine at --reltol 1e-8, whose own error (from its change between 1e-7 and 1e-8) is said beside the circuit. Times are the least of several of the simulation alone.
"""
import argparse
import os
import subprocess
import sys
import tempfile

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import circuits  # noqa: E402
import measure  # noqa: E402

CIRCUITS = [("cockcroft_walton", (n,)) for n in (10, 20, 50, 100, 300, 1000, 2000)] + [("multilevel", (n,)) for n in (10, 40, 100, 400)] + [
    ("grid", (10, 6)), ("grid", (20, 12)), ("grid", (40, 24)), ("grid", (100, 100))] + [("solar", (n,)) for n in (10, 30)] + [
    ("ladder", (n,)) for n in (50, 400)] + [("line", (n,)) for n in (60, 600)] + [("six_pulse", (n,)) for n in (1, 6)]
RELTOL = ("1e-3", "1e-4", "1e-6")
NGSPICE = ((1e-3, 1e-3), (1e-3, 1e-4))  # Ron and reltol


def timed(pwlsim, deck, folder, engine, *options, limit, repeats=3):
    """Milliseconds and rows, or why there are none."""
    best, rows = None, None
    for _ in range(repeats):
        stats, out = os.path.join(folder, "stats.json"), os.path.join(folder, f"{engine}.csv")
        command = [pwlsim, deck, "--quiet", "--engine", engine, "-o", out, "--stats", stats, *options]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=limit)
        except subprocess.TimeoutExpired:
            return None, f"over {limit:g} s"
        if done.returncode != 0:
            error = next((line for line in done.stderr.splitlines() if "error[" in line), "error[?]")
            return None, error[error.index("error[") + 6:].split("]")[0]
        with open(stats) as file:
            seconds = measure.json.load(file)["seconds"]["simulate"]
        best = min(best or 1e9, seconds)
        rows = np.genfromtxt(out, delimiter=",", skip_header=1)
        if seconds > 2.0:
            break
    return 1e3 * best, rows


def error_of(rows, reference):
    """Gates are saved in no deck here, and no row lies on a jump."""
    return measure.worst_error(rows, reference) if len(rows) == len(reference) else float("nan")


def cell(milliseconds, rows, reference):
    return rows if milliseconds is None else f"{milliseconds:.3g} ({error_of(rows, reference):.0e})"


def line(name, sizes, options):
    with tempfile.TemporaryDirectory() as folder:
        deck = measure.write(folder, "deck.net", circuits.deck(name, sizes))
        run = lambda engine, *more, **how: timed(options.pwlsim, deck, folder, engine, *more, limit=options.limit, **how)  # noqa: E731
        exact, exact_rows = run("modes")
        if exact is not None:
            reference, beside = exact_rows, "dense modes"
        else:
            _, coarse = run("sparse", "--reltol", "1e-7", repeats=1)
            _, reference = run("sparse", "--reltol", "1e-8", repeats=1)
            if isinstance(reference, str) or isinstance(coarse, str):
                return f"| {name} {' '.join(map(str, sizes))} | no reference: {reference if isinstance(reference, str) else coarse} |"
            beside = f"sparse, 1e-8 (its error: {measure.worst_error(coarse, reference):.0e})"
        cells = [beside, f"{exact:.3g}" if exact is not None else exact_rows, cell(*run("krylov"), reference)]
        cells += [cell(*run("sparse", "--reltol", reltol), reference) for reltol in RELTOL]
        for ron, reltol in NGSPICE:
            if options.no_ngspice:
                cells.append("")
                continue
            seconds, error = measure.run_ngspice(name, sizes, ron, reltol, folder, reference, options.limit)
            cells.append(f"{1e3 * seconds:.3g} ({error:.0e})" if seconds else str(error).split(";")[0])
        return f"| {name} {' '.join(map(str, sizes))} | " + " | ".join(cells) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pwlsim", required=True)
    parser.add_argument("--only", default="", help="a circuit's name, or part of one")
    parser.add_argument("--limit", type=float, default=60.0, help="seconds a run")
    parser.add_argument("--no-ngspice", action="store_true")
    options = parser.parse_args()
    print("# Large circuits: error against time\n")
    print("Time of the simulation in ms, and in parentheses the largest error of a saved signal against the reference, relative to its largest value. Circuits:")
    print("`validation/large/circuits.py`. Made by `validation/large/precision.py`. ngspice has diodes")
    print("with Ron = 1 mΩ; its columns are for `reltol` 1e-3 and 1e-4.\n")
    print("| circuit | reference | dense modes | krylov | sparse 1e-3 | sparse 1e-4 | sparse 1e-6 | ngspice 1e-3 | ngspice 1e-4 |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    chosen = {f"{name} {' '.join(map(str, sizes))}": (name, sizes) for name, sizes in CIRCUITS}
    if options.only in chosen:
        chosen = {options.only: chosen[options.only]}
    for title, (name, sizes) in chosen.items():
        if options.only in title:
            print(line(name, sizes, options), flush=True)


if __name__ == "__main__":
    main()
