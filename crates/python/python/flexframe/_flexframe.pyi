"""The compiled part of flexframe. Lengths, masses and times are in the units of the scene, angles in rad."""

import os
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexframe.results import Results

__all__ = [
    "VERSION",
    "Body",
    "Force",
    "JointEquation",
    "JointForce",
    "MarkerForce",
    "ModalForce",
    "Motion",
    "Reached",
    "RelativeMotion",
    "Report",
    "Row",
    "Scene",
    "Simulation",
    "System",
    "_scene",
    "campbell_report",
    "fitted",
    "frf_report",
    "gradients",
    "linearized",
    "psd_report",
    "read_results",
    "resume",
    "run",
    "shock_report",
    "srs_report",
]

VERSION: str

_Path = str | os.PathLike[str]

@final
class Scene:
    """A scene: what a scene file says about a run, read and checked.

    From the path of a scene file; or from a dict with the sections and keys of one, such as
    `{"title": "Bar", "units": {...}, "body": {"mesh": "bar.msh", ...}, ...}`. Its lists may be arrays of numpy. Paths in a
    dict are relative to `base` (default: the current folder); `name` stands for it in messages and names its results file
    (default: "scene"). In a scene of several bodies, `body` names one, to take it alone; `run` takes all of them. With
    `trust_geometry`, gmsh may do all that a `.geo` file says which the scene names; otherwise one that runs other programs or
    writes files is refused.

    A scene can be pickled and copied. The files that it names are read where it is unpickled.
    """

    def __new__(
        cls,
        source: _Path | dict[str, Any],
        *,
        base: _Path | None = None,
        name: str | None = None,
        body: str | None = None,
        trust_geometry: bool = False,
    ) -> Scene: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    def with_values(self, values: dict[str, Any]) -> Scene:
        """The scene with other values of some keys: `{"time.end": 0.5, "loads[0].amplitude": 20.0}`, as with `--set`."""
    @property
    def title(self) -> str:
        """The title of the run."""
    @property
    def text(self) -> str:
        """The text of the scene, TOML; with all bodies, where it has several."""
    @property
    def bodies(self) -> list[str]:
        """Names of its bodies; "body" is that of a single one."""
    @property
    def path(self) -> os.PathLike[str]:
        """The scene file, or `base` and `name` of a dict."""
    @property
    def end(self) -> float:
        """Time at the end of the run."""
    @property
    def units(self) -> dict[str, str]:
        """Labels of "length", "mass" and "time"."""

