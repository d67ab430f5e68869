#!/usr/bin/env python3
"""Work-precision: error against run time of pwlsim, ngspice, gnucap and Siconos on every case of validation/cases.

    python3 validation/work_precision/run.py --pwlsim build/pwlsim           all of it: points.csv, longer.csv, diagrams, docs/validation/report.md
    python3 validation/work_precision/run.py --pwlsim build/pwlsim buck      this case; the others keep their points
    python3 validation/work_precision/run.py --pwlsim build/pwlsim --only pwlsim     this program (or ngspice, gnucap, siconos); the others keep their points
    python3 validation/work_precision/run.py --pwlsim build/pwlsim --only exact      times of its exact engine alone, in rounds over some minutes
    python3 validation/work_precision/run.py --pwlsim build/pwlsim --only longer     converters over longer runs alone, see longer.py
    python3 validation/work_precision/run.py --report                        diagrams and report from the points there are

Needs Debian's gnuplot-nox; ngspice, gnucap and Siconos (python3-siconos, python3-mpmath) are left out, with a line that says so, where they are not installed.
Takes about an hour on an idle machine.

Error: worst over the reference's times and signals, relative to each signal's maximum. Time: pwlsim's is `seconds.simulate` of --stats, that of ngspice and
gnucap the CPU time of the process less that of an empty deck, that of Siconos the CPU time of its process without start and reading. Every setting runs
once; those that no other beats in both run again, and the median counts. Points that are measured anew are compared with those of the same settings in points.csv:
errors should repeat to the last digit.
"""
import argparse
import csv
import math
import shutil
import statistics
import sys
import time
from itertools import product
from pathlib import Path

sys.dont_write_bytecode = True

import cases  # noqa: E402
import longer  # noqa: E402
import programs  # noqa: E402
import report  # noqa: E402
from programs import Point  # noqa: E402

HERE = Path(__file__).resolve().parent
POINTS = HERE / "points.csv"
ORDER = ["pwlsim", "ngspice", "gnucap", "siconos"]
LONGER, EXACT = "longer", "exact"
COLUMNS = ["case", "program", "setting", "seconds", "error", "message"]

SPARSE = [10.0 ** -k for k in range(2, 10)]
SMOOTH = [1e-2, 1e-3, 1e-4, 1e-5]
RELTOL = [1e-2, 1e-3, 1e-4, 1e-6]
STEPS = [50, 200, 1000, 5000, 20000, 100000]
FINER_RELTOL = [1e-7]  # for circuits of which the settings above reach the larger error of the report, but not the smaller one
FINER_STEPS = [1000, 5000, 20000, 100000, 400000]
GNUCAP_DIVIDE = [1, 10, 100]
SICONOS_METHODS = [(1.0, None), (0.5, None), (0.5, 0.5)]  # theta and gamma of EulerMoreauOSI
SICONOS_DIVIDE = [1, 3, 10, 30, 100, 300, 1000, 3000, 10000, 30000]
ROUNDS, REPEATS_IN_ROUND, BETWEEN_ROUNDS = 15, 5, 5.0  # s
REPEATS = 3
OWN_REPEATS = 25  # of the exact engine: fractions of a millisecond, which a machine that is shared doubles now and then
ENOUGH = 60.0  # s of ngspice a case: finer steps are then left out


def front(points):
    """The points that no other beats in both time and error."""
    good = sorted((p for p in points if p.error is not None), key=lambda p: (p.seconds, p.error))
    best, chosen = float("inf"), []
    for point in good:
        if point.error < best:
            best = point.error
            chosen.append(point)
    return chosen


def settle(points, run_again, repeats=REPEATS):
    """The median time of so many runs for the points of the front."""
    for point in front(points):
        times = [point.seconds] + [run_again(point).seconds for _ in range(repeats - 1)]
        point.seconds = statistics.median(t for t in times if t is not None)


