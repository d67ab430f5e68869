#!/usr/bin/env python3
"""tests/layers/circles.py: fails if files of src include each other in a circle.

A header and the source file of the same name count as one unit.
"""
import pathlib
import re
import sys

SRC = pathlib.Path(__file__).resolve().parents[2] / "src"


def includes():
    units = {}
    for path in sorted(SRC.rglob("*.[ch]pp")):
        unit = str(path.relative_to(SRC).with_suffix(""))
        found = {name.rsplit(".", 1)[0] for name in re.findall(r'^#include "([^"]+)"', path.read_text(), re.MULTILINE)}
        units.setdefault(unit, set()).update(found - {unit})
    return {unit: {other for other in found if other in units} for unit, found in units.items()}


def reachable(units):
    """For each unit all that it includes, directly or not."""
    reach = {unit: set(found) for unit, found in units.items()}
    changed = True
    while changed:
        changed = False
        for unit, found in reach.items():
            more = set().union(*(reach[other] for other in found)) - found if found else set()
            if more:
                found.update(more)
                changed = True
    return reach


def main():
    reach = reachable(includes())
    circles = {tuple(sorted(other for other in found if unit in reach[other])) for unit, found in reach.items() if unit in found}
    for circle in sorted(circles):
        print("circle of includes:", ", ".join(circle))
    if not reach:
        print("no files in", SRC)
    sys.exit(bool(circles or not reach))


main()
