"""Reads a results file as a user of h5py would, and checks the promised names, shapes and types."""

import sys

import h5py
import numpy as np

with h5py.File(sys.argv[1], "r") as file:
    rows = file["time"].shape[0]
    modes = file["body/frequencies"].shape[0]
    shapes = {
        "attitude": (rows, 4),
        "position": (rows, 3),
        "velocity": (rows, 3),
        "angular_velocity": (rows, 3),
        "angular_acceleration": (rows, 3),
        "modal/displacement": (rows, modes),
        "modal/velocity": (rows, modes),
        "energy/kinetic": (rows,),
        "energy/strain": (rows,),
        "momentum/linear": (rows, 3),
        "momentum/angular": (rows, 3),
        "body/mass": (),
        "body/center_of_mass": (3,),
        "body/inertia": (3, 3),
        "body/frequencies": (modes,),
        "body/damping_ratios": (modes,),
    }
    for point in file["points"]:
        for quantity in ("displacement", "velocity", "acceleration", "rigid_acceleration"):
            shapes[f"points/{point}/{quantity}"] = (rows, 3)
    for name, shape in shapes.items():
        data = file[name]
        assert data.shape == shape, (name, data.shape, shape)
        assert data.dtype == np.float64, (name, data.dtype)
        assert np.isfinite(data[()]).all(), name
    for name in ("units_length", "units_mass", "units_time", "scheme", "program_version", "title", "scene"):
        assert isinstance(file.attrs[name], str), name
    assert file.attrs["step"] > 0 and file.attrs["complete"] == 1
    quaternion = file["attitude"][:]
    assert np.abs(np.linalg.norm(quaternion, axis=1) - 1).max() < 1e-14
    print(f"{sys.argv[1]}: {rows} rows, {modes} modes, {len(shapes)} data sets as promised")
