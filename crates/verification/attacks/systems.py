"""Random scenes of systems with all keys, most of them rare, some of them wrong."""

import json
import os
import random

import h5py
import numpy as np

from program import Count, fault

KINDS = ["fixed", "revolute", "prismatic", "cylindrical", "spherical", "universal", "planar"]
TURNS, SLIDES = {"revolute", "cylindrical"}, {"prismatic", "cylindrical"}


class Maker:
    def __init__(self, seed):
        self.rng = random.Random(seed)
        self.end = 10 ** self.rng.uniform(-2, 0)
        # Three of four have nothing that is wrong by itself.
        self.is_wild = self.rng.random() < 0.25

    def chance(self, share):
        return self.rng.random() < share

    def number(self, size=1.0):
        """Mostly ordinary, now and then zero, huge or tiny."""
        rng = self.rng
        if self.is_wild and self.chance(0.02):
            return rng.choice([0.0, 1e-30, 1e30, -1e-12, 1e9, 5e-324, 1e308])
        return size * rng.uniform(-1, 1)

    def positive(self, size=1.0):
        return size * 10 ** self.rng.uniform(-2, 1) if not (self.is_wild and self.chance(0.02)) else self.rng.choice([0.0, -1.0, 1e-300, 1e300])

    def vector(self, size=1.0):
        if self.chance(0.3):
            vector = [0.0, 0.0, 0.0]
            vector[self.rng.randrange(3)] = self.rng.choice([-1.0, 1.0]) * size
            return vector
        return [self.number(size) for _ in range(3)]

    def history(self, depth=0):
        rng, end = self.rng, self.end
        start = rng.uniform(-0.2, 1.2) * end
        kind = rng.choice(["constant", "step", "ramp", "half-sine", "sine", "sweep", "table", "expression", "product"])
        if kind == "step":
            return {"kind": kind, "at": start}
        if kind in ("ramp", "half-sine"):
            return {"kind": kind, "duration": self.positive(end), "start": start}
        if kind == "sine":
            return {"kind": kind, "frequency": self.positive(3 / end), "phase": self.number(7), "start": start}
        if kind == "sweep":
            return {"kind": kind, "duration": self.positive(end), "from": self.positive(1 / end), "to": self.positive(5 / end)}
        if kind == "table":
            times = sorted(rng.uniform(-0.1, 1.1) * end for _ in range(rng.randint(2, 9)))
            if self.chance(0.05):
                times[-1] = times[0]
            return {"kind": kind, "points": [[t, self.number()] for t in times], "interpolation": rng.choice(["linear", "monotone-cubic"])}
        if kind == "expression":
            formula = rng.choice(["t", "sin(20*t)", "t^2", "exp(-t)", "abs(t-0.01)", "1/t", "sqrt(-t)", "tanh(100*(t-0.01))", "t*", "min(t,0.01)"])
            return {"kind": kind, "formula": formula, **({"discontinuities": [0.3 * end]} if self.chance(0.3) else {})}
        if kind == "product" and depth < 2:
            return {"kind": kind, "factors": [self.history(depth + 1) for _ in range(rng.randint(1, 3))]}
        return {"kind": "constant"}

    def along(self, kind):
        choice = [name for name, kinds in (("turn", TURNS), ("slide", SLIDES)) if kind in kinds]
        return {"along": self.rng.choice(choice)} if len(choice) > 1 or choice and self.chance(0.5) else {}

    def spring(self, kind):
        spring = self.along(kind)
        for key, size in [("stiffness", 100), ("damping", 1)]:
            if self.chance(0.6):
                spring[key] = self.positive(size)
        for key in ["free", "preload"]:
            if self.chance(0.3):
                spring[key] = self.number()
        if self.chance(0.3):
            spring["stops"] = {"low": self.number() - 1, "high": 1 + self.number(), "stiffness": self.positive(1e4)}
        if self.chance(0.3):
            spring["friction"] = {"force": self.positive(), "rate": self.positive(0.1)}
        return spring

    def scene(self):
        rng = self.rng
        names = [rng.choice(["a", "b c", "ä", "ground", "B", "längs", '"q"', "n"] + ["x.y"] * self.is_wild) + str(i) for i in range(rng.randint(1, 5))]
        bodies, ends, places = {}, ["ground"], {}
        for name in names:
            place = self.vector()
            sides = [min(self.positive(0.3), 1e100) ** 2 for _ in range(3)]
            moments = [sides[1] + sides[2], sides[0] + sides[2], sides[0] + sides[1]]
            marks = {"m": {"at": [0.0, 0.0, 0.0]}}
            if self.chance(0.5):
                marks["tip"] = {"at": self.vector(0.5), **({"z": self.vector()} if self.chance(0.4) else {}), **({"x": self.vector(), "z": self.vector()} if self.chance(0.2) else {})}
            body = {"rigid": {"mass": self.positive(), "center_of_mass": self.vector(0.3) if self.chance(0.5) else [0.0] * 3,
                              "inertia": [[moments[0], 0, 0], [0, moments[1], 0], [0, 0, moments[2]]]},
                    "markers": marks, "initial": {"position": place}}
            for key, share in [("velocity", 0.2), ("angular_velocity", 0.3)]:
                if self.chance(share):
                    body["initial"][key] = self.vector(3)
            if self.chance(0.3):
                body["initial"]["attitude"] = [self.number() for _ in range(4)]
            if self.chance(0.5):
                body["loads"] = [{"kind": "gravity", "direction": [0, 0, -1], "amplitude": 9.81}]
            if self.chance(0.3):
                load = {"kind": rng.choice(["force", "moment"] + ["base-acceleration"] * self.is_wild), "direction": rng.choice([[1, 0, 0], [0, 0.6, 0.8]] + [self.vector()] * self.is_wild),
                        "amplitude": self.number(5), "history": self.history()}
                body.setdefault("loads", []).append({**load, **({"at": [0, 0, 0]} if load["kind"] != "base-acceleration" else {}),
                                                     **({"frame": rng.choice(["body", "global", "material"])} if load["kind"] != "base-acceleration" and self.chance(0.4) else {})})
            if self.chance(0.2):
                body["points"] = {"p": self.vector()}
            if self.chance(0.1):
                body["effects"] = {rng.choice(["coriolis", "gravity", "rotation", "damping", "refuse"]): rng.choice([True, False])}
            bodies[name] = body
            ends += [f"{name}.{mark}" for mark in marks]
        scene = {"title": "random", "units": {"length": "m", "mass": "kg", "time": "s"}, "bodies": bodies}
        if self.chance(0.3):
            scene["ground"] = {"markers": {"g": {"at": self.vector(), **({"z": self.vector()} if self.chance(0.5) else {})}}}
            ends.append("ground.g")
        joints = []
        for name in names:
            before = [end for end in ends if end.split(".")[0] not in names[names.index(name):]]
            for _ in range(1 + self.chance(0.2)):
                kind = rng.choice(KINDS)
                joint = {"name": f"j{len(joints)}", "kind": kind, "between": [rng.choice(ends if self.is_wild else before), f"{name}.m"]}
                if self.chance(0.1):
                    del joint["kind"]
                    joint["locked"] = rng.sample(["x", "y", "z", "rx", "ry", "rz"], rng.randint(0, 6))
                if not self.is_wild or self.chance(0.8):
                    joint["axis"] = self.vector() if self.chance(0.5) else [0.0, 0.0, 1.0]
                if self.chance(0.15):
                    joint["between"][0] = rng.choice(ends if self.is_wild else [end for end in ends if not end.startswith(f"{name}.")])
                moves = "kind" in joint and kind in TURNS | SLIDES
                if self.chance(0.4) and (moves or self.is_wild):
                    joint["spring"] = self.spring(kind)
                if self.chance(0.25) and (moves or self.is_wild):
                    joint["drive" if self.chance(0.4) else "motor"] = {**self.along(kind), "amplitude": self.number(3), "history": self.history()}
                joints.append(joint)
        scene["joints"] = joints
        if self.chance(0.2):
            scene["springs"] = [{"between": rng.sample(ends[1:], 2) if len(ends) > 2 else ["ground", "ground"], "stiffness": self.positive(50), "damping": self.positive()}]
        if self.chance(0.2):
            scene["bushings"] = [{"between": rng.sample(ends, 2), "stiffness": {"translation": self.vector(100), "rotation": [1, 1, 1]}}]
        if self.chance(0.15) and joints:
            kind = rng.choice(["gear", "rack", "screw"])
            pair = [rng.choice(joints)["name"] for _ in range(2)]
            scene["couplings"] = [{"kind": kind, **({"joints": pair} if kind != "screw" else {"joint": pair[0]}),
                                   {"gear": "ratio", "rack": "radius", "screw": "lead"}[kind]: self.number()}]
        if self.chance(0.15):
            scene["relaxed"] = True
        scene["time"] = {"end": self.end, **({"tolerance": 10 ** rng.uniform(-7, -2)} if self.chance(0.7) else {"step": self.end / rng.randint(5, 200)})}
        if self.chance(0.3):
            scene["time"]["scheme"] = rng.choice(["radau", "gauss", "rkmk4"] + ["exponential", "paper"] * self.is_wild)
        if self.chance(0.5):
            scene["output"] = {"interval": self.end / rng.randint(1, 30)}
        if self.is_wild and self.chance(0.2):
            scene[rng.choice(["jonits", "modes", "body", "effects"])] = {"x": 1}
        return scene


