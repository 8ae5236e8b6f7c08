"""Tables of docs/evidence/performance.md about the loop over time."""

from statistics import median

import loop
from page import summary
from page.markdown import number, ratio, table


def speeds_by_modes(results):
    """{modes: {program: [seconds of a step by turn]}}."""
    speeds = {}
    for key, record in results.items():
        if key.startswith("speed, "):
            count, rest = key.removeprefix("speed, ").split(", ", 1)
            program = rest.rsplit(", ", 1)[0]
            speeds.setdefault(int(count), {}).setdefault(program, []).append(record["step_seconds"])
    return speeds


def steps_a_second(times):
    rates = [1 / time for time in times]
    middle, width = summary.of(rates)
    return f"{number(round(middle))} ± {number(round(width))}"


def speed_table(speeds):
    rows = []
    for program in (loop.OURS, loop.OURS_SAME, loop.ALPHA, loop.RK4):
        cells = [program if program in (loop.OURS, loop.OURS_SAME) else f"Exudyn, {program}"]
        for count in loop.MODES:
            cells.append(steps_a_second(speeds[count][program]))
            is_reference = program == loop.OURS
            cells.append(
                "" if is_reference else ratio(summary.ratios(speeds[count][program], speeds[count][loop.OURS]))
            )
        rows.append(cells)
    head = ["steps a second"]
    for count in loop.MODES:
        head += [f"{count} modes", "step ÷ flexframe's"]
    return table(head, rows)


def row_table(speeds):
    rows = []
    for count in loop.MODES:
        pairs = list(zip(speeds[count][loop.OURS], speeds[count][loop.WITH_ROWS]))
        steps, differences = [step for step, _ in pairs], [with_row - step for step, with_row in pairs]
        shares = [100 * (with_row / step - 1) for step, with_row in pairs]
        share = f"**{median(shares):.0f} %** ({min(shares):.0f} to {max(shares):.0f} %)"
        rows.append([count, f"{1e6 * median(steps):.2f}", f"{1e6 * median(differences):.2f}", share])
    return table(["modes", "a step, µs", "a row, µs", "row ÷ step, turn by turn"], rows, left=0)


def cost(results, speeds, count, program, target):
    """Step, processor seconds for a second of motion, and whether it is extrapolated."""
    order = 2 if program == loop.ALPHA else 4
    step, is_extrapolated = loop.step_for(loop.errors(results, count, program), target, order)
    return step, summary.of(speeds[count][program])[0] / step, is_extrapolated


def error_table(results, speeds):
    rows = []
    for count in loop.MODES:
        for target in loop.TARGETS:
            found = {program: cost(results, speeds, count, program, target) for program in loop.FIRST}
            exudyn = min(found[scheme][1] for scheme in (loop.ALPHA, loop.RK4))
            cells = [
                f"{'≈ ' if is_extrapolated else ''}{seconds_of_motion(time)} ({step:.1e})"
                for step, time, is_extrapolated in found.values()
            ]
            factors = [f"{exudyn / found[ours][1]:.1f}" for ours in (loop.OURS, loop.OURS_SAME)]
            rows.append([count, f"{target:.0e}", *cells, *factors])
    head = [
        "modes",
        "error, rad",
        *(program if "flexframe" in program else f"Exudyn, {program}" for program in loop.FIRST),
    ]
    return table([*head, "ratio", "ratio (the same equations)"], rows, left=0)


def seconds_of_motion(time):
    if time < 1:
        return f"{1e3 * time:.3g} ms"
    return f"{time:.3g} s" if time < 100 else f"{time:.0f} s"


def better(speed):
    """How many times the step of Exudyn's better scheme takes that of flexframe: the ratio in `speed_table`."""
    return min(summary.ratios(speed[scheme], speed[loop.OURS])[0] for scheme in (loop.ALPHA, loop.RK4))
