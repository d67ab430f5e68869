"""Diagrams and docs/validation/report.md from the points."""
import platform
import re
import statistics
import subprocess
import sys
from pathlib import Path

import cases
import longer

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "validation"))

import diagrams  # noqa: E402

DOCS = ROOT / "docs" / "validation"
PICTURES = DOCS / "work-precision"
FLOOR = 1e-17  # an error of 0 is drawn here
MARKS = {"pwlsim exact": 7, "pwlsim sparse": 9, "ngspice": 5, "gnucap": 13, "siconos": 11}
PROGRAMS = [(program, colour, MARKS[program]) for program, colour in diagrams.COLOURS.items()]
TARGETS = (1e-3, 1e-4)
PROFILE_TARGETS = (1e-3, 1e-6)
LONGEST_FACTOR = 1e5
SICONOS_ENOUGH = 2.0  # s a run: steps that would take longer are left out
ORDER = ["converter", "rectifier", "stiff", "impulsive", "grazing", "chattering", "paper", "large"]


def of(points, case, program):
    return [p for p in points if p.case == case and p.program == program]


# ---- diagrams
def work_precision(name, points, front):
    """Small dots are all settings, lines the front that no setting beats."""
    series = []
    for program, colour, mark in PROGRAMS:
        good = [p for p in of(points, name, program) if p.error is not None]
        if good:
            dots, line = ([(p.seconds, max(p.error, FLOOR)) for p in chosen] for chosen in (good, front(good)))
            series += [(dots, f"points pt {mark} ps 0.3 lc rgb '{colour}' notitle"), (line, f"linespoints lw 2 pt {mark} ps 0.8 lc rgb '{colour}' title '{program}'")]
    if series:
        settings = ("set logscale xy; set format '10^{%L}'; set ytics 1e3; set yrange [1e-17:10]; set key outside right top; "
                    f"set xlabel 'run time (s)'; set ylabel 'error'; set title '{name.replace('_', ' ')}'")
        diagrams.draw(PICTURES / f"{name}.svg", (640, 420), settings, [("", series)])


# ---- the performance profile
def ratios_to_best(points, target):
    """{program: [its shortest time at an error of at most `target` over the shortest of all programs], one for each circuit it solves}, and the number of circuits."""
    ratios, solved = {program: [] for program, _, _ in PROGRAMS}, 0
    for name in sorted({p.case for p in points}):
        best = {program: fastest(of(points, name, program), target) for program in ratios}
        times = {program: point.seconds for program, point in best.items() if point}
        solved += bool(times)
        for program, seconds in times.items():
            ratios[program].append(seconds / min(times.values()))
    return ratios, solved


def profile(points):
    """Share of the circuits that a program solves within a factor of the fastest (Dolan and Moré 2002, Mathematical Programming 91, 201-213)."""
    panels = []
    for column, target in enumerate(PROFILE_TARGETS):
        ratios, solved = ratios_to_best(points, target)
        series = []
        for program, colour, _ in PROGRAMS:
            steps = sorted(ratios[program])
            rows = [(1.0, 0.0), *((factor, (k + 1) / solved) for k, factor in enumerate(steps)), (LONGEST_FACTOR, len(steps) / solved)]
            series.append((rows, f"steps lw 2 lc rgb '{colour}' title '{program}'"))
        panels.append((f"set title 'error of at most {target:.0e}, {solved} circuits'\n" + ("unset key" if column == 0 else "set key at graph 0.97, 0.94"), series))
    settings = (f"set logscale x; set format x '10^{{%L}}'; set xrange [1:{LONGEST_FACTOR:g}]; set yrange [0:1.02]; "
                "set xlabel 'run time over that of the fastest program'; set ylabel 'share of the circuits'")
    diagrams.draw(PICTURES / "performance-profile.svg", (900, 380), settings, panels)


# ---- the table
def fastest(points, target):
    good = [p for p in points if p.error is not None and p.error <= target]
    return min(good, key=lambda p: p.seconds) if good else None


def cell(point):
    return f"{point.seconds * 1e3:.3g} ({point.error:.0e})" if point else "–"


def best_error(points):
    good = [p for p in points if p.error is not None]
    return min(good, key=lambda p: p.error) if good else None


def most_common_words(points):
    words = [re.sub(r"[0-9.e+-]+ s:", "", p.message) for p in points if p.message]
    return max(set(words), key=words.count).replace("|", "\\|") if words else ""


def remark(points, name):
    return "; ".join(filter(None, [ngspice_remark(of(points, name, "ngspice")), siconos_remark(of(points, name, "siconos"))]))


def siconos_remark(siconos):
    if not siconos:
        return "Siconos was not run"
    return "" if best_error(siconos) else f"Siconos: {most_common_words(siconos)}"


