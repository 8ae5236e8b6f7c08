"""Systems of bodies in joints: flexframe and Exudyn, time against error; writes docs/evidence/systems.md and its picture.

Usage: systems.py FLEXFRAME SYSTEMS PAGE
FLEXFRAME is the program, SYSTEMS the one of crates/verification/src/bin/systems.rs. Exudyn runs in this Python.
"""

import copy
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np

HERE = Path(__file__).parent
ROWS = 20
TOLERANCES = ["0.3", "0.1", "3e-2", "1e-2", "1e-3", "1e-4", "1e-5", "1e-6", "1e-7", "1e-8", "1e-9", "1e-10"]
TARGETS = [1e-3, 1e-5, 1e-7]
SECONDS = 12.0  # of Exudyn's longest run
RADIUS = "0.9"
# Scene, flexible bodies, the body and the point that are followed, the size of the system, Exudyn's fewest steps.
CASES = {
    "Slider-crank": ("slider_crank", ["rod"], "rod", "middle", 0.45, 100),
    "Double pendulum": ("double_pendulum", ["upper", "lower"], "lower", "end", 400.0, 50),
    "Hinged satellite": ("satellite", ["right", "left"], "right", "end", 440.0, 50),
    "Chain": ("chain", ["bar0", "bar1", "bar2", "bar3"], "bar3", "end", 800.0, 50),
}


def run(*words):
    done = subprocess.run(list(map(str, words)), capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"systems: {' '.join(map(str, words))}\n{done.stderr}")
    return [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]


class Run:
    """What a run has found: places and elastic displacements of the point at the rows."""

    def __init__(self, found):
        self.seconds, self.steps = found["seconds"], found["steps"]
        self.places, self.bent = (np.array(found[of]) for of in ("positions", "displacements"))

    def errors(self, limit, size):
        """Errors over the size of the system; and the larger of these and of the errors of the deformation over its largest."""
        place, bent = (
            float(np.max(np.linalg.norm(own - right, axis=1)))
            for own, right in ((self.places, limit.places), (self.bent, limit.bent))
        )
        place /= size
        return place, max(place, bent / float(np.max(np.linalg.norm(limit.bent, axis=1))))

    def against(self, limit, size):
        return (self.seconds, *self.errors(limit, size), self.steps)


def ours(program, case):
    """(seconds, errors, steps) for each tolerance, against the tightest; that run."""
    scene, _, body, point, size, _ = case
    found = [Run(one) for one in run(program, HERE / "systems" / f"{scene}.toml", body, point, ROWS, *TOLERANCES)]
    *others, limit = found
    return [one.against(limit, size) for one in others], limit


def theirs(flexframe, case):
    """The same for twice as many steps each time, against what the two finest lead to by their order, two."""
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
    found = [Run(one) for one in found if one["positions"] is not None]
    coarse, limit = found[-2], copy.copy(found[-1])
    limit.places = limit.places + (limit.places - coarse.places) / 3
    limit.bent = limit.bent + (limit.bent - coarse.bent) / 3
    return [one.against(limit, size) for one in found[:-1]], limit


def seconds_for(runs, kind, target):
    """Seconds at an error of a kind, by a line between logarithms; beyond the ends at most (≤), or by an order of two (≈)."""
    pairs = [(run[0], run[1 + kind]) for run in runs]
    within = [i for i in range(len(pairs)) if all(error <= target for _, error in pairs[i:])]
    if within and within[0] == 0:
        return pairs[0][0], "≤ "
    if within:
        (s0, e0), (s1, e1) = pairs[within[0] - 1], pairs[within[0]]
        part = math.log(e0 / target) / math.log(e0 / e1)
        return s0 * (s1 / s0) ** part, ""
    seconds, error = pairs[-1]
    return seconds * (error / target) ** 0.5, "≈ "


def main():
    flexframe, program, page = sys.argv[1:]
    figure, axes = plt.subplots(1, len(CASES), figsize=(15, 4), sharey=True)
    rows, limits = [], []
    for axis, (name, case) in zip(axes, CASES.items()):
        mine, our_limit = ours(program, case)
        others, their_limit = theirs(flexframe, case)
        place, both = our_limit.errors(their_limit, case[4])
        limits.append(f"| {name} | {place:.1e} | {both:.1e} |")
        for target in TARGETS:
            cells = [name, f"{target:.0e}"]
            for kind in (1, 0):
                (a, how_a), (b, how_b) = seconds_for(mine, kind, target), seconds_for(others, kind, target)
                cells += [f"{how_a}{1e3 * a:.3g}", f"{how_b}{1e3 * b:.3g}", f"{b / a:.3g}"]
            rows.append(f"| {' | '.join(cells)} |")
        for color, who, runs in (("C0", "flexframe", mine), ("C1", "Exudyn", others)):
            for kind, style in enumerate(("o-", "x--")):
                axis.loglog(
                    [one[0] for one in runs],
                    [one[1 + kind] for one in runs],
                    style,
                    color=color,
                    label=who + (", with deformation" if kind else ""),
                )
        axis.set_title(name)
        axis.set_xlabel("processor seconds")
        axis.grid(True, which="major", alpha=0.3)
    axes[0].set_ylabel("error")
    axes[0].legend()
    figure.tight_layout()
    target = Path(page)
    picture = target.parent / "systems" / "exudyn.svg"
    picture.parent.mkdir(exist_ok=True)
    figure.savefig(picture, metadata={"Date": None})
    template = (HERE / "systems" / "page.template").read_text()
    text = template.replace("TIMES", "\n".join(rows)).replace("LIMITS", "\n".join(limits))
    # What other recipes have measured stays.
    _, mark, rest = target.read_text().partition("\n## Random systems\n") if target.exists() else ("", "", "")
    target.write_text(text + mark + rest)


main()
