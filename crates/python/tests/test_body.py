"""Bodies: what Python sees of them is what the program writes, and memory of the body itself."""

import gc

import h5py
import numpy as np
import pytest
from conftest import EXAMPLES, RING

import flexframe


@pytest.fixture(scope="module")
def bent(tmp_path_factory, program):
    """A body with static shapes and large deflection, and its body file."""
    folder = tmp_path_factory.mktemp("bent")
    scene = flexframe.Scene(RING, base=EXAMPLES)
    scene = scene.with_values({"modes.static_correction": True, "modes.large": 2, "effects.large_deflection": True,
                               "effects.geometric_stiffening": True})
    path = folder / "bent.toml"
    path.write_text(scene.with_values({"body.mesh": EXAMPLES / "../meshes/ring.msh"}).text)
    made = program("reduce", path, "-o", folder / "bent.h5", "--no-cache")
    assert made.returncode == 0, made.stderr
    with h5py.File(folder / "bent.h5") as file:
        yield flexframe.Body(flexframe.Scene(path)), file


# Conserved: the numbers of the body file, bit for bit.
def test_modes_and_constants_are_those_of_the_body_file_bit_for_bit(bent):
    body, file = bent
    shapes = np.concatenate([file["modes/shapes"], file["static_shapes/shapes"]])
    natural = file["modes/shapes"].shape[0]
    assert body.kinds == ["natural mode"] * natural + ["static shape"] * (len(shapes) - natural)
    assert len(shapes) > natural
    assert np.array_equal(body.shapes, shapes)
    assert np.array_equal(body.rigid_shapes, file["rigid_modes/shapes"])
    assert np.array_equal(body.positions, file["mesh/positions"])
    assert np.array_equal(body.tetrahedra, file["mesh/tetrahedra"])
    assert np.array_equal(body.surface_triangles, file["mesh/surface_triangles"])
    assert np.array_equal(body.frequencies[:natural], file["modes/frequencies"])
    assert np.array_equal(body.damping_ratios[:natural], file["modes/damping_ratios"])
    assert set(body.constants) == set(file["constants"])
    for name, value in body.constants.items():
        expected = file["constants"][name][()]
        assert np.shape(value) == expected.shape, name
        assert np.array_equal(value, expected), name
        if name != "mass":
            assert isinstance(value, np.ndarray) and not value.flags.writeable, name


# Independent reference: the sum over shapes and products by NumPy.
def test_displacements_follow_large_modes(bent):
    body, file = bent
    q = 3.0 * np.linspace(1.0, 0.1, len(body.frequencies)) * body.mass**0.5
    large = file["large_deflection"]
    products = np.prod(np.append(q, 1.0)[large["factors"][:]], axis=1)
    xi = np.append(q, np.zeros(len(large["shapes"]))) + products @ large["products"][:]
    u = np.tensordot(xi, np.concatenate([body.shapes, large["shapes"]]), 1)
    found = body.displacements(q)
    assert np.abs(found - u).max() < 1e-12 * np.abs(u).max()
    assert np.abs(found - np.tensordot(q, body.shapes, 1)).max() > 1e-4 * np.abs(u).max()


def test_arrays_are_memory_of_the_body(ring):
    views = [ring.shapes, ring.rigid_shapes, ring.positions, ring.tetrahedra, ring.origin, ring.center_of_mass,
             ring.damping_ratios, *(ring.constants[name] for name in ("inertia", "circular_frequencies"))]
    for array in views:
        assert type(array.base).__name__ == "Memory"
        assert not array.flags.writeable and not array.flags.owndata
        with pytest.raises(ValueError):
            array.flags.writeable = True
    assert np.shares_memory(ring.shapes, ring.shapes)
    assert ring.shapes.ctypes.data == ring.shapes.ctypes.data


def test_an_array_keeps_its_body():
    body = flexframe.Body(flexframe.Scene(RING, base=EXAMPLES))
    shapes, copy = body.shapes, np.array(body.shapes)
    del body
    gc.collect()
    others = [np.ones(shapes.size) for _ in range(4)]
    assert np.array_equal(shapes, copy) and len(others) == 4


# Conserved: the numbers of the scene.
def test_a_rigid_body_has_mass_and_no_mesh(rigid):
    assert rigid.mass == 2.0
    assert np.array_equal(rigid.inertia, np.diag([0.2, 0.3, 0.4]))
    assert rigid.positions.shape == (0, 3) and rigid.frequencies.shape == (0,)
    assert np.array_equal(rigid.points["corner"], [0.3, 0.1, -0.2])