@final
class Body:
    """The body of a scene of one: its mesh is read, its modes are found, and it is reduced.

    Results of a mesh are kept in the user's cache, as by the program: the same body is there at once the next time, also in
    another process. So a body that is pickled is its scene, and is made again from the cache where it is unpickled.

    Ctrl-C raises KeyboardInterrupt at once; a factorization that is under way goes on in its thread until it is done. A
    view is memory of the body: read-only, not copied, and valid as long as the array is (it keeps the body).
    nf is the number of flexible modes plus that of the static shapes, which come after them.
    """

    def __new__(cls, scene: Scene) -> Body: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    @property
    def scene(self) -> Scene:
        """The scene that it was made for."""
    @property
    def mass(self) -> float:
        """Mass, point masses among it."""
    @property
    def center_of_mass(self) -> NDArray[np.float64]:
        """Centre of mass, mesh axes (3; view)."""
    @property
    def inertia(self) -> NDArray[np.float64]:
        """Inertia of the undeformed body about its centre of mass (3x3)."""
    @property
    def origin(self) -> NDArray[np.float64]:
        """Origin of the body frame, mesh axes (3; view): the centre of mass of a free body."""
    @property
    def frequencies(self) -> NDArray[np.float64]:
        """Natural frequencies, cycles per time (nf); after them those of the static shapes, which are none."""
    @property
    def damping_ratios(self) -> NDArray[np.float64]:
        """Damping ratio of each of them (nf; view); zero where the scene alone calls for no damping. Under laws it is that of
        the scene: see Results."""
    @property
    def kinds(self) -> list[str]:
        """Kind of each: "natural mode" or "static shape"; beside the "static answer" to moments, "combination of modes"."""
    @property
    def positions(self) -> NDArray[np.float64]:
        """Nodes of the mesh (n x 3; view); none of a rigid body."""
    @property
    def tetrahedra(self) -> NDArray[np.uint32]:
        """Nodes of the elements, from 0: corners, then mid-edges 01 12 02 03 23 13 (m x 10; view)."""
    @property
    def surface_triangles(self) -> NDArray[np.uint32]:
        """Nodes of the faces on the surface, seen from outside: corners, then mid-edges 01 12 20 (t x 6)."""
    @property
    def shapes(self) -> NDArray[np.float64]:
        """Mass-normalised modes, then static shapes: displacements of the nodes, mesh axes (nf x n x 3, or 6 with the
        rotations of the nodes; view)."""
    @property
    def rigid_shapes(self) -> NDArray[np.float64]:
        """Rigid modes, zero where the body has less (6 x n x 3, or 6 with the rotations of the nodes; view)."""
    @property
    def constants(self) -> dict[str, Any]:
        """Constants of the reduced body, by the names in docs/reference/body.md: "mass" is a number, the others are read-only arrays with the
        shapes given there. Those without an index of their own are views."""
    @property
    def points(self) -> dict[str, NDArray[np.float64]]:
        """Where the points of the scene are in the undeformed body, mesh axes."""
    def displacements(self, modal_displacement: ArrayLike) -> NDArray[np.float64]:
        """Elastic displacement of each node, body axes (n x 3, or 6 with the rotations of the nodes), with what follows large
        modes, and that of a bent reference."""

@final
class Motion:
    """The motion of the body at one time, as a law sees it. Arrays are copies."""

    @property
    def time(self) -> float:
        """Time."""
    @property
    def rotation(self) -> NDArray[np.float64]:
        """Matrix that takes body components to global ones (3x3)."""
    @property
    def origin(self) -> NDArray[np.float64]:
        """Position of the origin of the body frame, global (3)."""
    @property
    def origin_velocity(self) -> NDArray[np.float64]:
        """Its velocity, global (3)."""
    @property
    def angular_velocity(self) -> NDArray[np.float64]:
        """Angular velocity of the body frame, body axes (3)."""
    @property
    def modal_displacement(self) -> NDArray[np.float64]:
        """Coordinates of the flexible modes and static shapes (nf)."""
    @property
    def modal_velocity(self) -> NDArray[np.float64]:
        """Their rates (nf)."""
    def position(self, point: str | None = None) -> NDArray[np.float64]:
        """Position of a point of the scene, global (3); of that of the force, if none is named."""
    def velocity(self, point: str | None = None) -> NDArray[np.float64]:
        """Velocity of a point of the scene, global (3); of that of the force, if none is named."""

@final
class Force:
    """A force at a point of the scene, by a law: a function of the motion that returns three components.

    They are global, or in body axes with `frame="body"`. The law is evaluated several times a step, and must depend on
    nothing but the motion. `discontinuities` are times at which it or its rate jumps, so that steps end there; `longest_step` is
    the longest step that sees it as it is.
    """

    def __new__(
        cls,
        point: str,
        law: Callable[[Motion], ArrayLike],
        *,
        frame: Literal["global", "body"] = "global",
        name: str | None = None,
        discontinuities: Sequence[float] = ...,
        longest_step: float | None = None,
    ) -> Force: ...

@final
class ModalForce:
    """Forces on the modal coordinates, by a law that returns nf of them. They have no resultant. Otherwise as Force."""

    def __new__(
        cls,
        law: Callable[[Motion], ArrayLike],
        *,
        name: str | None = None,
        discontinuities: Sequence[float] = ...,
        longest_step: float | None = None,
    ) -> ModalForce: ...

