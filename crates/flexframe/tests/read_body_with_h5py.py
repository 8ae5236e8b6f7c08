"""Runs the example of docs/body.md on a body file and a results file, and checks what it says."""

import re
import sys
from pathlib import Path

page = (Path(__file__).parents[3] / "docs/body.md").read_text()
example = re.search(r"```python\n(.*?)```", page, re.S)[1]
example = example.replace("ring.body.h5", sys.argv[1]).replace("out/ring/ring.h5", sys.argv[2])
names = {}
exec(example, names)
energy, expected = names["kinetic"], names["run"]["energy/kinetic"][-1]
assert abs(energy / expected - 1) < 1e-12, (energy, expected)
for name, dataset in names["body"]["modes"].items():
    assert all(isinstance(dataset.attrs[key], str) for key in ("unit", "frame", "description")), name
