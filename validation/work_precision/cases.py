"""The cases: a folder each with circuit.net, why.md, reference.csv (rows of the deck's grid) and events.csv; where events lie on most
of these rows also between.csv, with rows between them."""
import csv
import re
from dataclasses import dataclass
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[1] / "cases"
APART = 1e-6  # of the run: an event nearer than this to a row makes what another program gives there a matter of rounding


@dataclass
class Reference:
    times: list
    rows: list  # one list of signals a time

    def maxima(self):
        return [max(abs(row[i]) for row in self.rows) or 1.0 for i in range(len(self.rows[0]))]

    def error(self, rows):
        """Worst over times and signals, relative to each signal's maximum; `rows` at the same times."""
        return max(abs(x - y) / m for p, q in zip(rows, self.rows) for x, y, m in zip(p, q, self.maxima()))


@dataclass
class Case:
    name: str
    deck: Path
    kind: str
    signals: list
    grid: Reference  # the deck's own rows, the value after a jump
    free: Reference  # rows with no event near
    stop: float


def read_table(path):
    lines = [line for line in path.read_text(encoding="utf-8").split("\n") if line and not line.startswith("#")]
    table = list(csv.reader(lines))
    return table[0], table[1:]


def read_reference(path):
    head, rows = read_table(path)
    return head[1:], Reference([float(row[0]) for row in rows], [[float(x) for x in row[1:]] for row in rows])


def without_events(grid, events, stop):
    kept = [k for k, t in enumerate(grid.times) if t > 0 and all(abs(t - e) > APART * stop for e in events)]
    return Reference([grid.times[k] for k in kept], [grid.rows[k] for k in kept])


def load(name):
    folder = FOLDER / name
    signals, grid = read_reference(folder / "reference.csv")
    stop = grid.times[-1]
    events = [float(row[0]) for row in read_table(folder / "events.csv")[1]]
    between = folder / "between.csv"
    free = read_reference(between)[1] if between.exists() else without_events(grid, events, stop)
    kind = re.search(r"^Class: (\w+)", (folder / "why.md").read_text(encoding="utf-8")).group(1)
    return Case(name, folder / "circuit.net", kind, signals, grid, free, stop)


def names():
    return sorted(path.name for path in FOLDER.iterdir() if path.is_dir())
