"""Results, body files, tables of sweeps and FMUs with bytes changed, cut, or written anew by HDF5."""

import os
import random
import shutil

import h5py

from program import Count, fault
import signals
import systems

SWEEP = 'scene = "top.toml"\nparameters = { "time.end" = [0.01, 0.02] }\nresults = { w = { final = "system/energy/kinetic" } }\n'
BODY = ('title = "bar"\nunits = { length = "mm", mass = "Mg", time = "s" }\n[body]\nmesh = "bar.msh"\n'
        'material = { young_modulus = 70e3, poisson_ratio = 0.3, density = 2.7e-9 }\n[modes]\nflexible = 2\n'
        '[initial]\nangular_velocity = [1, 2, 3]\n[[loads]]\nkind = "force"\nat = [200, 0, 0]\ndirection = [0, 0, -1]\namplitude = 1.0\n[output]\npoints = { tip = [200, 0, 0] }\n[time]\nend = 1e-4\nstep = 1e-5\n')
HERE = os.path.dirname(os.path.abspath(__file__))
SEEDS = {
    "bar.h5": [["export", "--csv", "x", "--overwrite"], ["report", "-o", "x.html", "--overwrite"], ["check"], ["resume"], ["animate", "-o", "x.gif", "--overwrite"]],
    "bar.part.h5": [["resume"], ["export", "--csv", "x", "--overwrite"]],
    "bar.body.h5": [["modes"], ["fmu", "-o", "x.fmu", "--overwrite"]],
}


def seeds(program, folder):
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    shutil.copy(os.path.join(HERE, "../../model/tests/data/bar.msh"), os.path.join(folder, "bar.msh"))
    with open(os.path.join(folder, "bar.toml"), "w") as file:
        file.write(BODY)
    for command in [["run", "bar.toml", "-o", ".", "--no-check"], ["reduce", "bar.toml", "-o", "bar.body.h5"],
                    ["run", "bar.toml", "-o", "part", "--no-check", "--set", "time.end=1e3", "--set", "output.interval=1"]]:
        child = program.start(command, folder)
        if "part" in command:
            path = os.path.join(folder, "part", "bar.part.h5")
            while not os.path.exists(path) and child.poll() is None:
                pass
            child.kill()
        child.communicate()
    shutil.copy(os.path.join(folder, "part", "bar.part.h5"), os.path.join(folder, "bar.part.h5"))
    return {name: open(os.path.join(folder, name), "rb").read() for name in SEEDS}


def forge(rng, path, sound):
    """Writes a changed file; its kind."""
    kind = rng.choice(["bytes", "bytes", "cut", "zeros", "other", "anew"])
    data = bytearray(sound)
    if kind == "bytes":
        for _ in range(rng.choice([1, 1, 4, 100])):
            data[rng.randrange(len(data))] = rng.randrange(256)
    elif kind == "cut":
        del data[rng.randrange(len(data)):]
    elif kind == "zeros":
        start = rng.randrange(len(data))
        data[start:start + rng.choice([8, 512, 8192])] = bytes(8)
    elif kind == "other":
        start, other = rng.randrange(len(data)), rng.randrange(len(data))
        data[start:start + 512] = data[other:other + 512]
    with open(path, "wb") as file:
        file.write(data)
    if kind == "anew":
        with h5py.File(path, "r+") as file:
            names = []
            file.visit(names.append)
            item = file[rng.choice(names)]
            if isinstance(item, h5py.Dataset) and item.dtype.kind == "f" and item.size and rng.random() < 0.5:
                item[...] = rng.choice([float("nan"), 1e308, 0.0])
            elif rng.random() < 0.5 and len(item.attrs):
                key = rng.choice(list(item.attrs))
                try:
                    item.attrs[key] = rng.choice(["x\n=1+1", "/etc/passwd", -1, 2**62])
                except (TypeError, ValueError, OSError):
                    pass
            else:
                del file[rng.choice(names)]
    return kind


def written(folder):
    """Bytes of the outputs; a page has the time at which it was made, and is left out."""
    found = {}
    for path in ["x.gif", "x/bar.csv", "x/bar.part.csv"]:
        path = os.path.join(folder, path)
        if os.path.exists(path):
            with open(path, "rb") as file:
                found[path] = file.read()
            os.remove(path)
    return found


def attack(program, trials, first=0):
    count = Count("forged", "results, unfinished and body files with bytes changed, cut, zeroed or moved, and written anew by h5py; read by `export`, `report`, `check`, "
                  "`resume`, `animate`, `modes`, `fmu`: refused, or the answers of the sound file from what is read")
    folder = os.path.join(program.folder, "forged")
    sound = seeds(program, folder)
    outputs = {}
    os.makedirs(os.path.join(folder, "forged"))
    for name, commands in SEEDS.items():
        for command in commands:
            with open(os.path.join(folder, "forged", name), "wb") as file:
                file.write(sound[name])
            if command[0] not in ("resume", "check"):
                program.run([command[0], f"forged/{name}", *command[1:]], folder)
                outputs[name, command[0]] = written(folder)
    for seed in count.seeds(first, trials):
        rng = random.Random(seed)
        name = rng.choice(list(SEEDS))
        path = os.path.join(folder, "forged", name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        kind = forge(rng, path, sound[name])
        command = rng.choice(SEEDS[name])
        code, _, said = program.run([command[0], f"forged/{name}", *command[1:]], folder, 60)
        wrong = fault(code, said)
        with open(path, "rb") as file:
            changed = file.read() != sound[name]
        # What a command does not read may be damaged.
        found = written(folder)
        if code == 0 and changed and not wrong and found != outputs.get((name, command[0]), {}) and command[0] != "resume":
            wrong = f"{kind}: other answers of {command[0]}"
        count.add("refused" if code else "read", wrong, f"{seed} {name} {kind}")
    return count
