#!/usr/bin/env python3
"""Periodic orbits of large circuits: dense modes beside Krylov segments, and one more period by the sparse engine.

    orbits.py PWLSIM [SECONDS]      a table of docs/validation/steady-state.md; a run that takes longer than SECONDS (60) is none

"next period": the orbit's stores become ic= of a run over one period by implicit steps (--engine sparse, reltol 1e-8), which shares no segment, event or product
with the search; the largest change of a saved signal from the begin of the period to its end, of its largest value.
"difference": of the stores of both orbits, of the largest of their unit.
"""
import json
import re
import subprocess
import sys
import tempfile
import time

import circuits

CASES = [("cockcroft_walton", [10]), ("cockcroft_walton", [20]), ("cockcroft_walton", [40]), ("cockcroft_walton", [100]), ("cockcroft_walton", [200]),
         ("multilevel", [10]), ("multilevel", [20]), ("multilevel", [40]), ("grid", [6, 3])]


def run(program, deck, arguments, seconds):
    with tempfile.TemporaryDirectory() as folder:
        with open(f"{folder}/deck.net", "w") as file:
            file.write("\n".join(deck) + "\n")
        began = time.time()
        try:
            done = subprocess.run([program, "deck.net", *arguments], cwd=folder, capture_output=True, text=True, timeout=seconds)
        except subprocess.TimeoutExpired:
            return None, None, None
        took = time.time() - began
        if done.returncode != 0:
            return took, re.search(r"error\[([^]]*)\]", done.stderr).group(1), None
        with open(f"{folder}/deck.csv") as file:
            rows = [[float(x) for x in line.split(",")] for line in file.readlines()[1:]]
        return took, json.loads(done.stdout) if "--json" in arguments else None, rows


def stores(result):
    return {s["name"]: (s["value"], s["unit"]) for s in result["pss"]["states"]}


def difference(a, b):
    largest = {}
    for value, unit in a.values():
        largest[unit] = max(largest.get(unit, 0.0), abs(value))
    return max(abs(value - b[name][0]) / largest[unit] for name, (value, unit) in a.items())


def next_period(program, deck, result, seconds):
    values = stores(result)
    lines = []
    for line in deck:
        name = line.split()[0]
        store = values.get(f"v({name})") if line[0] == "C" else values.get(f"i({name})") if line[0] == "L" else None
        lines.append(re.sub(r"\s+ic=\S+", "", line) + f" ic={store[0]!r}" if store else line)
    period = result["pss"]["period"]
    lines = [line for line in lines if not line.startswith(".pss")] + [f".tran {period / 1000!r} {period!r} uic"]
    _, _, rows = run(program, lines, ["--engine", "sparse", "--reltol", "1e-8"], seconds)
    if rows is None:
        return "none"
    columns = list(zip(*rows))[1:]
    return f"{max(abs(c[-1] - c[0]) / max(map(abs, c)) for c in columns):.0e}"


def main():
    program, seconds = sys.argv[1], float(sys.argv[2]) if len(sys.argv) > 2 else 60.0
    print("| circuit | dense modes, s | Krylov segments, s | steps | periods | residual | leading multiplier | difference | next period |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for name, sizes in CASES:
        deck = [line for line in getattr(circuits, name)(*sizes) if not line.startswith(".tran")]
        deck += [circuits.IDEAL["diode"], circuits.IDEAL["switch"], ".pss uic"]
        dense, exact, _ = run(program, deck, ["--engine", "modes", "--json"], seconds)
        took, result, _ = run(program, deck, ["--engine", "krylov", "--json"], 10 * seconds)
        told = f"over {seconds:.0f}" if dense is None else exact if isinstance(exact, str) else f"{dense:.2f}"
        label = f"{name} {' '.join(map(str, sizes))}"
        if not isinstance(result, dict):
            print(f"| {label} | {told} | {result} | | | | | | |", flush=True)
            continue
        pss = result["pss"]
        if pss["multipliers"]:
            leading = f"1 − {1.0 - pss['multipliers'][0]['abs']:.3g}"
        else:
            leading = "below 1e-9" if pss["stability"] else "not known"
        apart = f"{difference(stores(exact), stores(result)):.0e}" if isinstance(exact, dict) else ""
        print(f"| {label} | {told} | {took:.2f} | {pss['iterations']} | {pss['periods_simulated']} | {pss['residual']:.0e} | {leading} | "
              f"{apart} | {next_period(program, deck, result, 10 * seconds)} |", flush=True)


if __name__ == "__main__":
    main()
