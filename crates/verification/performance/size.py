"""Cost of `flexframe modes` against size, from thin to bulky: time by phase, memory estimated and taken."""

from cases import Case
from modes import ours

# Sizes of gmsh; the last of each is about a million unknowns.
SIZES = {"plate": [10, 6, 4.2, 3.2, 2.2], "block": [7.6, 5, 3.7, 2.9, 2.1]}


def measure(store, effort):
    """Each size `effort.runs` times in turn; those that take longer than `effort.once` seconds only once."""
    for turn in range(effort.runs):
        for shape, sizes in SIZES.items():
            for size in sizes:
                case = Case(shape, size)
                first = store.results.get(f"{case.name}, 0")
                if turn > 0 and first["seconds"] > effort.once:
                    continue
                store.once(f"{case.name}, {turn}", lambda: ours(case, 1))
