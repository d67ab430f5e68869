"""pwlsim: circuits of ideal diodes, switches and linear elements, solved without a time step.

>>> import pwlsim
>>> circuit = pwlsim.Circuit("half-wave rectifier")
>>> circuit = circuit.voltage_source("V1", "in", "0", pwlsim.sine(0, 10, 50)).diode("D1", "in", "out")
>>> circuit = circuit.capacitor("C1", "out", "0", 1e-3).resistor("R1", "out", "0", 50).measure("mean", "AVG v(out) FROM=20m")
>>> result = circuit.run(stop=0.1, step=1e-4)
>>> result["v(out)"].shape
(1001,)
>>> 8 < result.measurements["mean"] < 10
True
"""

from ._core import version as __version__
from .circuit import Circuit, Element
from .errors import Error, Interrupted, Message, PwlsimWarning, RunError
from .gradient import Gradient
from .result import Certificate, Fourier, Measurement, Result, Statistics
from .sweeps import MonteCarlo, Points, sweep
from .steady import LoopGain, Response, SteadyState
from .waveforms import pulse, sine, straight_lines

__all__ = [
    "Certificate",
    "Circuit",
    "Element",
    "Error",
    "Fourier",
    "Gradient",
    "Interrupted",
    "LoopGain",
    "Measurement",
    "Message",
    "MonteCarlo",
    "Points",
    "PwlsimWarning",
    "Response",
    "Result",
    "RunError",
    "Statistics",
    "SteadyState",
    "__version__",
    "pulse",
    "sine",
    "straight_lines",
    "sweep",
]
