"""What more of the same costs: every converter over its deck's own length and over ten times that, into longer.csv; run.py calls it.

Of a run of a few hundred switching periods a quarter to a half is, in pwlsim, the building of modes and a cold start; what (long − short)/9 gives is what each further
stretch of the deck's length costs. ngspice runs at its fastest settings below an error, as points.csv has them, with the same steps; its error is checked against
the same reference, which ends where the deck does. The least time of each, from rounds of all of them over some minutes: what shares the machine can only add
to a time, and adds more to a program that keeps all of a core busy.
"""
import csv
import re
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import programs

FILE = Path(__file__).resolve().parent / "longer.csv"
COLUMNS = ["case", "program", "error", "setting", "short", "long"]  # error: that was asked for; seconds
TIMES = 10
ROUNDS, OWN_REPEATS = 6, 5  # of pwlsim's runs in a round; ngspice has one
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
    deck = Path(folder) / f"{case.name}.net"
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


class Measured:
    """The least times of the deck and of the longer one, over as many runs as there are; None once one failed."""

    def __init__(self, runs):
        self.runs, self.least = runs, [float("inf")] * len(runs)

    def run(self):
        if self.least is None:
            return
        times = [run() for run in self.runs]
        self.least = None if None in times else [min(pair) for pair in zip(self.least, times)]


def measure(program, chosen, empty):
    """`chosen`: [(case, {error: fastest setting of ngspice})]."""
    with tempfile.TemporaryDirectory() as folder, programs.limit(LIMIT):
        measured = []
        for case, fastest in chosen:
            both = (case, lengthened(case, folder))
            measured.append((case.name, None, "exact", Measured([lambda c=c: programs.run_pwlsim(program, c, "exact").seconds for c in both])))
            measured += [(case.name, error, setting, Measured([ngspice_run(program, c, setting, error, empty) for c in both]))
                         for error, setting in fastest.items()]
        for _ in range(ROUNDS):
            for _, error, _, times in measured:
                for _ in range(OWN_REPEATS if error is None else 1):
                    times.run()
        return [Cost(name, "ngspice" if error else "pwlsim exact", error, setting, *times.least) for name, error, setting, times in measured if times.least]


def measure_again(program, chosen, empty):
    """The costs of these cases anew, the other cases' as they are in the file; the new ones in words, a line a case."""
    new = measure(program, chosen, empty)
    names = [case.name for case, _ in chosen]
    write([c for c in read() if c.case not in names] + new)
    return [f"{name}, longer: " + ", ".join(f"{c.program}{f' {c.error:g}' if c.error else ''} {c.further() * 1e3:.4g} ms" for c in new if c.case == name) for name in names]
