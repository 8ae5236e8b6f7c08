"""Reads exports with VTK's own readers, as ParaView does, and compares them with the modes and the motion.

Arguments: a results file of one body or several, its export by --vtkhdf, by --modes and by --vtu (the folder), the latter
two on the same cells and with the same rows.
"""

import sys
from pathlib import Path
from xml.etree import ElementTree

import h5py
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkCompositeDataSet
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOHDF import vtkHDFReader
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader


def read(reader, path):
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutputDataObject(0)


def arrays(grid):
    data = grid.GetPointData()
    return {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}


def rotation(w, x, y, z):
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])


def von_mises(stress):
    xx, yy, zz, xy, yz, zx = stress.T
    return np.sqrt(((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * (xy**2 + yz**2 + zx**2))


def of_body(data, name):
    """The grid of a body: that of a file of one, or the block of its name."""
    if not hasattr(data, "GetNumberOfPartitionedDataSets"):
        return data
    blocks = range(data.GetNumberOfPartitionedDataSets())
    names = [data.GetMetaData(block).Get(vtkCompositeDataSet.NAME()) for block in blocks]
    found = data.GetPartitionedDataSet(names.index(name))
    assert found.GetNumberOfPartitions() == 1
    return found.GetPartition(0)


def check(name, body, time):
    """Compares the exports of a body with its group in the results file."""
    attitude, origin, q = body["attitude"][:], body["origin"][:], body["modal/displacement"][:]
    body_origin, kinds = body["model/origin"][:], body["model/kinds"].asstr()[:]
    of_modes = arrays(of_body(read(vtkHDFReader(), modes), name))
    shapes = {field: values for field, values in of_modes.items() if not field.startswith("stress of ")}
    assert list(of_modes) == [*shapes, *(f"stress of {field}" for field in shapes)]
    stresses = np.stack([of_modes[f"stress of {field}"] for field in shapes], axis=2)
    assert stresses.shape[1] == 6
    named = [kind.split(" ")[0].replace("natural", "mode") for kind in kinds]
    assert [field.split(" ")[0] for field in shapes] == named
    shapes = np.stack(list(shapes.values()), axis=2)

    reader = vtkHDFReader()
    read(reader, moving)
    steps = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    rows = [int(np.argmin(np.abs(time - step))) for step in steps]
    assert len(steps) > 2 and np.array_equal(time[rows], steps), steps
    # The list of files names each, with its time and its body.
    listed = ElementTree.parse(folder / f"{results.stem}.pvd").getroot().iter("DataSet")
    files = {float(entry.get("timestep")): entry.get("file") for entry in listed if entry.get("name") in (None, name)}
    assert list(files) == list(steps), (files, steps)
    largest = {"displacement": 0.0, "elastic_displacement": 0.0, "von_mises_stress": 0.0}
    # Independent reference: displacements and stresses of modes and motion by NumPy.
    for step, row in zip(steps, rows):
        reader.UpdateTimeStep(step)
        grid = of_body(reader.GetOutputDataObject(0), name)
        points = vtk_to_numpy(grid.GetPoints().GetData())
        elastic = shapes @ q[row]
        placed = origin[row] + (points - body_origin + elastic) @ rotation(*attitude[row]).T
        expected = {"displacement": placed - points, "elastic_displacement": elastic,
                    "von_mises_stress": von_mises(stresses @ q[row])}
        other = read(vtkXMLUnstructuredGridReader(), folder / files[step])
        assert other.GetNumberOfCells() == grid.GetNumberOfCells() > 0
        assert np.array_equal(vtk_to_numpy(other.GetPoints().GetData()), points)
        assert np.array_equal(vtk_to_numpy(other.GetCells().GetConnectivityArray()),
                              vtk_to_numpy(grid.GetCells().GetConnectivityArray()))
        assert set(map(grid.GetCellType, range(grid.GetNumberOfCells()))) <= {5, 24}
        for field, values in expected.items():
            found = arrays(grid)[field]
            # Displacements are rounded as positions are.
            size = 0 if field == "von_mises_stress" else max(np.ptp(points), np.abs(placed).max())
            assert np.abs(found - values).max() <= 1e-12 * max(10 * np.abs(values).max(), size), (step, field)
            assert np.array_equal(arrays(other)[field], found), (step, field)
            largest[field] = max(largest[field], np.abs(values).max())
    assert all(value > 0 for value in largest.values()), largest
    print(f"{moving}: {name}: {len(steps)} steps of {len(points)} points as the modes have them, largest {largest}")


results, moving, modes, folder = map(Path, sys.argv[1:])
with h5py.File(results) as file:
    for name, body in file["bodies"].items():
        if "mesh" in body["model"]:
            check(name, body, file["time"][:])
