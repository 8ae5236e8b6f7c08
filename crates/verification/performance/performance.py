"""Measures flexframe against other programs and writes docs/evidence/performance.md with its figures.

Usage: performance.py [quick|full] [modes] [size] [loop] [page]

Without parts, all of them. Raw results go to out/performance; what is there of the same program is not measured again.
"""

import sys
from dataclasses import asdict, dataclass

import loop
import modes
import size
from store import Store


@dataclass
class Effort:
    """How much is measured."""

    runs: int  # of each program
    once: float  # a program that takes longer than this number of seconds is run only once
    patience: float  # a peer that takes longer than this number of seconds is stopped and left out
    loop_seconds: float  # the longest run of Exudyn


EFFORTS = {
    "quick": Effort(runs=2, once=20, patience=120, loop_seconds=8),
    "usual": Effort(runs=3, once=120, patience=1200, loop_seconds=60),
    "full": Effort(runs=3, once=120, patience=3600, loop_seconds=60),
}
PARTS = {"modes": modes.measure, "size": size.measure, "loop": loop.measure}


def main(words):
    unknown = set(words) - set(EFFORTS) - set(PARTS) - {"page"}
    efforts = [word for word in words if word in EFFORTS]
    if unknown or len(efforts) > 1:
        sys.exit(__doc__)
    name = efforts[0] if efforts else "usual"
    asked = [part for part in PARTS if part in words]
    parts = asked or ([] if "page" in words else list(PARTS))
    for part in parts:
        PARTS[part](Store(part, asdict(EFFORTS[name])), EFFORTS[name])
    # Here, since the process that measures has to be small.
    from page.write import write

    write()


if __name__ == "__main__":
    main(sys.argv[1:])
