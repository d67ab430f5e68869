"""Notebooks and examples run to their end; what they check for themselves holds."""

import importlib
import os
import subprocess
import sys

import numpy as np
import pytest

import pwlsim

NOTEBOOKS = ["first_run", "loop_gain", "optimisation"]


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_a_notebook_runs(name, source, tmp_path):
    nbformat = pytest.importorskip("nbformat")
    for package in ("nbconvert", "ipykernel", "matplotlib", "pandas", "scipy"):
        pytest.importorskip(package)
    path = source / "examples" / "notebooks" / f"{name}.ipynb"
    stored = nbformat.read(path, as_version=4)
    assert not any(cell.get("outputs") for cell in stored.cells), "outputs are stripped"
    command = [sys.executable, "-m", "nbconvert", "--execute", "--to", "notebook", "--output-dir", str(tmp_path), str(path)]
    environment = {**os.environ, "PWLSIM_SOURCE": str(source), "HOME": str(tmp_path), "MPLBACKEND": "module://matplotlib_inline.backend_inline"}
    finished = subprocess.run(command, capture_output=True, text=True, timeout=280, env=environment)
    assert finished.returncode == 0, finished.stderr[-3000:]
    cells = nbformat.read(tmp_path / f"{name}.ipynb", as_version=4).cells
    outputs = [output for cell in cells for output in cell.get("outputs", [])]
    assert any("image/png" in output.get("data", {}) for output in outputs)
    if name == "first_run":
        assert any("<iframe srcdoc=" in "".join(output.get("data", {}).get("text/html", "")) for output in outputs)


def test_a_sweep_by_dask_is_that_of_one_process(source, monkeypatch):
    distributed = pytest.importorskip("distributed")
    monkeypatch.syspath_prepend(str(source / "examples" / "python"))  # the workers take the path over
    module = importlib.import_module("dask_sweep")
    columns = pwlsim.MonteCarlo(12, {"L1": (47e-6, 2e-6)}, seed=1).columns()
    cluster = distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=False)
    with cluster, distributed.Client(cluster) as client:
        table = module.sweep(client, module.buck(), columns, size=3)
        processes = set(client.run(os.getpid).values())
    assert len(processes) == 2 and os.getpid() not in processes
    expected = pwlsim.sweep(module.buck(), pwlsim.Points(columns), stop=3e-3, step=3e-3, progress=False)
    np.testing.assert_array_equal(table["L1"], columns["L1"])
    np.testing.assert_array_equal(table["ripple"], np.asarray(expected["ripple"]))
    # In continuous conduction the ripple is Vin·D(1 − D)·T/L (Erickson and Maksimović, chapter 2); after 3 ms the output still swings by some percent.
    np.testing.assert_allclose(table["ripple"], 24 * 0.45 * 0.55 * 10e-6 / columns["L1"], rtol=4e-2)
