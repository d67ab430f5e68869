#!/usr/bin/env python3
"""validation/steady_state/check.py [PROGRAM [NAME ...]]: .pss, .ac and .sens of the decks here beside references/*.csv; a Markdown table on standard output.

Ends with status 1 if an error exceeds its limit. Errors are relative: of a state or mean to the signal's maximum over the period, of a period or response to
its own size, of a multiplier to 1 or its size if that is more, of a derivative to its size or, if that is more, the signal's maximum (a free period) over the
parameter.
"""
import csv
import json
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
PROGRAM = str(pathlib.Path(sys.argv[1]).resolve()) if len(sys.argv) > 1 else str(HERE.parents[1] / "build/pwlsim")
LIMITS = {"period": 1e-11, "state": 1e-9, "multiplier": 1e-8, "mean": 1e-9, "transfer": 1e-7, "derivative": 1e-7}
SUFFIXES = {"k": 1e3, "m": 1e-3, "u": 1e-6, "n": 1e-9}


def reference_of(name):
    lines = [line for line in (HERE / "references" / f"{name}.csv").read_text().splitlines() if not line.startswith("#")]
    return [(row["kind"], row["name"], complex(float(row["re"]), float(row["im"] or 0))) for row in csv.DictReader(lines)]


def anchored(deck):
    """A self-timed period begins where S1 closes, as in the references."""
    return re.sub(r"(?m)^\.pss(?!.*on=)", ".pss on=S1", deck) if not re.search(r"(?i)sin|pulse", deck) else deck


def run(deck, cards, folder):
    path = pathlib.Path(folder) / "deck.net"
    path.write_text(deck.replace("\n.end", "\n" + "\n".join(cards) + "\n.end"))
    done = subprocess.run([PROGRAM, path, "--json", "--no-rows", "--quiet"], capture_output=True, text=True, cwd=folder, timeout=300, check=False)
    return json.loads(done.stdout)


def results_of(name, reference, folder):
    text = anchored((HERE / f"{name}.net").read_text())
    names = {kind: [n for k, n, _ in reference if k == kind] for kind in LIMITS}
    signal = names["mean"][0]
    measured = [f".meas pss mean AVG {signal}", f".meas pss peak MAX abs({signal})", ".meas pss period PERIOD"]
    cards = measured + ([f".sens param={','.join(names['derivative'])}"] if names["derivative"] else [])
    for kind, state, _ in reference:
        if kind == "state":
            cards += [f".meas pss peak_{state[2:-1]} MAX abs({signal_of(state, text)})"]
    deck = re.sub(r"(?m)^\.save .*$", "", text)
    result = run(deck, cards, folder)
    result["responses"] = {}
    for source in dict.fromkeys(n.split()[0] for n in names["transfer"]):
        frequencies = [n.split()[1] for n in names["transfer"] if n.split()[0] == source]
        answer = run(deck, [f".ac list {' '.join(frequencies)} from={source}"], folder)
        signal = next(s for s in answer["ac"]["signals"] if s["name"] == names["mean"][0])
        result["responses"].update({f"{source} {f}": complex(x, y) for f, x, y in zip(frequencies, signal["re"], signal["im"])})
    return result, deck


def signal_of(state, deck):
    """i(L1) is one; v(C1) is the voltage between its nodes."""
    if state[0] == "i":
        return state
    nodes = re.search(rf"(?mi)^{state[2:-1]} (\S+) (\S+)", deck)
    return f"v({nodes.group(1)},{nodes.group(2)})".replace(",0)", ")")


def value_in(deck, parameter):
    match = re.search(rf"(?mi)^{parameter} \S+ \S+ (\S+)", deck)
    text = match.group(1) if match else "1"
    try:
        return float(text)
    except ValueError:
        return float(text[:-1]) * SUFFIXES.get(text[-1], 1) if re.match(r"^[\d.]+[kmun]$", text) else 1.0


def pairs_of(reference, result, deck):
    """(kind, reference, found, scale) of every number."""
    pss = result["pss"]
    states = {s["name"].lower(): s["value"] for s in pss["states"]}
    means = {m["name"]: m["value"] for m in result["measurements"]}
    free = pss["kind"] == "autonomous"
    found = [complex(m["re"], m["im"]) for m in pss["multipliers"] if not m["trivial"]]
    for kind, name, value in reference:
        if kind == "period":
            yield kind, value, pss["period"], abs(value)
        elif kind == "state":
            yield kind, value, states.get(name.lower()), means[f"peak_{name[2:-1]}"]
        elif kind == "multiplier":
            nearest = min(found, key=lambda m: abs(m - value), default=None)
            if nearest is not None:
                found.remove(nearest)
            yield kind, value, nearest, max(1.0, abs(value))
        elif kind == "mean":
            yield kind, value, means["mean"], means["peak"]
        elif kind == "transfer":
            yield kind, value, result["responses"][name], abs(value)
        else:
            measurement = "period" if free else "mean"
            entry = next(s for s in result["sensitivities"] if (s["measurement"], s["parameter"].lower()) == (measurement, name.lower()))
            yield kind, value, entry["derivative"], max(abs(value), abs(means["period" if free else "peak"]) / abs(value_in(deck, name)))
    for extra in found:
        yield "multiplier", 0j, extra, 1.0  # those that the reference leaves out are 0


def main():
    names = sys.argv[2:] or sorted(p.stem for p in (HERE / "references").glob("*.csv"))
    kinds, failures = list(LIMITS), []
    print("| deck | " + " | ".join(kinds) + " |\n|" + " --- |" * (len(kinds) + 1))
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            reference = reference_of(name)
            result, deck = results_of(name, reference, folder)
            worst = {}
            if not result["pss"]:
                failures.append(f"{name}: no orbit")
                continue
            for kind, value, found, scale in pairs_of(reference, result, deck):
                error = abs(found - value) / scale if found is not None else float("inf")
                worst[kind] = max(worst.get(kind, 0.0), error)
                if not error <= LIMITS[kind]:
                    failures.append(f"{name}: {kind} {value} found {found}, error {error:.2g} > {LIMITS[kind]:.0g}")
            print(f"| {name} | " + " | ".join(f"{worst[k]:.1e}" if k in worst else "" for k in kinds) + " |")
    print(f"\n{len(names)} circuits; " + (f"{len(failures)} numbers beyond their limit" if failures else "all numbers within their limits") + ".")
    for failure in failures:
        print(failure, file=sys.stderr)
    return 1 if failures else 0


sys.exit(main())
