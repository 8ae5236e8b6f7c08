"""Runs: the numbers are those of the program's results file, to the last bit."""

import h5py
import numpy as np
import pytest
from conftest import EXAMPLES, RING

import flexframe

# Scenes, and values that make them short.
SCENES = {
    "ring.toml": {"time.end": 0.01},
    "plate.toml": {"time.end": 0.002},  # the paper's scheme
    "pendulum.toml": {"time.end": 0.2, "output": {"every": 10}},  # rigid, with a hinge
    "thrown_plate.toml": {"time.end": 0.01},  # large deflection
    "spin_up.toml": {"time.end": 0.05},  # a drive
}


def same_as_file(results, path):
    with h5py.File(path) as file:
        for name, column in results.columns.items():
            dataset = file[name]
            assert results[name].shape == dataset.shape, name
            assert np.array_equal(results[name], dataset[()]), name
            for attribute in ("unit", "frame", "description"):
                assert dataset.attrs[attribute] == getattr(column, attribute), name
        histories = []
        file.visititems(lambda name, item: histories.append(name) if isinstance(item, h5py.Dataset) else None)
        assert not [path for path in results if path not in file]
        constant = ("/model/", "/points/position", "/trust/")
        histories = {name for name in histories if not any(part in f"/{name}" for part in constant)}
        numbers = sum(file[name].dtype.kind == "f" and file[name].ndim > 0 for name in histories)
        assert len(results) == numbers
        assert file.attrs["complete"] == 1


# Conserved: the numbers of the program's results file, bit for bit.
@pytest.mark.parametrize("name", SCENES)
def test_a_run_is_that_of_the_program_bit_for_bit(name, program, tmp_path):
    (tmp_path / "meshes").symlink_to(EXAMPLES.parent / "meshes")
    (tmp_path / "examples").mkdir()
    path = tmp_path / "examples" / name
    path.write_text(flexframe.Scene(EXAMPLES / name).with_values(SCENES[name]).text)
    said = program("run", path, "-o", tmp_path, "--no-cache")
    assert said.returncode == 0, said.stderr
    file = (tmp_path / name).with_suffix(".h5")

    body = flexframe.Body(flexframe.Scene(path))
    results = flexframe.Simulation(body).run()
    same_as_file(results, file)
    read = flexframe.read_results(file)
    same_as_file(read, file)
    assert results.complete and read.complete
    assert results.warnings == read.warnings
    assert results.columns == read.columns
    assert (results.points, results.title, results.scheme) == (read.points, read.title, read.scheme)

    rows = list(flexframe.Simulation(body))
    assert np.array_equal([row.time for row in rows], results["time"])
    for path in results:
        assert np.array_equal([row[path] for row in rows], results[path]), path


