"""Writes an example deck for stock ngspice and runs it: expanded numbers, a smoothed diode, finite switches.

What ngspice cannot have ideal is a setting here: how sharp the diode is, the switch's on-resistance, tolerances, steps.
"""
import os
import signal
import struct
import subprocess
import tempfile
import threading
import time
from dataclasses import asdict, dataclass
from pathlib import Path


@dataclass(frozen=True)
class Setting:
    reltol: float = 1e-3
    steps: float = 1000          # largest step = run length / steps
    diode: str = "exponential"   # or sidiode
    sharpness: float = 1.0       # emission coefficient N, or Ron of the sidiode
    shunt: float = 0.0           # resistor across every diode, 0: none
    switch_on: float = 1e-4
    control_gain: float = 1.0    # amplifies switch controls that are no plain gate: ngspice stops within 0.05 V of a threshold
    method: str = "trap"

    def as_dict(self):
        return asdict(self)


EDGE = 1e-9   # stands for a true jump of a PULSE
GATE = 1e-10  # edge of a gate signal: ngspice steps on its corners, so it switches at the right instant
SWITCH_OFF = 1e8


def source_text(source, gate=None):
    """`gate`: the threshold of the switch that the source drives and nothing else."""
    if source.kind == "dc":
        return f"DC {float(source.value)!r}"
    if source.kind == "sin":
        phase = float(source.phase) * 57.29577951308232
        return f"SIN({float(source.value)!r} {float(source.amplitude)!r} {float(source.frequency)!r} 0 0 {phase!r})"
    v1, v2, delay = float(source.before), float(source.corners[1][1]), float(source.delay)
    rise = float(source.corners[1][0])
    width = float(source.corners[2][0]) - rise
    fall = float(source.corners[3][0]) - rise - width
    if gate is not None:  # steep edges around the instants at which the threshold is passed
        up = (gate - v1) / (v2 - v1)
        delay, width = max(delay + up * rise - GATE / 2, 0.0), width + (1 - up) * (rise + fall) - GATE
        rise = fall = GATE
    elif rise == 0:
        rise = fall = EDGE
        width -= EDGE
    if width == 0:  # ngspice reads 0 as "to the end"
        width, fall = EDGE, fall - EDGE
    return f"PULSE({v1!r} {v2!r} {delay!r} {rise!r} {fall!r} {width!r} {float(source.period)!r})"


def gate_thresholds(deck):
    """{source name: threshold} of the PULSE sources whose node is the control of switches against ground and nothing else."""
    used = [node for e in deck.elements for node in e.nodes + (e.control if e.kind in "EG" else [])]
    out = {}
    for source in deck.elements:
        if source.kind == "V" and source.value.kind == "pulse" and used.count(source.nodes[0]) == 1:
            switches = [e for e in deck.elements if e.kind == "S" and source.nodes[0] in e.control]
            if switches and all(e.control == [source.nodes[0], "0"] for e in switches):
                out[source.name] = float(switches[0].model.get("vt", 0))
    return out


def switch_lines(element, setting, gated):
    gain = 1.0 if gated else setting.control_gain
    control, lines = " ".join(element.control), []
    if gain != 1.0:
        lines, control = [f"EC{element.name} ec{element.name} 0 {control} {gain!r}"], f"ec{element.name} 0"
    threshold, band = (gain * float(element.model.get(key, 0)) for key in ("vt", "vh"))
    return lines + [f"{element.name} {' '.join(element.nodes)} {control} MS_{element.name}",
                    f".model MS_{element.name} SW(VT={threshold!r} VH={band!r} RON={setting.switch_on!r} ROFF={SWITCH_OFF!r})"]


def element_lines(element, setting, gates, gate_nodes):
    p, n, name = *element.nodes, element.name
    if element.kind in "RCL":
        initial = f" IC={float(element.initial)!r}" if element.kind in "CL" else ""
        return [f"{name} {p} {n} {float(element.value)!r}{initial}"]
    if element.kind in "VI":
        return [f"{name} {p} {n} {source_text(element.value, gates.get(name))}"]
    if element.kind == "S":
        return switch_lines(element, setting, element.control[0] in gate_nodes)
    lines = [f"A{name} {p} {n} MD" if setting.diode == "sidiode" else f"{name} {p} {n} MD"]
    return lines + ([f"RS{name} {p} {n} {setting.shunt!r}"] if setting.shunt else [])


