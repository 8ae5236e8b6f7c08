"""Fixtures of the tests: scenes of the project, and its program to compare with."""

import os
import subprocess
from pathlib import Path

import pytest

import flexframe

# Each body is computed, whatever was computed before.
os.environ["FLEXFRAME_CACHE"] = ""

ROOT = Path(__file__).parents[3]
EXAMPLES = ROOT / "examples"

# A steel ring with few nodes, struck: quick to build and to run.
RING = {
    "title": "Ring, struck",
    "units": {"length": "mm", "mass": "Mg", "time": "s"},
    "body": {
        "mesh": "../meshes/ring.msh",
        "material": {"young_modulus": 210000.0, "poisson_ratio": 0.3, "density": 7.85e-9},
    },
    "modes": {"flexible": 4, "damping_ratio": 0.01, "static_correction": False},
    "initial": {"angular_velocity": [0.0, 5.0, 20.0]},
    "loads": [
        {
            "kind": "force",
            "at": [0.0, 100.0, 10.0],
            "direction": [0.0, -1.0, 0.5],
            "amplitude": 200.0,
            "history": {"kind": "half-sine", "duration": 0.002},
        }
    ],
    "time": {"end": 0.01, "step": 2e-5},
    "output": {"every": 5, "points": {"struck": [0.0, 100.0, 10.0], "other": [0.0, -100.0, 10.0]}},
}

# A free rigid body.
RIGID = {
    "title": "Rigid body",
    "units": {"length": "m", "mass": "kg", "time": "s"},
    "body": {
        "rigid": {
            "mass": 2.0,
            "center_of_mass": [0.0, 0.0, 0.0],
            "inertia": [[0.2, 0.0, 0.0], [0.0, 0.3, 0.0], [0.0, 0.0, 0.4]],
        }
    },
    "time": {"end": 1.0, "step": 1e-3},
    "output": {"interval": 0.1, "points": {"center": [0.0, 0.0, 0.0], "corner": [0.3, 0.1, -0.2]}},
}


@pytest.fixture(scope="session")
def ring():
    return flexframe.Body(flexframe.Scene(RING, base=EXAMPLES))


@pytest.fixture(scope="session")
def rigid():
    return flexframe.Body(flexframe.Scene(RIGID))


@pytest.fixture(scope="session")
def program():
    """Runs the program that `./dev python` names in FLEXFRAME."""
    path = os.environ["FLEXFRAME"]

    def run(*arguments, **options):
        return subprocess.run([path, *map(str, arguments)], capture_output=True, text=True, **options)

    return run
