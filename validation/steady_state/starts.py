#!/usr/bin/env python3
"""validation/steady_state/starts.py [PROGRAM]: the orbit of each deck here from zero and from eight random starts; a Markdown table on standard output.

Capacitors start within 20 V and inductors within 5 A of zero, evenly distributed; the seed is fixed. Periods are those simulated, counted by the program.
"""
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


def orbit_of(deck, folder):
    path = pathlib.Path(folder) / "deck.net"
    path.write_text(deck)
    run = subprocess.run([PROGRAM, path, "--json", "--no-rows", "--quiet"], capture_output=True, text=True, cwd=folder, timeout=120, check=False)
    return json.loads(run.stdout)["pss"]


def main():
    random.seed(5)
    periods = []
    print("| deck | stable | largest multiplier | periods from zero | periods from random starts |\n| --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        for path in sorted(HERE.glob("*.net")):
            deck = path.read_text()
            orbits = [orbit_of(with_start(deck, None if k == 0 else lambda s: random.uniform(-s, s)), folder) for k in range(1 + STARTS)]
            counts = [orbit["periods_simulated"] if orbit else None for orbit in orbits]
            periods += counts
            radius = max((m["abs"] for m in orbits[0]["multipliers"] if not m["trivial"]), default=0.0) if orbits[0] else float("nan")
            shown = [str(c) if c else "none" for c in counts]
            print(f"| {path.stem} | {orbits[0]['stability'] if orbits[0] else 'not found'} | {radius:.6g} | {shown[0]} | {', '.join(shown[1:])} |")
    found = sorted(c for c in periods if c)
    print(f"\nFound: {len(found)} of {len(periods)}. Periods: median {found[len(found) // 2]}, 90 % at most {found[int(0.9 * len(found))]}.")


main()
