"""A sweep on many machines: circuits travel to the workers of dask.distributed as they are.

    python3 dask_sweep.py [address of a scheduler]

Without an address it works on processes of this machine. Each task is a block of runs, so that a task takes much longer than its message; the table is that of `pwlsim.sweep`, whatever the
number of workers.
"""

import sys

import numpy as np

import pwlsim

RUNS, BLOCK = 200, 20


def buck():
    circuit = pwlsim.Circuit("buck").voltage_source("V1", "in", "0", 24).voltage_source("VG", "gate", "0", pwlsim.pulse(0, 1, width=4.5e-6, period=10e-6))
    circuit.voltage_switch("S1", "in", "sw", "gate", "0", "ideal").model("ideal", "SW", Vt=0.5).diode("D1", "0", "sw")
    circuit.inductor("L1", "sw", "out", 47e-6).capacitor("C1", "out", "0", 100e-6).resistor("R1", "out", "0", 2.5)
    return circuit.measure("ripple", "PP i(L1) FROM=2.9m")


def block(circuit, columns):
    """The runs of one task, one after the other: a plain dict of arrays travels back."""
    points = pwlsim.Points(columns)
    table = pwlsim.sweep(circuit, points, jobs=1, progress=False, stop=3e-3, step=3e-3)
    return {name: np.asarray(table[name]) for name in ("L1", "ripple")}


def sweep(client, circuit, columns, size=BLOCK):
    count = len(next(iter(columns.values())))
    parts = [{name: column[k : k + size] for name, column in columns.items()} for k in range(0, count, size)]
    done = client.gather(client.map(block, [circuit] * len(parts), parts, pure=False))
    return {name: np.concatenate([part[name] for part in done]) for name in done[0]}


if __name__ == "__main__":
    from dask.distributed import Client

    columns = pwlsim.MonteCarlo(RUNS, {"L1": (47e-6, 2e-6)}, seed=1).columns()
    with Client(*sys.argv[1:] or [None], **({} if sys.argv[1:] else {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None})) as client:
        table = sweep(client, buck(), columns)
    print(f"{RUNS} runs: ripple {table['ripple'].mean():.4f} A, standard deviation {table['ripple'].std():.4f} A")
