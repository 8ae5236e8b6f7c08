"""Mistakes of Python programs, and their messages: docs/reference/python.md has the table. Nothing is left half-written."""

import json

import numpy as np
import pytest
from conftest import EXAMPLES, RIGID, RING

import flexframe

InputError, RefusedError, RunError, FileError = (
    flexframe.InputError,
    flexframe.RefusedError,
    flexframe.RunError,
    flexframe.FileError,
)


def changed(scene, **sections):
    return {**scene, **sections}


ITSELF = {}
ITSELF["a"] = ITSELF

SCENES = {
    "no scene": (5, TypeError, ["path of a scene file, or a dict", "found int"]),
    "a key that is wrong": (
        changed(RIGID, time={"end": 1.0, "stpe": 1e-3}),
        InputError,
        ["scene:", "`time.stpe`", "unknown key", "did you mean `step`?"],
    ),
    "a key that is missing": (changed(RIGID, time={"step": 1e-3}), InputError, ["scene:", "`time.end`", "`end` is missing"]),
    "None": (
        changed(RIGID, initial={"velocity": None}),
        InputError,
        ["scene: `initial.velocity`: found None", "leave the key out"],
    ),
    "a set": (changed(RIGID, loads={"force"}), InputError, ["scene: `loads`: found a value of the type set"]),
    "a key that is no text": (changed(RIGID, output={1: 2}), InputError, ["scene: `output`: found the key 1", "texts"]),
    "a text for a number": (
        changed(RIGID, time={"end": "long", "step": 1e-3}),
        InputError,
        ["scene:", "`time.end`", 'found the string "long"', "expected a finite number"],
    ),
    "two numbers for three": (
        changed(RIGID, initial={"velocity": np.ones(2)}),
        InputError,
        ["scene:", "`initial.velocity`", "expected"],
    ),
    "NaN": (changed(RIGID, time={"end": float("nan"), "step": 1e-3}), InputError, ["`time.end`", "found the number nan"]),
    "a number of 70 bits": (changed(RIGID, time={"end": 2**70, "step": 1e-3}), InputError, ["scene: `time.end`", "64 bits"]),
    "a dict in itself": (changed(RIGID, output=ITSELF), InputError, ["within each other", "contains itself"]),
}


@pytest.mark.parametrize("case", SCENES)
def test_scene(case):
    scene, error, words = SCENES[case]
    with pytest.raises(error) as raised:
        flexframe.Scene(scene)
    for word in words:
        assert word in str(raised.value)


def test_scene_arguments(tmp_path):
    with pytest.raises(FileError, match="the file cannot be read") as raised:
        flexframe.Scene(tmp_path / "none.toml")
    assert isinstance(raised.value, OSError) and raised.value.file == str(tmp_path / "none.toml")
    with pytest.raises(TypeError, match="`base` and `name` are those of a scene from a dict"):
        flexframe.Scene(EXAMPLES / "plate.toml", base=".")
    scene = flexframe.Scene(RIGID)
    with pytest.raises(InputError, match=r"`loads\[3\].amplitude`: found .*, expected a list"):
        scene.with_values({"loads[3].amplitude": 1.0})
    with pytest.raises(InputError, match="unknown key"):
        scene.with_values({"time.speed": 1.0})


def test_a_mesh_that_is_missing(program, tmp_path):
    scene = flexframe.Scene(changed(RING, body={**RING["body"], "mesh": "none.msh"}), base=tmp_path)
    with pytest.raises(flexframe.Error) as raised:
        flexframe.Body(scene)
    path = tmp_path / "scene"
    path.write_text(scene.text)
    told = json.loads(program("run", path, "-o", tmp_path / "out", "--json").stderr)
    assert str(raised.value) == told["message"] and "none.msh" in told["message"]
    assert {"input": InputError, "io": FileError}[told["kind"]] is type(raised.value)
    with pytest.raises(type(raised.value)):
        flexframe.run(scene, tmp_path / "other")
    assert list((tmp_path / "other").iterdir()) == []


def test_a_point_off_the_body_and_a_refused_model(program):
    off = flexframe.Scene(RING, base=EXAMPLES).with_values({"output.points.struck": [0.0, 500.0, 0.0]})
    with pytest.raises(InputError, match="a point that is not on the body") as raised:
        flexframe.Body(off)
    assert raised.value.key == "output.points.struck"
    long_steps = flexframe.Scene(EXAMPLES / "plate.toml").with_values({"time.step": 0.1})
    with pytest.raises(RefusedError, match="beyond the stability limit"):
        flexframe.Simulation(flexframe.Body(long_steps))


def test_a_load_that_stands_in_no_list():
    body = flexframe.Body(flexframe.Scene(RIGID))
    force = flexframe.Force("corner", lambda motion: [0.0, 0.0, 0.0])
    for loads, found in [(force, "Force"), (lambda motion: [0.0] * 3, "function"), (3, "int")]:
        with pytest.raises(TypeError, match=f"of type {found}, expected a list of Force and ModalForce") as raised:
            flexframe.Simulation(body, loads)
        assert "Simulation(body, [load])" in str(raised.value)
    flexframe.Simulation(body, (force,))