@final
class Row:
    """The motion at one time: a number or an array for each column of a results file, by its path."""

    @property
    def time(self) -> float:
        """Time."""
    def keys(self) -> list[str]:
        """Paths of its columns."""
    def __len__(self) -> int: ...
    def __contains__(self, path: str, /) -> bool: ...
    def __iter__(self) -> Iterator[str]: ...
    def __getitem__(self, path: str, /) -> Any: ...

@final
class Reached:
    """Where a simulation has come to."""

    @property
    def kind(self) -> str:
        """A "row" that is due, an "event", the "stop" of `advance_to`, the end of a "step", or the "end" of the run."""
    @property
    def event(self) -> str | None:
        """Name of the event."""
    @property
    def time(self) -> float:
        """Time."""

@final
class System:
    """All bodies of a scene with the joints between them: their meshes are read, their modes are found, and they are reduced.

    Results that take long are kept in the user's cache, as for Body. A Simulation of it steps all bodies together.
    """

    def __new__(cls, scene: Scene) -> System: ...
    @property
    def scene(self) -> Scene:
        """The scene that it was made for."""
    @property
    def bodies(self) -> list[str]:
        """Names of its bodies."""
    @property
    def joints(self) -> list[str]:
        """Names of its joints."""

@final
class JointEquation:
    """One more equation of a joint: a point on a wire, a cam, a rod of one length. The joint keeps it at zero, beside what it holds
    otherwise (`locked = []` holds nothing).

    `equation` is a function of the place of the second end as the first sees it, in the axes of the first: the position (3), and
    the matrix that takes components along the axes of the second end to those along the axes of the first (3x3). It returns the
    residual, a length or an angle; its derivative by the position (3); and, if it depends on the axes, its derivative by a small turn
    of the second end (3). The three are compared at the beginning. It must depend on nothing but the place.
    """

    def __new__(
        cls,
        joint: str,
        equation: Callable[[NDArray[np.float64], NDArray[np.float64]], Any],
        *,
        name: str | None = None,
    ) -> JointEquation: ...

@final
class JointForce:
    """A moment about the turn of a joint, or a force along its slide, by a law: a function of the time, the coordinate (rad or a
    length) and its rate that returns a number. It is positive on the second body along the coordinate, as the motor of a scene.

    `along` is "turn" or "slide"; a joint that has but one needs none. The law is evaluated several times a step, and must depend on
    nothing but these. `discontinuities` are times at which it or its rate jumps, so that steps end there. `switch` is a function of
    the same that changes its sign where the law has a kink or a jump, such as the gap of a stop: under a tolerance steps end there.
    """

    def __new__(
        cls,
        joint: str,
        law: Callable[[float, float, float], float],
        *,
        along: Literal["turn", "slide"] | None = None,
        name: str | None = None,
        discontinuities: Sequence[float] = ...,
        switch: Callable[[float, float, float], float] | None = None,
    ) -> JointForce: ...

@final
class RelativeMotion:
    """The motion of the second of two markers as the first sees it, in the axes of the first. Arrays are copies."""

    @property
    def position(self) -> NDArray[np.float64]:
        """Position of the second marker from the first (3)."""
    @property
    def velocity(self) -> NDArray[np.float64]:
        """Rate of the position (3)."""
    @property
    def rotation(self) -> NDArray[np.float64]:
        """Matrix that takes components along the axes of the second marker to those along the axes of the first (3x3)."""
    @property
    def angular_velocity(self) -> NDArray[np.float64]:
        """Angular velocity of the second marker less that of the first (3)."""

