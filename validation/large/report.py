"""Pictures of points.csv, and of docs/validation/large.md what stands above the part that is written by hand."""
import math
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "validation"))

import diagrams  # noqa: E402

PAGE, PICTURES = ROOT / "docs" / "validation" / "large.md", ROOT / "docs" / "validation" / "large"
REFERENCE = "reference"  # the message of that point
BY_HAND = "## What they show"  # from here on the page is not made of points
FLOOR = 1e-14  # an error of 0 is drawn here
PICTURED = ["cockcroft_walton 20", "cockcroft_walton 100", "cockcroft_walton 2000", "multilevel 10", "multilevel 40", "multilevel 400", "solar 10", "solar 30", "solar 60",
            "grid 10 6", "grid 20 12", "grid 100 100", "ladder 50", "ladder 400", "ladder 2000", "line 60", "line 200", "line 600", "six_pulse 1", "six_pulse 3", "six_pulse 6"]
PROGRAMS = [("pwlsim modes", "dense modes", diagrams.PALETTE[4], 13), ("pwlsim krylov", "Krylov segments", diagrams.COLOURS["pwlsim exact"], 7),
            ("pwlsim sparse", "sparse", diagrams.COLOURS["pwlsim sparse"], 9), ("ngspice", "ngspice", diagrams.COLOURS["ngspice"], 5)]
COLUMNS = [("pwlsim modes", "", "dense modes"), ("pwlsim krylov", "", "krylov")] + [("pwlsim sparse", r, f"sparse {r}") for r in ("1e-3", "1e-4", "1e-6")] + [
    ("ngspice", r, f"ngspice {r}") for r in ("1e-3", "1e-4")]
SPARSE_COST = "1e-4"  # its default tolerance
QUANTITIES = [("time", "s", lambda p: p.seconds), ("solutions", "", lambda p: p.solutions), ("segments or steps", "", lambda p: p.segments), ("events", "", lambda p: p.events),
              ("time a segment or step", "s", lambda p: p.seconds / p.segments), ("time an event", "s", lambda p: p.seconds / p.events if p.events else 0)]
OF_WHOLE_RUNS = 4  # so many of them: a part of a run has no place in the others


# ---- error against time
def is_exact(point):
    return point.program == "pwlsim modes" and point.message == REFERENCE


def work_precision(family, points):
    panels = []
    for circuit in (c for c in PICTURED if c.split()[0] == family):
        own = [p for p in points if p.circuit == circuit and p.seconds]
        limit = next((p.error for p in own if p.message == REFERENCE and p.error), None)
        series = [([(1e-3, limit), (100.0, limit)], "lines lw 1 dt 2 lc rgb '#888888' title 'error of the reference'")] if limit else []
        for program, title, colour, mark in PROGRAMS:
            rows = [(p.seconds, max(p.error or 0.0, FLOOR)) for p in own if p.program == program and (p.error is not None or is_exact(p)) and not (p.message == REFERENCE and p.error)]
            if rows:
                series.append((rows, f"linespoints lw 2 pt {mark} ps 0.8 lc rgb '{colour}' title '{title}'"))
        if series:
            panels.append((f"set title '{circuit.replace('_', ' ')}'", series))
    settings = (f"set logscale xy; set format '10^{{%L}}'; set xrange [1e-3:100]; set yrange [{FLOOR / 2:g}:1]; set ytics 1e2; set key below maxrows 2 font ',10'; set bmargin 6; "
                "set xlabel 'run time (s)'; set ylabel 'error'")
    if panels:
        diagrams.draw(PICTURES / f"{family}.svg", (1100, 380), settings, panels)


# ---- cost against size
def costs(points, family, engine, quantity):
    """(stores, value) of the engine's runs of a family."""
    own = [p for p in points if p.family == family and p.program == f"pwlsim {engine}" and p.setting == ("" if engine == "krylov" else SPARSE_COST) and p.seconds]
    whole = quantity in QUANTITIES[:OF_WHOLE_RUNS]
    rows = [(p.stores, quantity[2](p)) for p in own if not (whole and is_part(p.circuit))]
    return [row for row in rows if row[1]]


def is_part(circuit):
    return circuit.startswith("grid") and len(circuit.split()) > 3


def cost_picture(points, families, engine):
    panels = []
    for quantity in QUANTITIES:
        series = []
        for k, family in enumerate(families):
            rows = costs(points, family, engine, quantity)
            if rows:
                series.append((rows, f"linespoints lw 2 pt {5 + 2 * k % 10} ps 0.7 lc rgb '{diagrams.PALETTE[k % len(diagrams.PALETTE)]}' title '{family.replace('_', ' ')}'"))
        key = "set key left top font ',9'" if quantity is QUANTITIES[0] else "unset key"
        panels.append((f"{key}\nset title '{quantity[0]}'; set ylabel '{quantity[1]}'", series))
    settings = "set logscale xy; set format '10^{%L}'; set xlabel 'stores'"
    diagrams.draw(PICTURES / f"cost-{engine}.svg", (1100, 700), settings, panels, columns=3)


def exponent(rows):
    """Of the straight line of least squares through the logarithms, with its standard error where more than two points give one."""
    if len(rows) < 2:
        return ""
    x, y = ([math.log(row[k]) for row in rows] for k in (0, 1))
    middle_x, middle_y = sum(x) / len(x), sum(y) / len(y)
    spread = sum((a - middle_x) ** 2 for a in x)
    slope = sum((a - middle_x) * (b - middle_y) for a, b in zip(x, y)) / spread
    if len(rows) == 2:
        return f"{slope:.2f}"
    rest = sum((b - middle_y - slope * (a - middle_x)) ** 2 for a, b in zip(x, y))
    return f"{slope:.2f} ± {math.sqrt(rest / (len(rows) - 2) / spread):.2f}"


