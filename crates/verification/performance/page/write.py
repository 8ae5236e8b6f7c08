"""Writes docs/evidence/performance.md and its figures from the raw results."""

import json
import sys
from pathlib import Path
from string import Template

import loop
import modes
from measure import HERE
from page import figures, loop_tables, modes_tables, size_tables, summary
from page.markdown import number, table
from store import FOLDER

PAGE = Path("docs/evidence/performance.md")


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
    cases = modes_tables.modes_by_case(of_modes)
    sizes = size_tables.runs_by_size(of_size)
    speeds = loop_tables.speeds_by_modes(of_loop)
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
        "least": number(min(unknowns)),
        "most": number(max(unknowns)),
        "between": f"{size_tables.between_series(sizes, cases):.2f}",
        "size": size_tables.size_table(sizes),
        "slopes": size_tables.slopes(sizes),
        "static_shapes": of_loop[f"speed, {loop.MODES[0]}, {loop.OURS}, 0"]["coordinates"] - loop.MODES[0],
        "agreement": f"{agreement:.0e}",
        "step": f"{loop.STEP:g}",
        "speed": loop_tables.speed_table(speeds),
        "rows": loop_tables.row_table(speeds),
        "end": f"{loop.END:g}",
        "errors": loop_tables.error_table(of_loop, speeds),
    }
    PAGE.write_text(Template((HERE / "page/page.template").read_text()).substitute(words))
    print(PAGE, *sorted(folder.glob("*.svg")), sep="\n")


def about(parts):
    first = parts["modes"]
    machine, versions = first["machine"], first["versions"]
    names = ", ".join(f"{name} {version}" for name, version in versions.items())
    builds = {part["program"] for part in parts.values()}
    programs = first["version"]
    if len(builds) > 1:
        programs += f" (in {len(builds)} builds: not all parts by the same)"
    dates = " to ".join(sorted({part["date"] for part in parts.values()}))
    return (
        f"Measured {dates} with {programs} on {machine['processor']}, {machine['cores']} cores, "
        f"{machine['memory'] / 1e9:.0f} GB, {machine['system']}. "
        "`./dev performance` installs the others, measures again and writes this page.\n\n"
        f"Versions: {names}; OpenBLAS kernels: {machine['openblas_kernels']}."
    )


def method(parts):
    loads = [record["load"] for part in parts.values() for record in part["results"].values()]
    efforts = {part["effort"]["runs"] for part in parts.values()}
    once, patience = parts["modes"]["effort"]["once"], parts["modes"]["effort"]["patience"]
    return (
        f"**Method.** The programs run in turn, {' or '.join(map(str, sorted(efforts)))} times each, the loop at the same "
        f"step {loop.TURNS} times as often; those that take longer than {once} s once, and those that take longer than "
        f"{patience} s are stopped. A time is the median, with ± the range. A ratio is of two runs of the same turn: median, "
        "and least to largest; above 1 flexframe is faster, or smaller. Each program runs on one thread unless it says "
        "otherwise. Memory is the peak of the whole process (of both ranks together). "
        f"The load of the machine was {min(loads):.1f} to {max(loads):.1f}."
    )


def short(cases, speeds):
    """Tables of time and memory of the whole processes, and the loop in words."""

    def ratios_of(what, ours, two_threads):
        head = ["", f"flexframe, {ours[0]}", *modes.PEERS, *([two_threads] if two_threads else [])]
        rows = []
        for name, programs in cases.items():
            cells = [
                f"{modes_tables.against(programs, peer, what)[0]:.2f}" if modes_tables.ran(programs, peer) else "–"
                for peer in modes.PEERS
            ]
            own = ours[1](summary.of(run[what] for run in programs[modes.OURS])[0])
            if two_threads:
                both = ([run[what] for run in programs[which]] for which in (modes.OURS, modes.OURS_2))
                cells.append(f"{summary.ratios(*both)[0]:.2f}")
            rows.append([modes_tables.heading(name, programs), own, *cells])
        return table(head, rows)

    time = ratios_of("seconds", ("s", lambda value: f"{value:.2f}"), "flexframe: one thread ÷ two")
    memory = ratios_of("memory", ("MB", lambda value: f"{value / 1e6:.0f}"), None)
    of_loop = [
        f"{count} modes: {loop_tables.better(speeds[count]):.1f} times as many steps a second as Exudyn's better scheme"
        for count in loop.MODES
    ]
    return (
        f"Time, over flexframe's:\n\n{time}\n\nMemory, over flexframe's:\n\n{memory}\n\n"
        f"SLEPc on two ranks is divided by flexframe on two threads. The loop: {'; '.join(of_loop)}."
    )


def lost(cases, results, speeds):
    """Cases in which flexframe is not better, in words."""
    words = []
    for name, programs in cases.items():
        for peer in modes.PEERS:
            for what, noun in (("seconds", "time"), ("memory", "memory")):
                if modes_tables.ran(programs, peer) and modes_tables.against(programs, peer, what)[0] < 1:
                    part = modes_tables.against(programs, peer, what)[0]
                    words.append(
                        f"{modes_tables.heading(name, programs)}: {peer} takes {part:.2f} of flexframe's {noun}"
                    )
    for count in loop.MODES:
        for target in loop.TARGETS:
            costs = {program: loop_tables.cost(results, speeds, count, program, target)[1] for program in loop.FIRST}
            best = min((loop.ALPHA, loop.RK4), key=costs.get)
            for ours in (loop.OURS, loop.OURS_SAME):
                if costs[best] < costs[ours]:
                    part = costs[best] / costs[ours]
                    error = f"{count} modes to {target:.0e} rad"
                    words.append(f"{error}: Exudyn's {best} takes {part:.2f} of the time of {ours}")
    return "; ".join(words) + "." if words else "None of the cases measured here."
