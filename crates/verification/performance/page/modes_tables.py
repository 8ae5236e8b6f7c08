"""Tables of docs/evidence/performance.md about the modes."""

import modes
from page import summary
from page.markdown import number, ratio, seconds, spread, table


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
            rows.append([program, f"more than {int(runs[0]['seconds'])}", "–", "–", "–", "–", "–"])
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
    head = [
        "program",
        "time, s",
        "processor, s",
        "time ÷ flexframe's",
        "memory, MB",
        "memory ÷ flexframe's",
        "frequencies differ",
    ]
    return f"**{heading(name, programs).capitalize()}**\n\n{table(head, rows)}"
