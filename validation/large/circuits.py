#!/usr/bin/env python3
"""Large circuits as decks, every part of them charged and working from the start.

    circuits.py cockcroft_walton STAGES      2 capacitors and 2 diodes a stage, loaded; 50 Hz, 0.4 s
    circuits.py multilevel SUBMODULES        one phase leg, SUBMODULES half bridges with body diodes in each of two arms
    circuits.py solar SIDE                   SIDE x SIDE cells in strings, a bypass diode each, a string diode each, a part in the shade
    circuits.py grid SIDE RECTIFIERS [US]    SIDE x SIDE nodes of R and C to ground, fed at RECTIFIERS points by half-wave rectifiers; for US microseconds (2000)
    circuits.py mesh SIDE                    SIDE x SIDE nodes joined by diodes, a capacitor at each
    circuits.py ladder SECTIONS              SECTIONS of R and C, a rectified sine at the begin
    circuits.py line SECTIONS                SECTIONS of L and C without loss, a step at the begin, a diode that clamps the end
    circuits.py six_pulse BRIDGES            BRIDGES of six diodes in series on their dc side, each on its own phases with filters of the orders 5, 7 and 11

The deck goes to standard output. `--dialect ngspice` gives diodes and switches that ngspice knows.
"""
import argparse
import math

IDEAL = {"diode": ".model DI D", "switch": ".model SW SW(Ron=1m Roff=1meg Vt=0.5 Vh=0)"}
NGSPICE = {"diode": ".model DI sidiode(Ron={ron} Roff=1e9 Vfwd=0)", "switch": ".model SW SW(Ron=1m Roff=1meg Vt=0.5 Vh=0)"}


def cockcroft_walton(stages, frequency=50.0, periods=20, amplitude=100.0):
    """Columns start at nine tenths of their no-load voltages, so that every stage is charged within the first period and goes on working."""
    yield f"Cockcroft-Walton multiplier, {stages} stages, {2 * stages} diodes"
    yield f"V1 s 0 SIN(0 {amplitude} {frequency})"
    capacitance = 1e-6 * max(stages, 3) ** 2 / 9.0 * 1000.0 / frequency
    for n in range(1, stages + 1):
        below = "s" if n == 1 else f"a{n - 1}"
        yield f"CA{n} a{n} {below} {capacitance:.6e} ic={0.9 * amplitude if n == 1 else 1.8 * amplitude}"
        low = "0" if n == 1 else f"b{n - 1}"
        yield f"CB{n} b{n} {low} {capacitance:.6e} ic={1.8 * amplitude}"
        yield f"DA{n} {low} a{n} DI"
        yield f"DB{n} a{n} b{n} DI"
    yield f"RL b{stages} 0 {stages * 1e5:.6e}"
    yield f".save v(b{stages}) v(b1) v(a{max(1, stages // 2)})"
    yield f".tran {periods / frequency / 1000:.6e} {periods / frequency:.6e} uic"


def multilevel(submodules, frequency=50.0, periods=1, link=800.0):
    """Nearest-level modulation: each submodule is in or out by its own gate pulse once a period, the arms against each other."""
    n = submodules
    cell = link / n
    yield f"Modular multilevel converter, one leg, {n} submodules an arm"
    yield f"VP p 0 {link / 2}"
    yield f"VN n 0 {-link / 2}"
    capacitance = 4e-3 * n / 10.0
    for arm, top, bottom, sign in (("U", "p", "ua", 1.0), ("L", "la", "n", -1.0)):
        for k in range(n):
            above = top if k == 0 else f"{arm}{k}"
            below = bottom if k == n - 1 else f"{arm}{k + 1}"
            level = (2 * k + 1) / n - 1.0
            # in while sign * sin(wt) < -level: the upper arm makes link / 2 * (1 - 0.9 sin), the lower one the rest
            angle = math.asin(max(-0.999, min(0.999, level / 0.9)))
            on = 0.25 * frequency ** -1 + angle / (2 * math.pi * frequency)  # half the time in, about the lowest point of sin
            centre = (0.75 if sign > 0 else 0.25) / frequency
            start = (centre - on) % (1.0 / frequency)
            width = 2.0 * on
            edge = 1e-6
            for gate, first, second in ((f"{arm}g{k}", 1, 0), (f"{arm}h{k}", 0, 1)):
                wraps = start + width > 1.0 / frequency
                a, b, delay, length = (first, second, start, width) if not wraps else (
                    second, first, (start + width) % (1.0 / frequency), 1.0 / frequency - width)
                yield f"V{gate} {gate} 0 PULSE({b} {a} {delay:.9e} {edge} {edge} {max(length - edge, edge):.9e} {1 / frequency:.9e})"
            yield f"C{arm}{k} {arm}c{k} {below} {capacitance:.6e} ic={cell}"
            yield f"S{arm}t{k} {arm}c{k} {above} {arm}g{k} 0 SW"
            yield f"S{arm}b{k} {above} {below} {arm}h{k} 0 SW"
            yield f"D{arm}t{k} {above} {arm}c{k} DI"
            yield f"D{arm}b{k} {below} {above} DI"
    yield "LU ua o 3m"
    yield "LL o la 3m"
    yield "RO o x 10"
    yield "LO x 0 5m"
    yield f".save v(o) i(LO) i(LU) v(Uc0,{'ua' if n == 1 else 'U1'})"
    yield f".tran {periods / frequency / 500:.6e} {periods / frequency:.6e} uic"


