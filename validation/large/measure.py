#!/usr/bin/env python3
"""Cost of the sparse engine against size, and against ngspice at one error. Needs numpy; ngspice for the second table.

    measure.py --pwlsim build/pwlsim growth                 cost a step and an event, memory
    measure.py --pwlsim build/pwlsim ngspice [--repeats 3]  time at an error of 1e-3

The reference of the second table is the sparse engine at --reltol 1e-7, which agrees with the exact one where both run
(tests/regression/sparse_engine_test.cpp). Errors are those of all saved signals, relative to each one's largest value.
"""
import argparse
import json
import math
import os
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import circuits  # noqa: E402

GROWTH = [("cockcroft_walton", (n,)) for n in (100, 200, 500, 1000, 2000)] + [("multilevel", (n,)) for n in (10, 40, 100, 400)] + [
    ("solar", (100,)), ("grid", (316, 100)), ("mesh", (32,))]
AGAINST = [("cockcroft_walton", (20,)), ("cockcroft_walton", (80,)), ("multilevel", (20,))]
RON = (1e-1, 1e-2, 1e-3, 1e-4)
RELTOL = (1e-2, 1e-3, 1e-4, 1e-5)


def write(folder, name, text):
    path = os.path.join(folder, name)
    with open(path, "w") as file:
        file.write(text)
    return path


def run(pwlsim, deck, folder, *options, engine="sparse", limit=900):
    """Statistics and rows of a run; None where it failed. "time" is the less of the simulation's wall time and the processor time of the process: each is an upper limit of the simulation's."""
    rows, stats = os.path.join(folder, f"{engine}.csv"), os.path.join(folder, "stats.json")
    command = ["/usr/bin/time", "-f", "%M", *limited(limit), pwlsim, deck, "--quiet", "--engine", engine, "-o", rows, "--stats", stats, *options]
    before = processor_time()
    done = subprocess.run(command, capture_output=True, text=True)
    spent = processor_time() - before
    if is_late(done):
        return None, None, f"over {limit:g} s"
    if done.returncode != 0:
        named = re.search(r"error\[([^]]*)\]", done.stderr)
        return None, None, named.group(1) if named else " ".join(done.stderr.split())[:160]
    with open(stats) as file:
        statistics = json.load(file)
    statistics["memory"] = int(done.stderr.split()[-1]) / 1024.0
    statistics["time"] = min(spent, statistics["seconds"]["simulate"])
    return statistics, np.genfromtxt(rows, delimiter=",", skip_header=1), ""


def limited(seconds):
    """Of the processor: what a command begins with that may take no more."""
    return ["prlimit", f"--cpu={math.ceil(seconds)}"]


def is_late(done):
    """Of a command that was limited, by itself or below `time`, which tells it by 128 and the signal."""
    return done.returncode in (-signal.SIGKILL, -signal.SIGXCPU, 128 + signal.SIGKILL, 128 + signal.SIGXCPU)


