"""Scenes from files and dicts."""

import json
import pickle
import shutil
from pathlib import Path

import numpy as np
import pytest
from conftest import EXAMPLES, RING

import flexframe


def test_a_dict_is_the_scene_that_its_file_is():
    tomllib = pytest.importorskip("tomllib")
    path = EXAMPLES / "plate.toml"
    of_file = flexframe.Scene(path)
    of_dict = flexframe.Scene(tomllib.loads(path.read_text()), base=EXAMPLES, name="plate")
    assert tomllib.loads(of_dict.text) == tomllib.loads(of_file.text)
    assert (of_dict.title, of_dict.units, of_dict.end) == (of_file.title, of_file.units, of_file.end)
    assert of_file.units == {"length": "mm", "mass": "Mg", "time": "s"}
    assert Path(of_file.path) == path and Path(of_dict.path) == EXAMPLES / "plate"


def test_values_of_numpy_and_paths_are_taken_as_they_are():
    tomllib = pytest.importorskip("tomllib")
    scene = {
        **RING,
        "body": {**RING["body"], "mesh": Path("../meshes/ring.msh")},
        "modes": {"flexible": np.int64(4), "damping_ratio": np.float64(0.1), "static_correction": np.bool_(False)},
        "initial": {"angular_velocity": np.array([0.1, 0.2, 1 / 3])},
    }
    read = tomllib.loads(flexframe.Scene(scene, base=EXAMPLES).text)
    assert read["initial"]["angular_velocity"] == [0.1, 0.2, 1 / 3]
    assert read["modes"] == {"flexible": 4, "damping_ratio": 0.1, "static_correction": False}
    assert read["body"]["mesh"] == "../meshes/ring.msh"


def test_values_are_set_as_by_the_program():
    tomllib = pytest.importorskip("tomllib")
    scene = flexframe.Scene(RING, base=EXAMPLES)
    other = scene.with_values({"time.end": 0.5, "loads[0].amplitude": 20, "output.points.'a b'": (1.0, 2.0, 3.0)})
    read = tomllib.loads(other.text)
    assert (other.end, scene.end) == (0.5, 0.01)
    assert read["loads"][0]["amplitude"] == 20 and read["output"]["points"]["a b"] == [1.0, 2.0, 3.0]
    assert other.path == scene.path


def test_messages_and_what_is_known_are_those_of_the_program(program, tmp_path):
    path = tmp_path / "ring.toml"
    path.write_text(flexframe.Scene(RING, base=EXAMPLES).text.replace("step = 0.00002", "stpe = 0.00002"))
    assert "stpe" in path.read_text()
    said = program("run", path, "-o", tmp_path, "--json")
    told = json.loads(said.stderr)
    with pytest.raises(flexframe.InputError) as raised:
        flexframe.Scene(path)
    error = raised.value
    assert str(error) == told["message"]
    for name in ("file", "line", "key", "found", "expected", "help"):
        assert getattr(error, name) == told.get(name), name
    assert isinstance(error, flexframe.Error) and isinstance(error, ValueError)


def test_what_is_doubtful_is_a_warning_before_the_work():
    steel = {**RING["body"]["material"], "young_modulus": 210.0}
    scene = flexframe.Scene({**RING, "body": {**RING["body"], "material": steel}}, base=EXAMPLES)
    with pytest.warns(UserWarning, match="speed of sound"):
        flexframe.Body(scene)


# Closed form: ρV.
@pytest.mark.skipif(shutil.which("gmsh") is None, reason="gmsh is not there")
def test_geometry_that_runs_programs_is_refused_unless_it_is_trusted(tmp_path):
    evidence = tmp_path / "ran"
    (tmp_path / "box.geo").write_text(
        f'SetFactory("OpenCASCADE");\nBox(1) = {{0, 0, 0, 30, 10, 10}};\nSystemCall "touch {evidence}";\n'
    )
    made = {**RING, "body": {"mesh": "box.geo", "mesh_size": 10.0, "material": RING["body"]["material"]}, "loads": [],
            "output": {}}
    with pytest.raises(flexframe.InputError, match="trust-geometry"):
        flexframe.Body(flexframe.Scene(made, base=tmp_path))
    assert not evidence.exists()
    scene = flexframe.Scene(made, base=tmp_path, trust_geometry=True)
    with pytest.warns(UserWarning, match="gmsh is free to do all"):
        body = flexframe.Body(scene.with_values({"title": "Trusted"}))
    assert evidence.exists() and body.mass == pytest.approx(3000.0 * 7.85e-9)


def test_a_scene_has_several_bodies_or_one_of_them_alone():
    pair = EXAMPLES / "pair.toml"
    both = flexframe.Scene(pair)
    ring, block = (flexframe.Scene(pair, body=body) for body in ("ring", "block"))
    assert (both.bodies, ring.bodies, block.bodies) == (["ring", "block"], ["ring"], ["block"])
    assert flexframe.Scene(RING, base=EXAMPLES).bodies == ["body"]
    assert both.text == ring.text == block.text == pair.read_text()
    for scene in (both, block):
        assert pickle.loads(pickle.dumps(scene)).bodies == scene.bodies
    assert (ring.units, ring.end) == (block.units, block.end) == (both.units, both.end)
    longer = block.with_values({"time.end": 0.5, "bodies.block.initial.velocity": [1.0, 0.0, 0.0]})
    assert (longer.bodies, longer.end) == (["block"], 0.5)
    with pytest.raises(flexframe.InputError, match="found 2 bodies, expected one of ring, block"):
        flexframe.Body(both)
    with pytest.raises(flexframe.InputError, match="no body `wheel`"):
        flexframe.Scene(pair, body="wheel")
