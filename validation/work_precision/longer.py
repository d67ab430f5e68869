"""What more of the same costs: every converter over its deck's own length and over ten times that, into longer.csv; run.py calls it.

Of a run of a few hundred switching periods a quarter to a half is, in pwlsim, the building of modes and a cold start; what (long − short)/9 gives is what each further
stretch of the deck's length costs. ngspice runs at its fastest settings below an error, as points.csv has them, with the same steps; its error is checked against
the same reference, which ends where the deck does. The middle one of several runs of each, one after the other.
"""
import csv
import re
import statistics
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import programs

FILE = Path(__file__).resolve().parent / "longer.csv"
COLUMNS = ["case", "program", "error", "setting", "short", "long"]  # error: that was asked for; seconds
TIMES = 10
REPEATS, OWN_REPEATS = 3, 5
SLACK = 1.1  # of the error, which moves a little with the length of the run
LIMIT = 120.0  # s of wall time a run


@dataclass
class Cost:
    case: str
    program: str
    error: float  # None: of pwlsim's exact engine there is no choice
    setting: str
    short: float
    long: float

    def further(self):
        """Seconds for each further stretch of the deck's length."""
        return (self.long - self.short) / (TIMES - 1)


def read():
    if not FILE.exists():
        return []
    with FILE.open(encoding="utf-8") as file:
        return [Cost(r["case"], r["program"], float(r["error"]) if r["error"] else None, r["setting"], float(r["short"]), float(r["long"]))
                for r in csv.DictReader(file)]


def write(costs):
    with FILE.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        for c in sorted(costs, key=lambda c: (c.case, c.program != "pwlsim exact", -(c.error or 0.0))):
            writer.writerow([c.case, c.program, f"{c.error:g}" if c.error else "", c.setting, f"{c.short:.4g}", f"{c.long:.4g}"])


def lengthened(case, folder):
    text, count = re.subn(r"(?m)^(\.tran \S+) \S+", lambda m: f"{m[1]} {case.stop * TIMES!r}", case.deck.read_text(encoding="utf-8"))
    assert count == 1
    deck = Path(folder) / "longer.net"
    deck.write_text(text, encoding="utf-8")
    return replace(case, deck=deck, stop=case.stop * TIMES)


def ngspice_run(program, case, setting, error, empty):
    """A function that runs ngspice on the case: seconds, or None where it fails or misses the error."""
    words = dict(word.split("=") for word in setting.split())
    deck, _ = programs.exported(program, case, float(words["smooth"]))
    steps = int(words["steps"]) * round(case.stop / case.grid.times[-1])
    text = programs.with_settings(deck, case, float(words["reltol"]), steps, words["method"])
    def run():
        point = programs.run_ngspice(text, case, setting)
        return point.seconds - empty if point.seconds is not None and point.error <= SLACK * error else None
    return run


def medians(pairs):
    """Of the short and of the long runs; None where one failed."""
    return None if any(t is None for pair in pairs for t in pair) else [statistics.median(column) for column in zip(*pairs)]


def measure(program, case, fastest, empty):
    """`fastest`: {error: setting of ngspice}. A machine that is shared may be slow for seconds: pwlsim runs before, between and after the others."""
    with tempfile.TemporaryDirectory() as folder, programs.limit(LIMIT):
        both, own, others = (case, lengthened(case, folder)), [], []
        def run_own():
            own.extend([programs.run_pwlsim(program, c, "exact").seconds for c in both] for _ in range(OWN_REPEATS))
        run_own()
        for error, setting in fastest.items():
            runs, pairs = [ngspice_run(program, c, setting, error, empty) for c in both], []
            for _ in range(REPEATS):
                pairs.append([run() for run in runs])
                run_own()
            found = medians(pairs)
            if found:
                others.append(Cost(case.name, "ngspice", error, setting, *found))
        return [Cost(case.name, "pwlsim exact", None, "exact", *medians(own)), *others]


def measure_again(program, case, fastest, empty):
    """The case's costs anew, the other cases' as they are in the file; the new ones in words."""
    new = measure(program, case, fastest, empty)
    write([c for c in read() if c.case != case.name] + new)
    return ", ".join(f"{c.program}{f' {c.error:g}' if c.error else ''} {c.further() * 1e3:.4g} ms" for c in new)
