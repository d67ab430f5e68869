#!/usr/bin/env python3
"""Runs every deck that has a reference and prints how far the program is from it.

    python3 validation/references/check.py build/pwlsim [NAME …]

Per saved signal: the worst error over all reference rows, relative to the signal's maximum; then the program's number of events beside
the reference's (without mere corners of a source), and the simulate phase. Exit status 1 where a run fails or an error is above 1e-9 (1e-8 for lossless tanks and rings over
many cycles, 1e-6 where a stop is touched).
"""
import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
REFERENCE = ROOT / "tests" / "reference"
TOLERANCE = {"tank_clamp": 1e-8, "buck_parasitic": 1e-8, "case31b": 1e-6, "case31c": 1e-6}


def table(path):
    rows = list(csv.reader(line for line in path.open() if not line.startswith("#")))
    return rows[0], rows[1:]


def deck_of(name):
    return ROOT / ("tests/hard" if name.startswith("case") else "netlists") / f"{name}.net"


def run(program, name):
    """(header, {time: values}, stats) or a message."""
    with tempfile.TemporaryDirectory() as folder:
        out, stats = Path(folder) / "out.csv", Path(folder) / "stats.json"
        try:
            done = subprocess.run([program, deck_of(name), "-o", out, "--stats", stats, "--quiet"], capture_output=True, text=True, timeout=120)
        except subprocess.TimeoutExpired:
            return "no end within 120 s"
        if done.returncode:
            return f"exit {done.returncode}: {done.stderr.splitlines()[:1]}"
        header, rows = table(out)
        return header, {float(r[0]): [float(x) for x in r[1:]] for r in rows}, json.loads(stats.read_text())


def errors(rows, got):
    columns = list(zip(*[[float(x) for x in row] for row in rows]))
    times = columns[0]
    for i, column in enumerate(columns[1:]):
        size = max(map(abs, column)) or 1.0
        yield max(abs(got[t][i] - x) / size for t, x in zip(times, column))


def check(program, name):
    answer = run(program, name)
    if isinstance(answer, str):
        print(f"{name}: {answer}")
        return False
    header, got, stats = answer
    expected, rows = table(REFERENCE / f"{name}.csv")
    events = sum(float(row[0]) > 0 and row[1] != "corner" for row in table(REFERENCE / f"{name}.events.csv")[1])
    worst = list(errors(rows, got))
    good = header == expected and max(worst) <= TOLERANCE.get(name, 1e-9)
    print(f"{name}: {'' if good else 'WRONG '}{' '.join(f'{w:.1e}' for w in worst)}; events {stats['events']} of {events}; "
          f"{stats['seconds']['simulate'] * 1e3:.3f} ms", flush=True)
    return good


def main():
    names = sys.argv[2:] or sorted(p.stem for p in REFERENCE.glob("*.csv") if not p.stem.endswith(".events"))
    sys.exit(0 if all([check(sys.argv[1], name) for name in names]) else 1)


if __name__ == "__main__":
    main()
