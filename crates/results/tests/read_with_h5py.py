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
        "energy/work": (rows,),
        "energy/dissipation": (rows,),
        "energy/balance": (rows,),
        "momentum/linear": (rows, 3),
        "momentum/angular": (rows, 3),
        "momentum/linear_balance": (rows, 3),
        "momentum/angular_balance": (rows, 3),
        "body/mass": (),
        "body/center_of_mass": (3,),
        "body/inertia": (3, 3),
        "body/frequencies": (modes,),
        "body/damping_ratios": (modes,),
        "body/origin": (3,),
        "origin": (rows, 3),
    }
    points = len(file["points/names"].asstr()[:])
    shapes["points/position"] = (points, 3)
    quantities = ("displacement", "velocity", "acceleration", "rigid_acceleration", "elastic_displacement",
                  "elastic_displacement_body")
    shapes |= {f"points/{quantity}": (rows, points, 3) for quantity in quantities}
    kinds = list(file["body/kinds"].asstr())
    assert len(kinds) == modes and set(kinds) <= {"natural mode", "static shape"}, kinds
    for name, shape in shapes.items():
        data = file[name]
        assert data.shape == shape, (name, data.shape, shape)
        assert data.dtype == np.float64, (name, data.dtype)
        assert np.isfinite(data[()]).all(), name
    texts = ("units_length", "units_mass", "units_time", "formulation", "scheme", "program_version", "title", "scene")
    for name in texts:
        assert isinstance(file.attrs[name], str), name
    lengths = [name for name in ("step", "tolerance") if name in file.attrs]
    assert len(lengths) == 1 and file.attrs[lengths[0]] > 0, lengths
    assert file.attrs["complete"] == 1
    assert file.attrs["format_version"] == "7"
    if "body/shapes" in file:
        nodes, faces = file["body/mesh/nodes"].shape[0], file["body/mesh/surface_triangles"][:]
        coordinates = file["body/shapes"].shape[0]
        assert coordinates >= modes and faces.shape[1] == 6 and faces.max() == nodes - 1
        assert file["body/mesh/positions"].shape == (nodes, 3)
        assert file["body/shapes"].shape == (coordinates, nodes, 3)
        assert file["body/stress/shapes"].shape == (coordinates, len(file["body/stress/nodes"]), 6)
        assert np.isfinite(file["body/shapes"]).all() and np.isfinite(file["body/stress/shapes"]).all()
    # Conserved: the balance of energy, and unit quaternions.
    energy = {name: file[f"energy/{name}"][:] for name in ("kinetic", "strain", "work", "dissipation", "balance")}
    balance = energy["kinetic"] + energy["strain"] - energy["work"] + energy["dissipation"]
    assert np.allclose(energy["balance"], balance, rtol=1e-12, atol=1e-12 * np.abs(balance).max())
    quaternion = file["attitude"][:]
    assert np.abs(np.linalg.norm(quaternion, axis=1) - 1).max() < 1e-14
    print(f"{sys.argv[1]}: {rows} rows, {modes} modes, {len(shapes)} data sets as promised")
