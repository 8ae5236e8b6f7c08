"""Meshes of arrays."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexframe.errors import FileError, InputError

# Ends of the mid-edge nodes of a tetrahedron and of a triangle, in their order.
_EDGES = {4: ((0, 1), (1, 2), (0, 2), (0, 3), (2, 3), (1, 3)), 3: ((0, 1), (1, 2), (2, 0))}
_TRIANGLE, _TETRAHEDRON = 9, 11  # gmsh's numbers of the kinds of second order


def write_mesh(
    file: str | os.PathLike[str],
    positions: ArrayLike,
    tetrahedra: ArrayLike,
    *,
    groups: Mapping[str, ArrayLike] | None = None,
    surfaces: Mapping[str, ArrayLike] | None = None,
    overwrite: bool = False,
) -> None:
    """Writes a mesh of arrays into a file (MSH 4.1), which a scene can name.

    `positions` are the nodes (n x 3), `tetrahedra` the nodes of the elements, from 0: corners, then mid-edges 01 12 02 03 23 13
    (m x 10); with corners alone (m x 4), nodes in the middle of straight edges are added. `groups` are lists of elements, from 0, by
    the name of their material; an element is in one of them at the most. `surfaces` are triangles by the name of a surface, for
    loads and supports: their corners, or corners and mid-edges 01 12 20 (t x 3 or t x 6), either way round. What only a body cannot
    have, such as an element inside out, is refused when the body is built.
    """
    nodes = _floats("positions", positions)
    elements = _indices("tetrahedra", tetrahedra, (4, 10), len(nodes))
    if len(elements) == 0:
        raise _wrong("tetrahedra", "no elements", "at least one", "name the nodes of each element in a row")
    on_edges: dict[tuple[int, int], int] = {}
    if elements.shape[1] == 4:
        ends, of_elements = _edges(elements)
        on_edges = {(a, b): len(nodes) + i for i, (a, b) in enumerate(ends.tolist())}
        elements = np.hstack([elements, len(nodes) + of_elements])
        nodes = np.vstack([nodes, nodes[ends].mean(axis=1)])
    else:
        for i, (a, b) in enumerate(_EDGES[4]):
            ends = np.sort(elements[:, [a, b]])
            on_edges.update(zip(map(tuple, ends.tolist()), elements[:, 4 + i].tolist()))
    triangles = {
        name: _triangles(f"surfaces[{name!r}]", list_of, len(nodes), on_edges) for name, list_of in (surfaces or {}).items()
    }
    regions = _regions(groups or {}, len(elements))
    for name in [*triangles, *regions]:
        if name is not None and (not name or '"' in name or not name.isprintable()):
            raise _wrong("name of a group", repr(name), "a text without quotes and line breaks", "give it another name")
    _replace(Path(file), overwrite, lambda out: _write(out, nodes, elements, regions, triangles))


def _wrong(key: str, found: str, expected: str, help: str) -> InputError:
    return InputError(
        f"{key}: found {found}, expected {expected}\n = {help}", key=key, found=found, expected=expected, help=help
    )


def _floats(key: str, values: ArrayLike) -> NDArray[np.float64]:
    array = np.asarray(values, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != 3:
        raise _wrong(key, f"an array of the shape {array.shape}", "one of n x 3", "give each node a row with x, y and z")
    if not np.isfinite(array).all():
        raise _wrong(key, "a number that is not finite", "finite numbers", "look at how the nodes were made")
    return array


def _indices(
    key: str, values: ArrayLike, columns: tuple[int, ...], count: int, what: str = "node"
) -> NDArray[np.int64]:
    array = np.asarray(values)
    if array.size == 0:
        return np.empty((0, columns[-1]), dtype=np.int64)
    if not np.issubdtype(array.dtype, np.integer):
        raise _wrong(key, f"numbers of the type {array.dtype}", "whole numbers", f"name each {what} by its row, from 0")
    if array.ndim != 2 or array.shape[1] not in columns:
        expected = " or ".join(str(width) for width in columns)
        raise _wrong(key, f"an array of the shape {array.shape}", f"{expected} columns", "give each a row with its nodes")
    outside = array[(array < 0) | (array >= count)]
    if outside.size:
        raise _wrong(key, f"the {what} {outside[0]}", f"numbers from 0 to {count - 1}", "count from 0")
    return array.astype(np.int64)


def _edges(elements: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The edges by their ends, and those of each element in the order of its mid-edge nodes."""
    all_ends = np.sort(elements[:, _EDGES[4]].reshape(-1, 2), axis=1)
    ends, of_elements = np.unique(all_ends, axis=0, return_inverse=True)
    return ends, of_elements.reshape(len(elements), 6)


