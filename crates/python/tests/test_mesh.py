"""Meshes of arrays."""

import itertools

import numpy as np
import pytest
from conftest import RING

import flexframe

STEEL = {"young_modulus": 210000.0, "poisson_ratio": 0.3, "density": 7.85e-9}


def bar(cells=(6, 1, 1), size=(60.0, 10.0, 10.0)):
    """Nodes and corners of the tetrahedra of a bar, six in each cell."""
    axes = [np.linspace(0.0, length, count + 1) for length, count in zip(size, cells)]
    nodes = np.array(list(itertools.product(*axes)))
    at = np.arange(len(nodes)).reshape([count + 1 for count in cells])
    elements = []
    for cell in itertools.product(*map(range, cells)):
        for order in itertools.permutations(range(3)):
            corner, corners = list(cell), [at[cell]]
            for axis in order:
                corner[axis] += 1
                corners.append(at[tuple(corner)])
            a, b, c, d = nodes[corners]
            if np.linalg.det([b - a, c - a, d - a]) < 0:
                corners[2:] = corners[:1:-1]
            elements.append(corners)
    return nodes, np.array(elements)


def scene(**body):
    loads = [{"kind": "pressure", "group": "end", "amplitude": 1.0, "history": {"kind": "constant"}}]
    return {**RING, "body": body, "loads": loads, "initial": {}, "output": {"points": {"tip": [60.0, 5.0, 5.0]}}}


# Closed form: Σ ρV, and pressure times area.
def test_a_bar_of_arrays_has_its_mass_groups_and_surfaces(tmp_path):
    nodes, elements = bar()
    of_end = [[a, b, c] for element in elements for a, b, c in itertools.combinations(element, 3)
              if (nodes[[a, b, c], 0] == 60.0).all()]
    halves = np.flatnonzero(nodes[elements, 0].mean(axis=1) < 30.0)
    file = tmp_path / "bar.msh"
    flexframe.write_mesh(file, nodes, elements, groups={"steel": halves}, surfaces={"end": of_end})
    with pytest.raises(flexframe.FileError, match="overwrite=True"):
        flexframe.write_mesh(file, nodes, elements)
    flexframe.write_mesh(
        file, nodes, elements.tolist(), surfaces={"end": of_end}, overwrite=True,
        groups={"steel": halves, "light": np.setdiff1d(np.arange(len(elements)), halves)},
    )
    assert [path.name for path in tmp_path.iterdir()] == ["bar.msh"]
    light = {**STEEL, "density": 2e-9}
    body = flexframe.Body(flexframe.Scene(scene(mesh=file, materials={"steel": STEEL, "light": light})))
    assert body.mass == pytest.approx(3000.0 * (7.85e-9 + 2e-9), rel=1e-12)
    assert np.array_equal(body.positions[: len(nodes)], nodes)
    assert np.array_equal(body.tetrahedra[:, :4], elements)
    ends = body.positions[body.tetrahedra[:, [0, 1]]]
    assert np.allclose(body.positions[body.tetrahedra[:, 4]], ends.mean(axis=1), rtol=1e-15, atol=0)

    # The same elements with all their nodes, curved or not.
    again = tmp_path / "again.msh"
    of_end = [list(face) for face in body.surface_triangles if (body.positions[face, 0] == 60.0).all()]
    flexframe.write_mesh(again, body.positions, body.tetrahedra, surfaces={"end": of_end})
    other = flexframe.Body(flexframe.Scene(scene(mesh=again, material=STEEL)))
    assert np.array_equal(other.positions, body.positions) and np.array_equal(other.tetrahedra, body.tetrahedra)
    force = flexframe.Simulation(other).run()["momentum/linear"][-1, 0] / 0.01
    assert force == pytest.approx(-100.0, rel=1e-3)


def test_arrays_that_are_no_mesh_are_refused(tmp_path):
    nodes, elements = bar()
    file = tmp_path / "bar.msh"
    for arguments, named, words in [
        ((nodes[:, :2], elements, {}), "positions", r"\(28, 2\)"),
        ((np.full_like(nodes, np.nan), elements, {}), "positions", "not finite"),
        ((nodes, elements[:, :3], {}), "tetrahedra", "4 or 10 columns"),
        ((nodes, elements + 1, {}), "tetrahedra", "the node 28"),
        ((nodes, elements.astype(float), {}), "tetrahedra", "float64"),
        ((nodes, [], {}), "tetrahedra", "no elements"),
        ((nodes, elements, {"groups": {"a": [0, 1], "b": [1]}}), "groups['b']", "element 1"),
        ((nodes, elements, {"groups": {"a": [99]}}), "groups['a']", "the element 99"),
        ((nodes, elements, {"surfaces": {"s": [[0, 1, 27]]}}), "surfaces['s']", "an edge from"),
        ((nodes, elements, {"surfaces": {'s"': [elements[0, :3]]}}), "name of a group", "without quotes"),
    ]:
        with pytest.raises(flexframe.InputError, match=words) as raised:
            flexframe.write_mesh(file, arguments[0], arguments[1], **arguments[2])
        assert raised.value.key == named and raised.value.help
    with pytest.raises(flexframe.FileError):
        flexframe.write_mesh(tmp_path / "none" / "bar.msh", nodes, elements)
    assert list(tmp_path.iterdir()) == []
    flexframe.write_mesh(file, nodes, elements[:, [0, 2, 1, 3]])
    with pytest.raises(flexframe.InputError):
        flexframe.Body(flexframe.Scene(scene(mesh=file, material=STEEL)))
