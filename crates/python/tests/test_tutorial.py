"""The tutorial runs, and draws what it says."""

import os
import runpy
from pathlib import Path

import pytest

TUTORIAL = Path(__file__).parents[1] / "tutorial.py"


# Closed form: the bounce of the tutorial.
def test_tutorial(tmp_path, monkeypatch):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    # Where its figures are to be looked at.
    folder = Path(os.environ.get("FLEXFRAME_FIGURES", tmp_path))
    folder.mkdir(parents=True, exist_ok=True)
    monkeypatch.setenv("FLEXFRAME_FIGURES", str(folder))
    names = runpy.run_path(str(TUTORIAL))
    assert names["energy_left"] < 0.2
    assert abs(names["bounce"] - names["closed_form"]) < 1e-9
    for figure in ("mode_shapes", "tip", "spectrum", "controller"):
        assert (folder / f"{figure}.png").stat().st_size > 10_000, figure
