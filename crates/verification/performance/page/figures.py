"""The figures of docs/evidence/performance.md."""

import math

import loop as the_loop
import matplotlib
import modes as the_modes
from page import summary
from page.markdown import number

matplotlib.use("svg")
import matplotlib.pyplot as plot

plot.rcParams.update({"font.size": 9, "svg.hashsalt": "performance", "axes.grid": True, "grid.alpha": 0.3})
COLOURS = dict(
    zip(
        [the_modes.OURS, the_modes.OURS_2, the_modes.SCIPY, the_modes.SLEPC, the_modes.SLEPC_2, the_modes.CALCULIX],
        ["#0b5fa5", "#6fa8dc", "#d9822b", "#5b8c3e", "#a3c585", "#9a3b3b"],
    )
)


def thousands(value):
    return number(round(value, -3))


def save(figure, file):
    figure.savefig(file, metadata={"Date": None})
    plot.close(figure)


def modes(cases, file):
    """Time by that of flexframe on one thread: a bar for the median of each program, with its range."""
    figure, panels = plot.subplots(1, len(cases), figsize=(11, 2.8), sharey=True, layout="constrained")
    names = list(COLOURS)[::-1]
    for panel, (name, programs) in zip(panels, cases.items()):
        ours = [run["seconds"] for run in programs[the_modes.OURS]]
        for row, program in enumerate(names):
            runs = programs.get(program)
            if not runs:
                continue
            times = [run["seconds"] for run in runs]
            middle, least, most = summary.ratios(times, ours)
            is_stopped = the_modes.was_stopped(runs[0])
            panel.barh(row, middle, color=COLOURS[program], alpha=0.4 if is_stopped else 1)
            panel.plot([least, most], [row, row], color="black", linewidth=1.5)
            words = f"  {'> ' if is_stopped else ''}{summary.of(times)[0]:.3g} s"
            # On white: the line of flexframe may pass behind it.
            white = {"facecolor": "white", "edgecolor": "none", "pad": 0}
            panel.text(most, row, words, va="center", fontsize=8, bbox=white)
        panel.axvline(1, color="black", linewidth=0.8)
        panel.set_xlim(right=1.3 * panel.get_xlim()[1])
        unknowns = programs[the_modes.OURS][0]["mesh"]["unknowns"]
        panel.set_title(f"{name.split()[0]}, {thousands(unknowns)} unknowns", fontsize=9)
        panel.set_yticks(range(len(names)), names)
        panel.grid(axis="y", visible=False)
    figure.supxlabel("time of the whole process ÷ that of flexframe on one thread", fontsize=9)
    save(figure, file)


def size(sizes, cases, file):
    """Time, and memory estimated and taken, against unknowns; the peers where they ran."""
    figure, (left, right) = plot.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
    for (shape, by_size), colour in zip(sizes.items(), ["#0b5fa5", "#d9822b"]):
        unknowns = [runs[0]["mesh"]["unknowns"] for runs in by_size]
        times = [[run["seconds"] for run in runs] for runs in by_size]
        middle = [summary.of(values)[0] for values in times]
        slope = summary.slope(list(zip(unknowns, middle)))
        left.plot(unknowns, middle, "o-", color=colour, label=f"{shape}, slope {slope:.2f}")
        left.vlines(unknowns, [min(values) for values in times], [max(values) for values in times], color=colour)
        taken = [summary.of(run["memory"] for run in runs)[0] / 1e9 for runs in by_size]
        estimated = [runs[0]["mesh"]["peak_bytes"] / 1e9 for runs in by_size]
        right.plot(unknowns, taken, "o-", color=colour, label=f"{shape}, taken")
        right.plot(unknowns, estimated, "x:", color=colour, label=f"{shape}, estimated")
        for program, marker in ((the_modes.SCIPY, "^"), (the_modes.SLEPC, "s")):
            of_shape = [programs for name, programs in cases.items() if name.startswith(shape)]
            of_shape = [programs for programs in of_shape if not the_modes.was_stopped(programs[program][0])]
            at = [programs[the_modes.OURS][0]["mesh"]["unknowns"] for programs in of_shape]
            for panel, what, unit in ((left, "seconds", 1), (right, "memory", 1e9)):
                values = [summary.of(run[what] for run in programs[program])[0] / unit for programs in of_shape]
                label = f"{shape}, {program}" if panel is left else None
                panel.plot(at, values, marker, color=colour, markerfacecolor="none", label=label)
    for panel, label in ((left, "whole process, s"), (right, "peak memory, GB")):
        panel.set(xscale="log", yscale="log", xlabel="unknowns", ylabel=label)
        panel.legend(fontsize=8)
    save(figure, file)


def phases(sizes, file):
    """Parts of the time of each phase, at each size."""
    figure, panels = plot.subplots(1, len(sizes), figsize=(9, 3.4), sharey=True, layout="constrained")
    names = list(dict.fromkeys(name for by_size in sizes.values() for runs in by_size for name in runs[0]["times"]))
    colours = plot.get_cmap("tab10").colors
    for panel, (shape, by_size) in zip(panels, sizes.items()):
        totals = [
            sum(summary.of(run["times"][name] for run in runs)[0] for name in runs[0]["times"]) for runs in by_size
        ]
        below = [0.0] * len(by_size)
        for name, colour in zip(names, colours):
            parts = [
                100 * summary.of(run["times"].get(name, 0.0) for run in runs)[0] / total
                for runs, total in zip(by_size, totals)
            ]
            panel.bar(range(len(by_size)), parts, bottom=below, color=colour, label=name, width=0.7)
            below = [a + b for a, b in zip(below, parts)]
        labels = [thousands(runs[0]["mesh"]["unknowns"]) for runs in by_size]
        panel.set_xticks(range(len(by_size)), labels)
        panel.set(title=shape, xlabel="unknowns")
        panel.grid(axis="x", visible=False)
    panels[0].set_ylabel("part of the time, %")
    handles, labels = panels[-1].get_legend_handles_labels()
    figure.legend(handles[::-1], labels[::-1], loc="outside right center")
    save(figure, file)


def loop(results, speeds, file):
    """Error of the attitude against processor time, for each number of modes."""
    figure, panels = plot.subplots(1, len(the_loop.MODES), figsize=(9, 4), sharey=True, layout="constrained")
    styles = dict(zip(the_loop.FIRST, ["o-", "o--", "s-", "^-"]))
    colours = dict(zip(the_loop.FIRST, ["#0b5fa5", "#6fa8dc", "#5b8c3e", "#d9822b"]))
    for panel, count in zip(panels, the_loop.MODES):
        for program in the_loop.FIRST:
            step_seconds = summary.of(speeds[count][program])[0]
            steps_and_errors = the_loop.errors(results, count, program)
            points = [(step_seconds / step, error) for step, error in steps_and_errors if math.isfinite(error)]
            label = program if "flexframe" in program else f"Exudyn, {program}"
            panel.plot(*zip(*points), styles[program], color=colours[program], label=label, markersize=4)
        panel.set(xscale="log", yscale="log", title=f"{count} modes", xlabel="processor seconds for a second of motion")
    panels[0].set_ylabel(f"error of the attitude after {the_loop.END:g} s, rad")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize=8)
    save(figure, file)
