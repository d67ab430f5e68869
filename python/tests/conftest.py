"""Doctests run with the modules; tests of optional packages are skipped where these are not installed."""

import os
import pathlib

import pytest

SOURCE = pathlib.Path(os.environ.get("PWLSIM_SOURCE", pathlib.Path(__file__).resolve().parents[2]))


@pytest.fixture
def source():
    """The folder of the project."""
    return SOURCE


@pytest.fixture
def buck(source):
    """A converter of 500 cycles (netlists/buck.net)."""
    import pwlsim

    return pwlsim.Circuit.from_file(source / "netlists" / "buck.net")