def exponents(points, families):
    lines = ["| circuits | stores | engine | " + " | ".join(name for name, _, _ in QUANTITIES) + " |", "| --- " * (3 + len(QUANTITIES)) + "|"]
    for family in families:
        for engine in ("krylov", "sparse"):
            stores = [row[0] for row in costs(points, family, engine, QUANTITIES[-2])]
            if stores:
                lines.append(f"| {family} | {min(stores):,} to {max(stores):,} | {engine} | " + " | ".join(exponent(costs(points, family, engine, q)) for q in QUANTITIES) + " |")
    return lines


# ---- the tables
def cell(point):
    if point is None:
        return ""
    if point.seconds is None:
        return point.message
    shown = "reference" if point.message == REFERENCE else "" if point.error is None else f"{point.error:.0e}"
    return f"{1e3 * point.seconds:.3g}" + (f" ({shown})" if shown else "")


def table(points):
    lines = ["| circuit | reference | " + " | ".join(title for _, _, title in COLUMNS) + " |", "| --- " * (2 + len(COLUMNS)) + "|"]
    for circuit in dict.fromkeys(p.circuit for p in points):
        own = [p for p in points if p.circuit == circuit]
        reference = next((p for p in own if p.message == REFERENCE), None)
        beside = "none" if reference is None else "dense modes" if is_exact(reference) else f"sparse, {reference.setting} (its error: {reference.error:.0e})"
        cells = [cell(next((p for p in own if (p.program, p.setting) == (program, setting)), None)) for program, setting, _ in COLUMNS]
        lines.append(f"| {circuit} | {beside} | " + " | ".join(cells) + " |")
    return lines


def counts(points):
    lines = ["| circuit | stores | events | segments | solutions | factors | s | MiB | sparse 1e-4: events | steps | solutions | s | MiB |", "| --- " * 13 + "|"]
    for circuit in dict.fromkeys(p.circuit for p in points):
        krylov, sparse = ((next((p for p in points if (p.circuit, p.program, p.setting) == (circuit, program, setting) and p.seconds), None))
                          for program, setting in (("pwlsim krylov", ""), ("pwlsim sparse", SPARSE_COST)))
        if krylov and sparse and krylov.stores >= 2000:
            lines.append(f"| {circuit} | {krylov.stores:,} | {krylov.events:,} | {krylov.segments:,} | {krylov.solutions:,} | {krylov.factors:,} | {krylov.seconds:.3g} | {krylov.megabytes:.0f} | "
                         f"{sparse.events:,} | {sparse.segments:,} | {sparse.solutions:,} | {sparse.seconds:.3g} | {sparse.megabytes:.0f} |")
    return lines


def text(points, families):
    return ["# Large circuits", "",
            "Made by `python3 validation/large/precision.py --pwlsim build/pwlsim` (program as `./run` builds it) from the circuits of `validation/large/circuits.py`; all points are in",
            "[points.csv](../../validation/large/points.csv).", "",
            "- **Time** is that of the simulation, the least of up to five runs: the less of its wall time and of the processor time of the whole process, as other programs ran beside it. That of ngspice is the less of its own \"Total analysis time\" and of the processor time of its process. A run has 60 s of the processor.",
            "- **Error** is the largest of all saved signals, relative to each one's largest value. The reference is dense modes where they end, else the finest tolerance of the sparse engine that ended; its",
            "  own error is its change from the run at ten times the tolerance; smaller errors than that are not known.",
            "- ngspice has diodes with Ron = 1 mΩ and a `reltol` of 1e-2 to 1e-5; the sparse engine has `--reltol` 1e-3 to 1e-8.", "",
            "## Error against time", "",
            *[f"![{family.replace('_', ' ')}: error against time](large/{family}.svg)\n" for family in families],
            "Time in ms (error). A setting that took more than 60 s on a smaller circuit is not tried again. The last number of `grid 316 1000 50` is the microseconds that are run, a fortieth of the others'.", "", *table(points), "",
            "## Cost against size", "",
            "![Cost of Krylov segments against the number of stores](large/cost-krylov.svg)", "",
            "![Cost of implicit steps against the number of stores](large/cost-sparse.svg)", "",
            f"The first picture is of Krylov segments, the second of the sparse engine at `--reltol {SPARSE_COST}`. Exponents p of N^p by least squares on the logarithms, with their standard errors (N: stores):", "",
            *exponents(points, families), "",
            "Rectifiers of a grid grow with it (6, 12, 24, 100, 1,000), and so do events. The largest circuits:", "", *counts(points), ""]


def write(points, families):
    PICTURES.mkdir(parents=True, exist_ok=True)
    for family in families:
        work_precision(family, points)
    for engine in ("krylov", "sparse"):
        cost_picture(points, families, engine)
    by_hand = PAGE.read_text(encoding="utf-8").partition(f"\n{BY_HAND}\n")
    if not by_hand[1]:
        raise SystemExit(f"{PAGE} has no '{BY_HAND}': what is written by hand below it would be lost")
    PAGE.write_text("\n".join(text(points, families)) + by_hand[1] + by_hand[2], encoding="utf-8")