def processor_time():
    """Of all processes that were started and have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def growth(options):
    print("| circuit | states | ports | steps | events | factorisations | solves | s | ms a step | ms an event | MiB | worst residual |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for name, sizes in GROWTH:
        if options.only and options.only not in name:
            continue
        with tempfile.TemporaryDirectory() as folder:
            deck = write(folder, "deck.net", circuits.deck(name, sizes))
            s, _, why = run(options.pwlsim, deck, folder)
        label = f"{name} {' '.join(map(str, sizes))}"
        if s is None:
            print(f"| {label} | {why} |", flush=True)
            continue
        seconds = s["time"]
        residual = max(s["certificate"]["complementarity"], s["certificate"]["kcl_kvl"])
        print(f"| {label} | {s['states']} | {s['ports']} | {s['steps']} | {s['events']} | {s['klu_factorizations']} | {s['klu_solves']} | "
              f"{seconds:.3g} | {1e3 * seconds / s['steps']:.3g} | {1e3 * seconds / max(1, s['events']):.3g} | {s['memory']:.0f} | {residual:.0e} |",
              flush=True)


def worst_error(rows, reference):
    largest = np.abs(reference[:, 1:]).max(axis=0)
    return float((np.abs(rows[:, 1:] - reference[:, 1:]) / largest).max())


def ngspice_deck(name, sizes, ron, reltol, output):
    text = circuits.deck(name, sizes, "ngspice", ron)
    signals = re.search(r"^\.save (.*)$", text, re.M).group(1).split()
    step = re.search(r"^\.tran (\S+)", text, re.M).group(1)
    control = [f".options reltol={reltol:g}", ".control", "set wr_singlescale", "set numdgt=10", "run", "rusage time", "linearize",
               f"wrdata {output} {' '.join(signals)}", ".endc", ".end", ""]
    return text.replace("\n.end\n", "\n" + "\n".join(control)), signals, step


def run_ngspice(name, sizes, ron, reltol, folder, reference, limit=300.0):
    """Seconds of its analysis, or of the processor for all of it where that is less, and its error; or None and its words."""
    output = os.path.join(folder, "ng.txt")
    if os.path.exists(output):
        os.remove(output)
    text, _, _ = ngspice_deck(name, sizes, ron, reltol, output)
    deck = write(folder, "ng.cir", text)
    before = processor_time()
    done = subprocess.run([*limited(limit), "ngspice", "-b", deck], capture_output=True, text=True)
    spent = processor_time() - before
    if is_late(done):
        return None, f"over {limit:g} s"
    log = done.stdout + done.stderr
    found = re.search(r"Total analysis time \(seconds\) = (\S+)", log)
    failure = re.search(r"(Timestep too small|singular matrix[^\n]*)", log)
    if failure or not found or not os.path.exists(output):
        return None, failure.group(1) if failure else "no result"
    table = np.loadtxt(output)
    resampled = np.column_stack([reference[:, 0]] + [np.interp(reference[:, 0], table[:, 0], table[:, k]) for k in range(1, table.shape[1])])
    return max(min(float(found.group(1)), spent), 1e-3), worst_error(resampled, reference)  # it counts whole milliseconds


def against(options):
    for name, sizes in AGAINST:
        if options.only and options.only not in f"{name} {sizes[0]}":
            continue
        with tempfile.TemporaryDirectory() as folder:
            deck = write(folder, "deck.net", circuits.deck(name, sizes))
            _, reference, why = run(options.pwlsim, deck, folder, "--reltol", "1e-7")
            if reference is None:
                print(f"{name} {sizes}: no reference: {why}")
                continue
            print(f"## {name} {' '.join(map(str, sizes))}")
            for reltol in ("1e-1", "1e-2", "3e-3", "1e-3", "3e-4", "1e-4", "1e-5"):
                best = None
                for _ in range(options.repeats):
                    s, rows, why = run(options.pwlsim, deck, folder, "--reltol", reltol)
                    if s is None:
                        break
                    best = min(best or 1e9, s["time"])
                print(f"pwlsim --reltol {reltol}: " + (f"{1e3 * best:.1f} ms, error {worst_error(rows, reference):.1e}" if s else why), flush=True)
            for ron in RON:
                for reltol in RELTOL:
                    seconds, error = run_ngspice(name, sizes, ron, reltol, folder, reference)
                    print(f"ngspice Ron {ron:g} reltol {reltol:g}: " + (f"{1e3 * seconds:.0f} ms, error {error:.1e}" if seconds else error), flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", choices=["growth", "ngspice"])
    parser.add_argument("--pwlsim", required=True)
    parser.add_argument("--only", default="", help="part of a circuit's name")
    parser.add_argument("--repeats", type=int, default=3)
    arguments = parser.parse_args()
    started = time.time()
    growth(arguments) if arguments.table == "growth" else against(arguments)
    print(f"\n{time.time() - started:.0f} s in all")
