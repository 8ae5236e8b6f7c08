"""Attacks on the program by random inputs, signals and full disks: counts of each into docs/evidence/attacks.md.

attacks.py PROGRAM LIBRARY FOLDER [--page PAGE] [--only NAME,…] [--part SHARE] [--first SEED] [--seconds EACH]
"""

import argparse
import os

import decks
import disks
import fmi_calls
import forged
import signals
import systems
from program import Count, Program

# Trials of a whole attack; together about half an hour on one core.
ATTACKS = {"systems": (systems.attack, 3000), "signals": (signals.attack, 300), "forged": (forged.attack, 4000), "decks": (decks.attack, 4000),
           "fmi": (fmi_calls.attack, 1000), "disks": (disks.attack, 600)}
BEGIN, END = "<!-- counts -->", "<!-- end of counts -->"


def table(counts):
    lines = ["| attack | trials | outcomes | faults |", "|---|---:|---|---|"]
    for count in counts:
        outcomes = ", ".join(f"{number} {name}" for name, number in sorted(count.outcomes.items(), key=lambda pair: -pair[1]))
        note = f"; {count.note}" if getattr(count, "note", None) else ""
        faults = "; ".join(f"{case}: {fault}" for case, fault in count.faults[:10]) or "none"
        lines.append(f"| **{count.name}**: {count.what} | {count.trials} | {outcomes}{note} | {faults} |")
    return "\n".join(lines)


def main():
    options = argparse.ArgumentParser()
    options.add_argument("program")
    options.add_argument("library")
    options.add_argument("folder")
    options.add_argument("--page")
    options.add_argument("--only", default=",".join(ATTACKS))
    options.add_argument("--part", type=float, default=1.0)
    options.add_argument("--first", type=int, default=0)
    options.add_argument("--seconds", type=float, default=float("inf"), help="the most that each attack may take")
    options = options.parse_args()
    Count.seconds = options.seconds
    os.makedirs(options.folder, exist_ok=True)
    program = Program(options.program, os.path.abspath(options.folder))
    program.library = os.path.abspath(options.library)
    counts = []
    for name in options.only.split(","):
        attack, trials = ATTACKS[name]
        counts.append(attack(program, max(1, round(trials * options.part)), options.first))
        print(counts[-1], flush=True)
    if options.page:
        with open(options.page, encoding="utf-8") as file:
            before, after = file.read().split(BEGIN)
        with open(options.page, "w", encoding="utf-8") as file:
            file.write(f"{before}{BEGIN}\n\n{table(counts)}\n\n{END}{after.split(END)[1]}")
    raise SystemExit(any(count.faults for count in counts))


main()
