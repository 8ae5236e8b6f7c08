"""One body for many runs and processes: other scenes, copies, pickles, the cache."""

import copy
import os
import pickle
import subprocess
import sys

import numpy as np
import pytest
from conftest import EXAMPLES, RING, RIGID

import flexframe


# Conserved: the same rows on a body of its own, bit for bit.
@pytest.mark.parametrize("values", [
    {"loads[0].amplitude": 350.0},
    {"loads[0].direction": [1.0, 0.0, 0.0], "initial.angular_velocity": [1.0, 2.0, 3.0]},
    {"time.end": 0.002, "time.step": 1e-5, "modes.damping_ratio": 0.2, "effects.coriolis": False},
    {"loads": [], "output.points": {"new": [0.0, 100.0, 0.0]}},
    {"modes.static_correction": True},
])
def test_another_scene_of_a_body_runs_as_on_a_body_of_its_own(ring, values):
    scene = ring.scene.with_values(values)
    own = flexframe.Simulation(flexframe.Body(scene)).run()
    shared = flexframe.Simulation(ring, scene=scene)
    assert shared.body.scene is scene and shared.body is not ring
    found = shared.run()
    assert found.columns == own.columns and found.scene == scene.text
    for path in own:
        assert np.array_equal(found[path], own[path]), path


# Closed form: F t²/(2m), and V t.
def test_another_scene_with_a_law_and_of_a_rigid_body(rigid):
    law = flexframe.Force("center", lambda motion: [2.0, 0.0, 0.0])
    scene = rigid.scene.with_values({"time.end": 0.5, "initial": {"velocity": [0.0, 1.0, 0.0]}})
    row = flexframe.Simulation(rigid, [law], scene=scene).run()["position"][-1]
    assert row == pytest.approx([0.125, 0.5, 0.0], abs=1e-12)


def test_a_scene_of_another_body_is_refused(ring):
    for values in ({"modes.flexible": 5}, {"body.material.density": 1e-9}, {"body.point_masses": [
        {"mass": 1e-6, "at": [0.0, 100.0, 10.0]}
    ]}):
        with pytest.raises(flexframe.InputError, match="a scene of another body") as raised:
            flexframe.Simulation(ring, scene=ring.scene.with_values(values))
        assert "Simulation(Body(scene))" in raised.value.help
    with pytest.raises(flexframe.InputError, match="another body"):
        flexframe.Simulation(ring, scene=flexframe.Scene(RIGID))


def test_scenes_bodies_and_results_can_be_pickled_and_copied(ring):
    scene = ring.scene
    for again in (pickle.loads(pickle.dumps(scene)), copy.copy(scene), copy.deepcopy(scene)):
        assert (again.text, again.path, repr(again)) == (scene.text, scene.path, repr(scene))
    body = pickle.loads(pickle.dumps(ring))
    assert np.array_equal(body.shapes, ring.shapes) and body.scene.text == scene.text
    results = flexframe.Simulation(ring).run()
    again = pickle.loads(pickle.dumps(results))
    assert again.columns == results.columns and repr(again) == repr(results)
    assert all(np.array_equal(again[path], results[path]) for path in results)


def test_a_scene_of_a_relative_path_is_found_again(tmp_path, monkeypatch):
    (tmp_path / "table.csv").write_text("0, 0\n1, 1\n")
    scene = RIGID | {"loads": [{"kind": "force", "at": [0.0, 0.0, 0.0], "direction": [1.0, 0.0, 0.0], "amplitude": 1.0,
                                "history": {"kind": "table", "file": "table.csv"}}]}
    pickled = pickle.dumps(flexframe.Scene(scene, base=tmp_path))
    monkeypatch.chdir("/")
    assert pickle.loads(pickled).text == flexframe.Scene(scene, base=tmp_path).text


def built_in_another_process(folder):
    """The files that the cache has after a ring was built, and whether any of them is new."""
    code = f"import flexframe; flexframe.Body(flexframe.Scene({RING!r}, base={str(EXAMPLES)!r}))"
    environment = {**os.environ, "FLEXFRAME_CACHE": str(folder)}
    before = {path: path.stat().st_ino for path in folder.rglob("*") if path.is_file()}
    said = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True)
    assert said.returncode == 0, said.stderr
    after = {path: path.stat().st_ino for path in folder.rglob("*") if path.is_file()}
    return after, after != before


def test_what_was_computed_of_a_mesh_is_kept(tmp_path):
    first, is_new = built_in_another_process(tmp_path)
    assert is_new and len(first) > 2
    second, is_new = built_in_another_process(tmp_path)
    assert not is_new and second == first


def test_runs_of_one_body_search_no_modes_again(tmp_path, monkeypatch):
    monkeypatch.setenv("FLEXFRAME_CACHE", str(tmp_path))
    # Large modes have responses of second order, which are more fields than the modes.
    scene = flexframe.Scene(RING, base=EXAMPLES).with_values({"effects.large_deflection": False})
    body = flexframe.Body(scene)
    files = lambda: {path: path.stat().st_ino for path in tmp_path.rglob("*") if path.is_file()}
    kept = files()
    for values in ({"loads[0].amplitude": 350.0}, {"time.end": 0.005}, {"initial": {"velocity": [1.0, 0.0, 0.0]}}):
        flexframe.Simulation(body, scene=scene.with_values(values)).run()
        now = files()
        assert kept.items() <= now.items()
        # The rigid and flexible modes are ten fields over the nodes, the static responses to loads and spin nine.
        assert all(path.stat().st_size < 10 * 24 * len(body.positions) for path in now.keys() - kept.keys())


def test_representations_have_units(ring, rigid):
    assert repr(ring).startswith("Body('Ring, struck': mass ") or 'Body("Ring, struck": mass ' in repr(ring)
    assert " Mg, 4 flexible modes from " in repr(ring) and " Hz, " in repr(ring) and repr(ring).endswith(" nodes)")
    assert "2 kg, rigid" in repr(rigid)
    simulation = flexframe.Simulation(ring)
    assert "time 0 of 0.01 s" in repr(simulation)
    assert repr(simulation.advance()).endswith(" s)") and repr(simulation.observe()).endswith(" s)")
    results = flexframe.Simulation(ring).run()
    assert "rows to 0.01 s" in repr(results)


def test_notebooks_show_tables(ring):
    html = ring._repr_html_()
    assert "frequency, Hz" in html and html.count("<tr>") == 1 + 4 and "<b>Ring, struck</b>" in html
    html = flexframe.Simulation(ring).run()._repr_html_()
    assert "points/velocity" in html and "mm/s" in html and html.count("<tr>") > 10
    scene = ring.scene.with_values({"title": "a <b> & c"})
    assert "a &lt;b&gt; &amp; c" in scene._repr_html_() and "<b>a <b>" not in scene._repr_html_()