# Conserved: the numbers of the run in memory, bit for bit.
def test_a_file_is_written_as_by_the_program(program, tmp_path):
    scene = flexframe.Scene(RING, base=EXAMPLES, name="ring")
    results = flexframe.run(scene, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["ring.h5"]
    same_as_file(results, tmp_path / "ring.h5")
    in_memory = flexframe.Simulation(flexframe.Body(scene)).run()
    for path in results:
        assert np.array_equal(results[path], in_memory[path]), path
    assert results.scene == scene.text


# Conserved: the numbers of the program, and sums over the bodies.
def test_a_run_of_several_bodies_has_what_each_of_them_has_alone(program, tmp_path):
    pandas = pytest.importorskip("pandas")
    pytest.importorskip("xarray")
    scene = flexframe.Scene(EXAMPLES / "pair.toml").with_values({"time.end": 0.01})
    results = flexframe.run(scene, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["pair.h5"]
    same_as_file(results, tmp_path / "pair.h5")
    assert list(results.bodies) == ["ring", "block"] and "2 bodies" in repr(results)
    with pytest.raises(AttributeError, match="bodies.'ring'"):
        _ = results.frequencies

    ring, block = results.bodies.values()
    assert ring.points == ["rim"] and len(ring.frequencies) == ring["modal/displacement"].shape[1]
    assert np.array_equal(ring["points/rim/velocity"], results["bodies/ring/points/velocity"][:, 0])
    assert ring["position"] is results["bodies/ring/position"]
    momentum = ring["momentum/linear"] + block["momentum/linear"]
    assert np.allclose(results["system/momentum/linear"], momentum, rtol=1e-12, atol=1e-30)
    column = results.columns["bodies/ring/points/velocity"]
    assert (column.scope, column.body) == ("point", "ring")
    assert results.columns["system/energy/total"].scope == "system"

    dataset = results.to_xarray()
    assert dataset["bodies/ring/points/velocity"].dims == ("time", "ring.point", "axis")
    assert ring.to_xarray()["points/velocity"].dims == ("time", "point", "axis")
    assert program("export", tmp_path / "pair.h5", "--csv", tmp_path / "pair.csv").returncode == 0
    exported = pandas.read_csv(tmp_path / "pair.csv", index_col=0)
    assert [name.split(" [")[0] for name in exported.columns] == list(results.to_pandas().columns)
    assert np.array_equal(exported.to_numpy(), results.to_pandas().to_numpy())


def test_a_run_without_points_is_a_table(rigid):
    results = flexframe.Simulation(flexframe.Body(rigid.scene.with_values({"output": {"interval": 0.1}}))).run()
    table = results.to_pandas()
    assert len(table) == len(results["time"]) and "position x" in table.columns
    assert not [name for name in table.columns if name.startswith("points/")]


# Conserved: the numbers of the whole run, bit for bit.
def test_a_run_in_parts_is_the_run(ring):
    whole = flexframe.Simulation(ring).run()
    simulation = flexframe.Simulation(ring)
    assert simulation.advance(steps=7).kind in ("row", "step")
    while not simulation.done:
        reached = simulation.advance()
        assert reached.kind == "row" and reached.time == simulation.time
    last = simulation.observe()
    for path in whole:
        assert np.array_equal(last[path], whole[path][-1]), path
    assert np.array_equal(last["points/struck/velocity"], whole["points/struck/velocity"][-1])
    assert simulation.stats["steps"] == 500


# Conserved: the same state after it was set.
def test_a_simulation_stops_at_times_and_goes_on_from_states(ring):
    simulation = flexframe.Simulation(ring)
    assert simulation.advance_to(0.00333).kind == "stop"
    assert simulation.time == pytest.approx(0.00333, rel=1e-12)
    state = simulation.state()
    there = simulation.observe()
    other = flexframe.Simulation(ring)
    other.set_state(state)
    assert other.time == simulation.time
    for path in ("attitude", "position", "modal/displacement", "modal/velocity", "energy/strain"):
        assert np.allclose(other.observe()[path], there[path], rtol=1e-11, atol=1e-11 * np.abs(there[path]).max()), path
    state["velocity"] *= -1.0
    other.set_state({"velocity": state["velocity"]})
    assert np.array_equal(other.state()["velocity"], state["velocity"])


def test_rows_on_stops_and_events_are_kept(rigid):
    rows = np.linspace(0.0, 1.0, 11)
    for stop in (0.5, 1.0):
        simulation = flexframe.Simulation(rigid)
        assert simulation.advance_to(stop).kind == "stop"
        if stop == 0.5:
            simulation.set_state({"velocity": [1.0, 0.0, 0.0]})
        found = simulation.run()
        assert found["time"] == pytest.approx(rows[rows > stop - 0.01], rel=1e-12)
    simulation = flexframe.Simulation(rigid)
    simulation.add_event("half", lambda row: row.time - 0.5)
    simulation.add_event("end", lambda row: row.time - 1.0)
    results = simulation.run()
    assert results["time"] == pytest.approx(rows, rel=1e-12)
    assert [name for name, _ in results.events] == ["half", "end"]


@pytest.mark.parametrize("end, step", [(1.0, 1e-3), (2.99, 0.01)])
def test_done_is_when_neither_a_step_nor_a_row_is_to_come(rigid, end, step):
    body = flexframe.Body(rigid.scene.with_values({"time": {"end": end, "step": step}}))
    for time in (end, np.nextafter(end, 0.0)):
        simulation = flexframe.Simulation(body)
        simulation.add_event("end", lambda row: row.time - time)
        reached = []
        while not simulation.done:
            reached.append(simulation.advance())
        assert [now.kind for now in reached] == ["row"] * (len(reached) - 2) + ["event", "row"]
        rows = np.array([now.time for now in reached if now.kind == "row"])
        assert rows == pytest.approx(np.append(np.arange(0.1, end - 0.05, 0.1), end), rel=1e-12)


def test_a_row_at_which_an_event_raised_comes_when_it_is_mended(rigid):
    broken, asked = [True], []

    def function(row):
        asked.append(row.time)
        if broken[0] and row.time > 0.5 - 1e-9:
            raise LookupError("the table has no such time")
        return 1.0

    simulation = flexframe.Simulation(rigid)
    simulation.add_event("event", function)
    assert asked == [0.0]
    with pytest.raises(LookupError, match="no such time") as raised:
        simulation.run()
    assert raised.value.results["time"] == pytest.approx(np.linspace(0.0, 0.4, 5), abs=1e-12)
    broken[0] = False
    assert simulation.run()["time"] == pytest.approx(np.linspace(0.5, 1.0, 6), rel=1e-12)


# Closed form: X + V t.
def test_a_run_from_a_set_state_begins_with_its_row(rigid):
    nothing = flexframe.Force("center", lambda motion: [0.0, 0.0, 0.0])
    simulation = flexframe.Simulation(rigid, [nothing])
    simulation.run()
    simulation.set_state({"time": 0.35, "velocity": [2.0, 0.0, 0.0], "origin": [1.0, 0.0, 0.0]})
    results = simulation.run()
    assert results["time"] == pytest.approx(np.append(0.35, np.linspace(0.4, 1.0, 7)), rel=1e-12)
    assert np.array_equal(results["velocity"][0], [2.0, 0.0, 0.0])
    assert results["position"][:, 0] == pytest.approx(1.0 + 2.0 * (results["time"] - 0.35), rel=1e-9)


def test_an_iteration_goes_on_though_the_state_is_set_at_every_row(rigid):
    simulation = flexframe.Simulation(rigid, [flexframe.Force("center", lambda motion: [0.0, 0.0, 0.0])])
    times = []
    for row in simulation:
        times.append(row.time)
        assert len(times) <= 11
        if not simulation.done:
            simulation.set_state({"velocity": [row.time, 0.0, 0.0]})
    assert times == pytest.approx(np.linspace(0.0, 1.0, 11), rel=1e-12)


# Conserved: the numbers of the results and of the CSV file, bit for bit.
def test_rows_become_a_dataset_and_a_table(ring, program, tmp_path):
    xarray, pandas = pytest.importorskip("xarray"), pytest.importorskip("pandas")
    results = flexframe.Simulation(ring).run()
    dataset = results.to_xarray()
    assert isinstance(dataset, xarray.Dataset)
    velocity = dataset["points/velocity"]
    assert velocity.dims == ("time", "point", "axis") and velocity.attrs["units"] == "mm/s"
    assert np.array_equal(velocity.sel(point="struck", axis="z"), results["points/struck/velocity"][:, 2])
    assert np.shares_memory(velocity.values, results["points/velocity"])
    assert dataset["mode"].values.tolist() == [1, 2, 3, 4] and np.array_equal(dataset["time"], results["time"])

    table = results.to_pandas()
    path = tmp_path / "ring.toml"
    path.write_text(ring.scene.with_values({"body.mesh": EXAMPLES.parent / "meshes/ring.msh"}).text)
    assert program("run", path, "-o", tmp_path, "--no-cache").returncode == 0
    assert program("export", tmp_path / "ring.h5", "--csv", tmp_path / "ring.csv").returncode == 0
    exported = pandas.read_csv(tmp_path / "ring.csv", index_col=0)
    assert [name.split(" [")[0] for name in exported.columns] == list(table.columns)
    assert np.array_equal(exported.to_numpy(), table.to_numpy())
    assert np.array_equal(table.index, results["time"])


def test_a_run_says_what_the_full_body_says(tmp_path):
    scene = flexframe.Scene(EXAMPLES / "ring.toml").with_values({"time.end": 0.01})
    results = flexframe.run(scene, tmp_path / "checked")
    (body,) = results.check.values()
    assert body["not_checked"] is None
    first = body["rows"][0]
    assert "largest strain energy" in first["why"]
    # A state of small displacements: what is left of it is what no mode has.
    assert 0 < first["error_of_largest"] <= first["error"] < 0.1
    assert results["time"][first["row"]] == first["time"]
    # Conserved: the parts make up the error. Of three vectors two may be at an angle: along the modes, and what a linear body has there, too.
    along, left_out, bending = (size for size, _ in first["parts"].values())
    squares = along**2 + left_out**2 + bending**2
    assert abs(squares - first["error_of_largest"] ** 2) <= 2 * along * left_out * (1 + 1e-9)
    assert flexframe.run(scene, tmp_path / "alone", check=False).check is None
