#!/usr/bin/env python3
"""Error against time of the engines and of ngspice on large circuits, and cost against size. Needs numpy and gnuplot; ngspice for its points.

    precision.py --pwlsim build/pwlsim                     all of it: points.csv, then as --report (half an hour)
    precision.py --pwlsim build/pwlsim "line 60" solar     this circuit and this family alone; the others keep their points
    precision.py --report                                  docs/validation/large/*.svg and the first part of docs/validation/large.md from points.csv

Errors are those of all saved signals, relative to each one's largest value. The reference is the exact engine with dense modes where they end within --limit seconds of the processor, else the finest
run of the sparse engine that ended; its own error is its change from the run before at ten times the tolerance. A setting that takes more than the limit is left out for larger circuits of its family, and so are finer ones.
"""
import argparse
import csv
import math
import sys
import tempfile
from dataclasses import asdict, dataclass, fields
from pathlib import Path

sys.dont_write_bytecode = True

import circuits  # noqa: E402
import measure  # noqa: E402
import report  # noqa: E402

POINTS = Path(__file__).resolve().parent / "points.csv"
FAMILIES = {
    "cockcroft_walton": [(n,) for n in (10, 20, 50, 100, 300, 1000, 2000)],
    "multilevel": [(n,) for n in (10, 20, 40, 100, 200, 400)],
    "solar": [(n,) for n in (10, 20, 30, 60)],
    "grid": [(10, 6), (20, 12), (40, 24), (100, 100), (316, 1000, 50)],
    "ladder": [(n,) for n in (50, 100, 400, 2000)],
    "line": [(n,) for n in (60, 200, 600)],
    "six_pulse": [(n,) for n in (1, 2, 3, 6)]}
RELTOL = ("1e-3", "1e-4", "1e-5", "1e-6", "1e-7", "1e-8")  # of the sparse engine
VERY_LARGE, VERY_LARGE_RELTOL = 30000, RELTOL[:3]  # stores and diodes, from which on each run takes minutes
RON, NGSPICE_RELTOL = 1e-3, ("1e-2", "1e-3", "1e-4", "1e-5")
REPEATS, ENOUGH = 5, 2.0  # runs, or as many as take so many seconds


@dataclass
class Point:
    family: str
    circuit: str
    program: str
    setting: str
    seconds: float = None
    error: float = None
    stores: int = None
    ports: int = None
    segments: int = None
    events: int = None
    solutions: int = None
    factors: int = None
    megabytes: float = None
    message: str = ""


def pwlsim_point(options, family, title, deck, folder, engine, *settings, limit):
    """A point without error, and its rows."""
    point, rows, spent = Point(family, title, f"pwlsim {engine}", settings[-1] if settings else ""), None, 0.0
    for _ in range(REPEATS):
        s, rows, point.message = measure.run(options.pwlsim, deck, folder, *settings, engine=engine, limit=limit)
        if s is None:
            break
        point.seconds, spent = min(point.seconds or math.inf, s["time"]), spent + s["time"]
        point.stores, point.ports, point.segments, point.events = s["states"], s["ports"], s["steps"], s["events"]
        point.solutions, point.factors, point.megabytes = s["klu_solves"], s["klu_factorizations"], s["memory"]
        if spent > ENOUGH:
            break
    return point, rows


def set_errors(found):
    """Of [(point, rows)], whose last that has rows is the reference unless the first is; the reference has none, but its own error where it is not exact."""
    exact, ended = found[0], [(p, r) for p, r in found[1:] if r is not None and p.program == "pwlsim sparse"]
    reference = exact[1] if exact[1] is not None else ended[-1][1] if ended else None
    for point, rows in found:
        if reference is not None and rows is not None and rows is not reference:
            point.error = measure.worst_error(rows, reference) if len(rows) == len(reference) else None
    if exact[1] is None and len(ended) > 1:
        ended[-1][0].error = ended[-2][0].error
        ended[-1][0].message = report.REFERENCE
    elif exact[1] is not None:
        exact[0].message = report.REFERENCE
    return reference