def ngspice_remark(ngspice):
    if not ngspice:
        return "ngspice was not run"
    best = best_error(ngspice)
    if best is None:
        return f"ngspice: {most_common_words(ngspice)}"
    if best.error > TARGETS[0]:
        return f"ngspice: none of {len(ngspice)} settings below {best.error:.0e}"
    failed = sum(p.error is None for p in ngspice)
    return f"{failed} of {len(ngspice)} settings of ngspice failed" if failed else ""


def ratio(points, name, target, program="ngspice"):
    exact, other = of(points, name, "pwlsim exact"), fastest(of(points, name, program), target)
    if not exact or exact[0].error is None or exact[0].error > target or other is None:
        return None
    return other.seconds / exact[0].seconds


def row(points, name):
    exact = of(points, name, "pwlsim exact")
    columns = [f"[{name}](work-precision/{name}.svg)", cell(exact[0]) if exact and exact[0].error is not None else (exact[0].message if exact else "–")]
    columns.append(cell(fastest(of(points, name, "pwlsim sparse"), TARGETS[0])))
    for target in TARGETS:
        columns.append(cell(fastest(of(points, name, "ngspice"), target)))
    best = best_error(of(points, name, "ngspice"))
    columns.append(f"{best.error:.0e}" if best else "–")
    columns.append(cell(fastest(of(points, name, "gnucap"), TARGETS[0])))
    siconos = of(points, name, "siconos")
    best = best_error(siconos)
    columns.append(cell(fastest(siconos, TARGETS[0])) if not best or best.error <= TARGETS[0] else f"– ({best.error:.0e})")
    for target in TARGETS:
        value = ratio(points, name, target)
        columns.append("–" if value is None else f"{value:.0f}" if value >= 10 else f"{value:.1g}")
    return "| " + " | ".join([*columns, remark(points, name)]) + " |"


def means_in_words(ratios):
    """Geometric means of {target: ratios}; empty where there are none."""
    return ", ".join(f"{statistics.geometric_mean(values):.0f} at {target:g} ({len(values)} circuits)" for target, values in ratios.items() if values)


def mean_ratios(points, names, program):
    return means_in_words({target: [v for v in (ratio(points, name, target, program) for name in names) if v is not None] for target in TARGETS})


# ---- longer runs
def longer_table():
    costs = longer.read()
    if not costs:
        return []
    rows, ratios, short_ratios = [], {target: [] for target in TARGETS}, {target: [] for target in TARGETS}
    for name in sorted({c.case for c in costs}):
        own, *others = [next((c for c in costs if c.case == name and c.error == target), None) for target in (None, *TARGETS)]
        times = [c and c.further() for c in (own, *others)]
        beside = [t and t / times[0] for t in times[1:]]
        rows.append("| " + " | ".join([name, *("–" if t is None else f"{t * 1e3:.3g}" for t in times), *("–" if r is None else f"{r:.0f}" for r in beside)]) + " |")
        for target, value, other in zip(TARGETS, beside, others):
            ratios[target] += [] if value is None else [value]
            short_ratios[target] += [] if other is None else [other.short / own.short]
    return ["### Longer runs", "",
            f"In pwlsim a quarter to a half of a run of a few hundred periods is the building of modes and a cold start. The table has the time in ms of each further interval of the deck's length, from runs {longer.TIMES} times as long "
            "([longer.py](../../validation/work_precision/longer.py)), with ngspice at the settings of the table above. Times are the shortest of each program, from rounds over minutes: other programs on the machine can only add to them.", "",
            "| circuit | exact | ngspice 1e-3 | ngspice 1e-4 | ratio 1e-3 | ratio 1e-4 |", "| --- | --- | --- | --- | --- | --- |",
            *rows, "", f"Geometric mean of the ratios: {means_in_words(ratios)}. Over the deck's own length, by the same method: {means_in_words(short_ratios)}; "
            "the table above has medians of fewer runs, for pwlsim and ngspice from different minutes, in which the machine may have been slow.", ""]


# ---- the page
def version_of(command):
    try:
        ended = subprocess.run(command, capture_output=True, text=True, check=False, errors="replace", stdin=subprocess.DEVNULL)
    except FileNotFoundError:
        return "not installed"
    match = re.search(r"ngspice-\d+|gnucap\D*[\d.]+|gnuplot [\d.]+|master [\d.]+", ended.stdout + ended.stderr)
    return match[0] if match else "unknown"


def siconos_version():
    """Of Debian's package: the module does not tell."""
    try:
        ended = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", "python3-siconos"], capture_output=True, text=True, check=False)
    except FileNotFoundError:
        return "unknown"
    return ended.stdout if ended.returncode == 0 else "not installed"