def toml(value):
    """A value in TOML: its tables are written inline."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{json.dumps(key, ensure_ascii=False)} = {toml(inner)}" for key, inner in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    return json.dumps(value, ensure_ascii=False)


def text(scene):
    return "".join(f"{key} = {toml(value)}\n" for key, value in scene.items())


def not_finite(path):
    """Names of the data sets of the motion with numbers that are not finite."""
    found = []

    def look(name, item):
        if isinstance(item, h5py.Dataset) and item.dtype.kind == "f" and "/model/" not in name and not name.startswith("trust/") and not np.isfinite(item[...]).all():
            found.append(name)

    with h5py.File(path, "r") as file:
        file.visititems(look)
    return found


COMMANDS = [["modes"], ["advise"], ["linearize", "-o", "l.json"], ["campbell", "--speeds", "0:5:3", "--joint", "j0"], ["frf", "--frequencies", "1:10:3"], ["cost", "--patience", "1"],
            ["gradient"], ["fmu", "-o", "x.fmu"]]


def attack(program, trials, first=0):
    count = Count("systems", "random scenes of one to five bodies with all keys of joints, springs, couplings and histories, a quarter of them with wrong ones; run, "
                  "and some of those that ran by another command")
    folder = os.path.join(program.folder, "systems")
    os.makedirs(folder, exist_ok=True)
    for seed in count.seeds(first, trials):
        scene = Maker(seed).scene()
        with open(os.path.join(folder, "scene.toml"), "w") as file:
            file.write(text(scene))
        result = os.path.join(folder, "out", "scene.h5")
        if os.path.exists(result):
            os.remove(result)
        code, out, said = program.run(["run", "scene.toml", "-o", "out", "--overwrite", "--no-check"], folder, 60)
        wrong = fault(code, said)
        if code == 0 and (bad := not_finite(result)):
            wrong = f"not finite: {bad[:3]}"
        count.add({0: "run", 3: "refused as input", 4: "refused as a model", 5: "ended with a reason", None: "too long"}.get(code, "other"), wrong, seed)
        if seed % 3 == 0 and code == 0:
            command = COMMANDS[seed // 3 % len(COMMANDS)]
            code, _, said = program.run([command[0], "scene.toml", *command[1:], *([] if command[0] in ("modes", "advise") else ["--overwrite"])], folder, 60)
            # Else nothing of the command would be attacked.
            wrong = "not a command line" if "unexpected argument" in said else fault(code, said)
            count.add(command[0] if code == 0 else f"{command[0]} refused", wrong, f"{seed} {command[0]}")
    return count
