"""Python on the pages of the documentation: run where it needs only flexframe, else read."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
PAGES = sorted([ROOT / "README.md", *(ROOT / "docs").rglob("*.md")])
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)

# Pages whose blocks are only read, with the reason.
READ_ONLY = {
    "docs/how-to/fmu.md": "wants FMPy: ./dev fmu-test",
    "docs/reference/fmu.md": "wants FMPy: ./dev fmu-test",
    "docs/reference/body.md": "wants a body file with matrices: ./dev h5py does it",
    "docs/reference/matrices.md": "matrices of another program",
    "docs/reference/meshes.md": "wants mapdl-archive, and a mesh of Ansys",
    "docs/reference/results.md": "parts of a program, of a run that was killed",
    "docs/start/first-steps.md": "wants the results of the commands before it",
}


def blocks():
    for page in PAGES:
        found = BLOCK.findall(page.read_text())
        if found:
            yield pytest.param(page, found, id=str(page.relative_to(ROOT)))


@pytest.mark.parametrize("page, found", blocks())
def test_the_python_of_a_page_runs(page, found, monkeypatch):
    monkeypatch.chdir(ROOT)
    names = {}
    for block in found:
        code = compile(block, page, "exec")
        if str(page.relative_to(ROOT)) not in READ_ONLY:
            exec(code, names)


def test_pages_that_are_only_read_have_python():
    for page in READ_ONLY:
        assert BLOCK.search((ROOT / page).read_text()), page
