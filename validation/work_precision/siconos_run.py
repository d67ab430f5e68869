#!/usr/bin/env python3
"""Siconos' time-stepping of one deck (Debian: python3-siconos, python3-mpmath):

    siconos_run.py DECK LIMIT

Standard input: a line with the times of the signals, then a line [theta, gamma or null, divide] for each run, all JSON. Standard output: a line {} once the
deck is read or {"reason": why it cannot be run}, then a line for each run: the signals at the times and the CPU seconds of building and stepping the
simulations, or the reason why there are none. More than LIMIT seconds are not spent on a run.

Steps are equal and at most the deck's own over `divide` between two edges of sources or switches; at each edge the TimeStepping of the switches' new position and
the new step goes on from the last state.
"""
import json
import os
import sys
import time

import numpy as np
import siconos.kernel as kernel
import siconos.numerics as numerics

from complementarity import Circuit, NotForSiconos

BETWEEN_LOOKS = 256  # steps between two looks at the clock
ENDLESS = 1e9        # steps
WHOLE = 1e-9         # of a step: a stretch longer than whole steps by no more has no further one


class Stopped(Exception):
    pass


def integrator(theta, gamma):
    return kernel.EulerMoreauOSI(theta) if gamma is None else kernel.EulerMoreauOSI(theta, gamma)


class Simulation:
    """A TimeStepping with one system and step, of any length; in all stretches that have them it goes on from the state it is given."""

    def __init__(self, system, state, step, method):
        states, ports = system.B.shape
        self.dynamics = kernel.FirstOrderLinearTIDS(state, system.A, np.zeros(states))
        relation = kernel.FirstOrderLinearTIR(system.C, system.B)
        relation.setDPtr(system.D)
        relation.setePtr(np.zeros(ports))
        interaction = kernel.Interaction(kernel.ComplementarityConditionNSL(ports), relation)
        model = kernel.NonSmoothDynamicalSystem(0.0, ENDLESS * step)
        model.insertDynamicalSystem(self.dynamics)
        model.link(interaction, self.dynamics)
        discretisation = kernel.TimeDiscretisation(0.0, step)
        self.stepping = kernel.TimeStepping(model, discretisation, integrator(*method), kernel.LCP(numerics.SICONOS_LCP_LEMKE))
        self.b, self.e = self.dynamics.b(), relation.e()  # x' = A x + B l + b, y = C x + D l + e
        self.x, self.inputs = self.dynamics.x(), interaction.lambda_(0)

    def start(self, state):
        """Also forgets the last step's multipliers, which gamma would weigh in."""
        self.x[:] = state
        self.dynamics.resetAllNonSmoothParts()
        self.dynamics.swapInMemory()


class Piece:
    """One stretch with its steps' ends, and what Siconos gave there."""

    def __init__(self, circuit, stretch, longest):
        self.system = circuit.system(stretch.closed)
        self.count = max(1, int(np.ceil((stretch.end - stretch.start) / longest - WHOLE)))
        self.step = (stretch.end - stretch.start) / self.count
        self.times = np.linspace(stretch.start, stretch.end, self.count + 1)
        self.sources = circuit.zeta(self.times, stretch.middle)
        self.kind = stretch.closed, f"{self.step:.9e}"  # a Simulation serves for all of a kind

    def run(self, simulation, state, theta, deadline):
        b_of = (self.system.E @ (theta * self.sources[:, 1:] + (1 - theta) * self.sources[:, :-1])).T
        e_of = (self.system.F @ self.sources[:, 1:]).T
        stepping, b, e, x, inputs = simulation.stepping, simulation.b, simulation.e, simulation.x, simulation.inputs
        self.states, self.inputs = np.empty((self.count + 1, len(x))), np.empty((self.count + 1, len(inputs)))
        self.states[0] = state
        simulation.start(state)
        for k in range(self.count):
            b[:], e[:] = b_of[k], e_of[k]
            stepping.computeOneStep()
            self.states[k + 1], self.inputs[k + 1] = x, inputs
            stepping.nextStep()
            if k % BETWEEN_LOOKS == 0 and time.process_time() > deadline:
                raise Stopped
        self.inputs[0] = self.inputs[1]
        return self.states[-1].copy()

    def write_signals(self, at, rows):
        """By straight lines between the steps' ends."""
        inside = (at > self.times[0]) & (at <= self.times[-1])
        values = self.states @ self.system.P.T + self.inputs @ self.system.Q.T + self.sources.T @ self.system.R.T
        for column in range(values.shape[1]):
            rows[inside, column] = np.interp(at[inside], self.times, values[:, column])


def run(circuit, method, divide, limit, at):
    longest, state = float(circuit.deck.step) / divide, circuit.start()
    pieces = [Piece(circuit, stretch, longest) for stretch in circuit.stretches()]
    began, simulations = time.process_time(), {}
    for piece in pieces:
        if piece.kind not in simulations:
            simulations[piece.kind] = Simulation(piece.system, state, piece.step, method)
        state = piece.run(simulations[piece.kind], state, method[0], began + limit)
    seconds = time.process_time() - began
    at = np.minimum(at, pieces[-1].times[-1])  # the last digits of the end
    rows = np.full((len(at), len(circuit.deck.saves)), np.nan)
    for piece in pieces:
        piece.write_signals(at, rows)
    return {"seconds": seconds, "rows": rows.tolist()} if np.isfinite(rows).all() else {"reason": "no finite answer"}


def answer(circuit, request, limit, at):
    theta, gamma, divide = request
    try:
        return run(circuit, (theta, gamma), divide, limit, at)
    except Stopped:
        return {"reason": f"stopped after {limit:g} s"}
    except Exception as failure:  # Siconos throws no other
        return {"reason": f"Siconos: {failure}"}


def main():
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # Siconos writes there
    limit, at = float(sys.argv[2]), np.array(json.loads(sys.stdin.readline()))
    try:
        circuit = Circuit(sys.argv[1])
        circuit.stretches()
    except NotForSiconos as reason:
        print(json.dumps({"reason": str(reason)}), file=answers)
        return
    print(json.dumps({}), file=answers)
    for line in sys.stdin:
        print(json.dumps(answer(circuit, json.loads(line), limit, at)), file=answers)


if __name__ == "__main__":
    main()