def solar(side):
    yield f"Solar array, {side} strings of {side} modules with bypass diodes, a corner shaded by a passing cloud"
    for s in range(side):
        for m in range(side):
            above = f"s{s}m{m + 1}"
            below = "0" if m == 0 else f"s{s}m{m}"
            current = 8.0 if (s < side // 2 or m < side // 2) else None
            if current is None:
                start = 1e-3 * (1 + (s + m) / side)
                yield f"I{s}_{m} {below} {above} PWL(0 8 {start:.6e} 8 {start + 2e-3:.6e} 1)"
            else:
                yield f"I{s}_{m} {below} {above} {current}"
            yield f"RP{s}_{m} {above} {below} 50"
            yield f"CP{s}_{m} {above} {below} 1u ic=30"
            yield f"D{s}_{m} {below} {above} DI"
        yield f"DS{s} s{s}m{side} bus DI"
    yield f"CB bus 0 {side * 1e-4:.6e} ic={30 * side}"
    yield f"RB bus 0 {30.0 / 8.0:.6e}"
    yield f".save v(bus) v(s{side - 1}m1) v(s0m1)"
    yield ".tran 50u 5m uic"


def grid(side, rectifiers, microseconds=2000):
    yield f"RC grid of {side} x {side} nodes fed by {rectifiers} rectifiers"
    for i in range(side):
        for j in range(side):
            if j + 1 < side:
                yield f"RH{i}_{j} n{i}_{j} n{i}_{j + 1} 1"
            if i + 1 < side:
                yield f"RV{i}_{j} n{i}_{j} n{i + 1}_{j} 1"
            yield f"C{i}_{j} n{i}_{j} 0 1u ic=8"
            if (i + j) % 7 == 0:
                yield f"RG{i}_{j} n{i}_{j} 0 1k"
    for r in range(rectifiers):
        place = (r * side * side) // rectifiers + side // 2
        i, j = place // side % side, place % side
        yield f"V{r} v{r} 0 SIN(0 10 {1000 + 10 * (r % 7)} 0 0 {360.0 * r / rectifiers:.3f})"
        yield f"RS{r} v{r} w{r} 0.5"
        yield f"D{r} w{r} n{i}_{j} DI"
    yield f".save v(n0_0) v(n{side // 2}_{side // 2}) v(n{side - 1}_{side - 1})"
    yield f".tran 10u {microseconds}u uic"


def mesh(side):
    yield f"Diode mesh, {side} x {side} nodes"
    yield "V1 s 0 SIN(0 10 1k)"
    yield "RS s n0_0 1"
    for i in range(side):
        for j in range(side):
            if j + 1 < side:
                yield f"DH{i}_{j} n{i}_{j} n{i}_{j + 1} DI"
            if i + 1 < side:
                yield f"DV{i}_{j} n{i}_{j} n{i + 1}_{j} DI"
            yield f"C{i}_{j} n{i}_{j} 0 {1e-6 * (1 + (7 * i + 3 * j) % 5):.6e} ic={5.0 - 4.0 * (i + j) / (2 * side):.6f}"
            yield f"R{i}_{j} n{i}_{j} 0 {1e3 * side:.6e}"
    yield f".save v(n0_0) v(n{side - 1}_{side - 1})"
    yield ".tran 10u 2m uic"


def ladder(sections):
    """1 us a section; the diffusion along all of it takes the square of that many."""
    yield f"Ladder of {sections} sections of R and C behind a rectifier"
    yield "V1 s 0 SIN(0 10 50k)"
    yield "D1 s n0 DI"
    yield "R0 n0 0 10k"
    for k in range(1, sections + 1):
        yield f"R{k} n{k - 1} n{k} 100"
        yield f"C{k} n{k} 0 10n ic=0"
    yield f".save v(n0) v(n1) v(n{max(1, sections // 10)})"
    yield ".tran 1u 200u uic"


def line(sections):
    """A front along it rings in all of its modes; sqrt(LC) = 31.6 ns a section."""
    yield f"Line of {sections} sections of L and C, clamped by a diode at its end"
    yield "V1 x0 0 1"
    for k in range(1, sections + 1):
        yield f"L{k} x{k - 1} x{k} 1u ic=0"
        yield f"C{k} x{k} 0 1n ic=0"
    yield f"D1 x{sections} c DI"
    yield "VC c 0 0.8"
    yield f".save v(x1) v(x{max(1, sections // 2)}) v(x{sections}) i(L1)"
    stop = 1.5 * sections * math.sqrt(1e-6 * 1e-9)
    yield f".tran {stop / 200:.6e} {stop:.6e} uic"


def six_pulse(bridges, frequency=50.0):
    yield f"{bridges} six-pulse bridges in series, filters of the orders 5, 7 and 11 at each"
    for b in range(bridges):
        low, high = "0" if b == 0 else f"d{b - 1}", f"d{b}"
        for p in range(3):
            phase = -120.0 * p + 60.0 * b / bridges
            yield f"V{b}_{p} s{b}_{p} m{b} SIN(0 325 {frequency} 0 0 {phase:.6f})"
            yield f"R{b}_{p} s{b}_{p} t{b}_{p} 0.05"
            yield f"L{b}_{p} t{b}_{p} a{b}_{p} 1m ic=0"
            for order in (5, 7, 11):
                farads = 1e-4 / order
                own = f"{b}_{p}_{order}"
                yield f"CF{own} a{b}_{p} f{own} {farads:.6e} ic=0"
                yield f"RF{own} f{own} g{own} 0.1"
                yield f"LF{own} g{own} w{b}_{order} {1.0 / (farads * (2 * math.pi * frequency * order) ** 2):.6e} ic=0"
            yield f"DP{b}_{p} a{b}_{p} {high} DI"
            yield f"DN{b}_{p} {low} a{b}_{p} DI"
        yield f"RM{b} m{b} {low} 1meg"
    yield f"LD d{bridges - 1} o 2m ic=0"
    yield f"CD o 0 {1e-3 / bridges:.6e} ic={450 * bridges}"
    yield f"RD o 0 {20 * bridges}"
    yield ".save v(o) i(LD) i(L0_0)"
    yield f".tran {0.04 / 500:.6e} 0.04 uic"


def deck(name, sizes, dialect="ideal", ron=1e-3):
    """The deck as text."""
    kinds = {"cockcroft_walton": cockcroft_walton, "multilevel": multilevel, "solar": solar, "grid": grid, "mesh": mesh, "ladder": ladder,
             "line": line, "six_pulse": six_pulse}
    lines = list(kinds[name](*sizes))
    models = IDEAL if dialect == "ideal" else NGSPICE
    if dialect == "ngspice":  # its idealised diode is a code model
        lines = [f"A{line}" if line.startswith("D") else line for line in lines]
    lines.append(models["diode"].replace("{ron}", f"{ron:g}"))
    if name == "multilevel":
        lines.append(models["switch"])
    return "\n".join(lines + [".end", ""])


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("name", choices=["cockcroft_walton", "multilevel", "solar", "grid", "mesh", "ladder", "line", "six_pulse"])
    parser.add_argument("sizes", type=int, nargs="+")
    parser.add_argument("--dialect", choices=["ideal", "ngspice"], default="ideal")
    options = parser.parse_args()
    print(deck(options.name, options.sizes, options.dialect), end="")
