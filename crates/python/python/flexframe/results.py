"""The rows of a run as arrays."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from html import escape
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pandas  # type: ignore[import-untyped, unused-ignore]
    import xarray


class Column(NamedTuple):
    """A column of the results."""

    path: str
    """Its name, such as "energy/work"."""
    unit: str
    """Its unit in the labels of the run, such as "mm/s"."""
    frame: str
    """The axes of its components, such as "global"; "none" of scalars."""
    description: str
    """A sentence on it."""
    dimensions: tuple[str, ...]
    """Names of the dimensions of its array: the first is "time"."""
    scope: str
    """What it has values of: the "system", a "body", or each "point" or "support" of one."""
    body: str | None
    """Name of the body."""


_LABELS = {
    "axis": ["x", "y", "z"],
    "quaternion": ["w", "x", "y", "z"],
    "stress_component": ["xx", "yy", "zz", "xy", "yz", "zx"],
}


class Columns(Mapping[str, NDArray[np.float64]]):
    """An array for each column, by its path. Each array owns its numbers."""

    columns: dict[str, Column]
    """The columns, by their paths."""
    bodies: Mapping[str, BodyResults]
    """The bodies that they are of, by their names."""

    def __init__(self, columns: dict[str, Column], arrays: dict[str, NDArray[np.float64]]) -> None:
        self.columns = columns
        self._arrays = arrays

    def __getitem__(self, path: str) -> NDArray[np.float64]:
        if path in self._arrays:
            return self._arrays[path]
        for whole in self._arrays:
            for place, name in enumerate(self._histories(whole)):
                if name == path:
                    return self._arrays[whole][:, place]
        raise KeyError(f"{path!r} is no column of this run; it has {', '.join(self._arrays)}")

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)

    def _histories(self, path: str) -> list[str]:
        """Paths of the parts of a column that are each of a point or a support."""
        column = self.columns[path]
        if column.body is None or column.scope not in ("point", "support"):
            return []
        group, _, quantity = path.rpartition("/")
        return [f"{group}/{place}/{quantity}" for place in self._labels(column, column.scope, 0)]

    def _labels(self, column: Column, dimension: str, size: int) -> list[Any]:
        """Label of each entry along a dimension; modes are numbered from 1."""
        if column.body is not None and dimension == "point":
            return self.bodies[column.body].points
        if column.body is not None and dimension == "support":
            return self.bodies[column.body].supports
        return _LABELS.get(dimension, list(range(1, size + 1)))

    def _html_table(self) -> str:
        """A table of the columns with their units and ranges."""
        rows = []
        for path, column in self.columns.items():
            array = self._arrays[path]
            ends = f"{array.min():.4g} to {array.max():.4g}" if array.size else ""
            unit = "" if column.unit == "1" else column.unit
            rows.append([path, " x ".join(map(str, array.shape)), ends, unit, column.frame, column.description])
        head = ["column", "shape", "range", "unit", "frame", ""]

        def cells(tag: str, texts: list[str]) -> str:
            return "<tr>" + "".join(f"<{tag}>{escape(text)}</{tag}>" for text in texts) + "</tr>"

        body = "".join(cells("td", row) for row in rows)
        return f"<table><thead>{cells('th', head)}</thead><tbody>{body}</tbody></table>"

    def _about(self) -> dict[str, Any]:
        """Attributes of the dataset."""
        return {}

    def to_xarray(self) -> xarray.Dataset:
        """A dataset with a variable for each column, named by its path, with unit, frame and description. Where there are
        several bodies, the dimensions that each has of its own are "ring.point", "ring.support" and "ring.mode". Needs xarray.
        No number is copied."""
        import xarray

        coordinates: dict[str, Any] = {}
        variables: dict[str, Any] = {}
        for path, column in self.columns.items():
            array = self._arrays[path]
            attributes = {"units": column.unit, "frame": column.frame, "long_name": column.description}
            if path == "time":
                coordinates[path] = xarray.Variable(("time",), array, attributes)
                continue
            dimensions = ["time"]
            for dimension, size in zip(column.dimensions[1:], array.shape[1:]):
                is_of_one = len(self.bodies) > 1 and dimension not in _LABELS
                dimensions.append(f"{column.body}.{dimension}" if is_of_one else dimension)
                coordinates[dimensions[-1]] = self._labels(column, dimension, size)
            variables[path] = xarray.Variable(dimensions, array, attributes)
        return xarray.Dataset(variables, coordinates, self._about())

    def to_pandas(self) -> pandas.DataFrame:
        """A table with the time as index and a column for each number, named as by `flexframe export --csv` without its units:
        "position x", "points/tip/velocity z". Needs pandas."""
        import pandas  # type: ignore[import-untyped, unused-ignore]

        table: dict[str, NDArray[np.float64]] = {}
        for path, column in self.columns.items():
            if path == "time":
                continue
            is_of_places = column.body is not None and column.scope in ("point", "support")
            for name in self._histories(path) if is_of_places else [path]:
                array = self[name]
                if array.ndim == 1:
                    table[name] = array
                    continue
                for k, label in enumerate(self._labels(column, column.dimensions[-1], array.shape[1])):
                    kind = self._kind(column, k)
                    table[f"{name} {label}" if kind is None else f"{name} {label} {kind}"] = array[:, k]
        return pandas.DataFrame(table, index=pandas.Index(self["time"], name="time"))

    def _kind(self, column: Column, number: int) -> str | None:
        """Kind of a modal coordinate that is none of a natural mode."""
        if column.body is None or column.dimensions[-1] != "mode":
            return None
        kind = self.bodies[column.body].kinds[number]
        return None if kind == "natural mode" else kind


class BodyResults(Columns):
    """What a run has of one of its bodies: the time, and its columns by their paths in the group of the body.

    `results.bodies["ring"]["points/rim/velocity"]` is `results["bodies/ring/points/rim/velocity"]`.
    """

    name: str
    """Its name."""
    frequencies: NDArray[np.float64]
    """Frequencies of the modes, cycles per time; after them those of static shapes, which are none."""
    damping_ratios: NDArray[np.float64]
    """The damping ratio of each of these in the run; zero where damping is left out."""
    kinds: list[str]
    """Kind of each of these: "natural mode" or "static shape"."""
    points: list[str]
    """Names of the points."""
    point_positions: NDArray[np.float64]
    """Where they are in the undeformed body, mesh axes (points x 3)."""
    supports: list[str]
    """Names of the supports with reactions of their own."""

    def __init__(
        self, columns: dict[str, Column], arrays: dict[str, NDArray[np.float64]], data: dict[str, Any]
    ) -> None:
        super().__init__(columns, arrays)
        for name, value in data.items():
            setattr(self, name, value)
        self.bodies = {self.name: self}

    def __repr__(self) -> str:
        return f"BodyResults({self.name!r}, {len(self['time'])} rows, {len(self)} columns)"

    def _repr_html_(self) -> str:
        """The name, and a table of the columns with their units and ranges."""
        return f"<b>{escape(repr(self))}</b>{self._html_table()}"

    def _about(self) -> dict[str, Any]:
        return {"body": self.name}


class Results(Columns):
    """The rows of a run: an array for each column, by its path as in the results file.

    `results["points/velocity"]` has the velocity of all points (rows x points x 3), `results["points/tip/velocity"]` that of
    the point `tip`. In a run of several bodies these are "bodies/ring/points/velocity" and "bodies/ring/points/tip/velocity",
    or `results.bodies["ring"]["points/velocity"]`. Each array owns its numbers.
    """

    title: str
    """Title of the scene."""
    units: dict[str, str]
    """Labels of length, mass and time."""
    formulation: str
    """The equations of motion."""
    scheme: str
    """The scheme that stepped them."""
    step: float | None
    """Length of its steps, where they have one."""
    tolerance: float | None
    """The error allowed, where that sets their length."""
    program_version: str
    """Version of flexframe that made the run."""
    scene: str
    """Text of the scene."""
    scene_file: str
    """Where it was."""
    complete: bool
    """True if the run came to its end."""
    warnings: list[str]
    """Warnings of the run, such as assumptions that did not hold."""
    trust: list[dict[str, Any]]
    """The trust card, the worst line first, each with `place` ("mesh", "modes", "steps", "model"), `body` (of several), `error` (relative, None
    where it is not known), `meaning`, `known` (the way in which it is) and `next` (what would mend it, or tell); empty of an unfinished run."""
    events: list[tuple[str, float]]
    """The events that a run in memory has passed, and when."""
    check: dict[str, Any] | None = None
    """After `run`, for each body by its name: `rows` that were checked by the full nonlinear body, each with `row`, `time`, `why`, the
    `error` of the displacements over the body, `error_of_largest` (over the largest of the run), its `parts` with their sizes and
    what would mend them, `points` with their true displacements and the errors of them, `frequencies` (of the model, of the full
    body), `negative_directions` and `growth`; `not_checked`, the reason where it was not. None where nothing was checked."""

    def __init__(self, data: dict[str, Any]) -> None:
        columns, arrays = {}, {}
        of_bodies: dict[str, tuple[dict[str, Column], dict[str, NDArray[np.float64]]]]
        of_bodies = {body["name"]: ({}, {}) for body in data["bodies"]}
        for path, own_path, about, array in data.pop("columns"):
            unit, frame, description, dimensions, scope, body = about
            column = Column(path, unit, frame, description, tuple(dimensions), scope, body)
            columns[path], arrays[path] = column, array
            for name in of_bodies if path == "time" else [body]:
                if name is not None:
                    of_bodies[name][0][own_path] = column._replace(path=own_path)
                    of_bodies[name][1][own_path] = array
        super().__init__(columns, arrays)
        self.bodies = {body["name"]: BodyResults(*of_bodies[body["name"]], body) for body in data.pop("bodies")}
        for name, value in data.items():
            setattr(self, name, value)

    def _only_body(self) -> BodyResults:
        if len(self.bodies) == 1:
            return next(iter(self.bodies.values()))
        names = ", ".join(self.bodies)
        raise AttributeError(f"each body has its own, such as results.bodies[{next(iter(self.bodies))!r}]: {names}")

    @property
    def frequencies(self) -> NDArray[np.float64]:
        """Those of the only body. Of several, each has its own, as have all that follow."""
        return self._only_body().frequencies

    @property
    def damping_ratios(self) -> NDArray[np.float64]:
        """The damping ratio of each of these in the run."""
        return self._only_body().damping_ratios

    @property
    def kinds(self) -> list[str]:
        """Kind of each of these: "natural mode" or "static shape"."""
        return self._only_body().kinds

    @property
    def points(self) -> list[str]:
        """Names of the points."""
        return self._only_body().points

    @property
    def point_positions(self) -> NDArray[np.float64]:
        """Where they are in the undeformed body, mesh axes (points x 3)."""
        return self._only_body().point_positions

    @property
    def supports(self) -> list[str]:
        """Names of the supports with reactions of their own."""
        return self._only_body().supports

    def __repr__(self) -> str:
        bodies = f"{len(self.bodies)} bodies, " if len(self.bodies) > 1 else ""
        end = "" if self.complete else ", unfinished"
        times = self["time"]
        reach = f" to {times[-1]:.6g} {self.units['time']}" if len(times) else ""
        return f"Results({self.title!r}, {bodies}{len(times)} rows{reach}, {len(self)} columns{end})"

    def _repr_html_(self) -> str:
        """The title, the warnings, and a table of the columns with their units and ranges."""
        told = "".join(f"<li>{escape(warning)}</li>" for warning in self.warnings)
        warnings = f"<ul>{told}</ul>" if told else ""
        return f"<b>{escape(repr(self))}</b>{warnings}{self._html_table()}"

    def _about(self) -> dict[str, Any]:
        return {
            "title": self.title,
            "formulation": self.formulation,
            "scheme": self.scheme,
            "program_version": self.program_version,
        }
