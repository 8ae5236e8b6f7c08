"""Ctrl-C."""

import signal
import subprocess
import sys
import textwrap

import numpy as np
from conftest import EXAMPLES, ROOT

import flexframe

HEAD = f"""
import sys
sys.path.insert(0, {str(ROOT / "crates/python/tests")!r})
import flexframe
from conftest import EXAMPLES, RIGID, RING
LONG = {{"time.end": 1e6, "output": {{"interval": 1e3, "points": {{"corner": [0.3, 0.1, -0.2]}}}}}}
"""


def interrupted(program, folder):
    """Output of a program of Python that gets a Ctrl-C when it has printed "go"."""
    script = HEAD + textwrap.dedent(program)
    child = subprocess.Popen([sys.executable, "-u", "-c", script], cwd=folder, stdout=subprocess.PIPE,
                             stderr=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "go\n", child.stderr.read()
    child.send_signal(signal.SIGINT)
    said, wrong = child.communicate(timeout=120)
    assert child.returncode == 0, wrong
    return said


def test_a_run_in_memory_stops_and_may_go_on(tmp_path):
    said = interrupted(
        """
        simulation = flexframe.Simulation(flexframe.Body(flexframe.Scene(RIGID).with_values(LONG)))
        try:
            print("go")
            simulation.run()
        except KeyboardInterrupt:
            time = simulation.time
            simulation.advance()
            print(0 <= time < simulation.time)
        """,
        tmp_path,
    )
    assert said == "True\n"


def test_a_law_is_interrupted_where_it_is(tmp_path):
    said = interrupted(
        """
        import time
        def law(motion):
            if motion.time > 0.1:
                print("go")
                time.sleep(60)
            return [0.0, 0.0, 0.0]
        simulation = flexframe.Simulation(flexframe.Body(flexframe.Scene(RIGID)), [flexframe.Force("corner", law)])
        try:
            simulation.run()
        except KeyboardInterrupt as stopped:
            print(round(simulation.time, 3), len(stopped.results["time"]))
        """,
        tmp_path,
    )
    assert said == "0.1 2\n"


def test_a_run_with_a_file_stops_and_is_resumed(tmp_path):
    said = interrupted(
        """
        import os, signal, threading
        scene = flexframe.Scene(RIGID, name="long").with_values({"time.end": 20.0, "time.step": 2e-5, "output.interval": 0.1})
        def tell():
            while not os.path.exists("out/long.part.h5"):
                pass
            print("go")
        threading.Thread(target=tell).start()
        try:
            flexframe.run(scene, "out")
        except KeyboardInterrupt as stopped:
            print(" ".join(getattr(stopped, "__notes__", ["go on with: flexframe resume"])))
        print(sorted(os.listdir("out")))
        """,
        tmp_path,
    )
    assert "go on with: flexframe resume" in said and "['long.part.h5']" in said
    part = tmp_path / "out/long.part.h5"
    before = flexframe.read_results(part)
    rows = len(before["time"])
    assert not before.complete and rows < 201
    after = flexframe.resume(part)
    assert after.complete and len(after["time"]) == 201
    assert np.array_equal(after["attitude"][:rows], before["attitude"])


def test_building_stops_at_once(tmp_path):
    said = interrupted(
        f"""
        import time
        scene = flexframe.Scene({str(EXAMPLES / "plate.toml")!r}).with_values({{"modes.flexible": 400}})
        try:
            print("go")
            flexframe.Body(scene)
        except KeyboardInterrupt:
            print("stopped")
        """,
        tmp_path,
    )
    assert said == "stopped\n"