def saved_vectors(saved):
    """The raw file's vectors that a saved signal needs: [(name, sign)]."""
    inside = [w.strip().lower() for w in saved[2:-1].split(",")]
    if saved[0] in "iI":
        return [(f"i({inside[0]})", 1.0)]
    return [(f"v({node})", sign) for node, sign in zip(inside, (1.0, -1.0)) if node != "0"]


def deck_text(deck, setting, sample_times):
    stop = float(deck.stop)
    largest = stop / setting.steps
    lines = ["* " + deck.title]
    gates = gate_thresholds(deck)
    gate_nodes = {e.nodes[0] for e in deck.elements if e.name in gates}
    for element in deck.elements:
        lines += element_lines(element, setting, gates, gate_nodes)
    lines += [f"K{i} {a} {b} {float(k)!r}" for i, (a, b, k) in enumerate(deck.couplings)]
    if setting.diode == "sidiode":
        lines.append(f".model MD sidiode(Ron={setting.sharpness!r} Roff={SWITCH_OFF!r} Vfwd=0)")
    else:
        lines.append(f".model MD D(IS=1e-12 N={setting.sharpness!r})")
    corners = " ".join(f"{t!r} {i % 2}" for i, t in enumerate(sample_times))
    lines += [f"VSAMPLE sample_ 0 PWL(0 1 {corners})", "RSAMPLE sample_ 0 1"]  # makes ngspice step on the sample times
    lines.append(".save " + " ".join(name for saved in deck.saves for name, _ in saved_vectors(saved)))
    lines.append(f".options reltol={setting.reltol!r} abstol=1e-9 vntol=1e-6 method={setting.method}")
    lines += [f".tran {largest!r} {stop!r} 0 {largest!r} uic", ".end", ""]
    return "\n".join(lines)


EMPTY = "* empty\nV1 1 0 1\nR1 1 0 1\n.tran 1 1\n.end\n"


@dataclass
class Run:
    wall: float
    cpu: float
    vectors: dict


def run(text, timeout=60.0):
    """Runs a deck in batch mode. None where ngspice fails, stops early, or needs longer than `timeout` seconds."""
    with tempfile.TemporaryDirectory() as folder:
        deck, raw = Path(folder) / "deck.cir", Path(folder) / "deck.raw"
        deck.write_text(text)
        measured = timed(["ngspice", "-b", "-r", str(raw), str(deck)], timeout)
        if measured is None or not raw.exists():
            return None
        return Run(*measured, read_raw(raw.read_bytes()))


def kill(handle):
    try:
        signal.pidfd_send_signal(handle, signal.SIGKILL)
    except ProcessLookupError:
        pass  # ended by itself just now


def timed(command, timeout=60.0):
    """(wall, user + system) seconds of a process that ends with status 0 within `timeout`, else None."""
    started = time.perf_counter()
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    handle = os.pidfd_open(process.pid)  # names this process even after its end, as a number would not
    timer = threading.Timer(timeout, kill, (handle,))
    timer.start()
    _, status, usage = os.wait4(process.pid, 0)  # subprocess' own wait gives no usage
    wall = time.perf_counter() - started
    timer.cancel()
    timer.join()
    os.close(handle)
    process.returncode = os.waitstatus_to_exitcode(status)
    return (wall, usage.ru_utime + usage.ru_stime) if status == 0 else None


def read_raw(data):
    head, _, body = data.partition(b"Binary:\n")
    lines = head.decode("latin-1").split("\n")
    first = lines.index("Variables:") + 1
    names = [line.split()[1].lower() for line in lines[first:] if line.startswith("\t")]
    count = len(body) // (8 * len(names))
    values = struct.unpack(f"<{count * len(names)}d", body[:8 * count * len(names)])
    return {name: values[i::len(names)] for i, name in enumerate(names)}


def samples(deck, vectors, times):
    """The saved signals at the sample times, or None where the run ended before."""
    moments = vectors.get("time", ())
    out, at = [], 0
    for t in times:
        while at < len(moments) and moments[at] < t - 1e-9 * float(deck.stop):
            at += 1
        if at == len(moments):
            return None
        out.append([sum(sign * vectors[name][at] for name, sign in saved_vectors(saved)) for saved in deck.saves])
    return out
