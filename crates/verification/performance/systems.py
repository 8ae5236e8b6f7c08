"""Systems of bodies in joints: flexframe and Exudyn, time against error; writes docs/evidence/systems.md and its picture.

Usage: systems.py FLEXFRAME SYSTEMS PAGE
FLEXFRAME is the program, SYSTEMS the one of crates/verification/src/bin/systems.rs. Exudyn runs in this Python.
"""

import json
import math
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np

HERE = Path(__file__).parent
ROWS = 20
TOLERANCES = ["1e-2", "1e-3", "1e-4", "1e-5", "1e-6", "1e-7", "1e-8", "1e-9", "1e-10"]
TARGETS = [1e-3, 1e-5, 1e-7]
SECONDS = 12.0  # of Exudyn's longest run
RADIUS = "0.9"
# Scene, flexible bodies, the body and the point that are followed, the size of the system, Exudyn's fewest steps.
CASES = {
    "Slider-crank": ("slider_crank", ["rod"], "rod", "middle", 0.45, 100),
    "Double pendulum": ("double_pendulum", ["upper", "lower"], "lower", "end", 400.0, 50),
    "Hinged satellite": ("satellite", ["right", "left"], "right", "end", 440.0, 50),
}


def run(*words):
    done = subprocess.run(list(map(str, words)), capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"systems: {' '.join(map(str, words))}\n{done.stderr}")
    return [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]


def distance(a, b, size):
    return float(np.max(np.linalg.norm(np.array(a) - np.array(b), axis=1)) / size)


def ours(program, case):
    """(seconds, error) for each tolerance, against the tightest; the positions by the tightest."""
    scene, _, body, point, size, _ = case
    found = run(program, HERE / "systems" / f"{scene}.toml", body, point, ROWS, *TOLERANCES)
    limit = found[-1]["positions"]
    return [(one["seconds"], distance(one["positions"], limit, size), one["steps"]) for one in found[:-1]], limit


def theirs(flexframe, case):
    """(seconds, error) for twice as many steps each time, against what the two finest lead to by their order, two."""
    scene, bodies, body, point, size, steps = case
    path = HERE / "systems" / f"{scene}.toml"
    with tempfile.TemporaryDirectory() as folder:
        for name in bodies:
            target = Path(folder) / f"{name}.body.h5"
            done = subprocess.run(
                [flexframe, "reduce", str(path), "--body", name, "--matrices", "-o", str(target)], capture_output=True, text=True
            )
            if done.returncode != 0:
                sys.exit(f"systems: {done.stderr}")
        found = []
        while not found or found[-1]["seconds"] < SECONDS / 2:
            peer = HERE / "peers/exudyn_system.py"
            found += run(sys.executable, peer, path, folder, body, point, RADIUS, ROWS, steps)
            steps *= 2
    found = [one for one in found if one["positions"] is not None]
    coarse, fine = (np.array(one["positions"]) for one in found[-2:])
    limit = fine + (fine - coarse) / 3
    return [(one["seconds"], distance(one["positions"], limit, size), one["steps"]) for one in found[:-1]], limit


def seconds_for(pairs, target):
    """Seconds at an error, by a line between logarithms; beyond the ends, "at most", or by an order of two, marked."""
    pairs = [(seconds, error) for seconds, error, _ in pairs]
    within = [i for i in range(len(pairs)) if all(error <= target for _, error in pairs[i:])]
    if within and within[0] == 0:
        return pairs[0][0], "at most"
    if within:
        (s0, e0), (s1, e1) = pairs[within[0] - 1], pairs[within[0]]
        part = math.log(e0 / target) / math.log(e0 / e1)
        return s0 * (s1 / s0) ** part, ""
    seconds, error = pairs[-1]
    return seconds * (error / target) ** 0.5, "extrapolated"


def main():
    flexframe, program, page = sys.argv[1:]
    figure, axes = plt.subplots(1, len(CASES), figsize=(12, 4), sharey=True)
    rows, limits, ladders = [], [], []
    for axis, (name, case) in zip(axes, CASES.items()):
        mine, our_limit = ours(program, case)
        others, their_limit = theirs(flexframe, case)
        apart = distance(our_limit, their_limit, case[4])
        limits.append(f"| {name} | {apart:.1e} |")
        for target in TARGETS:
            (a, how_a), (b, how_b) = seconds_for(mine, target), seconds_for(others, target)
            cell = lambda seconds, how: f"{1e3 * seconds:.3g} ms" + (f" ({how})" if how else "")
            rows.append(f"| {name} | {target:.0e} | {cell(a, how_a)} | {cell(b, how_b)} | {b / a:.3g} |")
        for who, pairs in (("flexframe", mine), ("Exudyn", others)):
            axis.loglog([s for s, _, _ in pairs], [e for _, e, _ in pairs], "o-", label=who)
            ladders += [f"| {name} | {who} | {n} | {1e3 * s:.3g} ms | {e:.1e} |" for s, e, n in pairs]
        axis.set_title(name)
        axis.set_xlabel("processor seconds")
        axis.grid(True, which="major", alpha=0.3)
    axes[0].set_ylabel("error over the size of the system")
    axes[0].legend()
    figure.tight_layout()
    target = Path(page)
    picture = target.parent / "systems" / "exudyn.svg"
    picture.parent.mkdir(exist_ok=True)
    figure.savefig(picture, metadata={"Date": None})
    template = (HERE / "systems" / "page.template").read_text()
    text = template.replace("TABLE", "\n".join(rows)).replace("LIMITS", "\n".join(limits)).replace("LADDERS", "\n".join(ladders))
    # What other recipes have measured stays.
    _, mark, rest = target.read_text().partition("\n## Random systems\n") if target.exists() else ("", "", "")
    target.write_text(text + mark + rest)


main()
