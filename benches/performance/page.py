"""Writes docs/performance.md and its figures from the raw results."""

import json
import sys
from pathlib import Path
from string import Template

import figures
import loop
import modes
import summary
from measure import HERE
from store import FOLDER

PAGE = Path("docs/performance.md")


def write():
    """Where all parts have been measured; else says what is missing."""
    parts = {}
    for part in ("modes", "size", "loop"):
        file = FOLDER / f"{part}.json"
        if not file.exists():
            print(f"performance: no page yet: nothing has been measured of `{part}`", file=sys.stderr)
            return
        parts[part] = json.loads(file.read_text())
    of_modes, of_size, of_loop = (parts[part]["results"] for part in ("modes", "size", "loop"))
    folder = PAGE.with_suffix("")
    folder.mkdir(exist_ok=True)
    cases = modes_by_case(of_modes)
    sizes = runs_by_size(of_size)
    speeds = speeds_by_modes(of_loop)
    figures.modes(cases, folder / "modes.svg")
    figures.size(sizes, cases, folder / "size.svg")
    figures.phases(sizes, folder / "phases.svg")
    figures.loop(of_loop, speeds, folder / "loop.svg")
    unknowns = [runs[0]["mesh"]["unknowns"] for by_size in sizes.values() for runs in by_size]
    agreement = max(loop.agreement(of_loop, count) for count in loop.MODES)
    words = {
        "about": about(parts),
        "method": method(parts),
        "short": short(cases, speeds),
        "lost": lost(cases, of_loop, speeds),
        "matrices_file": "`benches/performance/peers/matrices.py`",
        "modes": "\n\n".join(table_of_case(name, programs) for name, programs in cases.items()),
        "least": number(min(unknowns)),
        "most": number(max(unknowns)),
        "size": size_table(sizes),
        "slopes": slopes(sizes),
        "phases": phase_table(sizes),
        "agreement": f"{agreement:.0e}",
        "step": f"{loop.STEP:g}",
        "speed": speed_table(speeds),
        "rows": row_table(speeds),
        "end": f"{loop.END:g}",
        "errors": error_table(of_loop, speeds),
    }
    PAGE.write_text(Template((HERE / "page.md").read_text()).substitute(words))
    print(PAGE, *sorted(folder.glob("*.svg")), sep="\n")


def table(head, rows, left=1):
    """Markdown; the first `left` columns to the left, the others to the right."""
    line = lambda cells: f"| {' | '.join(map(str, cells))} |"
    return "\n".join([line(head), "|" + "---|" * left + "---:|" * (len(head) - left), *map(line, rows)])


def number(value):
    """28311 as 28 311."""
    return f"{value:,}".replace(",", " ")


def seconds(value):
    return f"{value:.2f}" if value < 100 else f"{value:.0f}"


def spread(values):
    middle, width = summary.of(values)
    return f"{seconds(middle)} ± {seconds(width)}" if len(values) > 1 else seconds(middle)


def ratio(values):
    """Median and range."""
    middle, least, largest = values
    return f"**{middle:.2f}** ({least:.2f} to {largest:.2f})" if least < largest else f"**{middle:.2f}**"


def about(parts):
    first = parts["modes"]
    machine, versions = first["machine"], first["versions"]
    names = ", ".join(f"{name} {version}" for name, version in versions.items())
    builds = {part["program"] for part in parts.values()}
    programs = first["version"] if len(builds) == 1 else f"{first['version']} (in {len(builds)} builds: not all parts by the same)"
    dates = " to ".join(sorted({part["date"] for part in parts.values()}))
    return (
        f"Measured {dates} with {programs} on {machine['processor']}, {machine['cores']} cores, "
        f"{machine['memory'] / 1e9:.0f} GB, {machine['system']}. `./dev performance` installs the others, measures again and writes this page.\n\n"
        f"Versions: {names}; OpenBLAS kernels: {machine['openblas_kernels']}."
    )


