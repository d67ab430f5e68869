"""One run of each program at one setting: seconds, error against the reference, or its words where it fails."""
import csv
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "bench" / "ngspice"))

import cases  # noqa: E402
from ngspice_deck import EMPTY, read_raw  # noqa: E402

LIMIT = 5.0  # s of wall time a run
END = 1e-9    # of the run


@contextmanager
def limit(seconds):
    """Another limit for the runs within."""
    global LIMIT
    before, LIMIT = LIMIT, seconds
    try:
        yield
    finally:
        LIMIT = before


@dataclass
class Point:
    case: str
    program: str
    setting: str
    seconds: float = None
    error: float = None
    message: str = ""


def short(text):
    return " ".join(text.split())[:100]


# ---- pwlsim
def run_pwlsim(program, case, engine, reltol=None):
    """seconds: the simulate phase; `message` also holds the time of the whole process."""
    setting = engine if reltol is None else f"reltol={reltol:g}"
    point = Point(case.name, f"pwlsim {engine}", setting)
    with tempfile.TemporaryDirectory() as folder:
        out, stats = Path(folder) / "out.csv", Path(folder) / "stats.json"
        command = [program, str(case.deck), "-o", str(out), "--stats", str(stats), "--quiet", "--engine", engine]
        command += ["--reltol", repr(reltol)] if reltol else []
        try:
            ended = subprocess.run(command, capture_output=True, text=True, timeout=3 * LIMIT, check=False)
        except subprocess.TimeoutExpired:
            point.message = f"stopped after {3 * LIMIT:g} s"
            return point
        if ended.returncode != 0:
            point.message = short(ended.stderr)
            return point
        point.seconds = json.loads(stats.read_text())["seconds"]["simulate"]
        rows = {row[0]: row[1:] for row in ([float(x) for x in line] for line in list(csv.reader(out.open()))[1:])}
        point.error = case.grid.error([rows[t] for t in case.grid.times])
    return point


# ---- decks that pwlsim export writes, with other settings
def exported(program, case, smooth):
    """The deck, or None and why there is none."""
    ended = subprocess.run([program, "export", str(case.deck), "-o", "-", "--smooth", repr(smooth), "--quiet"], capture_output=True, text=True,
                           check=False)
    return (ended.stdout, "") if ended.returncode == 0 else (None, short(ended.stderr))


def with_settings(deck, case, reltol, steps, method):
    deck = re.sub(r"(?m)^\.options .*$", f".options reltol={reltol!r} abstol=1e-9 vntol=1e-6 rshunt=1e12 method={method}", deck)
    step = case.stop / steps
    deck = re.sub(r"(?m)^\.tran \S+ (\S+) (\S+) \S+", lambda m: f".tran {step!r} {m[1]} {m[2]} {step!r}", deck)
    corners = " ".join(f"{t!r} {k % 2}" for k, t in enumerate(case.free.times))
    sampler = f"V.sample pwlsim.sample 0 PWL(0 1 {corners})\nR.sample pwlsim.sample 0 1\n"  # makes ngspice step on the sample times
    return deck.replace(".options", sampler + ".options", 1)


def vectors_of(signal, names):
    """[(name in the file, sign)]"""
    kind, inside = signal[0].lower(), [w.strip().lower() for w in signal[2:-1].split(",")]
    if kind == "v":
        return [(f"v({node})", sign) for node, sign in zip(inside, (1.0, -1.0)) if node != "0"]
    wanted = (f"i(v.{inside[0]}.i)", f"i({inside[0]})")
    return [(next(name for name in wanted if name in names), 1.0)]


def signals_at(vectors, case, times):
    """Rows of signals by straight lines between the points of the file."""
    moments, out, at = vectors["time"], [], 1
    sums = [vectors_of(signal, vectors) for signal in case.signals]
    for t in times:
        while at + 1 < len(moments) and moments[at] < t:
            at += 1
        share = (t - moments[at - 1]) / (moments[at] - moments[at - 1]) if moments[at] > moments[at - 1] else 1.0
        share = min(max(share, 0.0), 1.0)
        out.append([sum(s * ((1 - share) * vectors[n][at - 1] + share * vectors[n][at]) for n, s in terms) for terms in sums])
    return out


