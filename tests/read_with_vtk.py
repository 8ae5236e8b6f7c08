"""Reads exports with VTK's own readers, as ParaView does, and compares them with the modes and the motion.

Arguments: a results file, its export by --vtkhdf, by --modes and by --vtu (the folder), the latter two on the same cells
and with the same rows.
"""

import sys
from pathlib import Path

import h5py
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
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


results, moving, modes, folder = map(Path, sys.argv[1:])
with h5py.File(results) as file:
    time, attitude, origin = file["time"][:], file["attitude"][:], file["origin"][:]
    q, body_origin = file["modal/displacement"][:], file["body/origin"][:]
    kinds = file["body/kinds"].asstr()[:]

def von_mises(stress):
    xx, yy, zz, xy, yz, zx = stress.T
    return np.sqrt(((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * (xy**2 + yz**2 + zx**2))


of_modes = arrays(read(vtkHDFReader(), modes))
shapes = {name: values for name, values in of_modes.items() if not name.startswith("stress of ")}
assert list(of_modes) == [*shapes, *(f"stress of {name}" for name in shapes)]
stresses = np.stack([of_modes[f"stress of {name}"] for name in shapes], axis=2)
assert stresses.shape[1] == 6
assert [name.split(" ")[0] for name in shapes] == [kind.split(" ")[0].replace("natural", "mode") for kind in kinds]
shapes = np.stack(list(shapes.values()), axis=2)

reader = vtkHDFReader()
read(reader, moving)
steps = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())
rows = [int(np.argmin(np.abs(time - step))) for step in steps]
assert len(steps) > 2 and np.array_equal(time[rows], steps), steps
largest = {"displacement": 0.0, "elastic_displacement": 0.0, "von_mises_stress": 0.0}
# Independent reference: displacements and stresses of modes and motion by NumPy.
for number, (step, row) in enumerate(zip(steps, rows)):
    reader.UpdateTimeStep(step)
    grid = reader.GetOutputDataObject(0)
    points = vtk_to_numpy(grid.GetPoints().GetData())
    elastic = shapes @ q[row]
    placed = origin[row] + (points - body_origin + elastic) @ rotation(*attitude[row]).T
    expected = {"displacement": placed - points, "elastic_displacement": elastic,
                "von_mises_stress": von_mises(stresses @ q[row])}
    other = read(vtkXMLUnstructuredGridReader(), folder / f"{results.stem}_{number:06}.vtu")
    assert other.GetNumberOfCells() == grid.GetNumberOfCells() > 0
    assert np.array_equal(vtk_to_numpy(other.GetPoints().GetData()), points)
    assert np.array_equal(vtk_to_numpy(other.GetCells().GetConnectivityArray()),
                          vtk_to_numpy(grid.GetCells().GetConnectivityArray()))
    assert set(map(grid.GetCellType, range(grid.GetNumberOfCells()))) <= {5, 24}
    for name, values in expected.items():
        found = arrays(grid)[name]
        # Displacements are rounded as positions are.
        size = 0 if name == "von_mises_stress" else np.ptp(points)
        assert np.abs(found - values).max() <= 1e-12 * max(10 * np.abs(values).max(), size), (step, name)
        assert np.array_equal(arrays(other)[name], found), (step, name)
        largest[name] = max(largest[name], np.abs(values).max())
assert all(value > 0 for value in largest.values()), largest
# The list of files names each, with its time.
listed = (folder / f"{results.stem}.pvd").read_text()
assert all(f'timestep="{step!r}"' in listed for step in steps) and listed.count("<DataSet") == len(steps)
print(f"{moving}: {len(steps)} steps of {len(points)} points as the modes have them, largest {largest}")
