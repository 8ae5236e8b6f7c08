"""The loop over time: flexframe against Exudyn at the same step and at the same error, and the cost of a row.

Seconds are of processor time, of the loop alone: Exudyn's solver by its process' clock; of flexframe the difference of a
long and a short run.
"""

import json
import math
import sys

from cases import FOLDER
from measure import HERE, PYTHON, Run, flexframe

SCENE = HERE / "tumbling.toml"
MODES = [10, 40]
END = 0.5  # s, of the runs for errors
STEP = 1e-4  # s, of the runs for speed
TARGETS = [1e-3, 1e-6, 1e-9]  # of the attitude at the end, rad
OURS, OURS_SAME = "flexframe", "flexframe (the same equations)"
WITH_ROWS = "flexframe with rows"
ALPHA, RK4 = "generalized-alpha", "RK4"
# Steps of the runs for speed, by modes; of flexframe a tenth as many in the short run. Before a run it looks at the length
# of its steps, for some tenths of a second: both runs are longer than that.
OUR_STEPS = {10: 400_000, 40: 200_000}
THEIR_STEPS = {10: 40_000, 40: 4_000}
# Runs for speed take a second or two each: as many for one of a long run, since a machine that others share is uneven.
TURNS = 3
# The ladder of steps is END / 2^k from here on.
FIRST = {OURS: 5, OURS_SAME: 5, ALPHA: 8, RK4: 9}
FINEST = 15  # of flexframe's ladder, where the error is below the least target
AGREEMENT = 1e-7  # rad, of two programs that solve the same equations in short steps
ROWS = "output.every=1"  # a row after every step, in place of one at the end

# Exudyn's equations have no stiffening by stress, and are given no static shapes.
SETTINGS = {
    OURS: (),
    OURS_SAME: ("--set", "effects.geometric_stiffening=false", "--set", "modes.static_correction=false"),
    WITH_ROWS: ("--set", ROWS),
}


def measure(store, effort):
    FOLDER.mkdir(parents=True, exist_ok=True)
    body = FOLDER / "tumbling.body.h5"
    arguments = ["--set", f"modes.flexible={max(MODES)}", "--matrices", "-o", body, "--overwrite"]
    flexframe("reduce", SCENE, *arguments, cache=cache())
    for modes in MODES:
        for arguments in SETTINGS.values():
            run_ours(modes, STEP, 10, *arguments)  # fills the cache
    for turn in range(TURNS * effort.runs):
        for modes in MODES:
            same_step(store, modes, turn, body)
    for modes in MODES:
        our_ladder(store, modes, OURS)
        our_ladder(store, modes, OURS_SAME)
        for scheme in (RK4, ALPHA):
            their_ladder(store, modes, scheme, body, effort.loop_seconds)
        check(store, modes)


def cache():
    """The modes are not what is measured here."""
    return (FOLDER / "cache").resolve()


def run_ours(modes, step, steps, *arguments):
    """Processor seconds of a whole run, and its attitude at the end."""
    import h5py  # here, since the process that measures memory has to be small

    keys = {"modes.flexible": modes, "time.step": step, "time.end": steps * step}
    if ROWS not in arguments:
        keys["output.interval"] = steps * step
    settings = [word for key, value in keys.items() for word in ("--set", f"{key}={value!r}")]
    folder = FOLDER / "run"
    run = flexframe("run", SCENE, *settings, *arguments, "-o", folder, "--overwrite", cache=cache())
    with h5py.File(folder / "tumbling.h5") as results:
        attitude = matrix_of(*results["attitude"][-1].tolist())
    (folder / "tumbling.h5").unlink()
    return {"seconds": run.processor, "attitude": attitude, "coordinates": len(json.loads(run.output)["body"]["kinds"])}


def run_theirs(modes, scheme, step, steps, body):
    """Processor seconds of Exudyn's solver, and the attitude at the end."""
    run = Run([PYTHON, HERE / "peers/exudyn_loop.py", SCENE, body, modes, scheme, step, steps])
    return json.loads(run.output.splitlines()[-1])


