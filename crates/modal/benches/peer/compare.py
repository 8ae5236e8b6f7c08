"""Runs peer.py and `flexframe modes` in turn, checks that their frequencies agree, and prints a table.

Usage: compare.py FOLDER SIZE...        (FOLDER holds plate_SIZE.msh and plate_SIZE.toml)
"""

import json
import os
import platform
import subprocess
import sys
import time
from pathlib import Path

RUNS = 3
MODES = 20
TOLERANCE = 1e-6  # of a frequency, relative

PEER = Path(__file__).with_name("peer.py")
FLEXFRAME = "target/release/flexframe"
ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "RAYON")}


class Program:
    """One program on one mesh: the seconds of each of its whole processes, and its answer."""

    def __init__(self, *command):
        self.command = [str(word) for word in command]
        self.environment = openblas_kernels() | os.environ | ONE_THREAD
        self.wall, self.user, self.answers = [], [], []

    def run(self):
        begin = time.perf_counter()
        process = subprocess.Popen(self.command, stdout=subprocess.PIPE, env=self.environment)
        output = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        self.wall.append(time.perf_counter() - begin)
        self.user.append(usage.ru_utime)
        if process.returncode != 0:
            sys.exit(f"bench-modes: `{' '.join(self.command)}` failed")
        self.answers.append(json.loads(output))

    def seconds(self):
        """Least wall time with the spread of the runs, and least user time."""
        least = min(self.wall)
        return f"{least:7.2f} +{max(self.wall) - least:5.2f} {min(self.user):7.2f}"

    def phases(self):
        """Where the time of the fastest run went."""
        times = self.answers[self.wall.index(min(self.wall))]["times"]
        return ", ".join(f"{name} {seconds:.2f}" for name, seconds in dict(times).items() if name != "total")


def difference(peer, ours):
    """Largest relative difference of the frequencies over all runs; exits if it is too large."""
    worst = 0.0
    for theirs, our in zip(peer.answers, ours.answers):
        reference, found = theirs["natural_frequencies"], our["body"]["natural_frequencies"]
        if not len(reference) == len(found) == MODES:
            sys.exit(f"bench-modes: SciPy found {len(reference)} modes and flexframe {len(found)}, not {MODES}")
        for mode, (a, b) in enumerate(zip(reference, found), start=7):
            relative = abs(b / a - 1)
            if not relative <= TOLERANCE:  # NaN too
                sys.exit(f"bench-modes: mode {mode} is {a!r} Hz by SciPy and {b!r} Hz by flexframe ({relative:.1e})")
            worst = max(worst, relative)
    return worst


def of_processor(key):
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    return next((line.split(":")[1].strip() for line in lines if line.startswith(key)), "")


def openblas_kernels():
    """The OpenBLAS kernels for this processor, as environment.

    Debian's OpenBLAS 0.3.21 does not know processors younger than itself and then falls back to SSE3
    ("Prescott") without a word, which costs CHOLMOD half of its speed.
    """
    flags = set(of_processor("flags").split())
    if {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"} <= flags:
        return {"OPENBLAS_CORETYPE": "SkylakeX"}
    if {"avx2", "fma"} <= flags:
        return {"OPENBLAS_CORETYPE": "Haswell"}
    return {}


def main(folder, sizes):
    rows, phases = [], []
    for size in sizes:
        peer = Program(sys.executable, PEER, folder / f"plate_{size}.msh")
        ours = Program(FLEXFRAME, "--threads", 1, "modes", folder / f"plate_{size}.toml", "-n", MODES, "--json")
        for turn in range(RUNS):
            print(f"bench-modes: size {size}, run {turn + 1} of {RUNS}", file=sys.stderr)
            peer.run()
            ours.run()
        worst = difference(peer, ours)
        mesh = ours.answers[0]["mesh"]
        wall, user = min(peer.wall) / min(ours.wall), min(peer.user) / min(ours.user)
        rows.append(
            f"{size:>4} {mesh['nodes']:7} {mesh['unknowns']:8}  {peer.seconds()}  {ours.seconds()}"
            f"  {wall:5.2f} {user:5.2f}  {worst:.0e}"
        )
        phases += [f"{size:>4} SciPy      {peer.phases()}", f"     flexframe  {ours.phases()}"]

    version = subprocess.run([FLEXFRAME, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    answer = peer.answers[0]
    print(f"The plate's {MODES} lowest flexible modes: whole process, one thread, least of {RUNS} runs in turn, seconds.")
    print(f"{of_processor('model name')}, {os.cpu_count()} cores; load {os.getloadavg()[0]:.1f}; Python {platform.python_version()}")
    print(", ".join([version, *(f"{name} {number}" for name, number in answer["versions"].items())]))
    print(", ".join([*answer["libraries"], *(f"{name}={kind}" for name, kind in openblas_kernels().items())]))
    print()
    print("                       SciPy wall spread user  flexframe wall spread user  SciPy/flexframe  frequencies")
    print("size   nodes unknowns     min     max-min min     min     max-min min       wall  user   differ by")
    print("\n".join(rows))
    print("\nWhere the fastest run of each spent its time, by its own clock:")
    print("\n".join(phases))


main(Path(sys.argv[1]), sys.argv[2:])
