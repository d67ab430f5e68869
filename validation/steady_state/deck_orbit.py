"""The orbit of a deck by the solver of validation/references (pencils, Taylor series, all positions tried): 50 digits, differences for the monodromy matrix.

For circuits with many modes, where equations by hand would be long. The state is every capacitor's voltage and every coil's current; those that constraints
tie to one another are projected by the solver, and give multipliers 0.
"""
import pathlib
import re
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "references"))
from mpmath import mp, mpc, mpf  # noqa: E402

from deck import Deck  # noqa: E402
from trajectory import Trajectory  # noqa: E402

STEP = mpf(10) ** -20


class DeckOrbit:
    def __init__(self, path, period, output, guess):
        self.text = path.read_text()
        self.period_text, self.output = period, output
        self.solver = self.made({})
        self.names = list(guess)
        self.x = [mpf(v) for v in guess.values()]
        self.n = len(self.x)
        self.phi = None
        for _ in range(2):
            self.phi = self.monodromy()
            for _ in range(3):
                self.x = self.corrected(self.x)
        end, self.average = self.run(self.x)
        self.residual = max(abs(a - b) for a, b in zip(end, self.x))
        self.phi = self.monodromy()

    def made(self, changes):
        """A solver for the deck with factors on the values of elements; v(zz) is the mean of the output."""
        inside = re.match(r"v\((\w+)(?:,(\w+))?\)", self.output)
        text = re.sub(r"(?m)^\.(pss|save|end).*$", "", self.text)
        text += f"\nGzz 0 zz {inside.group(1)} {inside.group(2) or '0'} 1\nCzz zz 0 {self.period_text}\n.tran {self.period_text} {self.period_text} uic\n"
        with tempfile.NamedTemporaryFile("w", suffix=".net", delete=False) as file:
            file.write(text)
        mp.dps = 140
        deck = Deck(file.name)
        pathlib.Path(file.name).unlink()
        stores = [e for e in deck.elements if e.kind in "CL"]
        for element in deck.elements:
            if element.name in changes:
                element.value *= 1 + changes[element.name]
        deck.saves = [f"v({e.nodes[0]},{e.nodes[1]})" if e.kind == "C" else f"i({e.name})" for e in stores]
        solver = Trajectory(deck, digits=50)
        solver.stores = stores
        return solver

    def run(self, x, solver=None):
        solver = solver or self.solver
        solver.rows, solver.events = [], []
        values = dict(zip(self.names, x))
        for element in solver.stores:
            element.initial = values.get(f"{'v' if element.kind == 'C' else 'i'}({element.name})", mpf(0))
        solver.run([solver.deck.stop])
        found = dict(zip([f"{'v' if e.kind == 'C' else 'i'}({e.name})" for e in solver.stores], solver.rows[-1][1]))
        return [found[name] for name in self.names], found["v(Czz)"]

    def monodromy(self):
        end = self.run(self.x)[0]
        phi = mp.matrix(self.n, self.n)
        for k in range(self.n):
            moved = list(self.x)
            moved[k] += STEP
            for row, (a, b) in enumerate(zip(self.run(moved)[0], end)):
                phi[row, k] = (a - b) / STEP
        return phi

    def corrected(self, x, solver=None):
        end = self.run(x, solver)[0]
        d = mp.lu_solve(mp.eye(self.n) - self.phi, mp.matrix([a - b for a, b in zip(end, x)]))
        return [a + s for a, s in zip(x, d)]

    def multipliers(self):
        return sorted([mpc(v) for v in mp.eig(self.phi, left=False, right=False)], key=lambda v: (-abs(v), -v.imag))

    def derivative(self, parameter):
        means = []
        for sign in (1, -1):
            solver = self.made({parameter: sign * STEP})
            x = self.x
            for _ in range(2):
                x = self.corrected(x, solver)
            means.append(self.run(x, solver)[1])
        value = next(e.value for e in self.solver.deck.elements if e.name == parameter)
        return (means[0] - means[1]) / (2 * STEP * value)


# deck -> (period, mean of, first guess, parameters of .sens)
DECKS = {
    "flyback_clamp": ("10u", "v(out)", {"v(C2)": "15.0109", "v(Cc)": "114.718", "i(L1)": "0", "i(L2)": "0.66983"}, ["R2"]),
    "buck_type3": ("5u", "v(out)", {"v(C1)": "4.99918", "v(Cc)": "2.49999", "v(Cf)": "2.01802", "v(Cp)": "1.94958", "i(L1)": "4.24273"}, ["R1", "Rb"]),
    "cockcroft_walton": ("20m", "v(c)", {"v(C1)": "-100", "v(C2)": "174.032", "v(C3)": "-176.138", "v(C4)": "164.021"}, ["R1"]),
    "six_pulse": ("20m", "v(q,n)", {"v(Cd)": "519.1", "i(La)": "0", "i(Lb)": "-51.03", "i(Lc)": "51.03", "i(Ld)": "51.03"}, ["Rd"]),
    "llc": ("10u", "v(out)", {"v(Cr)": "80.758", "v(Co)": "26.163", "i(Lr)": "-1.8562", "i(L1)": "-1.8562", "i(L2)": "0", "i(L3)": "0"}, ["Ro"]),
}