def measure_pwlsim(program, case):
    runs = {"exact": lambda: programs.run_pwlsim(program, case, "exact")}
    for tolerance in SPARSE:
        runs[f"reltol={tolerance:g}"] = lambda tolerance=tolerance: programs.run_pwlsim(program, case, "sparse", tolerance)
    points = [run() for run in runs.values()]
    settle(points[:1], lambda point: runs[point.setting](), OWN_REPEATS)
    settle(points[1:], lambda point: runs[point.setting]())
    return points


def measure_exact_in_rounds(program, names, points):
    """The median time of the exact engine over rounds of all cases: a run takes less than a millisecond, and a machine that is shared may be slow for minutes."""
    chosen = [cases.load(name) for name in names]
    times = {case.name: [] for case in chosen}
    for _ in range(ROUNDS):
        for case in chosen:
            times[case.name] += [programs.run_pwlsim(program, case, "exact").seconds for _ in range(REPEATS_IN_ROUND)]
        time.sleep(BETWEEN_ROUNDS)
    for point in points:
        if point.case in times and point.program == "pwlsim exact":
            point.seconds = statistics.median(times[point.case])


def measure_ngspice(program, case, empty):
    decks = {}
    for smooth in SMOOTH:
        decks[smooth], refusal = programs.exported(program, case, smooth)
        if decks[smooth] is None:
            return [Point(case.name, "ngspice", "", message=refusal)]
    def run(setting):
        steps, reltol, smooth, method = setting
        text = f"steps={steps} reltol={reltol:g} smooth={smooth:g} method={method}"
        point = programs.run_ngspice(programs.with_settings(decks[smooth], case, reltol, steps, method), case, text)
        if point.seconds is not None:
            point.seconds = max(point.seconds - empty, 1e-4)
        return point
    points, settings = [], {}
    def sweep(steps, reltols, enough):
        spent = 0.0
        for setting in product(steps, reltols, SMOOTH, ("trap", "gear")):
            if spent > enough:
                break
            began = time.perf_counter()
            point = run(setting)
            spent += time.perf_counter() - began
            settings[point.setting] = setting
            points.append(point)
    sweep(STEPS, RELTOL, ENOUGH)
    least = min((p.error for p in points if p.error is not None), default=math.inf)
    if report.TARGETS[1] < least <= report.TARGETS[0]:
        sweep(FINER_STEPS, FINER_RELTOL, math.inf)
    settle(points, lambda point: run(settings[point.setting]))
    return points


def measure_gnucap(program, case, empty):
    points, runs = [], {}
    for divide, reltol, smooth in product(GNUCAP_DIVIDE, (1e-3, 1e-5), SMOOTH[1:3]):
        deck, refusal = programs.exported(program, case, smooth)
        try:
            if deck is None:
                raise programs.NotForGnucap(refusal)
            text, vectors = programs.gnucap_deck(deck, case, smooth, reltol, divide)
        except programs.NotForGnucap as reason:
            return [Point(case.name, "gnucap", "", message=str(reason))]
        setting = f"divide={divide} reltol={reltol:g} smooth={smooth:g}"
        runs[setting] = lambda text=text, vectors=vectors, setting=setting: programs.run_gnucap(text, vectors, case, setting)
        points.append(runs[setting]())
        if all(point.error is None for point in points):
            break
    def again(point):
        return runs[point.setting]()
    settle(points, again)
    for point in points:
        if point.seconds is not None:
            point.seconds = max(point.seconds - empty, 1e-4)
    return points


def measure_siconos(python, case):
    """Ever finer steps of each method, while the next would take no more than report.SICONOS_ENOUGH."""
    with programs.Siconos(python, case) as siconos:
        if siconos.refusal:
            return [Point(case.name, "siconos", "", message=siconos.refusal)]
        points, runs = [], {}
        for method in SICONOS_METHODS:
            a_divide = 0.0  # seconds
            for divide in SICONOS_DIVIDE:
                if a_divide * divide > report.SICONOS_ENOUGH:
                    break
                points.append(siconos.run(*method, divide))
                runs[points[-1].setting] = (*method, divide)
                if points[-1].seconds is None:
                    break
                a_divide = points[-1].seconds / divide
        settle(points, lambda point: siconos.run(*runs[point.setting]))
        return points


