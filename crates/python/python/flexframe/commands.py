"""The commands of the program on small motions, as functions that return reports."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from flexframe import _flexframe

if TYPE_CHECKING:
    from flexframe._flexframe import Report, Scene

_Path = str | os.PathLike[str]


def _about(
    spin: Sequence[float] | None,
    time: float | None,
    without_rigid: bool,
    inputs: Sequence[str],
    outputs: Sequence[str],
) -> dict[str, Any]:
    return {
        "spin": None if spin is None else [float(x) for x in spin],
        "time": time,
        "without_rigid": without_rigid,
        "inputs": list(inputs),
        "outputs": list(outputs),
    }


def _range(values: tuple[float, float, int]) -> tuple[float, float, int]:
    start, end, count = values
    return float(start), float(end), int(count)


def frf(
    scene: Scene,
    frequencies: tuple[float, float, int],
    *,
    logarithmic: bool = False,
    structural: float | None = None,
    spin: Sequence[float] | None = None,
    time: float | None = None,
    without_rigid: bool = False,
    inputs: Sequence[str] = (),
    outputs: Sequence[str] = (),
) -> Report:
    """Frequency responses, as `flexframe frf` finds them.

    `frequencies` are the first, the last and their number, cycles per time; `structural` is a loss factor in the place of the damping of
    the scene. The other keywords are those of `linearize`. Tables: "frf" with magnitude and phase (degrees) of each output by each input,
    and "peaks".
    """
    about = _about(spin, time, without_rigid, inputs, outputs)
    return _flexframe.frf_report(scene, about, _range(frequencies), logarithmic, structural)


def psd(
    scene: Scene,
    spectra: _Path,
    *,
    band: tuple[float, float] | None = None,
    structural: float | None = None,
    spin: Sequence[float] | None = None,
    time: float | None = None,
    without_rigid: bool = False,
    outputs: Sequence[str] = (),
) -> Report:
    """The response to stationary random inputs, as `flexframe psd` finds it.

    `spectra` is a CSV file of frequencies and one-sided densities, unit² per cycle per time; `band` the lowest and the highest frequency.
    Tables: "psd" with the density of each output, and "outputs" with root mean squares.
    """
    about = _about(spin, time, without_rigid, (), outputs)
    return _flexframe.psd_report(scene, about, spectra, band, structural)


def shock(
    scene: Scene,
    table: _Path,
    input: str,
    *,
    interpolation: str = "linear",
    spin: Sequence[float] | None = None,
    time: float | None = None,
    without_rigid: bool = False,
    outputs: Sequence[str] = (),
) -> Report:
    """Sums of the peaks of the modes under a shock, as `flexframe shock` finds them.

    The input, such as "base.acceleration.z", follows the CSV file of times and values. Tables: "modes", and "outputs" with the sums.
    """
    about = _about(spin, time, without_rigid, (input,), outputs)
    return _flexframe.shock_report(scene, about, table, interpolation)


def srs(
    table: _Path,
    frequencies: tuple[float, float, int],
    *,
    damping_ratios: Sequence[float] = (0.05,),
    interpolation: str = "linear",
) -> Report:
    """Shock response spectra of the base motion in a CSV file of times and accelerations, as `flexframe srs` finds them.

    Tables: "srs" with peaks of displacement and acceleration for each damping ratio, and "spectra".
    """
    return _flexframe.srs_report(table, _range(frequencies), [float(ratio) for ratio in damping_ratios], interpolation)


def campbell(
    scene: Scene,
    speeds: tuple[float, float, int],
    *,
    axis: Sequence[float] | None = None,
    joint: str | None = None,
    orders: Sequence[float] = (1, 2, 3, 4),
    about_rest: str = "auto",
) -> Report:
    """Natural frequencies against the speed of a spin, with critical speeds, as `flexframe campbell` finds them.

    `speeds` are the first, the last and their number, radians per time. A body alone needs the `axis`, in the axes of its mesh; of bodies in
    joints it is global, or that of a `joint`. Tables: "campbell" and "critical_speeds".
    """
    of_axis = None if axis is None else [float(x) for x in axis]
    all_orders = [float(order) for order in orders]
    return _flexframe.campbell_report(scene, _range(speeds), (of_axis, joint), all_orders, about_rest)