def method(parts):
    loads = [record["load"] for part in parts.values() for record in part["results"].values()]
    efforts = {part["effort"]["runs"] for part in parts.values()}
    once, patience = parts["modes"]["effort"]["once"], parts["modes"]["effort"]["patience"]
    return (
        f"**Method.** The programs run in turn, {' or '.join(map(str, sorted(efforts)))} times each; those that take longer than {once} s once, "
        f"and those that take longer than {patience} s are stopped. \"± s\" is the difference of the slowest and the fastest run, beside the median. "
        "A ratio is a run of the other program divided by the run of flexframe of the same turn: median, and least to largest. "
        "Above 1 flexframe is faster, or smaller. Each program runs on one thread unless it says otherwise. Memory is the peak of the whole process "
        f"(of both ranks together). The load of the machine, these runs with it, was {min(loads):.1f} to {max(loads):.1f}."
    )


# Modes


def modes_by_case(results):
    """{case: {program: [records by turn]}}, in the order of the cases."""
    cases = {}
    for key, record in results.items():
        name, program, _ = modes.split(key)
        cases.setdefault(name, {}).setdefault(program, []).append(record)
    return cases


def against(programs, program, what):
    """Ratios of a program to flexframe on as many threads."""
    ours = programs[modes.OURS_2 if program == modes.SLEPC_2 else modes.OURS]
    return summary.ratios([run[what] for run in programs[program]], [run[what] for run in ours])


def ran(programs, program):
    return program in programs and not modes.was_stopped(programs[program][0])


def heading(name, programs):
    mesh = programs[modes.OURS][0]["mesh"]
    shape, gmsh = name.split()
    return f"{shape}, gmsh {gmsh}: {number(mesh['unknowns'])} unknowns"


def table_of_case(name, programs):
    rows = []
    for program in (modes.OURS, modes.OURS_2, *modes.PEERS):
        if program not in programs:
            continue
        runs = programs[program]
        if modes.was_stopped(runs[0]):
            rows.append([program, f"more than {runs[0]['seconds']:.0f}", "–", "–", "–", "–", "–"])
            continue
        difference = max(modes.difference(run, programs[modes.OURS][0]) for run in runs)
        is_reference = program == modes.OURS
        rows.append(
            [
                program,
                spread([run["seconds"] for run in runs]),
                seconds(summary.of(run["processor"] for run in runs)[0]),
                "" if is_reference else ratio(against(programs, program, "seconds")),
                f"{summary.of(run['memory'] for run in runs)[0] / 1e6:.0f}",
                "" if is_reference else ratio(against(programs, program, "memory")),
                "" if is_reference else f"{difference:.0e}",
            ]
        )
    head = ["program", "time, s", "processor, s", "time ÷ flexframe's", "memory, MB", "memory ÷ flexframe's", "frequencies differ"]
    fastest = [fastest_phases(program, programs) for program in (modes.OURS, modes.SCIPY, modes.SLEPC) if ran(programs, program)]
    words = f"In the fastest run: {'; '.join(fastest)}."
    return f"**{heading(name, programs).capitalize()}**\n\n{table(head, rows)}\n\n{words}"


def fastest_phases(program, programs):
    run = min(programs[program], key=lambda run: run["seconds"])
    return f"{program}: " + ", ".join(f"{name} {time:.2f}" for name, time in run["times"].items())


def short(cases, speeds):
    head = ["time ÷ flexframe's", *modes.PEERS, "flexframe: one thread ÷ two"]
    rows = []
    for name, programs in cases.items():
        cells = [f"{against(programs, peer, 'seconds')[0]:.2f}" if ran(programs, peer) else "–" for peer in modes.PEERS]
        two = summary.ratios(*([run["seconds"] for run in programs[which]] for which in (modes.OURS, modes.OURS_2)))
        rows.append([heading(name, programs), *cells, f"{two[0]:.2f}"])
    of_modes = table(head, rows)
    of_loop = [
        f"{count} modes: {better(speeds[count]):.1f} times as many steps a second as Exudyn's better scheme"
        for count in loop.MODES
    ]
    return f"{of_modes}\n\nSLEPc on two ranks is divided by flexframe on two threads. The loop: {'; '.join(of_loop)}."


def better(speed):
    """How many times the step of Exudyn's better scheme takes that of flexframe."""
    return min(summary.of(speed[scheme])[0] for scheme in (loop.ALPHA, loop.RK4)) / summary.of(speed[loop.OURS])[0]


