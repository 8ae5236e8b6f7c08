"""Systems of bodies in joints by the schemes radau and rkmk4: processor time at equal error.

Usage: schemes.py SYSTEMS
SYSTEMS is the program of crates/verification/src/bin/systems.rs. Prints a table; errors are those of a point at 20 times over the size of the
system, against radau at a tolerance of 1e-11. The runs of both schemes of a case follow each other.
"""

import json
import math
import re
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROWS = 20
TOLERANCES = ["1e-2", "1e-3", "1e-4", "1e-5", "1e-6", "1e-7", "1e-8", "1e-9", "1e-10"]
TARGETS = [1e-3, 1e-5, 1e-7]
# Scene, what is changed in it, the body and the point that are followed, the size.
CASES = {
    "double pendulum, rigid": ("double_pendulum", [(r"flexible = \d+", "flexible = 0")], "lower", "end", 400.0),
    "satellite, rigid": ("satellite", [(r"flexible = \d+", "flexible = 0")], "right", "end", 440.0),
    "satellite, E/100": ("satellite", [("young_modulus = 70e3", "young_modulus = 700")], "right", "end", 440.0),
    "double pendulum, as it is": ("double_pendulum", [], "lower", "end", 400.0),
}


def ladder(program, case):
    scene, changes, body, point, size = case
    text = (HERE / "systems" / f"{scene}.toml").read_text()
    for pattern, value in changes:
        text = re.sub(pattern, value, text)
    meshes = (HERE / "../../../meshes").resolve()
    text = text.replace("../../../../meshes", str(meshes))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.toml"
        path.write_text(text)
        asked = ["radau:1e-11"] + [f"{scheme}:{t}" for scheme in ("radau", "rkmk4") for t in TOLERANCES]
        words = [str(program), str(path), body, point, str(ROWS), *asked]
        done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"schemes: {' '.join(words)}\n{done.stderr}")
    found = [json.loads(line) for line in done.stdout.splitlines()]
    limit = found[0]["positions"]

    def off(one):
        return max(math.dist(a, b) for a, b in zip(one["positions"], limit)) / size

    return [(one["scheme"], one["seconds"], off(one), one["steps"]) for one in found[1:]]


def at(points, target):
    """Seconds at an error, by a line of the logarithms between the runs around it; none where no run is as exact."""
    best = None
    for (_, s0, e0, _), (_, s1, e1, _) in zip(points, points[1:]):
        if e0 >= target > e1 > 0:
            part = math.log(e0 / target) / math.log(e0 / e1)
            best = math.exp(math.log(s0) + part * math.log(s1 / s0))
    if best is None and points[0][2] < target:
        best = points[0][1]
    return best


def main(program):
    print("| case | error | radau, ms | rkmk4, ms | rkmk4 over radau |\n|---|---|---|---|---|")
    for name, case in CASES.items():
        found = ladder(program, case)
        for target in TARGETS:
            radau, rkmk4 = (at([one for one in found if one[0] == scheme], target) for scheme in ("radau", "rkmk4"))
            shown = [f"{1e3 * s:.2g}" if s else "–" for s in (radau, rkmk4)]
            ratio = f"{rkmk4 / radau:.2g}" if radau and rkmk4 else "–"
            print(f"| {name} | {target:.0e} | {shown[0]} | {shown[1]} | {ratio} |")


main(Path(sys.argv[1]))