def measurements(program, wanted):
    """{first word of a program's name: its points for a case}, of what is wanted and installed."""
    found = {"pwlsim": lambda case: measure_pwlsim(program, case)}
    if shutil.which("ngspice"):
        empty = programs.empty_ngspice()
        found["ngspice"] = lambda case: measure_ngspice(program, case, empty)
    if shutil.which("gnucap"):
        empty_gnucap = programs.empty_gnucap()
        found["gnucap"] = lambda case: measure_gnucap(program, case, empty_gnucap)
    python = programs.siconos_python()
    if python:
        found["siconos"] = lambda case: measure_siconos(python, case)
    for name in ORDER:
        if name not in found and wanted in (None, name):
            print(f"{name} is left out: not installed; its points stay", flush=True)
    return {name: measure for name, measure in found.items() if wanted in (None, name)}


def measure_longer(program, names, points, empty):
    """Of the converters among these cases."""
    chosen = []
    for case in (case for case in map(cases.load, names) if case.kind == "converter"):
        best = {target: report.fastest(report.of(points, case.name, "ngspice"), target) for target in report.TARGETS}
        chosen.append((case, {target: point.setting for target, point in best.items() if point}))
    return longer.measure_again(program, chosen, empty)


def read_points():
    if not POINTS.exists():
        return []
    def number(text):
        return float(text) if text else None
    with POINTS.open(encoding="utf-8") as file:
        return [Point(r["case"], r["program"], r["setting"], number(r["seconds"]), number(r["error"]), r["message"]) for r in csv.DictReader(file)]


def text(value):
    return "" if value is None else f"{value:.4g}"


def beside(new, old):
    """How the points compare with those of the same settings there were."""
    before = {(p.case, p.program, p.setting): p for p in old if p.error is not None}
    pairs = [(p, before[p.case, p.program, p.setting]) for p in new if p.error is not None and (p.case, p.program, p.setting) in before]
    if not pairs:
        return ""
    same = sum(text(p.error) == text(q.error) for p, q in pairs)
    times = sorted(p.seconds / q.seconds for p, q in pairs)
    return f"; beside the points before: {same} of {len(pairs)} errors the same, times by {times[0]:.2g} to {times[-1]:.2g}, median {statistics.median(times):.2g}"


def write_points(points):
    with POINTS.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        for p in sorted(points, key=lambda p: (p.case, ORDER.index(p.program.split()[0]))):
            writer.writerow([p.case, p.program, p.setting, text(p.seconds), text(p.error), p.message])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*")
    parser.add_argument("--pwlsim", help="the program to measure")
    parser.add_argument("--only", choices=[*ORDER, EXACT, LONGER])
    parser.add_argument("--report", action="store_true", help="no runs")
    options = parser.parse_args()
    points = read_points()
    if not options.report:
        if not options.pwlsim and options.only != "siconos":
            parser.error("--pwlsim names the program to measure")
        if options.only == LONGER and not shutil.which("ngspice"):
            parser.error("longer runs are measured beside ngspice, which is not installed")
        measured = measurements(options.pwlsim, options.only)
        if options.only == EXACT:
            measure_exact_in_rounds(options.pwlsim, options.cases or cases.names(), points)
            write_points(points)
        for name in options.cases or cases.names():
            case = cases.load(name)
            if measured:
                new = [point for measure in measured.values() for point in measure(case)]
                compared = beside(new, points)
                points = [p for p in points if p.case != name or p.program.split()[0] not in measured] + new
                write_points(points)
                print(f"{name}: {sum(p.error is not None for p in new)} of {len(new)} settings reached the end{compared}", flush=True)
        if options.only in (None, LONGER) and shutil.which("ngspice"):
            print(*measure_longer(options.pwlsim, options.cases or cases.names(), points, programs.empty_ngspice()), sep="\n", flush=True)
    report.write(points, front)


if __name__ == "__main__":
    main()
