"""Signals at random times, and resumes until the run is at its end."""

import os
import random
import shutil
import signal
import subprocess
import time

import h5py
import numpy as np

from program import Count, fault
import systems

SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL, signal.SIGABRT, signal.SIGQUIT, signal.SIGUSR1, signal.SIGXCPU]
# Answered in words, with the exit code of a stop.
ASKED = SIGNALS[:3]
PENDULUM = {
    "title": "two", "units": {"length": "m", "mass": "kg", "time": "s"},
    "bodies": {name: {"rigid": {"mass": 1.0, "center_of_mass": [0.2, 0, 0], "inertia": [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]},
                      "markers": {"a": {"at": [0, 0, 0]}, "b": {"at": [0.5, 0, 0]}}, "initial": {"position": [0.5 * i, 0, 0]},
                      "loads": [{"kind": "gravity", "direction": [0, 0, -1], "amplitude": 9.81}]} for i, name in enumerate(["one", "two"])},
    "joints": [{"name": "p", "kind": "revolute", "axis": [0, 1, 0], "between": ["ground", "one.a"]},
               {"name": "q", "kind": "revolute", "axis": [0, 1, 0], "between": ["one.b", "two.a"]}],
    "time": {"end": 3.0, "tolerance": 1e-9}, "output": {"interval": 0.001}}
TOP = {"title": "top", "units": {"length": "m", "mass": "kg", "time": "s"},
       "body": {"rigid": {"mass": 1.0, "center_of_mass": [0, 0, 0], "inertia": [[1, 0, 0], [0, 2, 0], [0, 0, 2.5]]}},
       "initial": {"angular_velocity": [1.0, 20.0, 3.0]}, "time": {"end": 60.0, "step": 1e-3}, "output": {"every": 10}}


def rows(path):
    found = {}
    with h5py.File(path, "r") as file:
        file.visititems(lambda name, item: found.update({name: item[...]}) if isinstance(item, h5py.Dataset) and item.dtype.kind == "f" else None)
    return found


def attack(program, trials, first=0):
    count = Count("signals", "signals of eight kinds at random times to runs of a lone body and of two in joints, each resumed, with more signals, until it is at its "
                  "end: the same numbers as without signals")
    folder = os.path.join(program.folder, "signals")
    for name, scene in [("two", PENDULUM), ("top", TOP)]:
        os.makedirs(os.path.join(folder, name), exist_ok=True)
        with open(os.path.join(folder, name, f"{name}.toml"), "w") as file:
            file.write(systems.text(scene))
        started = time.time()
        code, _, said = program.run(["run", f"{name}.toml", "-o", "whole", "--no-check", "--overwrite"], os.path.join(folder, name))
        assert code == 0, said
        scene["seconds"] = time.time() - started
        scene["rows"] = rows(os.path.join(folder, name, "whole", f"{name}.h5"))
    resumes = 0
    for seed in count.seeds(first, trials):
        rng = random.Random(seed)
        name, scene = rng.choice([("two", PENDULUM), ("top", TOP)])
        here = os.path.join(folder, name)
        out = os.path.join(here, "out")
        shutil.rmtree(out, ignore_errors=True)
        shutil.rmtree(program.temporary)
        os.makedirs(program.temporary)
        end, part = os.path.join(out, f"{name}.h5"), os.path.join(out, f"{name}.part.h5")
        command, wrong, sent = ["run", f"{name}.toml", "-o", "out", "--no-check"], None, 0
        for _ in range(40):
            child = program.start(command, here)
            which = rng.choice(SIGNALS)
            is_sent = sent < 4
            if is_sent:
                time.sleep(rng.uniform(0, 1.2) * scene["seconds"])
                child.send_signal(which)
                sent += 1
            asked = time.time()
            try:
                out_, said = child.communicate(timeout=60)
            except subprocess.TimeoutExpired:
                child.kill()
                child.communicate()
                wrong = f"{which.name} is not answered"
                break
            said, code = said.decode(errors="replace"), child.returncode
            if code == 0:
                break
            if is_sent and code == -which:
                pass
            elif is_sent and which in ASKED and code == 130:
                if time.time() - asked > 5:
                    wrong = f"{which.name} was answered after {time.time() - asked:.1f} s"
            else:
                wrong = fault(code, said) or f"exit code {code} after {which.name}: {said[-200:]}"
                break
            if which != signal.SIGKILL and os.listdir(program.temporary):
                wrong = f"{which.name} leaves temporary files"
            if os.path.exists(part):
                command = ["resume", os.path.relpath(part, here)]
                resumes += 1
            elif os.path.exists(end):
                command = ["resume", os.path.relpath(end, here)]
            else:
                command = ["run", f"{name}.toml", "-o", "out", "--no-check", "--overwrite"]
        else:
            wrong = "does not come to its end"
        if not wrong:
            found = rows(end)
            other = [key for key, numbers in scene["rows"].items() if key not in found or not np.array_equal(numbers, found[key], equal_nan=True)]
            wrong = f"other numbers: {other[:3]}" if other else None
        count.add(f"{name}, {sent} signals", wrong, seed)
    count.note = f"{resumes} resumes"
    return count
