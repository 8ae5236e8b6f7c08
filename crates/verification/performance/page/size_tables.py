"""Tables of docs/evidence/performance.md about cost against size."""

import modes
from page import summary
from page.markdown import number, seconds, spread, table


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
    head = [
        "body",
        "unknowns",
        "factor, 10⁶ entries",
        "time, s",
        "processor, s",
        "estimated, MB",
        "taken, MB",
        "estimated ÷ taken − 1",
    ]
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


def between_series(sizes, cases):
    """How many times as long the same command took in this series as in that of the modes, or the other way round."""
    runs_of = {runs[0]["mesh"]["unknowns"]: runs for by_size in sizes.values() for runs in by_size}
    factors = [1.0]
    for programs in cases.values():
        there = programs[modes.OURS]
        here = runs_of.get(there[0]["mesh"]["unknowns"])
        if here:
            factor = summary.of(run["seconds"] for run in there)[0] / summary.of(run["seconds"] for run in here)[0]
            factors += [factor, 1 / factor]
    return max(factors)