LAWS = {
    "a wrong shape": (lambda motion: [1.0, 2.0], InputError, ["the force of the law `law`", "found 2 numbers", "3 finite numbers"]),
    "a table": (lambda motion: np.ones((3, 3)), InputError, ["found an array of shape [3, 3]"]),
    "NaN": (lambda motion: np.array([0.0, np.nan, 0.0]), InputError, ["found NaN as number 2"]),
    "infinity": (lambda motion: (np.inf, 0.0, 0.0), InputError, ["found inf as number 1"]),
    "nothing": (lambda motion: None, InputError, ["found None"]),
    "a complex number": (lambda motion: np.array([1.0 + 2.0j, 0.0, 0.0]), InputError, ["complex128", "3 finite numbers"]),
    "one of a list": (lambda motion: [np.complex64(1.0 + 2.0j), 0.0, 0.0], InputError, ["3 finite numbers"]),
    "a text": (lambda motion: "abc", InputError, ["found a str"]),
    "raises": (lambda motion: 1 / 0, ZeroDivisionError, ["division by zero"]),
    "no such point": (lambda motion: motion.position("nose"), InputError, ["found `nose`", "`center`, `corner`"]),
    "takes nothing": (lambda: [0.0] * 3, TypeError, ["argument"]),
}


@pytest.mark.parametrize("control", [{"step": 1e-3}, {"tolerance": 1e-6}])
@pytest.mark.parametrize("case", LAWS)
def test_law(case, control):
    """Each is fine up to half of the run, with equal steps and under step control."""
    bad, error, words = LAWS[case]
    law = lambda motion: bad(motion) if case != "takes nothing" and motion.time > 0.5 else [0.0, 0.0, 0.0]
    law = bad if case == "takes nothing" else law
    body = flexframe.Body(flexframe.Scene(changed(RIGID, time={"end": 1.0, **control})))
    make = lambda: flexframe.Simulation(body, [flexframe.Force("corner", law, name="law")])
    with pytest.raises(error) as raised:
        simulation = make()
        simulation.run()
    for word in words:
        assert word in str(raised.value)
    if case != "takes nothing":
        assert simulation.time <= 0.5
        assert np.isfinite(simulation.observe()["position"]).all()


@pytest.mark.parametrize("scheme", ["exponential", "rkmk4", "paper"])
def test_a_law_that_raises_stops_every_scheme_before_the_step(scheme):
    scene = flexframe.Scene(RING, base=EXAMPLES).with_values({"time.scheme": scheme, "time.step": 2e-6, "time.end": 1e-3})

    def law(motion):
        if motion.time > 5e-4:
            raise OSError("the sensor is gone")
        return [0.0, 0.0, 0.0]

    simulation = flexframe.Simulation(flexframe.Body(scene), [flexframe.Force("struck", law)])
    with pytest.raises(OSError, match="the sensor is gone"):
        simulation.run()
    assert 4.9e-4 < simulation.time <= 5e-4 * (1 + 1e-9)


def test_load_arguments(rigid, ring):
    zero = lambda motion: [0.0] * 3
    with pytest.raises(TypeError, match="a law is a function of the motion; found list"):
        flexframe.Force("corner", [1.0, 0.0, 0.0])
    with pytest.raises(InputError, match="frame: found `world`, expected `global` or `body`"):
        flexframe.Force("corner", zero, frame="world")
    with pytest.raises(InputError, match="discontinuities: found NaN"):
        flexframe.Force("corner", zero, discontinuities=[float("nan")])
    with pytest.raises(InputError, match="longest_step: found 0, expected a positive number"):
        flexframe.Force("corner", zero, longest_step=0.0)
    with pytest.raises(InputError, match="point: found `nose`, expected a point of the scene"):
        flexframe.Simulation(rigid, [flexframe.Force("nose", zero)])
    with pytest.raises(InputError, match="ModalForce: found a rigid body"):
        flexframe.Simulation(rigid, [flexframe.ModalForce(zero)])
    with pytest.raises(TypeError, match="a load is a Force or a ModalForce; found function"):
        flexframe.Simulation(rigid, [zero])
    with pytest.raises(InputError, match="the modal forces of the law `zero`: found 3 numbers, expected 4 finite numbers"):
        flexframe.Simulation(ring, [flexframe.ModalForce(zero, name="zero")]).run()


EVENTS = {
    "raises": (lambda row: row["no such column"], KeyError, "is no column of this run; it has time, attitude"),
    "a complex number": (lambda row: np.complex128(1.0), InputError, "the event `event`: found a complex128, expected a finite number"),
    "NaN": (lambda row: float("nan"), InputError, "the event `event`: found NaN, expected a finite number"),
    "an array": (lambda row: row["velocity"], InputError, "found an array of shape .3. and type float64"),
}


