"""Linear models of small motions: x' = A x + B u, y = C x + D u."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from flexframe import _flexframe

if TYPE_CHECKING:
    from flexframe._flexframe import Scene


class Channel(NamedTuple):
    """A state, an input or an output: its name and the label of its unit."""

    name: str
    unit: str


@dataclass(frozen=True, eq=False)
class LinearModel:
    """A state space about a state of a scene, with names and units.

    `error_bound` is that of a balanced truncation: no response is wrong by more, in the largest singular value. `time` and
    `omega_global` say which state it is about, `warnings` what is doubtful about that.
    """

    A: NDArray[np.float64]
    B: NDArray[np.float64]
    C: NDArray[np.float64]
    D: NDArray[np.float64]
    states: list[Channel]
    inputs: list[Channel]
    outputs: list[Channel]
    error_bound: float | None
    time: float
    omega_global: tuple[float, float, float]
    warnings: list[str]

    @property
    def poles(self) -> NDArray[np.complex128]:
        """Eigenvalues of A, slowest first."""
        poles = np.linalg.eigvals(self.A).astype(complex)
        return poles[np.lexsort((poles.imag, abs(poles)))]

    def to_control(self) -> Any:
        """A `control.StateSpace` with the same names, where python-control is installed."""
        control = importlib.import_module("control")
        # Names of python-control have no dots.
        kinds = {"states": self.states, "inputs": self.inputs, "outputs": self.outputs}
        names = {kind: [channel.name.replace(".", "_") for channel in channels] for kind, channels in kinds.items()}
        return control.ss(self.A, self.B, self.C, self.D, **names)


def linearize(
    scene: Scene,
    *,
    spin: Sequence[float] | None = None,
    time: float | None = None,
    without_rigid: bool = False,
    inputs: Sequence[str] = (),
    outputs: Sequence[str] = (),
    reduce: str | None = None,
) -> LinearModel:
    """The linear model of small motions of a scene, as `flexframe linearize` writes it.

    It is about rest, the steady spin that a free body begins with or a drive has, `spin` (global, about the center of mass or the
    axis of a driven joint), or the state of the run at `time`. `inputs` and `outputs` are names or beginnings of them, such as
    "loads[0]", "base.acceleration.z", "tip.acceleration"; without any they are loads and forces at joints, points and joints.
    `reduce` lowers the order: "balanced:12" or "modal:12".
    """
    found = _flexframe.linearized(
        scene,
        spin=None if spin is None else [float(x) for x in spin],
        time=time,
        without_rigid=without_rigid,
        inputs=list(inputs),
        outputs=list(outputs),
        reduce=reduce,
    )
    channels = {key: [Channel(*pair) for pair in found.pop(key)] for key in ("states", "inputs", "outputs")}
    return LinearModel(**{**found, **channels})
