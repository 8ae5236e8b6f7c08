"""Everything says what it is where Python runs: the text in the stubs, which editors show."""

import ast
import inspect
from pathlib import Path

import pytest

import flexframe
from flexframe import _flexframe

STUBS = ast.parse((Path(_flexframe.__file__).parent / "_flexframe.pyi").read_text())


def described():
    """Names that have a text in the stubs, with this text."""
    for node in STUBS.body:
        if isinstance(node, ast.ClassDef):
            yield node.name, ast.get_docstring(node)
            for inner in node.body:
                if isinstance(inner, ast.FunctionDef) and not inner.name.startswith("__"):
                    yield f"{node.name}.{inner.name}", ast.get_docstring(inner)
        elif isinstance(node, ast.FunctionDef):
            yield node.name, ast.get_docstring(node)


@pytest.mark.parametrize("name, text", list(described()))
def test_the_text_of_the_stubs_is_there_at_run_time(name, text):
    found = _flexframe
    for part in name.split("."):
        found = getattr(found, part)
    assert text and inspect.getdoc(found)
    assert inspect.getdoc(found).split() == text.split()


def test_every_public_name_has_a_text():
    for name in flexframe.__all__:
        thing = getattr(flexframe, name)
        assert inspect.getdoc(thing), name
        for member, value in vars(thing).items() if inspect.isclass(thing) else ():
            if not member.startswith("_") and (callable(value) or inspect.isdatadescriptor(value)):
                assert inspect.getdoc(value), f"{name}.{member}"
