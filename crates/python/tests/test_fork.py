"""Processes that Python forks (`multiprocessing`) after flexframe has used its threads."""

import multiprocessing

import numpy as np
import pytest

import flexframe

from conftest import ROOT

SCENE = ROOT / "examples/ring.toml"
FORK = multiprocessing.get_context("fork")


def tip(seconds):
    """A body of its own in this process, its run, and a step by step run."""
    scene = flexframe.Scene(SCENE).with_values({"time.end": seconds, "output.stress": True})
    body = flexframe.Body(scene)
    rows = [row["points/struck/displacement"] for row in flexframe.Simulation(body)]
    results = flexframe.Simulation(body).run()
    return np.array(rows), results["points/struck/displacement"]


def put(queue, seconds):
    queue.put(tip(seconds))


def test_a_forked_process_does_what_its_parent_does():
    expected, results = tip(0.02)
    assert np.array_equal(expected, results)
    queue = FORK.Queue()
    child = FORK.Process(target=put, args=(queue, 0.02))
    child.start()
    try:
        found, again = queue.get(timeout=120)
    finally:
        child.kill()
        child.join()
    assert np.array_equal(found, expected) and np.array_equal(again, expected)


def test_a_pool_of_forked_processes_shares_a_body():
    scene = flexframe.Scene(SCENE).with_values({"time.end": 0.01, "output.stress": True})
    body = flexframe.Body(scene)
    expected = flexframe.Simulation(body).run()["energy/strain"]
    global run  # found by the forked processes

    def run(_):
        return flexframe.Simulation(body).run()["energy/strain"]

    with FORK.Pool(2) as pool:
        for found in pool.map_async(run, range(4)).get(timeout=120):
            assert np.array_equal(found, expected)


def test_errors_cross_to_the_parent():
    flexframe.Body(flexframe.Scene(SCENE))
    with FORK.Pool(1) as pool:
        with pytest.raises(Exception, match="No such file"):
            pool.apply_async(flexframe.Scene, ("nowhere.toml",)).get(timeout=60)
