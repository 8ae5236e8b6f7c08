"""Runs the examples of docs/reference/body.md, and checks what they say.

Arguments: a body file and a results file; the same of a scene with large deflection and stress, and an export of it by
--vtkhdf --volume.
"""

import re
import sys
from pathlib import Path

import h5py
import numpy as np

page = (Path(__file__).parents[1] / "docs/reference/body.md").read_text()
# Independent reference: energy, displacements and stresses by the formulas of the page, in NumPy.
first, second = re.findall(r"```python\n(.*?)```", page, re.S)
first = first.replace("ring.body.h5", sys.argv[1]).replace("out/ring/ring.h5", sys.argv[2])
names = {}
exec(first, names)
energy, expected = names["kinetic"], names["run"]["energy/kinetic"][-1]
assert abs(energy / expected - 1) < 1e-12, (energy, expected)
for name, dataset in names["body"]["modes"].items():
    assert all(isinstance(dataset.attrs[key], str) for key in ("unit", "frame", "description")), name

names = {"np": np, "body": h5py.File(sys.argv[3]), "run": h5py.File(sys.argv[4])}
exec(second, names)
# The results file has the same shapes and stresses, on its surface.
run, body, nodes = names["run"]["body"], names["body"], names["run"]["body/mesh/nodes"][:]
assert 0 < len(nodes) <= len(body["mesh/positions"])
assert np.array_equal(run["mesh/positions"], body["mesh/positions"][:][nodes])
assert np.array_equal(nodes[run["mesh/surface_triangles"][:]], body["mesh/surface_triangles"])
shapes = np.concatenate([body[name] for name in names["names"]])
assert np.array_equal(run["shapes"], shapes[:, nodes])
sites = np.flatnonzero(np.isin(body["stress/nodes"], nodes))
assert np.array_equal(nodes[run["stress/nodes"][:]], body["stress/nodes"][:][sites])
for name in ("stress/shapes", "stress/products"):
    assert np.array_equal(run[name], body[name][:][:, sites]), name
for name in ("factors", "products"):
    assert np.array_equal(run["large_deflection"][name], body["large_deflection"][name]), name
exported = h5py.File(sys.argv[5])["VTKHDF"]
points = exported["Points"][:]
assert np.array_equal(points, names["body"]["mesh/positions"][:])
u = exported["PointData/elastic_displacement"][-len(points):]
assert np.abs(names["u"] - u).max() < 1e-12 * np.abs(u).max()
xx, yy, zz, xy, yz, zx = names["stress"].T
von_mises = np.sqrt(((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * (xy**2 + yz**2 + zx**2))
expected = exported["PointData/von_mises_stress"][-len(points):]
assert np.abs(von_mises - expected).max() < 1e-11 * expected.max()
linear = np.tensordot(names["q"], np.concatenate([names["body"][name] for name in names["names"][:2]]), 1)
assert np.abs(linear - u).max() > 1e-4 * np.abs(u).max()
print(f"displacement {np.abs(u).max():.4g} and stress {expected.max():.4g} of a body that bends far, as exported")