def _triangles(
    key: str, values: ArrayLike, count: int, on_edges: dict[tuple[int, int], int]
) -> NDArray[np.int64]:
    triangles = _indices(key, values, (3, 6), count)
    if triangles.shape[1] == 6:
        return triangles
    middles = []
    for triangle in triangles.tolist():
        edges = [(min(triangle[a], triangle[b]), max(triangle[a], triangle[b])) for a, b in _EDGES[3]]
        unknown = [edge for edge in edges if edge not in on_edges]
        if unknown:
            help = "name three corners of one element"
            raise _wrong(key, f"an edge from {unknown[0][0]} to {unknown[0][1]}", "edges of the elements", help)
        middles.append([on_edges[edge] for edge in edges])
    return np.hstack([triangles, np.array(middles, dtype=np.int64)])


def _regions(groups: Mapping[str, ArrayLike], count: int) -> dict[str | None, NDArray[np.int64]]:
    """Elements by the name of their group; those of none under None."""
    taken: NDArray[np.object_] = np.full(count, None)
    regions: dict[str | None, NDArray[np.int64]] = {}
    for name, list_of in groups.items():
        key = f"groups[{name!r}]"
        members = np.unique(_indices(key, np.reshape(list_of, (-1, 1)), (1,), count, "element").ravel())
        twice = members[taken[members] != None]  # noqa: E711 - entry by entry
        if twice.size:
            help = "put each element into one group: it has one material"
            raise _wrong(key, f"element {twice[0]}, which is in {taken[twice[0]]!r}", "elements of no other group", help)
        taken[members] = name
        regions[name] = members
    rest = np.flatnonzero(taken == None)  # noqa: E711 - entry by entry
    return {**regions, None: rest} if rest.size else regions


def _write(
    out: IO[str],
    nodes: NDArray[np.float64],
    elements: NDArray[np.int64],
    regions: dict[str | None, NDArray[np.int64]],
    triangles: dict[str, NDArray[np.int64]],
) -> None:
    names = [(2, name) for name in triangles] + [(3, name) for name in regions if name is not None]
    number = {key: i for i, key in enumerate(names, 1)}
    box = " ".join(f"{x:.17g}" for x in [*nodes.min(axis=0), *nodes.max(axis=0)])

    def entity(dimension: int, tag: int, name: str | None) -> str:
        group = f"1 {number[dimension, name]}" if name is not None else "0"
        return f"{tag} {box} {group} 0\n"

    out.write("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n")
    if names:
        out.write(f"$PhysicalNames\n{len(names)}\n")
        out.writelines(f'{dimension} {number[dimension, name]} "{name}"\n' for dimension, name in names)
        out.write("$EndPhysicalNames\n")
    out.write(f"$Entities\n0 0 {len(triangles)} {len(regions)}\n")
    out.writelines(entity(2, tag, name) for tag, name in enumerate(triangles, 1))
    out.writelines(entity(3, tag, name) for tag, name in enumerate(regions, 1))
    out.write(f"$EndEntities\n$Nodes\n1 {len(nodes)} 1 {len(nodes)}\n3 1 0 {len(nodes)}\n")
    np.savetxt(out, np.arange(1, len(nodes) + 1), fmt="%d")
    np.savetxt(out, nodes, fmt="%.17g")
    count = len(elements) + sum(map(len, triangles.values()))
    out.write(f"$EndNodes\n$Elements\n{len(triangles) + len(regions)} {count} 1 {count}\n")
    first = 1

    def block(dimension: int, tag: int, kind: int, list_of: NDArray[np.int64]) -> None:
        nonlocal first
        out.write(f"{dimension} {tag} {kind} {len(list_of)}\n")
        numbers = np.arange(first, first + len(list_of))
        np.savetxt(out, np.column_stack([numbers, list_of + 1]), fmt="%d")
        first += len(list_of)

    for tag, list_of in enumerate(triangles.values(), 1):
        block(2, tag, _TRIANGLE, list_of)
    for tag, members in enumerate(regions.values(), 1):
        block(3, tag, _TETRAHEDRON, elements[members])
    out.write("$EndElements\n")


def _replace(file: Path, overwrite: bool, write: Callable[[IO[str]], None]) -> None:
    """Writes a file that appears whole or not at all."""
    if file.exists() and not overwrite:
        raise FileError(f"{file}: the file exists\n = give the mesh another name, or say overwrite=True", file=str(file))
    try:
        with tempfile.TemporaryDirectory(dir=file.parent, prefix=".flexframe-") as folder:
            whole = Path(folder) / file.name
            with whole.open("w") as out:
                write(out)
            os.replace(whole, file)
    except OSError as error:
        raise FileError(f"{file}: {error.strerror}\n = check the folder and its rights", file=str(file)) from error
