#!/usr/bin/env python3
"""Makes circuit.net and reference.csv of this folder from the closed form in why.md.

    python3 validation/cases/ladder/reference.py        (Debian: python3-mpmath)
"""
import sys
from pathlib import Path

sys.dont_write_bytecode = True
from mpmath import cos, exp, mp, mpf, pi, sin  # noqa: E402

mp.dps = 50
HERE = Path(__file__).resolve().parent
N, TAU, CHARGE, STEP, STOP = 150, mpf("1e-6"), mpf("5e-3"), mpf("0.2e-3"), mpf("20e-3")
WATCHED = [1, N // 2, N]


def charged(time):
    """All nodes while the diode conducts: the source holds the end before node 1."""
    values = [mpf(1)] * N
    for m in range(1, N + 1):
        theta = (2 * m - 1) * pi / (2 * N + 1)
        share = 4 * sum(sin(j * theta) for j in range(1, N + 1)) / (2 * N + 1) * exp(-4 * sin(theta / 2) ** 2 * time / TAU)
        if share == 0 or abs(share) < mpf(10) ** -45:
            continue
        for j in range(N):
            values[j] -= share * sin((j + 1) * theta)
    return values


def isolated(start):
    """f(time since the source fell): all nodes, no current at either end."""
    shares = [sum(start) / N]
    for m in range(1, N):
        shares.append(2 * sum(v * cos((j + mpf(1) / 2) * m * pi / N) for j, v in enumerate(start)) / N)
    def values(time):
        decays = [exp(-4 * sin(m * pi / (2 * N)) ** 2 * time / TAU) for m in range(N)]
        return [sum(s * d * cos((j - mpf(1) / 2) * m * pi / N) for m, (s, d) in enumerate(zip(shares, decays))) for j in WATCHED]
    return values


def text(value):
    return mp.nstr(value, 20, min_fixed=-4, max_fixed=6).replace(".0e", "e").removesuffix(".0")


def write_deck():
    lines = ["RC ladder of 150 sections, charged through a diode for 5 ms and then left alone",
             "V1 in 0 PULSE(1 0 5m 0 0 1 2)", "D1 in n0 DI", ".model DI D"]
    for j in range(1, N + 1):
        lines += [f"R{j} n{j - 1} n{j} 1k", f"C{j} n{j} 0 1n ic=0"]
    lines += [".save " + " ".join(f"v(n{j})" for j in WATCHED), ".tran 0.2m 20m uic", ".end", ""]
    (HERE / "circuit.net").write_text("\n".join(lines), encoding="ascii")


def main():
    write_deck()
    rest = isolated(charged(CHARGE))
    rows = []
    for k in range(int(STOP / STEP) + 1):
        time = k * STEP
        values = [mpf(0)] * 3 if k == 0 else rest(time - CHARGE) if time > CHARGE else [charged(time)[j - 1] for j in WATCHED]
        rows.append(",".join(text(v) for v in [time, *values]))
    head = ["# The closed form of why.md, 20 digits.", "# Made by: python3 validation/cases/ladder/reference.py",
            "time," + ",".join(f"v(n{j})" for j in WATCHED)]
    (HERE / "reference.csv").write_text("\n".join(head + rows) + "\n", encoding="ascii")
    (HERE / "events.csv").write_text(f"# The source falls and the diode blocks.\ntime,what\n{text(CHARGE)},edge\n", encoding="ascii")


if __name__ == "__main__":
    main()
