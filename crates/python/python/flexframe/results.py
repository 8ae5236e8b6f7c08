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


_LABELS = {"axis": ["x", "y", "z"], "quaternion": ["w", "x", "y", "z"]}


class Results(Mapping[str, NDArray[np.float64]]):
    """The rows of a run: an array for each column, by its path as in the results file.

    `results["points/velocity"]` has the velocity of all points (rows x points x 3), `results["points/tip/velocity"]` that of
    the point `tip`. Each array owns its numbers.
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
    complete: bool
    """True if the run came to its end."""
    warnings: list[str]
    """Warnings of the run, such as assumptions that did not hold."""
    events: list[tuple[str, float]]
    """The events that a run in memory has passed, and when."""
    columns: dict[str, Column]
    """The columns, by their paths."""

    def __init__(self, data: dict[str, Any]) -> None:
        self._arrays: dict[str, NDArray[np.float64]] = {}
        self.columns = {}
        for path, unit, frame, description, dimensions, array in data.pop("columns"):
            self.columns[path] = Column(path, unit, frame, description, tuple(dimensions))
            self._arrays[path] = array
        for name, value in data.items():
            setattr(self, name, value)

    def __getitem__(self, path: str) -> NDArray[np.float64]:
        if path in self._arrays:
            return self._arrays[path]
        group, _, rest = path.partition("/")
        name, _, quantity = rest.rpartition("/")
        whole = f"{group}/{quantity}"
        places = self._places(whole)
        if name in places:
            return self._arrays[whole][:, places.index(name)]
        raise KeyError(f"{path!r} is no column of this run; it has {', '.join(self._arrays)}")

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)

    def __repr__(self) -> str:
        end = "" if self.complete else ", unfinished"
        times = self["time"]
        reach = f" to {times[-1]:.6g} {self.units['time']}" if len(times) else ""
        return f"Results({self.title!r}, {len(times)} rows{reach}, {len(self)} columns{end})"

    def _repr_html_(self) -> str:
        """The title, and a table of the columns with their units and ranges."""
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
        told = "".join(f"<li>{escape(warning)}</li>" for warning in self.warnings)
        warnings = f"<ul>{told}</ul>" if told else ""
        return f"<b>{escape(repr(self))}</b>{warnings}<table><thead>{cells('th', head)}</thead><tbody>{body}</tbody></table>"

    def _places(self, path: str) -> list[str]:
        dimensions = self.columns[path].dimensions if path in self.columns else ()
        if "point" in dimensions:
            return self.points
        return self.supports if "support" in dimensions else []

    def _labels(self, dimension: str, size: int) -> list[Any]:
        """Label of each entry along a dimension; modes are numbered from 1."""
        if dimension == "point":
            return self.points
        if dimension == "support":
            return self.supports
        if dimension == "stress_component":
            return ["xx", "yy", "zz", "xy", "yz", "zx"]
        return _LABELS.get(dimension, list(range(1, size + 1)))

    def to_xarray(self) -> xarray.Dataset:
        """A dataset with a variable for each column, named by its path, with unit, frame and description. Needs xarray. No
        number is copied."""
        import xarray

        coordinates: dict[str, Any] = {}
        variables: dict[str, Any] = {}
        for path, column in self.columns.items():
            array = self._arrays[path]
            attributes = {"units": column.unit, "frame": column.frame, "long_name": column.description}
            for dimension, size in zip(column.dimensions[1:], array.shape[1:]):
                coordinates[dimension] = self._labels(dimension, size)
            if path == "time":
                coordinates[path] = xarray.Variable(("time",), array, attributes)
            else:
                variables[path] = xarray.Variable(column.dimensions, array, attributes)
        about = {
            "title": self.title,
            "formulation": self.formulation,
            "scheme": self.scheme,
            "program_version": self.program_version,
        }
        return xarray.Dataset(variables, coordinates, about)

    def to_pandas(self) -> pandas.DataFrame:
        """A table with the time as index and a column for each number, named as by `flexframe export --csv` without its units:
        "position x", "points/tip/velocity z". Needs pandas."""
        import pandas  # type: ignore[import-untyped, unused-ignore]

        table: dict[str, NDArray[np.float64]] = {}
        for path, column in self.columns.items():
            if path == "time":
                continue
            dimensions = column.dimensions[1:]
            places = self._places(path)
            group, _, quantity = path.rpartition("/")
            histories = [(f"{group}/{name}/{quantity}", self[f"{group}/{name}/{quantity}"]) for name in places]
            if dimensions[:1] not in (("point",), ("support",)):
                histories = [(path, self._arrays[path])]
            for name, array in histories:
                if array.ndim == 1:
                    table[name] = array
                    continue
                for k, label in enumerate(self._labels(dimensions[-1], array.shape[1])):
                    is_static = dimensions[-1] == "mode" and self.kinds[k] != "natural mode"
                    table[f"{name} {label} {self.kinds[k]}" if is_static else f"{name} {label}"] = array[:, k]
        return pandas.DataFrame(table, index=pandas.Index(self["time"], name="time"))