def same_step(store, modes, turn, body):
    """Steps a second of all programs at the same step, in turn."""
    for name, arguments in SETTINGS.items():
        store.once(f"speed, {modes}, {name}, {turn}", lambda: our_speed(modes, arguments))
    for scheme in (ALPHA, RK4):
        store.once(f"speed, {modes}, {scheme}, {turn}", lambda: their_speed(modes, scheme, body))


def our_speed(modes, arguments):
    most = OUR_STEPS[modes]
    long, short = (run_ours(modes, STEP, steps, *arguments) for steps in (most, most // 10))
    return {
        "step_seconds": (long["seconds"] - short["seconds"]) / (most - most // 10),
        "coordinates": long["coordinates"],
    }


def their_speed(modes, scheme, body):
    steps = THEIR_STEPS[modes]
    return {"step_seconds": run_theirs(modes, scheme, STEP, steps, body)["seconds"] / steps, "coordinates": modes}


def our_ladder(store, modes, program):
    """Attitudes at the end with steps of END / 2^k; the finest is the reference."""
    for k in [*range(FIRST[program], FINEST + 1), FINEST + 2]:
        store.once(f"end, {modes}, {program}, {k}", lambda: run_ours(modes, END / 2**k, 2**k, *SETTINGS[program]))


def their_ladder(store, modes, scheme, body, seconds):
    """As long as a run takes no more than this number of seconds."""
    k, took = FIRST[scheme], 0.0
    while 2 * took <= seconds and k <= 17:
        took = store.once(
            f"end, {modes}, {scheme}, {k}", lambda: run_theirs(modes, scheme, END / 2**k, 2**k, body)
        )["seconds"]
        k += 1


def ladder(results, modes, program):
    """Records of a program by k."""
    prefix = f"end, {modes}, {program}, "
    return {int(key.removeprefix(prefix)): record for key, record in results.items() if key.startswith(prefix)}


def errors(results, modes, program):
    """(step, error) from long to short, against the shortest step: of Exudyn, that of RK4."""
    is_reference = program != ALPHA
    refinements = ladder(results, modes, program)
    references = refinements if is_reference else ladder(results, modes, RK4)
    finest = max(references)
    pairs = [(k, angle(refinements[k]["attitude"], references[finest]["attitude"])) for k in sorted(refinements)]
    return [(END / 2**k, error) for k, error in pairs if not (is_reference and k == finest)]


def step_for(steps_and_errors, target, order):
    """The longest step within the target, by a line between the logarithms; and whether it lies beyond what was run."""
    within = [i for i in range(len(steps_and_errors)) if all(e <= target for _, e in steps_and_errors[i:])]
    first = within[0] if within else len(steps_and_errors)
    if first == len(steps_and_errors):
        step, error = steps_and_errors[-1]
        return step * (target / error) ** (1 / order), True
    step, error = steps_and_errors[first]
    if first > 0:
        longer, larger = steps_and_errors[first - 1]
        if math.isfinite(larger) and larger > error:
            step *= (target / error) ** (math.log(longer / step) / math.log(larger / error))
    return step, False


def agreement(results, modes):
    """Angle between the ends of the two programs, which solve the same equations in short steps, rad."""
    theirs, ours = ladder(results, modes, RK4), ladder(results, modes, OURS_SAME)
    return angle(ours[max(ours)]["attitude"], theirs[max(theirs)]["attitude"])


def check(store, modes):
    """Exits where the two programs do not agree."""
    found = agreement(store.results, modes)
    if not found <= AGREEMENT:  # NaN too
        sys.exit(f"performance: {modes} modes: flexframe and Exudyn end {found:.1e} rad apart, more than {AGREEMENT}")


def matrix_of(w, x, y, z):
    """Row by row, from body to global."""
    return [
        *(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        *(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        *(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    ]


def angle(a, b):
    """Between two attitudes, rad."""
    product = [[sum(a[3 * i + k] * b[3 * j + k] for k in range(3)) for j in range(3)] for i in range(3)]
    sine = [product[(i + 2) % 3][(i + 1) % 3] - product[(i + 1) % 3][(i + 2) % 3] for i in range(3)]
    return math.atan2(math.hypot(*sine), sum(product[i][i] for i in range(3)) - 1)
