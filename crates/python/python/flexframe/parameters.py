"""Rates with the numbers of a scene, and numbers by measured frequencies."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flexframe import _flexframe
from flexframe.errors import InputError

if TYPE_CHECKING:
    from flexframe._flexframe import Scene


@dataclass(frozen=True, eq=False)
class Rates:
    """Derivatives with one parameter, by its unit: of what a `Gradient` has under the same names.

    `relative` are d ln f / d ln p of the frequencies. A static displacement or a response whose load changes with the parameter in a way
    that is not known is None.
    """

    frequencies: NDArray[np.float64]
    relative: NDArray[np.float64]
    effective_masses: NDArray[np.float64]
    statics: dict[tuple[str, str], NDArray[np.float64] | None]
    responses: dict[tuple[str, str], NDArray[np.complex128] | None]


@dataclass(frozen=True, eq=False)
class Gradient:
    """What a body, or bodies in joints, do, with the rates of it with each parameter.

    `effective_masses` have a row for each mode, of translations of the base; `statics` are displacements by load and point;
    `responses` are complex, by output and input, at `response_frequencies`. `values` and `rates` are by the names of the parameters.
    `repeated` are the first mode and the one after the last, from 0, of each group of one frequency.
    """

    frequencies: NDArray[np.float64]
    repeated: list[tuple[int, int]]
    effective_masses: NDArray[np.float64]
    statics: dict[tuple[str, str], NDArray[np.float64]]
    response_frequencies: NDArray[np.float64]
    responses: dict[tuple[str, str], NDArray[np.complex128]]
    values: dict[str, float]
    rates: dict[str, Rates]


@dataclass(frozen=True)
class FittedParameter:
    """A number of the scene as it was and as measured frequencies have it, with the interval that has the true one in it.

    `is_key` is False of a stretch of the mesh, such as "thickness.z", which is a factor and no key of the scene.
    """

    start: float
    value: float
    interval: tuple[float, float] | None
    is_key: bool


@dataclass(frozen=True, eq=False)
class Fit:
    """Parameters by measured frequencies.

    `modes` are the numbers of the modes, from 0, that the lines of `measured` are; `before` and `after` their frequencies in the scene
    and with the parameters. `scatter` is what is left: in stated deviations, or relative to the frequencies where none are stated.
    """

    parameters: dict[str, FittedParameter]
    confidence: float
    modes: NDArray[np.int64]
    measured: NDArray[np.float64]
    before: NDArray[np.float64]
    after: NDArray[np.float64]
    correlation: NDArray[np.float64]
    degrees_of_freedom: int
    deviations_stated: bool
    scatter: float | None
    warnings: list[str]

    @property
    def values(self) -> dict[str, float]:
        """The values of the keys, as `Scene.with_values` takes them; a stretch of the mesh, which has no key, is in `parameters` alone."""
        return {name: parameter.value for name, parameter in self.parameters.items() if parameter.is_key}


def gradient(
    scene: Scene, parameters: Sequence[str] = (), *, frequencies: tuple[float, float, int] | None = None
) -> Gradient:
    """Exact derivatives of frequencies, effective masses, static displacements and responses, as `flexframe gradient` finds them.

    `parameters` are paths of keys, such as "body.material.young_modulus", or a stretch, such as "thickness.z"; of bodies in joints
    "springs[0].stiffness" or "bodies.arm.material.density". Without any they are all keys. `frequencies`, start, end and count, are
    those of responses.
    """
    found = json.loads(_flexframe.gradients(scene, parameters=list(parameters), frequencies=frequencies))
    of_statics = [(answer["load"], answer["point"]) for answer in found["statics"]]
    of_responses = [(answer["output"], answer["input"]) for answer in found["responses"]]

    def rates(parameter: dict[str, Any]) -> Rates:
        return Rates(
            frequencies=_array(parameter["frequencies"]),
            relative=_array(parameter["relative"]),
            effective_masses=_array(parameter["effective_masses"]).reshape(-1, 3),
            statics={key: None if rate is None else _array(rate) for key, rate in zip(of_statics, parameter["statics"])},
            responses={
                key: None if rate is None else _complex(rate) for key, rate in zip(of_responses, parameter["responses"])
            },
        )

    return Gradient(
        frequencies=_array(found["frequencies"]),
        repeated=[(first - 1, last) for first, last in found["repeated"]],
        effective_masses=_array(found["effective_masses"]).reshape(-1, 3),
        statics={key: _array(answer["displacement"]) for key, answer in zip(of_statics, found["statics"])},
        response_frequencies=_array(found["response_frequencies"]),
        responses={key: _complex(answer["values"]) for key, answer in zip(of_responses, found["responses"])},
        values={parameter["name"]: parameter["value"] for parameter in found["parameters"]},
        rates={parameter["name"]: rates(parameter) for parameter in found["parameters"]},
    )


def fit(
    scene: Scene,
    parameters: Sequence[str],
    measured: str | os.PathLike[str] | Sequence[float] | NDArray[np.float64] | None = None,
    *,
    deviation: float | None = None,
) -> Fit:
    """Parameters by measured frequencies with 95 % intervals, as `flexframe fit` finds them.

    `measured` is a CSV file as `flexframe fit --measured` reads it, or frequencies in the order of the modes; without it the scene has
    them in [modes]. `deviation` is the standard deviation relative to each frequency.
    """
    file = measured if isinstance(measured, (str, os.PathLike)) else None
    frequencies = None if file is not None or measured is None else _list_of_frequencies(measured)
    found = json.loads(
        _flexframe.fitted(
            scene,
            parameters=list(parameters),
            file=file,
            measured=frequencies,
            deviation=deviation,
        )
    )
    modes = found["modes"]
    fitted = {
        parameter["name"]: FittedParameter(
            start=parameter["start"],
            value=parameter["value"],
            interval=None if parameter["interval"] is None else (parameter["interval"][0], parameter["interval"][1]),
            is_key=parameter["is_key"],
        )
        for parameter in found["parameters"]
    }
    return Fit(
        parameters=fitted,
        modes=np.array([mode["mode"] - 1 for mode in modes], dtype=np.int64),
        measured=_array([mode["measured"] for mode in modes]),
        before=_array([mode["before"] for mode in modes]),
        after=_array([mode["after"] for mode in modes]),
        correlation=_array(found["correlation"]),
        **{
            key: found[key]
            for key in ("confidence", "degrees_of_freedom", "deviations_stated", "scatter", "warnings")
        },
    )


def _list_of_frequencies(measured: Any) -> list[float]:
    numbers = np.asarray(measured, dtype=float)
    if numbers.ndim != 1:
        key, found, expected = "measured", f"an array of the shape {numbers.shape}", "a list of frequencies, of one axis"
        help = "give one column, such as measured[:, 0]; deviations beside the frequencies stand in a CSV file"
        raise InputError(
            f"{key}: found {found}, expected {expected}\n = {help}", key=key, found=found, expected=expected, help=help
        )
    return [float(x) for x in numbers]


def _array(numbers: Sequence[Any]) -> NDArray[np.float64]:
    return np.array(numbers, dtype=float)


def _complex(pairs: Sequence[Sequence[float]]) -> NDArray[np.complex128]:
    return np.array([complex(re, im) for re, im in pairs], dtype=complex)