def machine():
    model = re.search(r"model name\s*: (.*)", Path("/proc/cpuinfo").read_text())
    count = len(re.findall(r"^processor", Path("/proc/cpuinfo").read_text(), re.M))
    return f"{model[1].strip() if model else platform.machine()}, {count} processors, Linux {platform.release().split('-')[0]}"


def head(points):
    used = sorted({p.case for p in points})
    return [
        "# Work and precision",
        "",
        f"Made by `python3 validation/work_precision/run.py --pwlsim build/pwlsim` on {machine()}; {version_of(['ngspice', '-v'])}, "
        f"gnucap {version_of(['gnucap', '-b', '/dev/null']).removeprefix('master ')}, "
        f"python3-siconos {siconos_version()}. {len(used)} circuits. Times on a machine that is not idle are accurate to a factor of two; errors are reproducible:",
        "a second run of pwlsim, ngspice and Siconos gave the same four digits of every error, and run.py checks this whenever it repeats a measurement.",
        "",
        "Each case is a folder of [validation/cases](../../validation/cases) with its deck, its purpose and the source of its reference; no reference comes from the program itself.",
        "Error: the largest over the reference's times and signals, relative to each signal's maximum. Time, in ms: `seconds.simulate` for pwlsim; for ngspice and gnucap the CPU time of the process",
        "minus that of an empty deck; for Siconos the CPU time to build and step its simulations. The columns show the fastest setting that reaches the error",
        "([run.py](../../validation/work_precision/run.py) has the lists); choosing it with the reference favours these programs. ngspice and gnucap run the deck of `pwlsim export`: smoothing, reltol,",
        "largest step and method are swept. After ngspice has run for 25 to 60 s on a circuit, finer steps are left out; if its error is then below 1e-3 but not below 1e-4, reltol=1e-7 with up to 400,000 steps follows.",
        "Times of ngspice below a millisecond are mostly noise of the process start.",
        "All points: [points.csv](../../validation/work_precision/points.csv).",
        "",
        "- **exact**: pwlsim's exact engine, time (error). **sparse**: the fastest tolerance of the sparse engine with an error below 1e-3, if any.",
        "- **ngspice 1e-3, 1e-4**: its fastest setting below that error. **least**: the smallest error of any setting.",
        "- **ratio**: ngspice's time over that of the exact engine at that error.",
        "- **gnucap** runs the circuits that it can read: no sources with expressions, no phase of a sine, no diodes with a drop; other diodes become exponential.",
        "- **siconos**: its fastest setting below 1e-3; – (e): there is none, e is the smallest error. Time-stepping by `EulerMoreauOSI` with ideal diodes, Lemke's method in each step, driven from Python;",
        f"  θ = 1, θ = 1/2, θ = γ = 1/2, and the deck's own step divided by 1, 3, 10, 30, … as long as a run takes no more than {SICONOS_ENOUGH:g} s. Its linear complementarity systems come from",
        "  [complementarity.py](../../validation/work_precision/complementarity.py), not from the program. Siconos receives the instants of the edges of sources and switches, steps to them, and continues",
        "  with the system of the new switch position; if a position of ideal switches has no system (freewheel, buck_parasitic), they are resistors, 1e9 times below and above the deck's",
        "  mean impedance. It cannot model a switch that the circuit itself controls.",
        "",
        "![Share of the circuits that a program solves within a factor of the fastest one](work-precision/performance-profile.svg)",
        "",
        "Performance profile (Dolan and Moré 2002): the share of the circuits that a program brings below the error within a factor of the fastest program's time.",
        "",
    ]


def table(points):
    used = {p.case for p in points}
    kinds = {name: cases.load(name).kind for name in cases.names() if name in used}
    lines = []
    for kind in ORDER:
        names = [name for name in sorted(kinds) if kinds[name] == kind]
        if not names:
            continue
        lines += [f"## {kind.capitalize()}", "",
                  "| circuit | exact | sparse 1e-3 | ngspice 1e-3 | ngspice 1e-4 | least | gnucap 1e-3 | siconos 1e-3 | ratio 1e-3 | ratio 1e-4 | remarks |",
                  "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"]
        lines += [row(points, name) for name in names] + [""]
        if len(names) > 2:
            means = [f"of {words} {text}" for program, words in (("ngspice", "ngspice"), ("siconos", "Siconos")) if (text := mean_ratios(points, names, program))]
            lines += ["Geometric mean of the time over that of the exact engine: " + "; ".join(means) + ".", ""] if means else []
        if kind == "converter":
            lines += longer_table()
    return lines


def write(points, front):
    PICTURES.mkdir(parents=True, exist_ok=True)
    for name in sorted({p.case for p in points}):
        work_precision(name, points, front)
    profile(points)
    (DOCS / "report.md").write_text("\n".join(head(points) + table(points)).rstrip("\n") + "\n", encoding="utf-8")
