"""Tables of docs/evidence/performance.md about the modes."""

import modes
from page import summary
from page.markdown import number


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
