"""The bodies: gmsh makes their meshes of any size, once."""

import re
import subprocess
from pathlib import Path

from measure import HERE

FOLDER = Path("target/performance")

BLOCK = """title = "A free block of aluminium, 100 x 80 x 60 mm"
units = { length = "mm", mass = "Mg", time = "s" }

[body]
mesh = "block.msh"
material = { young_modulus = 70000.0, poisson_ratio = 0.33, density = 2.7e-9 }

[modes]
flexible = 20

[time]
end = 1.0
step = 1e-4
"""


class Case:
    """A body with a mesh of one size: `scene` is its scene file."""

    def __init__(self, shape, size):
        self.name = f"{shape} {size}"
        self.shape, self.size = shape, size
        FOLDER.mkdir(parents=True, exist_ok=True)
        stem = FOLDER / f"{shape}_{size}"
        self.scene, mesh = stem.with_name(stem.name + ".toml"), stem.with_name(stem.name + ".msh")
        geometry = {"plate": Path("meshes/plate.geo"), "block": HERE / "block.geo"}[shape].read_text()
        scene = {"plate": Path("examples/plate.toml").read_text(), "block": BLOCK}[shape]
        self.scene.write_text(re.sub("(?m)^mesh = .*", f'mesh = "{mesh.name}"', scene))
        geo, geometry = mesh.with_suffix(".geo"), re.sub("(MeshSize(Min|Max)) = .*;", rf"\1 = {size};", geometry)
        if not mesh.exists() or geo.read_text() != geometry:
            geo.write_text(geometry)
            part = mesh.with_suffix(".part.msh")
            subprocess.run(["gmsh", "-3", "-format", "msh41", "-v", "2", geo, "-o", part], check=True)
            part.replace(mesh)
