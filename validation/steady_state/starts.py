#!/usr/bin/env python3
"""validation/steady_state/starts.py [PROGRAM]: the orbit of each deck here from zero and from eight random starts; a Markdown table on standard output.

Capacitors start within 20 V and inductors within 5 A of zero, evenly distributed; the seed is fixed. Periods are those simulated, counted by the program.
An orbit counts as found if its mean and multipliers are those of references/NAME.csv (1e-9, 1e-8), where that exists.
"""
import csv
import json
import pathlib
import random
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
PROGRAM = str(pathlib.Path(sys.argv[1]).resolve()) if len(sys.argv) > 1 else str(HERE.parents[1] / "build/pwlsim")
STARTS = 8


def with_start(deck, draw):
    deck = re.sub(r"(?m)^(\.pss)(?!.*uic)(.*)$", r"\1\2 uic", deck)

    def given(match):
        line = re.sub(r"\s+ic=\S+", "", match.group(0))
        return line if draw is None else f"{line} ic={draw(20.0 if line[0] == 'C' else 5.0):.4g}"

    return re.sub(r"(?m)^[CL]\w* .*$", given, deck)


def reference_of(name):
    """(signal, its mean, the multipliers' sizes) or None."""
    path = HERE / "references" / f"{name}.csv"
    if not path.exists():
        return None
    rows = list(csv.DictReader(line for line in path.read_text().splitlines() if not line.startswith("#")))
    mean = next(row for row in rows if row["kind"] == "mean")
    sizes = [abs(complex(float(row["re"]), float(row["im"]))) for row in rows if row["kind"] == "multiplier"]
    return mean["name"], float(mean["re"]), sorted(sizes, reverse=True)


def is_same(result, reference):
    _, mean, sizes = reference
    found = {m["name"]: m["value"] for m in result["measurements"]}
    own = sorted((m["abs"] for m in result["pss"]["multipliers"] if not m["trivial"]), reverse=True)
    own += [0.0] * (len(sizes) - len(own))
    return abs(found["mean"] - mean) <= 1e-9 * found["peak"] and all(abs(a - b) <= 1e-8 * max(1.0, b) for a, b in zip(own, sizes))


def orbit_of(deck, reference, folder):
    """The orbit of --json, or None; whether it is the reference's."""
    if reference:
        deck = deck.replace("\n.end", f"\n.meas pss mean AVG {reference[0]}\n.meas pss peak MAX abs({reference[0]})\n.end")
    path = pathlib.Path(folder) / "deck.net"
    path.write_text(deck)
    run = subprocess.run([PROGRAM, path, "--json", "--no-rows", "--quiet"], capture_output=True, text=True, cwd=folder, timeout=120, check=False)
    result = json.loads(run.stdout)
    return result["pss"], result["pss"] and (not reference or is_same(result, reference))


def main():
    random.seed(5)
    periods, compared = [], []
    print("| deck | stable | largest multiplier | periods from zero | periods from random starts |\n| --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        for path in sorted(HERE.glob("*.net")):
            deck, reference = path.read_text(), reference_of(path.stem)
            runs = [orbit_of(with_start(deck, None if k == 0 else lambda s: random.uniform(-s, s)), reference, folder) for k in range(1 + STARTS)]
            first = next((orbit for orbit, same in runs if orbit and same), None)
            counts = [orbit["periods_simulated"] if orbit else None for orbit, _ in runs]
            periods += [(c, same) for c, (_, same) in zip(counts, runs)]
            compared += [path.stem] if reference else []
            radius = max((m["abs"] for m in first["multipliers"] if not m["trivial"]), default=0.0) if first else float("nan")
            shown = ["none" if c is None else f"{c}{'' if same else ' (another orbit)'}" for c, (_, same) in zip(counts, runs)]
            print(f"| {path.stem} | {first['stability'] if first else 'not found'} | {radius:.6g} | {shown[0]} | {', '.join(shown[1:])} |", flush=True)
    found = sorted(c for c, same in periods if c and same)
    few = sum(c <= 20 for c in found)
    print(f"\nFound: {len(found)} of {len(periods)}; {few} of them with at most 20 periods. Periods: median {found[len(found) // 2]}, "
          f"90 % at most {found[int(0.9 * len(found))]}. {len(compared)} decks are compared with long-digit references.")


main()
