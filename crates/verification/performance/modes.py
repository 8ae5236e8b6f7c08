"""Twenty modes, as whole processes: flexframe against SciPy + CHOLMOD, SLEPc + MUMPS and CalculiX."""

import json
import sys

from cases import FOLDER, Case
from measure import HERE, PYTHON, PYTHON_OF_SLEPC, Run, flexframe

MODES = 20
OURS, OURS_2 = "flexframe", "flexframe, 2 threads"
SCIPY, SLEPC, SLEPC_2, CALCULIX = "SciPy + CHOLMOD", "SLEPc + MUMPS", "SLEPc + MUMPS, 2 ranks", "CalculiX"
PEERS = [SCIPY, SLEPC, SLEPC_2, CALCULIX]
# Relative, of a frequency. CalculiX prints seven digits.
TOLERANCE = {SCIPY: 1e-6, SLEPC: 1e-6, SLEPC_2: 1e-6, OURS_2: 1e-12, CALCULIX: 2e-5}

# Mesh; what the peers are told of it: the first frequency (Hz), which flexframe finds for itself, and the ordering of
# CHOLMOD's that takes the least time in all.
CASES = [
    ("plate", 10, 24.5, "amd"),
    ("plate", 6, 24.5, "amd"),
    ("plate", 4.2, 24.5, "amd"),
    ("block", 3.7, 13400, "metis"),
]


def measure(store, effort):
    """All programs in turn, `effort.runs` times; one that takes longer than `effort.once` seconds only once."""
    for shape, size, frequency, ordering in CASES:
        case = Case(shape, size)
        for turn in range(effort.runs):
            for program, run in programs(case, frequency, ordering, effort.patience).items():
                first = store.results.get(f"{case.name}, {program}, 0")
                if turn == 0 and first and was_stopped(first) and first["seconds"] < effort.patience:
                    del store.results[f"{case.name}, {program}, 0"]
                if turn > 0 and (first["seconds"] > effort.once or was_stopped(first)):
                    continue
                store.once(f"{case.name}, {program}, {turn}", run)
        check(store, case)


def programs(case, frequency, ordering, patience):
    """Functions that run each program on a case and return its record."""
    peers = HERE / "peers"
    told = [case.scene, MODES, frequency]
    slepc = [PYTHON_OF_SLEPC, peers / "slepc_modes.py", *told]
    two_ranks = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", 2, *slepc]
    return {
        OURS: lambda: ours(case, 1),
        SCIPY: lambda: peer([PYTHON, peers / "scipy_modes.py", *told, ordering], patience),
        SLEPC: lambda: peer(slepc, patience),
        OURS_2: lambda: ours(case, 2),
        SLEPC_2: lambda: peer(two_ranks, patience),
        CALCULIX: lambda: calculix(case, patience),
    }


def was_stopped(record):
    """It had no patience left."""
    return not record["frequencies"]


def ours(case, threads):
    run = flexframe("modes", case.scene, "-n", MODES, threads=threads)
    answer = json.loads(run.output)
    mesh = {key: answer["mesh"][key] for key in ("nodes", "unknowns", "factor_entries", "peak_bytes")}
    return run.record(frequencies=answer["body"]["natural_frequencies"], times=answer["times"], mesh=mesh)


def peer(command, patience):
    run = Run(command, patience)
    if run.output is None:
        return run.record(frequencies=None)
    answer = json.loads(run.output)
    memory = answer.get("memory", run.memory)
    return run.record() | {"frequencies": answer["natural_frequencies"], "times": answer["times"], "memory": memory}


def calculix(case, patience):
    job = FOLDER / case.scene.stem
    Run([PYTHON, HERE / "peers/calculix_deck.py", case.scene, MODES, f"{job}.inp"])
    run = Run(["ccx", job.name], patience, folder=FOLDER)
    if run.output is None:
        return run.record(frequencies=None)
    table = (job.with_name(job.name + ".dat")).read_text().split("P A R T I C I P A T I O N")[0]
    # "      7   0.1083371E+06   0.3291460E+03   0.5238521E+02   0.0000000E+00": the third number is in cycles.
    rows = [line.split() for line in table.splitlines() if len(line.split()) == 5 and line.split()[0].isdigit()]
    return run.record(frequencies=[float(row[3]) for row in rows[6:]])


def difference(record, reference):
    """Largest relative difference of the frequencies; infinite where they are not as many."""
    ours, theirs = reference["frequencies"], record["frequencies"]
    if not len(ours) == len(theirs) == MODES:
        return float("inf")
    return max(abs(a / b - 1) for a, b in zip(theirs, ours))


def check(store, case):
    """Exits where a program has other frequencies than flexframe."""
    reference = store.results[f"{case.name}, {OURS}, 0"]
    for key, record in store.results.items():
        name, program, _ = split(key)
        if name != case.name or program == OURS or was_stopped(record):
            continue
        found = difference(record, reference)
        if not found <= TOLERANCE[program]:  # NaN too
            sys.exit(
                f"performance: {key}: frequencies differ from flexframe's by {found:.1e}, more than {TOLERANCE[program]}"
            )


def split(key):
    """Case, program and turn of a key."""
    name, rest = key.split(", ", 1)
    program, turn = rest.rsplit(", ", 1)
    return name, program, int(turn)