def measured(options, family, sizes, late):
    """Points of a circuit; `late` are the settings that took too long on a smaller one, and gets those that do here."""
    title = f"{family} {' '.join(map(str, sizes))}"
    text = circuits.deck(family, sizes)
    very_large = text.count("\nC") + text.count("\nL") + text.count("\nD") > VERY_LARGE
    settings = [("modes",), ("krylov",)] + [("sparse", "--reltol", r) for r in (VERY_LARGE_RELTOL if very_large else RELTOL)]
    if very_large:
        late["modes",] = "left out"
    with tempfile.TemporaryDirectory() as folder:
        deck, found = measure.write(folder, "deck.net", text), []
        for setting in settings:
            if setting in late:
                found.append((Point(family, title, f"pwlsim {setting[0]}", setting[-1] if setting[1:] else "", message=late[setting]), None))
                continue
            found.append(pwlsim_point(options, family, title, deck, folder, *setting, limit=options.longest if very_large else options.limit))
            if found[-1][0].message.startswith("over"):
                late.update({s: found[-1][0].message for s in settings[settings.index(setting):] if s[0] == setting[0]})
        reference = set_errors(found)
        return [point for point, _ in found] + ngspice_points(options, family, sizes, title, folder, reference, late)


def ngspice_points(options, family, sizes, title, folder, reference, late):
    points = []
    for reltol in NGSPICE_RELTOL if reference is not None else ():
        point = Point(family, title, "ngspice", reltol, message=late.get("ngspice", ""))
        points.append(point)
        spent = 0.0
        for _ in range(REPEATS if not point.message else 0):
            seconds, told = measure.run_ngspice(family, sizes, RON, float(reltol), folder, reference, options.limit)
            if seconds is None:
                point.message = told
                break
            point.seconds, point.error, spent = min(point.seconds or math.inf, seconds), told, spent + seconds
            if spent > ENOUGH:
                break
        if point.message.startswith("over"):
            late["ngspice"] = point.message
    return points


def read_points():
    if not POINTS.exists():
        return []
    with POINTS.open(encoding="utf-8") as file:
        return [Point(**{f.name: row[f.name] if f.type is str else f.type(row[f.name]) if row[f.name] else None for f in fields(Point)}) for row in csv.DictReader(file)]


def write_points(points):
    def text(value):
        return "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)
    order = [f"{family} {' '.join(map(str, sizes))}" for family, all_sizes in FAMILIES.items() for sizes in all_sizes]
    with POINTS.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, [f.name for f in fields(Point)], lineterminator="\n")
        writer.writeheader()
        for point in sorted(points, key=lambda p: order.index(p.circuit)):
            writer.writerow({name: text(value) for name, value in asdict(point).items()})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("chosen", nargs="*", help="families, or circuits with their sizes")
    parser.add_argument("--pwlsim", help="the program to measure")
    parser.add_argument("--limit", type=float, default=60.0, help="seconds of the processor a run")
    parser.add_argument("--longest", type=float, default=900.0, help="the same for circuits of 10^5 stores")
    parser.add_argument("--report", action="store_true", help="no runs")
    options = parser.parse_args()
    if not options.report and not options.pwlsim:
        parser.error("--pwlsim names the program to measure")
    for family, all_sizes in FAMILIES.items() if not options.report else ():
        late = {}
        for sizes in all_sizes:
            title = f"{family} {' '.join(map(str, sizes))}"
            if not options.chosen or family in options.chosen or title in options.chosen:
                new = measured(options, family, sizes, late)
                write_points([p for p in read_points() if p.circuit != title] + new)
                print(f"{title}: {sum(p.seconds is not None for p in new)} of {len(new)} settings reached the end", flush=True)
    report.write(read_points(), FAMILIES)


if __name__ == "__main__":
    main()
