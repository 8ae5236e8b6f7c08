"""Writes a mesh of gmsh in the formats that meshio writes, with numbers and names as groups.

Arguments: the MSH 4.1 file, and the folder for bar.vtu, bar.vtk, bar.xdmf, bar.med and so on.
"""

import sys
from collections import defaultdict
from pathlib import Path

import numpy as np

try:
    import meshio
except ImportError:
    import meshlane as meshio

mesh = meshio.read(sys.argv[1])
folder = Path(sys.argv[2])
blocks = defaultdict(list)
for block in mesh.cells:
    blocks[block.type].append(block.data)
blocks = {kind: np.vstack(data) for kind, data in blocks.items()}
solid = {"tetra10": blocks["tetra10"]}
both = solid | {"triangle6": blocks["triangle6"]}
number = {"tetra10": 3, "triangle6": 2}


def write(name, cells, label):
    labels = [np.full(len(data), number[kind]) for kind, data in cells.items()]
    meshio.Mesh(mesh.points, list(cells.items()), cell_data={label: labels}).write(folder / name)


write("bar.vtu", both, "material")
write("meshio.vtk", both, "material")
# meshio does not read its own XDMF with elements of two kinds.
write("bar.xdmf", solid, "material")

families = {"tetra10": -3, "triangle6": -2}
tags = [np.full(len(data), families[kind]) for kind, data in both.items()]
med = meshio.Mesh(mesh.points, list(both.items()), cell_data={"cell_tags": tags})
med.cell_tags = {-2: ["skin"], -3: ["bar", "all"]}
med.point_tags = {4: ["end"]}
med.point_data = {"point_tags": np.where(mesh.points[:, 0] == 0, 4, 0)}
med.write(folder / "bar.med")

# As Salome has the corners, and with the nodes on edges that go with them.
turned = blocks["tetra10"][:, [0, 2, 1, 3, 6, 5, 4, 7, 8, 9]]
salome = meshio.Mesh(mesh.points, [("tetra10", turned)], cell_data={"cell_tags": [np.full(len(turned), -3)]})
salome.cell_tags = {-3: ["bar"]}
salome.point_tags = {}
salome.write(folder / "salome.med")

np.savez(folder / "bar.npz", points=mesh.points, solid=blocks["tetra10"], skin=blocks["triangle6"])

# Elements of any order, which VTK numbers otherwise.
meshio.Mesh(mesh.points, list(both.items()), cell_data={"material": [np.full(len(data), number[kind]) for kind, data in both.items()]}).write(
    folder / "text_only.vtu", binary=False
)
text = (folder / "text_only.vtu").read_text()
head, rest = text.split('Name="types"')
at, end = rest.index(">"), rest.index("</DataArray>")
rest = rest[:at] + rest[at:end].replace("24", "71").replace("22", "69") + rest[end:]
# VTK and ParaView write texts, too.
text_of_vtk = '<FieldData><Array type="String" Name="program" NumberOfTuples="1" format="ascii">80 86 0</Array></FieldData>'
head = head.replace("<UnstructuredGrid>", "<UnstructuredGrid>" + text_of_vtk)
(folder / "lagrange.vtu").write_text(head + 'Name="types"' + rest)

# First order, and bricks.
numbers = [np.arange(len(blocks["tetra10"]))]
linear = meshio.Mesh(mesh.points, [("tetra", blocks["tetra10"][:, :4])], cell_data={"id": numbers})
linear.write(folder / "linear.vtu")
brick = np.array([[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], dtype=float)
meshio.Mesh(brick, [("hexahedron", [list(range(8))])]).write(folder / "brick.inp")