@pytest.mark.parametrize("case", EVENTS)
def test_event(case, rigid):
    bad, error, words = EVENTS[case]
    with pytest.raises(error, match=words):
        flexframe.Simulation(rigid).add_event("event", bad)
    simulation = flexframe.Simulation(rigid)
    simulation.add_event("event", lambda row: bad(row) if row.time > 0.5 else 1.0)
    with pytest.raises(error, match=words):
        simulation.run()
    assert simulation.time == pytest.approx(0.501, abs=1e-9)  # at the end of the step


def test_event_arguments(rigid):
    with pytest.raises(TypeError, match="an event is a function of a row"):
        flexframe.Simulation(rigid).add_event("event", 5)
    with pytest.raises(InputError, match="crossing: found `up`, expected `rising`, `falling` or `any`"):
        flexframe.Simulation(rigid).add_event("event", lambda row: 1.0, crossing="up")


def test_stepping_past_the_end(rigid):
    simulation = flexframe.Simulation(rigid)
    simulation.run()
    assert simulation.done and list(simulation) == []
    for step in (simulation.advance, simulation.run, lambda: simulation.advance_to(0.5)):
        with pytest.raises(RunError, match="the run is at its end, time 1; take a scene with a later `time.end`"):
            step()
    simulation.set_state({"time": 0.5})
    assert not simulation.done and simulation.advance().kind == "row"
    for time in (0.2, 1.5, float("nan"), float(np.nextafter(simulation.time, 1.0))):
        with pytest.raises(InputError, match="expected a time after 0.6.*, up to the end at 1"):
            simulation.advance_to(time)
    with pytest.raises(InputError, match="steps: found 0, expected 1 or more"):
        simulation.advance(steps=0)


def test_states(ring):
    simulation = flexframe.Simulation(ring)
    before = simulation.state()
    for state, words in (
        ({"speed": 1.0}, "state: found the key \"speed\", expected one of time, attitude"),
        ({"velocity": [1.0, 2.0]}, r"state\[\"velocity\"\]: found 2 numbers, expected 3 finite numbers"),
        ({"modal_displacement": np.zeros(9)}, "found 9 numbers, expected 4 finite numbers"),
        ({"origin": [0.0, 0.0, np.inf]}, "found inf as number 3"),
        ({"attitude": [0.0] * 4}, "a quaternion that is not zero"),
        ({"time": "now"}, r"state\[\"time\"\]"),
        ({"time": 7.0}, "expected a time from 0 to the end at 0.01"),
    ):
        with pytest.raises(InputError, match=words):
            simulation.set_state(state)
        after = simulation.state()
        assert all(np.array_equal(after[key], before[key]) for key in before), state


def test_a_failed_run_keeps_the_rows_before_it():
    grows = lambda motion: 1e3 * motion.velocity() * np.linalg.norm(motion.velocity())
    scene = flexframe.Scene(changed(RIGID, initial={"velocity": [1.0, 0.0, 0.0]}))
    simulation = flexframe.Simulation(flexframe.Body(scene), [flexframe.Force("center", grows)])
    with pytest.raises((RunError, InputError)) as raised:
        simulation.run()
    results = raised.value.results
    assert not results.complete and len(results["time"]) >= 1
    assert all(np.isfinite(array).all() for array in results.values())


def test_what_is_asked_of_a_step_within_it(rigid):
    held = []
    law = lambda motion: [held[0].time, 0.0, 0.0] if held else [0.0] * 3
    simulation = flexframe.Simulation(rigid, [flexframe.Force("center", law)])
    held.append(simulation)
    with pytest.raises(RuntimeError, match="in the midst of a step"):
        simulation.advance()


def test_files(tmp_path, rigid):
    (tmp_path / "text.h5").write_text("no results")
    with pytest.raises(flexframe.Error, match="text.h5"):
        flexframe.read_results(tmp_path / "text.h5")
    with pytest.raises(FileError, match="none.h5"):
        flexframe.read_results(tmp_path / "none.h5")
    with pytest.raises(flexframe.Error, match="none.h5"):
        flexframe.resume(tmp_path / "none.h5")
    (tmp_path / "scene.h5").write_text("someone's")
    with pytest.raises(FileError, match="scene.h5"):
        flexframe.run(rigid.scene, tmp_path)
    assert (tmp_path / "scene.h5").read_text() == "someone's"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["scene.h5", "text.h5"]


def test_what_needs_a_mesh_or_other_numbers(rigid, ring):
    with pytest.raises(InputError, match="found a rigid body, expected a body with a mesh"):
        rigid.shapes
    with pytest.raises(InputError, match="modal_displacement: found 2 numbers, expected 4 finite numbers"):
        ring.displacements([1.0, 2.0])
    with pytest.raises(KeyError, match="is no column of this run"):
        flexframe.Simulation(ring).run()["points/nose/velocity"]
