"""Frequencies of the dished disc at rest and at 2000 rad/s in CalculiX: its nonlinear rest in the spin, then vibrations with Coriolis forces.

    python dished_disc.py FOLDER      (needs meshio and ccx)
"""

import pathlib
import subprocess
import sys

import meshio
import numpy

SPIN = 2000.0
COUNT = 8

folder = pathlib.Path(sys.argv[1])
folder.mkdir(parents=True, exist_ok=True)
mesh = meshio.read(pathlib.Path(__file__).parent.parent / "meshes" / "dished_disc.msh")
of_kind = lambda kind: numpy.vstack([block.data for block in mesh.cells if block.type == kind])
tetrahedra, hub = of_kind("tetra10"), numpy.unique(of_kind("triangle6"))

lines = ["*NODE,NSET=all"]
lines += ["{},{:.12e},{:.12e},{:.12e}".format(node + 1, *mesh.points[node]) for node in numpy.unique(tetrahedra)]
lines += ["*ELEMENT,TYPE=C3D10,ELSET=disc"]
lines += [",".join(map(str, [number, *(nodes + 1)])) for number, nodes in enumerate(tetrahedra, 1)]
lines += ["*NSET,NSET=hub"] + [f"{node + 1}," for node in hub]
lines += ["*BOUNDARY", "hub,1,3", "*MATERIAL,NAME=steel", "*ELASTIC", "2.1e11,0.3", "*DENSITY", "7800."]
lines += ["*SOLID SECTION,ELSET=disc,MATERIAL=steel"]
spin = ["*DLOAD", f"disc,CENTRIF,{SPIN**2:e},0.,0.,0.,0.,0.,1."]
rest = ["*STEP", "*FREQUENCY", str(COUNT), "*END STEP"]
# The complex modes are sought among 60 real ones.
spinning = ["*STEP,NLGEOM", "*STATIC", *spin, "*END STEP"]
spinning += ["*STEP,PERTURBATION", "*FREQUENCY,STORAGE=YES", "60", *spin, "*END STEP"]
spinning += ["*STEP,PERTURBATION", "*COMPLEX FREQUENCY,CORIOLIS", str(COUNT), *spin, "*END STEP"]

for name, steps in [("rest", rest), ("spinning", spinning)]:
    (folder / name).with_suffix(".inp").write_text("\n".join(lines + steps) + "\n")
    subprocess.run(["ccx", name], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    table = (folder / name).with_suffix(".dat").read_text().split("E I G E N V A L U E   O U T P U T")[-1]
    rows = [row for line in table.splitlines() if (row := line.split())[:1] and row[0].isdigit()][:COUNT]
    # At rest a row has the eigenvalue before both frequencies.
    print(name, *(f"{float(row[-2]):.3f}" for row in rows))
