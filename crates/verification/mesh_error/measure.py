"""Estimated errors of frequencies against true ones: coarse meshes beside a fine one. Makes docs/evidence/mesh-error.md.

usage: measure.py FLEXFRAME PAGE
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

MESHES = Path(__file__).resolve().parents[3] / "meshes"
CLAMP = '[[constraints]]\nkind = "clamp"\ngroup = "root"\n'
# Name, geometry, constraint, Poisson's ratio, coarse sizes, fine size.
CASES = [
    ("bar, clamped, 10 mm square", "rotating_bar", CLAMP, 0.0, [20, 10, 5], 2.2),
    ("bar, free, 10 mm square", "rotating_bar", "", 0.3, [20, 10, 5], 2.2),
    ("plate, free, 10 mm thick", "plate", "", 0.33, [60, 30, 15], 6),
    ("ring, free, curved, 20 mm square", "ring", "", 0.3, [20, 10, 5], 2.5),
]
MODES = 8
SCENE = """title = "Error of the mesh"
units = {{ length = "mm", mass = "Mg", time = "s" }}
[body]
mesh = "{mesh}"
material = {{ young_modulus = 70000.0, poisson_ratio = {nu}, density = 2.7e-9 }}
[modes]
flexible = {modes}
{constraint}
[time]
end = 0.01
tolerance = 1e-6
"""
HEAD = """# The error that a mesh makes

Made by `./dev mesh-error`: the estimated error of each frequency (Eq. (M15) of [the modes](../method/modes.md), `mesh_errors` of
`flexframe modes --json`) beside the true one, the difference to the frequency of the same shape on a fine mesh (a MAC of 0.9 or more,
`--mac`). The ratio is estimate over truth: its least, its median and its largest of the {modes} lowest modes.

| body | size of elements, mm | nodes | largest true error, % | estimate over truth |
|---|---|---|---|---|
"""
TAIL = """
On meshes that resolve the bending of the body the estimate is a half to nine tenths of the truth. With fewer than two elements across a wall,
single modes (torsion above all) are up to ten times worse than the estimate. A frequency whose estimate is above a per cent calls for a finer
mesh; one that has to be right to a tenth of a per cent wants an estimate of 0.05 % or less.
"""


def mesh(folder, name, size):
    text = (MESHES / f"{name}.geo").read_text()
    keep = [line for line in text.splitlines() if "MeshSizeM" not in line]
    keep += [f"Mesh.MeshSizeMin = {size};", f"Mesh.MeshSizeMax = {size};"]
    geometry, file = folder / f"{name}_{size}.geo", folder / f"{name}_{size}.msh"
    geometry.write_text("\n".join(keep) + "\n")
    command = ["gmsh", "-3", "-order", "2", "-format", "msh41", "-v", "1", geometry, "-o", file]
    subprocess.run(command, check=True)
    return file


def rows(flexframe):
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for title, geometry, constraint, nu, sizes, fine in CASES:
            other = mesh(folder, geometry, fine)
            for size in sizes:
                scene = folder / "scene.toml"
                file = mesh(folder, geometry, size)
                scene.write_text(SCENE.format(mesh=file, nu=nu, modes=MODES, constraint=constraint))
                command = [flexframe, "modes", scene, "--mac", other, "--json"]
                report = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
                mac = report["mac"]
                pairs = []
                for k, frequency in enumerate(report["body"]["natural_frequencies"]):
                    nearest = mac["nearest"][k] - 1
                    if mac["mac"][k][nearest] >= 0.9:
                        truth = frequency / mac["frequencies"][nearest] - 1
                        pairs.append((truth, report["strain_energy"]["mesh_errors"][k] / truth))
                ratios = sorted(ratio for _, ratio in pairs)
                worst = 100 * max(truth for truth, _ in pairs)
                low, middle, high = ratios[0], ratios[len(ratios) // 2], ratios[-1]
                yield (
                    f"| {title} | {size} | {report['mesh']['nodes']} | {worst:.2g} | "
                    f"{low:.2f}, {middle:.2f}, {high:.2f} |\n"
                )


def main():
    flexframe, page = sys.argv[1:]
    table = "".join(rows(flexframe))
    Path(page).write_text(HEAD.format(modes=MODES) + table + TAIL)


if __name__ == "__main__":
    main()