# ---- ngspice
def words_of(log):
    marks = ("too small", "singular", "error", "no convergence", "aborted", "unknown")
    lines = [line.strip() for line in log.split("\n") if any(mark in line.lower() for mark in marks) and "spinit" not in line]
    return short("; ".join(dict.fromkeys(lines[:2]))) or "no words"


@dataclass
class Process:
    seconds: float  # CPU time
    log: str        # what it said
    in_time: bool


def run_process(command):
    """Whether a run is complete its last time tells, not its status."""
    with tempfile.TemporaryFile() as log:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT)
        timer = threading.Timer(LIMIT, os.kill, (process.pid, signal.SIGKILL))  # Popen.kill may reap the process
        timer.start()
        _, status, usage = os.wait4(process.pid, 0)
        timer.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
        log.seek(0)
        return Process(usage.ru_utime + usage.ru_stime, log.read().decode("utf-8", "replace"), process.returncode != -signal.SIGKILL)


def run_ngspice(deck, case, setting):
    """seconds: CPU time of the process; that of an empty deck is taken off by the caller."""
    point = Point(case.name, "ngspice", setting)
    with tempfile.TemporaryDirectory() as folder:
        path, raw = Path(folder) / "deck.cir", Path(folder) / "deck.raw"
        path.write_text(deck)
        process = run_process(["ngspice", "-n", "-b", "-r", str(raw), str(path)])
        vectors = read_raw(raw.read_bytes()) if raw.exists() else {}
    moments = vectors.get("time", ())
    if not moments or moments[-1] < case.stop * (1 - END):
        reached = f"ended at t = {moments[-1]:.3g} s: " if moments else ""
        point.message = reached + (words_of(process.log) if process.in_time else f"stopped after {LIMIT:g} s")
        return point
    point.seconds = process.seconds
    point.error = case.free.error(signals_at(vectors, case, case.free.times))
    return point


