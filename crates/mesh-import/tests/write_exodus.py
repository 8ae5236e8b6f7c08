"""Writes a bar as Exodus: classic NetCDF with scipy, or HDF5 with h5py where there is no scipy.

Arguments: the file of arrays by `write_formats.py`, and the file to write.
"""

import sys

import numpy as np

arrays = np.load(sys.argv[1])
points, solid, skin = (arrays[name] for name in ("points", "solid", "skin"))
# Corners of the sides, as Exodus numbers them.
sides = [(0, 1, 3), (1, 2, 3), (0, 3, 2), (0, 2, 1)]
root = {tuple(sorted(row)) for row in skin[:, :3].tolist() if not points[row, 0].any()}
found = [
    (element, number)
    for element, nodes in enumerate(solid.tolist(), start=1)
    for number, side in enumerate(sides, start=1)
    if tuple(sorted(nodes[k] for k in side)) in root
]
names = np.zeros((1, 33), dtype="S1")


def named(name):
    array = names.copy()
    array[0, : len(name)] = list(name)
    return array


half = len(solid) // 2
# The nodes on edges are in the order 01 12 02 03 13 23.
exodus = solid[:, [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]] + 1
blocks = np.zeros((2, 33), dtype="S1")
blocks[0, :3] = list("one")
variables = {
    "coordx": (points[:, 0], ("num_nodes",)),
    "coordy": (points[:, 1], ("num_nodes",)),
    "coordz": (points[:, 2], ("num_nodes",)),
    "eb_names": (blocks, ("num_el_blk", "len_name")),
    "eb_prop1": (np.array([7, 9], dtype="i4"), ("num_el_blk",)),
    "connect1": (exodus[:half].astype("i4"), ("num_el_in_blk1", "num_nod_per_el1")),
    "connect2": (exodus[half:].astype("i4"), ("num_el_in_blk2", "num_nod_per_el2")),
    "ss_names": (named("root"), ("num_side_sets", "len_name")),
    "elem_ss1": (np.array([element for element, _ in found], dtype="i4"), ("num_side_ss1",)),
    "side_ss1": (np.array([side for _, side in found], dtype="i4"), ("num_side_ss1",)),
    "ns_prop1": (np.array([4], dtype="i4"), ("num_node_sets",)),
    "node_ns1": (np.flatnonzero(points[:, 0] == points[:, 0].max()).astype("i4") + 1, ("num_nod_ns1",)),
}
kinds = {"connect1": "TETRA10", "connect2": "tetra"}
try:
    from scipy.io import netcdf_file

    with netcdf_file(sys.argv[2], "w", version=2) as file:
        file.createDimension("time_step", None)
        time = file.createVariable("time_whole", "d", ("time_step",))
        time[0] = 0.0
        for name, (array, dimensions) in variables.items():
            for dimension, size in zip(dimensions, array.shape):
                if dimension not in file.dimensions:
                    file.createDimension(dimension, size)
            variable = file.createVariable(name, "c" if array.dtype.kind == "S" else array.dtype, dimensions)
            variable[:] = array
            if name in kinds:
                variable.elem_type = kinds[name]
except ImportError:
    import h5py

    with h5py.File(sys.argv[2], "w") as file:
        for name, (array, _) in variables.items():
            file[name] = array
            if name in kinds:
                file[name].attrs["elem_type"] = np.bytes_(kinds[name])
