"""The examples in the docstrings."""

import doctest
import importlib

import pytest

MODULES = ["pwlsim", "pwlsim.circuit", "pwlsim.errors", "pwlsim.result", "pwlsim.sweeps", "pwlsim.waveforms"]


@pytest.mark.parametrize("name", MODULES)
def test_examples(name):
    failures, tried = doctest.testmod(importlib.import_module(name))
    assert failures == 0 and tried > 0
