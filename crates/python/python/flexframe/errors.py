"""Exceptions. Their messages are those of the program `flexframe`."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flexframe.results import Results


class Error(Exception):
    """An error of flexframe. Details of the fault beside the message are in attributes, which are None where they are not known."""

    file: str | None
    """The file that is at fault, or could not be read or written."""
    line: int | None
    """Line in it, from 1."""
    key: str | None
    """Path of keys in the scene, such as `loads[0].history.duration`, or the argument at fault."""
    found: str | None
    """The value that stands there."""
    expected: str | None
    """The value that should stand there."""
    help: str | None
    """Help for the user."""
    results: Results | None
    """The rows before the fault, of a run in memory."""

    def __init__(
        self,
        message: str,
        *,
        file: str | None = None,
        line: int | None = None,
        key: str | None = None,
        found: str | None = None,
        expected: str | None = None,
        help: str | None = None,
    ) -> None:
        super().__init__(message)
        self.file, self.line, self.key = file, line, key
        self.found, self.expected, self.help = found, expected, help
        self.results = None


class InputError(Error, ValueError):
    """A scene, mesh, table, results file or argument says something that cannot be right."""


class RefusedError(Error):
    """The model is understood, but known to give wrong answers or none."""


class RunError(Error, RuntimeError):
    """The computation did not come to its end."""


class FileError(Error, OSError):
    """The system refused a file."""
