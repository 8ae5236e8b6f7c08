"""flexframe: the motion of an elastic body that flies, tumbles and spins while it vibrates.

    scene = flexframe.Scene("plate.toml")
    body = flexframe.Body(scene)
    results = flexframe.Simulation(body).run()
    results["points/P1/displacement"]
"""

import os
import sys

from flexframe import _flexframe
from flexframe._flexframe import (
    Body,
    Force,
    JointEquation,
    JointForce,
    MarkerForce,
    ModalForce,
    Motion,
    Reached,
    RelativeMotion,
    Report,
    Row,
    Scene,
    Simulation,
    System,
    read_results,
    resume,
    run,
)
from flexframe.commands import campbell, frf, psd, shock, srs
from flexframe.errors import Error, FileError, InputError, RefusedError, RunError
from flexframe.linear import Channel, LinearModel, linearize
from flexframe.mesh import write_mesh
from flexframe.parameters import Fit, FittedParameter, Gradient, Rates, fit, gradient
from flexframe.results import BodyResults, Column, Results

__version__ = _flexframe.VERSION

__all__ = [
    "Body",
    "BodyResults",
    "Channel",
    "Column",
    "Error",
    "FileError",
    "Fit",
    "FittedParameter",
    "Force",
    "Gradient",
    "InputError",
    "JointEquation",
    "JointForce",
    "LinearModel",
    "MarkerForce",
    "ModalForce",
    "Motion",
    "Reached",
    "Rates",
    "RefusedError",
    "RelativeMotion",
    "Report",
    "Results",
    "Row",
    "RunError",
    "Scene",
    "Simulation",
    "System",
    "campbell",
    "fit",
    "frf",
    "gradient",
    "linearize",
    "psd",
    "read_results",
    "resume",
    "run",
    "shock",
    "srs",
    "write_mesh",
]

# Meshes of other formats are read by meshio in a Python of its own: by default in this one.
if sys.executable:
    os.environ.setdefault("FLEXFRAME_PYTHON", sys.executable)