@final
class MarkerForce:
    """A force and a moment on the second of two markers, and the same the other way round on the first, by a law: a function of the
    time and the RelativeMotion of the second marker that returns the force, or the force and the moment, in the axes of the first.

    `between` names the markers as `between` of a scene does: "BODY.MARKER", "ground.MARKER" or "ground", which is where the other
    marker is at the start. Their axes are those of a bushing there. The law is evaluated many times a step, and must depend on
    nothing but these. `discontinuities` are times at which it or its rate jumps, so that steps end there. `switch` is a function of the same that
    changes its sign where the law has a kink or a jump, such as the gap of a contact: under a tolerance steps end there.
    """

    def __new__(
        cls,
        between: Sequence[str],
        law: Callable[[float, RelativeMotion], Any],
        *,
        name: str | None = None,
        discontinuities: Sequence[float] = ...,
        switch: Callable[[float, RelativeMotion], float] | None = None,
    ) -> MarkerForce: ...

@final
class Simulation:
    """A run of a body and its scene, with more loads. As an iterator it yields the rows from where it is.

    For a System, `loads` is a dict from names of bodies to lists, `joint_forces` a list of JointForce, `joint_equations` one of
    JointEquation, `marker_forces` one of MarkerForce, and states are dicts from names of bodies; all bodies are stepped together, also
    those that nothing ties.

    An exception of a law ends the step: the simulation stays where it was before it, and may go on. One of an event ends the
    run at the end of the step. Ctrl-C raises KeyboardInterrupt within some thousand steps, and the simulation may go on.

    With laws, the effects translation, rotation, gravity, damping, deformed inertia and Coriolis are on unless the scene
    switches them off, and there are no reactions of single supports. `run` watches whether the motion leaves the range of the
    model, such as a spin beyond the critical one, and raises RefusedError; `advance`, `advance_to` and iteration do not.

    With `scene`, the run is of this scene in the place of the body's own: other loads, another start, other effects or steps of the
    same body, whose modes are not searched again. What follows from the loads, such as static shapes, is solved for where it is
    not in the cache. A scene of another body, or one that holds it otherwise or asks for other modes, raises InputError.
    """

    def __new__(
        cls,
        body: Body | System,
        loads: Sequence[Force | ModalForce] | dict[str, Sequence[Force | ModalForce]] | None = None,
        *,
        joint_forces: Sequence[JointForce] | None = None,
        joint_equations: Sequence[JointEquation] | None = None,
        marker_forces: Sequence[MarkerForce] | None = None,
        scene: Scene | None = None,
    ) -> Simulation: ...
    @property
    def body(self) -> Any:
        """The Body with the scene that is run, or the System."""
    @property
    def time(self) -> float:
        """Time that has been reached."""
    @property
    def end(self) -> float:
        """Time at the end."""
    @property
    def done(self) -> bool:
        """True if there is nothing more to come, neither a step nor a row."""
    @property
    def stats(self) -> dict[str, int]:
        """Counts of its work: "steps", "rejected_steps", "evaluations"."""
    def run(self) -> Results:
        """Goes on to the end, and gives the rows from here; events are passed, and listed. Where it fails, the rows before are
        in the attribute `results` of the exception."""
    def advance(self, steps: int | None = None) -> Reached:
        """Goes on to the next row or event, or for at most `steps` tries of a step."""
    def advance_to(self, time: float) -> Reached:
        """Goes on to a time, past rows, or to an event before it. The time is later than now by more than 1e-12 of the end."""
    def add_event(
        self,
        name: str,
        function: Callable[[Row], float],
        *,
        crossing: Literal["rising", "falling", "any"] = "any",
    ) -> None:
        """Stops where a function of the row passes through zero, on the far side to rounding."""
    def observe(self) -> Row:
        """The motion at the time that has been reached."""
    def state(self) -> dict[str, Any]:
        """The state that has been reached: time, attitude (quaternion), origin, velocity of the origin, angular_velocity (body
        axes), modal_displacement, modal_velocity."""
    def set_state(self, state: dict[str, Any]) -> None:
        """Goes on from another state; keys that are not given stay as they are. Work and balances are counted from there.
        `run` then begins with the row of this state; an iteration goes on to the next row. Bodies in joints are moved so that
        these close."""
    def __iter__(self) -> Simulation: ...
    def __next__(self) -> Row: ...

