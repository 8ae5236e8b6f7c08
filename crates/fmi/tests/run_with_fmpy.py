"""FMUs in FMPy: its validator, runs against the program's own, and a controller outside.

    python run_with_fmpy.py PATH/TO/flexframe

Prints the largest differences; fails where one is above 1e-10 of the largest number of its kind.
"""

import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import h5py
import numpy as np
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi2 import FMU2Slave
from fmpy.validation import validate_fmu

PROGRAM = sys.argv[1]
ROOT = Path(__file__).resolve().parents[3]
SAME = 1e-10


def flexframe(*arguments):
    subprocess.run([PROGRAM, *map(str, arguments)], check=True, stdout=subprocess.PIPE)


def pack(scene, folder):
    fmu = folder / f"{scene.stem}.fmu"
    flexframe("fmu", scene, "-o", fmu)
    problems = validate_fmu(str(fmu))
    assert problems == [], problems
    with zipfile.ZipFile(fmu) as packed:
        for name in packed.namelist():
            if name.startswith("binaries/"):
                library = packed.read(name)
                # An FMU is to run where there is no HDF5, and to be sent by mail: its library is stripped.
                assert b"libhdf5" not in library, name
                alone = folder / "library.so"
                alone.write_bytes(library)
                sections = subprocess.run(["readelf", "--sections", "--wide", alone], check=True, capture_output=True).stdout
                assert b".debug_info" not in sections, f"{name}, {len(library) / 1e6:.0f} MB, has debugging information"
    return str(fmu)


def own_rows(scene, folder):
    """All columns of the program's own run, by the names that the FMU has for them."""
    flexframe("run", scene, "-o", folder / scene.stem, "--overwrite")
    columns = {}
    with h5py.File(folder / scene.stem / f"{scene.stem}.h5") as file:
        names = file["points/names"][()] if "points/names" in file else []
        points = [name.decode() if isinstance(name, bytes) else name for name in names]
        only = f"bodies/{next(iter(file['bodies']))}/"

        def take(path, item):
            if not isinstance(item, h5py.Dataset) or item.ndim == 0 or item.shape[0] != file["time"].shape[0]:
                return
            path = path.removeprefix(only)
            rows, name = item[()], path.replace("/", ".")
            if path.startswith("points/"):
                if rows.ndim < 2:
                    return
                for p, point in enumerate(points):
                    columns[name.replace("points.", f"points.{point}.")] = rows[:, p]
            else:
                columns[name] = rows

        file.visititems(take)
    return columns


# Conserved: the same numbers as the program's own run.
def compare(found, columns):
    """Largest difference of a kind of number, relative to the largest of that kind."""
    worst, kinds = 0.0, 0
    names = [name for name in found.dtype.names if name != "time"]
    for kind in sorted({re.sub(r"\[\d+\]$", "", name) for name in names}):
        if kind not in columns:
            continue
        expected = columns[kind].reshape(len(columns["time"]), -1)
        if expected.shape[1] == 1 and kind in found.dtype.names:
            ours = found[kind].reshape(-1, 1)
        else:
            ours = np.stack([found[f"{kind}[{i + 1}]"] for i in range(expected.shape[1])], axis=1)
        scale = np.abs(expected).max()
        if scale > 0:
            worst = max(worst, np.abs(ours - expected).max() / scale)
            kinds += 1
    assert kinds > 10, kinds
    assert worst <= SAME, worst
    return worst, kinds


def run_of_a_scene(scene, folder):
    fmu, columns = pack(scene, folder), own_rows(scene, folder)
    names = [v.name for v in read_model_description(fmu).modelVariables if v.causality in ("output", "local")]
    times = columns["time"]
    found = simulate_fmu(fmu, output_interval=times[1], stop_time=times[-1], output=names)
    worst, kinds = compare(found, columns)
    print(f"{scene.name}: {len(times)} rows, {kinds} kinds of numbers, largest difference {worst:.1e}")


BEAM = """
title = "A beam that flies"
units = {{ length = "m", mass = "kg", time = "s" }}
[body]
mesh = "{mesh}"
material = {{ young_modulus = 6.8952e10, poisson_ratio = 0.3, density = 2766.7 }}
[modes]
flexible = 5
static_correction = false
[effects]
geometric_stiffening = false
large_deflection = false
coriolis = true
deformed_inertia = true
[initial]
angular_velocity = [0.5, 3.0, 1.0]
[time]
end = 0.2
step = 1e-3
[output]
interval = 0.01
points = {{ tip = [8.0, 0.0, 0.0] }}
"""


def controller(folder):
    """A damper outside. Its forces, as loads of a scene, give the program's own run."""
    text = BEAM.format(mesh=ROOT / "meshes/wu_haug_beam.msh")
    scene = folder / "beam.toml"
    scene.write_text(text)
    path = pack(scene, folder)
    description = read_model_description(path)
    reference = {v.name: v.valueReference for v in description.modelVariables}
    names = [v.name for v in description.modelVariables if v.causality in ("output", "local")]
    # Accelerations and reactions jump with the force: before it in one run, after it in the other.
    names = [name for name in names if "acceleration" not in name]
    unpacked = extract(path)
    fmu = FMU2Slave(
        guid=description.guid,
        unzipDirectory=unpacked,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="beam",
    )
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    velocity, force = ([reference[f"points.tip.{what}[{i}]"] for i in (1, 2, 3)] for what in ("velocity", "force"))
    step, count, gain = 0.01, 20, 15.0
    rows, forces, state = [], [], None

    def row():
        return tuple([fmu.getReal([0])[0]] + fmu.getReal([reference[name] for name in names]))

    for k in range(count):
        rows.append(row())
        forces.append([-gain * v for v in fmu.getReal(velocity)])
        fmu.setReal(force, forces[-1])
        fmu.doStep(k * step, step)
        if k == 9:
            state = fmu.serializeFMUstate(fmu.getFMUState())
    rows.append(row())
    # From the state on, with the same forces: bit for bit.
    fmu.setFMUState(fmu.deSerializeFMUstate(state))
    for k in range(10, count):
        fmu.setReal(force, forces[k])
        fmu.doStep(k * step, step)
    assert row() == rows[-1]
    fmu.terminate()
    fmu.freeInstance()

    before = [0.0] * 3
    for k, now in enumerate(forces):
        for axis in range(3):
            text += f"""
[[loads]]
kind = "force"
at = [8.0, 0.0, 0.0]
direction = {[float(i == axis) for i in range(3)]}
amplitude = {now[axis] - before[axis]!r}
history = {{ kind = "step", at = {k * step!r} }}
"""
        before = now
    replay = folder / "replay.toml"
    replay.write_text(text)
    found = np.array(rows, dtype=[(name, float) for name in ["time", *names]])
    worst, kinds = compare(found, own_rows(replay, folder))
    print(f"a controller outside: {kinds} kinds of numbers, largest difference {worst:.1e}")


with tempfile.TemporaryDirectory() as temporary:
    folder = Path(temporary)
    run_of_a_scene(ROOT / "tests/bent_rod.toml", folder)
    run_of_a_scene(ROOT / "examples/spin_up.toml", folder)
    run_of_a_scene(ROOT / "examples/pendulum.toml", folder)
    controller(folder)