def empty_seconds(command, repeats=9):
    """CPU time of an empty deck."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "deck.cir"
        path.write_text(EMPTY)
        runs = sorted(run_process([word.replace("FOLDER", folder) for word in command] + [str(path)]).seconds for _ in range(repeats))
        return runs[repeats // 2]


@cache
def empty_ngspice():
    return empty_seconds(["ngspice", "-n", "-b", "-r", "FOLDER/deck.raw"])


def empty_gnucap():
    return empty_seconds(["gnucap", "-b"])


# ---- gnucap: no sidiode, no phase of a sine, no B source, no perfect coupling by K
class NotForGnucap(Exception):
    pass


def gnucap_line(line, smooth):
    words = line.split()
    letter = line[0].lower()
    if letter == "a":  # a sidiode
        return f"D{words[0]} {words[1]} {words[2]} {words[3]}"
    if line.startswith(".model") and " sidiode(" in line:
        if not re.search(r"Vfwd=0\)", line):
            raise NotForGnucap("a diode with a drop")
        return f".model {words[1]} D (is=1e-12 n={10 * smooth!r})"
    if letter == "b":
        match = re.fullmatch(r"(\S+) (\S+) (\S+) V=(\S+?)\*\(v\(([^,)]+)(?:,([^)]+))?\)\)", line)
        if not match:
            raise NotForGnucap("a source with an expression")
        return f"E{match[1]} {match[2]} {match[3]} {match[5]} {match[6] or '0'} {match[4]}"
    sine = re.search(r"SIN\((.*)\)", line)
    if sine:
        numbers = sine[1].split()
        if float(numbers[5]) != 0.0:
            raise NotForGnucap("a sine with a phase")
        return line.replace(sine[0], f"SIN({' '.join(numbers[:5])})")
    return line


def gnucap_deck(deck, case, smooth, reltol, divide):
    lines, vectors = [], []
    for line in deck.split("\n")[1:]:
        if line.startswith((".save", ".options", ".end", "V.sample", "R.sample")) or not line:
            if line.startswith(".save"):
                vectors.append(line.split()[1])
        elif line.startswith(".tran"):
            if len(case.grid.times) < 2:
                raise NotForGnucap("no grid")
            step = (case.grid.times[-1] / round(case.grid.times[-1] / min(b - a for a, b in zip(case.grid.times, case.grid.times[1:])))) / divide
            lines.append(f".tran {step!r} {case.stop!r} 0{' uic' if 'uic' in line else ''}")
        else:
            lines.append(gnucap_line(line, smooth))
    lines.insert(-1, ".print tran " + " ".join(vectors))
    text = "\n".join([f".options reltol={reltol!r} numdgt=12 method=trap", *lines, ".end", ""])
    return "* " + case.name + "\n" + re.sub(r"(?<=[A-Za-z0-9_])\.(?=[A-Za-z])", "_", text), [v.replace(".", "_") for v in vectors]


def run_gnucap(deck, vectors, case, setting):
    point = Point(case.name, "gnucap", setting)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "deck.ckt"
        path.write_text(deck)
        process = run_process(["gnucap", "-b", str(path)])
    if not process.in_time:
        point.message = f"stopped after {LIMIT:g} s"
        return point
    rows = [[number(w) for w in line.split()] for line in process.log.split("\n") if re.match(r"^ [-0-9.]", line)]
    rows = [row for row in rows if len(row) == len(vectors) + 1]
    wrong = [line for line in process.log.split("\n") if "?" in line or "did not converge" in line]
    if wrong or not rows or rows[-1][0] < case.stop * (1 - 1e-6):
        point.message = short(wrong[0]) if wrong else f"ended at t = {rows[-1][0]:.3g} s" if rows else "no rows"
        return point
    table = {"time": [row[0] for row in rows], **{name.replace("_i)", ".i)").replace("v_", "v."): [row[k + 1] for row in rows]
                                                   for k, name in enumerate(vectors)}}
    point.seconds = process.seconds
    later = cases.Reference(case.grid.times[1:], case.grid.rows[1:])  # its first row holds no initial conditions
    point.error = later.error(signals_at(table, case, later.times))
    return point


def number(text):
    """gnucap prints with suffixes: 960.u, -1.p, 1.2Meg"""
    match = re.fullmatch(r"([-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?)(Meg|[TGKkmunpfa])?", text)
    scale = {"T": 1e12, "G": 1e9, "Meg": 1e6, "K": 1e3, "k": 1e3, "m": 1e-3, "u": 1e-6, "n": 1e-9, "p": 1e-12, "f": 1e-15, "a": 1e-18}
    return float(match[1]) * scale.get(match[2], 1.0) if match else float("nan")


# ---- Siconos
def siconos_python():
    """A python3 that has Siconos and what complementarity.py needs, or None."""
    for python in (sys.executable, "/usr/bin/python3"):
        if subprocess.run([python, "-c", "import siconos.kernel, numpy, mpmath"], capture_output=True, check=False).returncode == 0:
            return python
    return None


class Siconos:
    """A process that steps one case. `refusal`: why it cannot, or empty."""

    def __init__(self, python, case):
        self.case, self.command = case, [python, "-B", str(HERE / "siconos_run.py"), str(case.deck), repr(LIMIT)]
        self.start()

    def start(self):
        self.process = subprocess.Popen(self.command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                                        env={**os.environ, "OPENBLAS_NUM_THREADS": "1"})
        self.refusal = self.ask(self.case.free.times).get("reason", "")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()

    def ask(self, request):
        timer = threading.Timer(12 * LIMIT, os.kill, (self.process.pid, signal.SIGKILL))
        timer.start()
        print(json.dumps(request), file=self.process.stdin, flush=True)
        line = self.process.stdout.readline()
        timer.cancel()
        if not line:
            self.process.wait()
        return json.loads(line or '{"reason": "Siconos ended the process"}')

    def run(self, theta, gamma, divide):
        """seconds: CPU time of building and stepping the simulations."""
        if self.process.poll() is not None:
            self.start()
        method = f"theta={theta:g}" + (f" gamma={gamma:g}" if gamma else "")
        point, answer = Point(self.case.name, "siconos", f"divide={divide} {method}"), self.ask([theta, gamma, divide])
        point.message = answer.get("reason", "")
        if not point.message:
            point.seconds, point.error = answer["seconds"], self.case.free.error(answer["rows"])
        return point