def run(
    scene: Scene, folder: _Path, *, overwrite: bool = False, large: bool = False, check: bool = True
) -> Results:
    """Runs the bodies of a scene as the program does, and writes their results to `<folder>/<name of the scene>.h5`. Until the
    end they are in `<name>.part.h5` beside it, from which `resume` goes on after Ctrl-C or a crash. What is there is replaced
    only with `overwrite`, and what the scene reads never; results of more than 1 GB are written only with `large`. At its end
    rows are checked by the full nonlinear body, as many as cost no more than the body did: `check` of the results, or with
    `check=False` none."""

def resume(file: _Path, *, overwrite: bool = False, check: bool = True, trust_geometry: bool = False) -> Results:
    """Goes on with a run that was cut off: the file is then the same as if it had not been, bit for bit. Another results
    file in its place is replaced only with `overwrite`. `check` is that of `run`, and `trust_geometry` that of Scene."""

def _scene(text: str, path: _Path, body: str | None, trust_geometry: bool) -> Scene:
    """The scene that was pickled."""

def read_results(path: _Path) -> Results:
    """Reads a results file, finished or not."""

@final
class Report:
    """The report of a command.

    `report["peaks[0].magnitude"]` is a value by its path in the JSON of the program, `table(name)` a table as columns of numpy, `str(report)`
    the text of the program. In a notebook it shows its figure and its text.
    """

    @property
    def title(self) -> str | None:
        """Title of the scene."""

    @property
    def warnings(self) -> list[str]:
        """Reservations of the program."""

    @property
    def tables(self) -> list[str]:
        """Names of the tables."""

    def __getitem__(self, key: str, /) -> Any: ...
    def data(self) -> dict[str, Any]:
        """The whole JSON of the program as a dict."""

    def table(self, name: str) -> dict[str, Any]:
        """A table as a dict of columns: arrays of numbers, NaN where there is none, and lists of words."""

    def to_pandas(self, name: str) -> Any:
        """A table as a DataFrame of pandas, which has to be installed."""

    def save(self, folder: _Path) -> list[os.PathLike[str]]:
        """Writes the files of the command to a folder, which is made if it does not exist: tables as CSV, figures as SVG, PDF and PNG, the page.

        Files of the same names are replaced.
        """

    def svg(self) -> str | None:
        """The figure as SVG; None where there is nothing to draw."""


_Range = tuple[float, float, int]

def frf_report(
    scene: Scene, about: dict[str, Any], frequencies: _Range, logarithmic: bool, structural: float | None
) -> Report:
    """The report of `flexframe frf`."""

def psd_report(
    scene: Scene,
    about: dict[str, Any],
    spectra: _Path,
    band: tuple[float, float] | None,
    structural: float | None,
) -> Report:
    """The report of `flexframe psd`."""

def shock_report(scene: Scene, about: dict[str, Any], table: _Path, interpolation: str) -> Report:
    """The report of `flexframe shock`."""

def srs_report(table: _Path, frequencies: _Range, damping_ratios: list[float], interpolation: str) -> Report:
    """The report of `flexframe srs`."""

def campbell_report(
    scene: Scene,
    speeds: _Range,
    about: tuple[list[float] | None, str | None],
    orders: list[float],
    about_rest: str,
) -> Report:
    """The report of `flexframe campbell`."""

def linearized(
    scene: Scene,
    *,
    spin: list[float] | None,
    time: float | None,
    without_rigid: bool,
    inputs: list[str],
    outputs: list[str],
    reduce: str | None,
) -> dict[str, Any]:
    """The state space of small motions of a scene: A, B, C, D, and names and units."""

def gradients(scene: Scene, *, parameters: list[str], frequencies: tuple[float, float, int] | None) -> str:
    """The report of `flexframe gradient`, in JSON."""

def fitted(
    scene: Scene,
    *,
    parameters: list[str],
    file: _Path | None,
    measured: list[float] | None,
    deviation: float | None,
) -> str:
    """The report of `flexframe fit`, in JSON, by the table in a file or by frequencies in the order of the modes."""
