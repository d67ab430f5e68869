"""Derivatives of measurements."""

from __future__ import annotations

from typing import Any, Dict, Optional, Tuple

import numpy as np

__all__ = ["Gradient"]


class Gradient:
    """A measurement with its derivatives to parameters, in the order of the call.

    ``np.asarray(gradient)`` is `derivatives`; ``gradient["L1"]`` is the one to L1.
    """

    measurement: str
    """Its name."""
    value: float
    """Of the measurement; NaN if it failed."""
    parameters: Tuple[str, ...]
    derivatives: np.ndarray
    """Shape (parameters,): dm/dp in units of the measurement per unit of the parameter; towards larger values at a kink; NaN if there is none."""
    normalised: np.ndarray
    """Shape (parameters,): p/m·dm/dp; NaN if the measurement is 0."""
    left: np.ndarray
    """Shape (parameters,): towards smaller values of the parameter."""
    kinks: Dict[str, str]
    """Parameters for which left and right differ, with the reason."""
    failures: Dict[str, str]
    """Parameters without a derivative, with the reason."""

    def __init__(self, measurement: str, value: float, derivatives: Any) -> None:
        self.measurement, self.value = measurement, value
        self.parameters = tuple(each[0] for each in derivatives)
        self.derivatives, self.normalised, self.left = (np.array([each[k] for each in derivatives], dtype=float) for k in (1, 2, 3))
        self.kinks = {each[0]: each[5] for each in derivatives if each[5]}
        self.failures = {each[0]: each[6] for each in derivatives if each[6]}

    def __getitem__(self, parameter: str) -> float:
        for name, value in zip(self.parameters, self.derivatives):
            if name.lower() == parameter.lower():
                return float(value)
        raise KeyError(f"no derivative to {parameter!r}; there are derivatives to {', '.join(self.parameters)}")

    def __array__(self, dtype: Optional[Any] = None) -> np.ndarray:
        return self.derivatives if dtype is None else self.derivatives.astype(dtype)

    def __len__(self) -> int:
        return len(self.derivatives)

    def __repr__(self) -> str:
        return f"<pwlsim.Gradient of {self.measurement} = {self.value:g}: {', '.join(f'{p}: {d:g}' for p, d in zip(self.parameters, self.derivatives))}>"