def lost(cases, results, speeds):
    """What flexframe is not better in, in words."""
    words = []
    for name, programs in cases.items():
        for peer in modes.PEERS:
            for what, noun in (("seconds", "time"), ("memory", "memory")):
                if ran(programs, peer) and against(programs, peer, what)[0] < 1:
                    part = against(programs, peer, what)[0]
                    words.append(f"{heading(name, programs)}: {peer} takes {part:.2f} of flexframe's {noun}")
    for count in loop.MODES:
        for target in loop.TARGETS:
            costs = {program: cost(results, speeds, count, program, target)[1] for program in loop.FIRST}
            best = min((loop.ALPHA, loop.RK4), key=costs.get)
            for ours in (loop.OURS, loop.OURS_SAME):
                if costs[best] < costs[ours]:
                    part = costs[best] / costs[ours]
                    words.append(f"{count} modes to {target:.0e} rad: Exudyn's {best} takes {part:.2f} of the time of {ours}")
    return "; ".join(words) + "." if words else "None of the cases measured here."


# Size


def runs_by_size(results):
    """{shape: [[records by turn] by size]}."""
    sizes = {}
    for key, record in results.items():
        shape = key.split()[0]
        sizes.setdefault(shape, {}).setdefault(record["mesh"]["unknowns"], []).append(record)
    return {shape: [by_size[unknowns] for unknowns in sorted(by_size)] for shape, by_size in sizes.items()}


def size_table(sizes):
    rows = []
    for shape, by_size in sizes.items():
        for runs in by_size:
            mesh = runs[0]["mesh"]
            taken = summary.of(run["memory"] for run in runs)[0]
            rows.append(
                [
                    shape,
                    number(mesh["unknowns"]),
                    f"{mesh['factor_entries'] / 1e6:.1f}",
                    spread([run["seconds"] for run in runs]),
                    seconds(summary.of(run["processor"] for run in runs)[0]),
                    f"{mesh['peak_bytes'] / 1e6:.0f}",
                    f"{taken / 1e6:.0f}",
                    f"{100 * (mesh['peak_bytes'] / taken - 1):+.0f} %",
                ]
            )
    head = ["body", "unknowns", "factor, 10⁶ entries", "time, s", "processor, s", "foretold, MB", "taken, MB", "foretold ÷ taken − 1"]
    return table(head, rows)


def slopes(sizes):
    words = []
    for shape, by_size in sizes.items():
        points = {
            "time": [(runs[0]["mesh"]["unknowns"], summary.of(run["seconds"] for run in runs)[0]) for runs in by_size],
            "memory": [(runs[0]["mesh"]["unknowns"], summary.of(run["memory"] for run in runs)[0]) for runs in by_size],
            "factor": [(runs[0]["mesh"]["unknowns"], runs[0]["mesh"]["factor_entries"]) for runs in by_size],
        }
        powers = [f"{name} N^{summary.slope(values):.2f}" for name, values in points.items()]
        words.append(f"{shape}: {', '.join(powers)}")
    return f"Slopes in log-log over all sizes (N unknowns): {'; '.join(words)}."


def phase_table(sizes):
    names = list(dict.fromkeys(name for by_size in sizes.values() for runs in by_size for name in runs[0]["times"]))
    rows = []
    for shape, by_size in sizes.items():
        for runs in by_size:
            cells = [summary.of(run["times"].get(name, 0.0) for run in runs)[0] for name in names]
            rows.append([shape, number(runs[0]["mesh"]["unknowns"]), *map(seconds, cells)])
    return table(["body", "unknowns", *names], rows)


# The loop


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
            cells.append("" if is_reference else ratio(summary.ratios(speeds[count][program], speeds[count][loop.OURS])))
        rows.append(cells)
    head = ["steps a second"]
    for count in loop.MODES:
        head += [f"{count} modes", "step ÷ flexframe's"]
    return table(head, rows)


def row_table(speeds):
    rows = []
    for count in loop.MODES:
        step, with_row = (summary.of(speeds[count][name])[0] for name in (loop.OURS, loop.WITH_ROWS))
        rows.append([count, f"{1e6 * step:.2f}", f"{1e6 * (with_row - step):.2f}", f"{100 * (with_row / step - 1):.0f} %"])
    return table(["modes", "a step, µs", "a row, µs", "row ÷ step"], rows, left=0)


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
    head = ["modes", "error, rad", *(program if "flexframe" in program else f"Exudyn, {program}" for program in loop.FIRST)]
    return table([*head, "ratio", "ratio (the same equations)"], rows, left=0)


def seconds_of_motion(time):
    return f"{1e3 * time:.2g} ms" if time < 1 else f"{time:.3g} s"
